//! A scenario as a whole: all its tables, and the checks that need more than one of them.

use std::collections::{BTreeMap, BTreeSet};

use crate::error::InputError;
use crate::section::{Section, plain};
use crate::text::InputText;
use iwan_core::Grid;
use iwan_sim::{Method, Mode, Settings, SharedJoint};

use super::force::{self, Force};
use super::joint::{self, ScenarioJoint};
use super::method::{self, MethodKeys, Overrides, Refusal};
use super::mode::{self, ScenarioMode};
use super::structure::OnStructure;
use super::sweep::SweepTable;

/// Keys at the top of a scenario.
pub(crate) const KEYS: &[&str] = &["title", "mode", "joint", "structure", "force", "time", "method", "sweep"];

/// Largest count of numbers in a response: 8 GB. A longer response is refused before anything is computed, since a computer that it
/// overfills would slow down to a halt. Half as much or twice as much would do as well.
const MOST_NUMBERS: f64 = 1e9;

/// A scenario whose values have been checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// Title of the scenario.
    pub title: Option<String>,
    /// The modes; empty where a structure takes their place.
    pub modes: Vec<ScenarioMode>,
    /// Joints that several modes share; empty where each mode has a joint of its own.
    pub joints: Vec<ScenarioJoint>,
    /// The structure, where there is one instead of modes.
    pub structure: Option<OnStructure>,
    /// The force on modes or structure.
    pub force: Force,
    /// Time axis and method.
    pub settings: Settings,
    /// The sweep for steady responses; a transient does not need it.
    pub sweep: Option<SweepTable>,
}

impl Scenario {
    /// Reads and checks a scenario, with changes from the command line.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    ///
    /// ```
    /// use iwan_input::scenario::{Overrides, Scenario, built_in};
    /// let scenario = Scenario::read(&built_in()[0].source(), &Overrides::default())?;
    /// assert_eq!((scenario.modes.len(), scenario.settings.dt), (3, 1e-5));
    /// # Ok::<(), iwan_input::InputError>(())
    /// ```
    pub fn read(source: &InputText, overrides: &Overrides) -> Result<Self, InputError> {
        let document = source.document("paper-modal")?;
        let top = Section::new(source, "the scenario", document.top(), KEYS)?;
        let structure = OnStructure::read(source, &top)?;
        let settings = read_settings(source, &top, overrides, structure.is_some())?;
        let modes = if structure.is_some() { Vec::new() } else { read_modes(source, &top)? };
        let joints = joint::read(source, &top, &modes)?;
        let scenario = Self {
            title: top.optional_text("title")?,
            modes,
            joints,
            structure,
            force: read_force(source, &top, settings.dt, overrides)?,
            settings,
            sweep: SweepTable::read(source, &top)?,
        };
        scenario.check_sampling(source, &top, overrides)?;
        if !scenario.joints.is_empty() {
            joint::check(source, &top, (&scenario.modes(), &scenario.joints), &settings)?;
        }
        Ok(scenario)
    }

    /// The modes for the simulation.
    #[must_use]
    pub fn modes(&self) -> Vec<Mode> {
        self.modes.iter().map(|m| m.mode.clone()).collect()
    }

    /// The joints that modes share, for the simulation.
    #[must_use]
    pub fn joints(&self) -> Vec<SharedJoint> {
        self.joints.iter().map(|j| j.joint.clone()).collect()
    }

    /// What the user should know about the input.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        match &self.force {
            Force::File(file) => &file.notes,
            Force::Formula(..) => &[],
        }
    }

    /// Checks that the time step can follow every mode and that the response fits the memory.
    fn check_sampling(
        &self,
        source: &InputText,
        top: &Section<'_>,
        overrides: &Overrides,
    ) -> Result<(), InputError> {
        let time = time_section(source, top)?;
        let fail = |message: &str, remedy: &str| match overrides.step.or(overrides.duration) {
            Some(_) => InputError::new(format!("{}: {message}", flags(overrides)), remedy),
            None => time.failure("step", message, remedy),
        };
        let Settings { dt, duration, method, .. } = self.settings;
        let steps = duration / dt;
        let points: BTreeSet<_> = self.modes.iter().flat_map(|m| &m.mode.outputs).map(|p| &p.name).collect();
        let columns = 1 + 4 * self.modes.len() + 2 * self.joints.len() + 3 * points.len();
        let numbers = steps * columns as f64;
        if steps < 1.0 {
            let (dt, duration) = (plain(dt), plain(duration));
            let message = format!("step = {dt} is longer than duration = {duration}: there would be no step");
            return Err(fail(&message, "shorten step or lengthen duration"));
        }
        if numbers > MOST_NUMBERS && !overrides.streamed {
            let message = format!("{steps:.3e} steps would need {:.0} GB of memory", numbers * 8e-9);
            return Err(fail(
                &message,
                "lengthen step or shorten duration (both in s), or write the response as it is computed (--stream); at most 8 GB are used",
            ));
        }
        let Method::Newmark { prewarp: true, .. } = method else { return Ok(()) };
        for ScenarioMode { mode, .. } in &self.modes {
            let omega0 = 2.0 * std::f64::consts::PI * mode.frequency;
            if iwan_core::Newmark::prewarped(dt, omega0).is_err() {
                let limit = 0.5 / mode.frequency;
                let message = format!(
                    "step = {} is too long for mode \"{}\" at {} Hz: must be below half its period, {limit:.4e} s",
                    plain(dt),
                    mode.name,
                    mode.frequency
                );
                return Err(fail(&message, "shorten step: 20 and more samples a cycle are advisable"));
            }
        }
        Ok(())
    }
}

/// The options of the command line that were given, for messages.
fn flags(overrides: &Overrides) -> String {
    let step = overrides.step.map(|_| "--step");
    let duration = overrides.duration.map(|_| "--duration");
    step.into_iter().chain(duration).collect::<Vec<_>>().join(" and ")
}

fn time_section<'a>(source: &'a InputText, top: &Section<'a>) -> Result<Section<'a>, InputError> {
    match top.optional_table("time")? {
        Some(place) => Section::new(source, "[time]", place, method::TIME_KEYS),
        None => Err(top.failure(
            "time",
            "the table [time] is missing",
            "add [time] with step = SECONDS and duration = SECONDS",
        )),
    }
}

fn read_settings(
    source: &InputText,
    top: &Section<'_>,
    overrides: &Overrides,
    structure: bool,
) -> Result<Settings, InputError> {
    let time = time_section(source, top)?;
    let seconds = |key, instead: Option<f64>| {
        let value = instead.map_or_else(|| time.number(key), Ok)?;
        if value > 0.0 && value.is_finite() {
            return Ok(value);
        }
        let message =
            format!("{key} = {} is out of range: must be a finite number of seconds > 0", plain(value));
        Err(time.failure(key, &message, &format!("give {key} in seconds")))
    };
    let (dt, duration) = (seconds("step", overrides.step)?, seconds("duration", overrides.duration)?);
    let method = read_method(source, top, overrides, structure)?;
    Ok(Settings { method, ..Settings::new(dt, duration) })
}

fn read_method(
    source: &InputText,
    top: &Section<'_>,
    overrides: &Overrides,
    structure: bool,
) -> Result<Method, InputError> {
    let section = match top.optional_table("method")? {
        Some(place) => Some(Section::kind(source, "[method]", place, method::KINDS, Some("newmark"))?),
        None => None,
    };
    let written = match &section {
        Some((section, kind)) => MethodKeys::read(section, kind)?,
        None => MethodKeys::named("newmark"),
    };
    let mut keys = written.overridden(overrides)?;
    // An error about a value as the file has it names its place there; a value that the command line changed stands nowhere in the file.
    let as_written = keys == written;
    let placed = |Refusal { key, message, remedy }: Refusal| match &section {
        Some((section, _)) if as_written => section.failure(key, &message, &remedy),
        _ => InputError::new(message, remedy),
    };
    let mut graded: fn(usize) -> Grid = Grid::graded;
    if structure {
        keys = keys.on_structure().map_err(placed)?;
        graded = |_| Grid::IN_STRUCTURES;
    }
    keys.resolve(graded).map_err(placed)
}

fn read_force(
    source: &InputText,
    top: &Section<'_>,
    step: f64,
    overrides: &Overrides,
) -> Result<Force, InputError> {
    let Some(place) = top.optional_table("force")? else {
        let remedy = "add [force] with kind = \"haversine\", amplitude and duration, or kind = \"none\"";
        return Err(top.failure("force", "the table [force] is missing", remedy));
    };
    let (section, kind) = Section::kind(source, "[force]", place, force::KINDS, None)?;
    let force = Force::read(source, &section, kind, step)?;
    let Some(amplitude) = overrides.amplitude else { return Ok(force) };
    force.with_amplitude(amplitude).ok_or_else(|| {
        let message = format!("--amplitude does not apply to a force of kind = \"{}\"", kind.name);
        InputError::new(message, "leave --amplitude out, or choose another force in the scenario")
    })
}

pub(super) fn read_modes(source: &InputText, top: &Section<'_>) -> Result<Vec<ScenarioMode>, InputError> {
    let tables = top.tables("mode")?;
    if tables.is_empty() {
        let remedy = "add [[mode]] with name and frequency (`iwan scenario paper-modal` prints an example), or [structure]";
        return Err(top.failure("mode", "there is no mode", remedy));
    }
    let (mut modes, mut known) = (Vec::<ScenarioMode>::new(), BTreeMap::new());
    for (index, place) in tables.iter().enumerate() {
        let mode = ScenarioMode::read(source, index, place.clone())?;
        let section = Section::new(source, format!("mode {}", index + 1), place.clone(), mode::KEYS)?;
        if let Some(other) = known.insert(mode.mode.name.clone(), index) {
            let message = format!("name = \"{}\" is the name of mode {} already", mode.mode.name, other + 1);
            return Err(section.failure("name", &message, "give every mode a name of its own"));
        }
        modes.push(mode);
    }
    let names: BTreeSet<_> = modes.iter().map(|m| m.mode.name.as_str()).collect();
    let points = modes.iter().flat_map(|m| &m.mode.outputs);
    if let Some(point) = points.map(|p| p.name.as_str()).find(|p| names.contains(p)) {
        let message = format!("outputs: the point \"{point}\" has the name of a mode");
        return Err(top.failure(
            "mode",
            &message,
            "rename the point: columns are called after modes and points",
        ));
    }
    Ok(modes)
}
