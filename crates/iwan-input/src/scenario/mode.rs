//! `[[mode]]`: an oscillator with its joint.

use iwan_core::ResidualStiffness;
use iwan_machine::is_harmful;
use iwan_sim::{Mode, Point};

use crate::error::InputError;
use crate::section::{Section, TablePlace, plain};
use crate::text::InputText;
use crate::written_law::WrittenLaw;

use super::{curves, part};
use iwan_sim::numbers::significant;

/// Keys of a mode.
pub(crate) const KEYS: &[&str] = &[
    "name",
    "frequency",
    "damping_ratio",
    "joint",
    "parts",
    "curves",
    "shape_at_force",
    "outputs",
    "initial",
    "allow_negative_residual",
    "informed",
];

/// Keys of a mode's initial conditions.
pub(crate) const INITIAL_KEYS: &[&str] = &["displacement", "velocity"];

/// A mode, and its joint as the file writes it.
#[derive(Debug, Clone, PartialEq)]
pub struct ScenarioMode {
    /// The mode for the simulation.
    pub mode: Mode,
    /// The mode's joint as the file writes it.
    pub joint: Option<WrittenLaw>,
    /// Smallest and largest amplitude of the modal displacement in the records from which this mode was identified.
    pub informed: Option<[f64; 2]>,
}

impl ScenarioMode {
    /// Reads and checks one mode; `index` counts from 0.
    pub(super) fn read(source: &InputText, index: usize, place: TablePlace<'_>) -> Result<Self, InputError> {
        let section = Section::new(source, format!("mode {}", index + 1), place, KEYS)?;
        let name = section.name("name")?;
        let section = section.renamed(format!("mode \"{name}\""));
        let joint = section.optional_table("joint")?.map(|table| read_joint(source, &section, table));
        let (joint, law) = joint.transpose()?.unzip();
        let residual = match section.optional_flag("allow_negative_residual")? {
            Some(true) => ResidualStiffness::Any,
            _ => ResidualStiffness::Positive,
        };
        let mode = Mode {
            damping_ratio: section.number_or("damping_ratio", 0.0)?,
            joint: law,
            parts: part::read(source, &section)?,
            residual,
            shape_at_force: section.number_or("shape_at_force", 1.0)?,
            outputs: read_outputs(source, &section)?,
            initial: read_initial(source, &section)?,
            ..of_curves(source, &section, name)?
        };
        mode.oscillator().map_err(|error| oscillator_failure(&section, error))?;
        Ok(Self { mode, joint, informed: read_informed(&section)? })
    }
}

fn read_informed(section: &Section<'_>) -> Result<Option<[f64; 2]>, InputError> {
    if !section.has("informed") {
        return Ok(None);
    }
    let values = section.numbers("informed")?;
    match values[..] {
        [low, high] if low > 0.0 && low <= high && high.is_finite() => Ok(Some([low, high])),
        _ => {
            let written: Vec<String> = values.iter().map(|value| plain(*value)).collect();
            let message = format!(
                "informed = [{}] is out of range: must be two amplitudes of the modal displacement, 0 < lower <= upper",
                written.join(", ")
            );
            let remedy = "give the amplitudes that a record informed, or leave informed out";
            Err(section.failure("informed", &message, remedy))
        }
    }
}

/// A mode known by its curves only, or by its frequency only.
fn of_curves(source: &InputText, section: &Section<'_>, name: String) -> Result<Mode, InputError> {
    if !section.has("curves") {
        return Ok(Mode::new(name, section.number("frequency")?, None));
    }
    let others = ["frequency", "damping_ratio", "joint", "parts", "allow_negative_residual"];
    if let Some(key) = others.into_iter().find(|key| section.has(key)) {
        let message = format!("`{key}` and `curves` exclude each other: the curves are the whole mode");
        return Err(section.failure(key, &message, "remove one of the two"));
    }
    Ok(Mode::by_curves(name, curves::read(source, section)?))
}

fn read_joint(
    source: &InputText,
    mode: &Section<'_>,
    place: TablePlace<'_>,
) -> Result<(WrittenLaw, iwan_sim::JointLaw), InputError> {
    WrittenLaw::read(source, format!("joint of {}", mode.title()), place)
}

fn oscillator_failure(section: &Section<'_>, error: iwan_core::Error) -> InputError {
    use iwan_core::Error::OutOfRange;
    match error {
        OutOfRange { name: "k_t", value, .. } => {
            let frequency = section.number("frequency").unwrap_or(f64::NAN);
            let limit = significant((2.0 * std::f64::consts::PI * frequency).powi(2), 4, 1e5);
            let message = format!(
                "k_t = {} of the joint must be below omega0^2 = (2 pi frequency)^2 = {limit}, so that \
                 K_inf = omega0^2 - k_t > 0",
                plain(value)
            );
            let remedy = "lower k_t or raise frequency (are both in the same units?), or set \
                allow_negative_residual = true in this mode if that is meant";
            section.failure("joint", &message, remedy)
        }
        OutOfRange { name: "damping_ratio", value, allowed } => section.failure(
            "damping_ratio",
            &format!("damping_ratio = {} is out of range: {allowed}", plain(value)),
            "give damping_ratio as a ratio: 0.01 is 1 %",
        ),
        error => section.out_of_range(error, |name| name.split(' ').next().unwrap_or(name).to_string()),
    }
}

fn read_outputs(source: &InputText, mode: &Section<'_>) -> Result<Vec<Point>, InputError> {
    let Some(place) = mode.optional_table("outputs")? else { return Ok(Vec::new()) };
    let (section, entries) = Section::entries(source, &format!("outputs of {}", mode.title()), place)?;
    let point = |(name, shape): (String, f64)| {
        if name.trim().is_empty() || name.contains(is_harmful) {
            return Err(section.failure(&name, "a point needs a readable name", "give the point a name"));
        }
        if !shape.is_finite() {
            let message = format!("{name} = {shape} is out of range: must be a finite number");
            return Err(section.failure(
                &name,
                &message,
                "give the mass-normalised mode shape at this point",
            ));
        }
        Ok(Point { name, shape })
    };
    entries.into_iter().map(point).collect()
}

fn read_initial(source: &InputText, mode: &Section<'_>) -> Result<iwan_core::Motion, InputError> {
    let Some(place) = mode.optional_table("initial")? else { return Ok(iwan_core::Motion::default()) };
    let section = Section::new(source, format!("initial of {}", mode.title()), place, INITIAL_KEYS)?;
    let number = |key| match section.number_or(key, 0.0)? {
        value if value.is_finite() => Ok(value),
        value => {
            let message = format!("{key} = {value} is out of range: must be a finite number");
            Err(section.failure(key, &message, &format!("give {key} a finite value")))
        }
    };
    Ok(iwan_core::Motion { displacement: number("displacement")?, velocity: number("velocity")? })
}
