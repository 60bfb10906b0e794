//! A scenario for steady vibration: modes or a structure, and a sweep. Force and time axis of transients are not read.

use crate::error::InputError;
use crate::section::Section;
use crate::text::InputText;
use iwan_sim::{Mode, SharedJoint};

use super::joint::{self, ScenarioJoint};
use super::mode::ScenarioMode;
use super::read::{KEYS, read_modes};
use super::structure::OnStructure;
use super::sweep::SweepTable;

/// The parts of a scenario that steady vibration needs.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyScenario {
    /// Title of the scenario.
    pub title: Option<String>,
    /// The modes; empty where a structure takes their place.
    pub modes: Vec<ScenarioMode>,
    /// Joints that several modes share; empty where each mode has a joint of its own.
    pub joints: Vec<ScenarioJoint>,
    /// The structure, where there is one instead of modes.
    pub structure: Option<OnStructure>,
    /// The sweep; none is needed for nonlinear modes.
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
        let structure = OnStructure::read(source, &top)?;
        let modes = if structure.is_some() { Vec::new() } else { read_modes(source, &top)? };
        let joints = joint::read(source, &top, &modes)?;
        let sweep = SweepTable::read(source, &top)?;
        let scenario = Self { title: top.optional_text("title")?, modes, joints, structure, sweep };
        if !scenario.joints.is_empty() {
            joint::check_steady(source, &top, &scenario.modes(), &scenario.joints())?;
        }
        Ok(scenario)
    }

    /// The modes for the computation.
    #[must_use]
    pub fn modes(&self) -> Vec<Mode> {
        self.modes.iter().map(|m| m.mode.clone()).collect()
    }

    /// The joints that modes share, for the computation.
    #[must_use]
    pub fn joints(&self) -> Vec<SharedJoint> {
        self.joints.iter().map(|j| j.joint.clone()).collect()
    }
}
