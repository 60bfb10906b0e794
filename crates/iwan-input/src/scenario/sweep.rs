//! `[sweep]`: what a steady forced response is asked for.

use iwan_sim::{Control, Sweep};

use crate::error::InputError;
use crate::section::{Section, plain};
use crate::text::InputText;

/// Keys of the table.
pub(crate) const KEYS: &[&str] = &[
    "from",
    "to",
    "force",
    "base_acceleration",
    "displacement",
    "velocity",
    "acceleration",
    "at",
    "harmonics",
    "points",
    "damping_ratio",
];

/// What may be held, one of which the table names.
const CONTROLS: [Control; 5] = [
    Control::Force,
    Control::BaseAcceleration,
    Control::Displacement,
    Control::Velocity,
    Control::Acceleration,
];

/// The table as written, with its defaults.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepTable {
    /// Band, levels and harmonics.
    pub sweep: Sweep,
    /// The point whose response is held or returned; none: the modal displacement, on a structure the loaded point.
    pub at: Option<String>,
    /// Viscous ratio of all modes of a structure; modes of a scenario have their own.
    pub damping_ratio: Option<f64>,
}

impl SweepTable {
    /// Reads the table, if there is one.
    pub(super) fn read(source: &InputText, top: &Section<'_>) -> Result<Option<Self>, InputError> {
        let Some(place) = top.optional_table("sweep")? else { return Ok(None) };
        let section = Section::new(source, "[sweep]", place, KEYS)?;
        let (control, levels) = levels(&section)?;
        let harmonics = section.optional_count("harmonics")?.unwrap_or(1);
        let points = section.optional_count("points")?.unwrap_or(Sweep::DEFAULT_POINTS);
        let (from, to) = (section.number("from")?, section.number("to")?);
        let sweep = Sweep { from, to, control, levels, harmonics, points };
        if let Err(error) = sweep.checked() {
            return Err(refused(&section, control, &error));
        }
        let damping_ratio = section.optional_number("damping_ratio")?;
        if let Some(ratio) = damping_ratio.filter(|ratio| !(0.0..1.0).contains(ratio)) {
            let message = format!(
                "damping_ratio = {} is out of range: must satisfy 0 <= damping_ratio < 1",
                plain(ratio)
            );
            return Err(section.failure("damping_ratio", &message, "give it as a ratio: 0.01 is 1 %"));
        }
        Ok(Some(Self { sweep, at: section.optional_text("at")?, damping_ratio }))
    }
}

/// What is held, and at which levels.
fn levels(section: &Section<'_>) -> Result<(Control, Vec<f64>), InputError> {
    let mut given = CONTROLS.iter().filter(|control| section.has(control.name()));
    let remedy = "give one of force, base_acceleration, displacement, velocity, acceleration = [LEVEL, ...]";
    let Some(&control) = given.next() else {
        return Err(section.failure("force", "no level is given", remedy));
    };
    if let Some(other) = given.next() {
        let message = format!("`{}` and `{}` exclude each other", control.name(), other.name());
        return Err(section.failure(other.name(), &message, remedy));
    }
    let levels = section.numbers(control.name())?;
    if levels.is_empty() {
        let message = format!("{} = [] has no level", control.name());
        return Err(section.failure(control.name(), &message, remedy));
    }
    Ok((control, levels))
}

/// The refusal of a value, at its place.
fn refused(section: &Section<'_>, control: Control, error: &iwan_sim::SimulationError) -> InputError {
    let iwan_sim::SimulationError::Parameter(iwan_core::Error::OutOfRange { name, value, allowed }) = error
    else {
        return section.failure("from", &error.to_string(), "change this value");
    };
    let key = if *name == "level" { control.name() } else { name };
    let message = format!("{key} = {} is out of range: {allowed}", plain(*value));
    section.failure(key, &message, &format!("give {key} a value in that range"))
}
