//! A scenario as steady vibration sees it: modes or a structure, and a sweep; force and time axis of transients do not matter.

use crate::error::InputError;
use crate::section::Section;
use crate::text::InputText;
use iwan_sim::Mode;

use super::mode::ScenarioMode;
use super::read::{KEYS, read_modes};
use super::structure::OnStructure;
use super::sweep::SweepTable;

/// What a scenario says about steady vibration.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyScenario {
    /// What it is called.
    pub title: Option<String>,
    /// The modes; none on a structure.
    pub modes: Vec<ScenarioMode>,
    /// The structure, where there is one instead of modes.
    pub structure: Option<OnStructure>,
    /// The sweep; nonlinear modes need none.
    pub sweep: Option<SweepTable>,
}

impl SteadyScenario {
    /// Reads and checks a scenario.
    ///
    /// # Errors
    /// [`InputError`] with the place, what stands there and what helps.
    ///
    /// ```
    /// use iwan_input::scenario::{SteadyScenario, built_in};
    /// let scenario = SteadyScenario::read(&built_in()[0].source())?;
    /// assert_eq!(scenario.sweep.map(|table| table.sweep.levels.len()), Some(4));
    /// # Ok::<(), iwan_input::InputError>(())
    /// ```
    pub fn read(source: &InputText) -> Result<Self, InputError> {
        let document = source.document("paper-modal")?;
        let top = Section::new(source, "the scenario", document.top(), KEYS)?;
        if top.has("joint") {
            let message =
                "steady responses and backbones of modes that share joints are not computed from a scenario";
            let remedy = "give the structure itself, or modes with a joint = { ... } of their own";
            return Err(top.failure("joint", message, remedy));
        }
        let structure = OnStructure::read(source, &top)?;
        let modes = if structure.is_some() { Vec::new() } else { read_modes(source, &top)? };
        let sweep = SweepTable::read(source, &top)?;
        Ok(Self { title: top.optional_text("title")?, modes, structure, sweep })
    }

    /// The modes for the computation.
    #[must_use]
    pub fn modes(&self) -> Vec<Mode> {
        self.modes.iter().map(|m| m.mode.clone()).collect()
    }
}
