//! `[sweep]`: band, levels and control of a steady forced response.

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
    "direction",
    "at",
    "harmonics",
    "points",
    "damping_ratio",
];

/// Quantities that may be held constant during a sweep; the table must name exactly one.
const CONTROLS: [Control; 5] = [
    Control::Force,
    Control::BaseAcceleration,
    Control::Displacement,
    Control::Velocity,
    Control::Acceleration,
];

/// The table as written, with defaults filled in.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepTable {
    /// Band, levels and harmonics.
    pub sweep: Sweep,
    /// The point whose response is held or returned; none: the modal displacement, or on a structure the loaded point.
    pub at: Option<String>,
    /// Viscous damping ratio of all modes of a structure; modes of a scenario have ratios of their own.
    pub damping_ratio: Option<f64>,
    /// Direction (x, y, z), of length 1, in which the base of a structure is accelerated; modes of a scenario have participation factors
    /// instead.
    pub direction: Option<[f64; 3]>,
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
        let direction = direction(&section, control)?;
        Ok(Some(Self { sweep, at: section.optional_text("at")?, damping_ratio, direction }))
    }
}

/// The direction of the base's motion.
fn direction(section: &Section<'_>, control: Control) -> Result<Option<[f64; 3]>, InputError> {
    if !section.has("direction") {
        return Ok(None);
    }
    if control != Control::BaseAcceleration {
        let message = format!("direction is that of base_acceleration, and {} is held", control.name());
        return Err(section.failure("direction", &message, "remove it, or hold base_acceleration"));
    }
    let given = section.numbers("direction")?;
    let length = given.iter().map(|d| d * d).sum::<f64>().sqrt();
    match <[f64; 3]>::try_from(given.as_slice()) {
        Ok(d) if length > 0.0 && length.is_finite() => Ok(Some(d.map(|d| d / length))),
        _ => {
            let message = "direction must be three numbers x, y, z that are not all 0";
            Err(section.failure("direction", message, "give it as in direction = [0, 0, 1]"))
        }
    }
}

/// The quantity that is held, and its levels.
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

/// The error for a value that the library refuses, at the place of that value.
fn refused(section: &Section<'_>, control: Control, error: &iwan_sim::SimulationError) -> InputError {
    let iwan_sim::SimulationError::Parameter(iwan_core::Error::OutOfRange { name, value, allowed }) = error
    else {
        return section.failure("from", &error.to_string(), "change this value");
    };
    let key = if *name == "level" { control.name() } else { name };
    let message = format!("{key} = {} is out of range: {allowed}", plain(*value));
    section.failure(key, &message, &format!("give {key} a value in that range"))
}
