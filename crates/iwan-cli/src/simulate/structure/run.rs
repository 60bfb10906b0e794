//! The run of a scenario on a structure.

use std::ops::Deref;
use std::sync::Arc;
use std::time::Instant;

use iwan_fem::{Extras, NamedModes, Run, Watch};
use iwan_input::scenario::{OnStructure, Scenario, representation};
use iwan_input::{RunError, StructureFile, StructureTask};
use iwan_machine::checkpoint::Checkpoint;

use crate::failure::Failure;
use crate::progress::Bar;
use crate::structures::Linear;

/// The response of a structure with its linear modes and settings.
#[derive(Debug)]
pub(crate) struct Truth {
    pub(crate) linear: Linear,
    run: Run,
    pub(crate) seconds: f64,
}

impl Deref for Truth {
    type Target = Run;

    fn deref(&self) -> &Run {
        &self.run
    }
}

/// Runs the scenario.
pub(crate) fn run(
    scenario: &Scenario,
    on: &OnStructure,
    (name, file): (String, StructureFile),
    bar: &Bar,
    kept: Option<Arc<Checkpoint>>,
) -> Result<Truth, Failure> {
    let clock = Instant::now();
    let linear = Linear::computed(name, file, NamedModes::LOOKED_UP, bar)?;
    // The run goes on another thread, so that this one notices Ctrl-C even while a matrix is factored.
    let (own, scenario, on, teller) = (linear.clone(), scenario.clone(), on.clone(), bar.teller());
    let run = bar.wait(move || {
        let task = StructureTask {
            force: Some(scenario.force.pulse()),
            velocity: &[],
            dt: scenario.settings.dt,
            duration: scenario.settings.duration,
            representation: representation(&scenario.settings.method),
            model: on.model,
            modes: &on.modes,
            extras: Extras { errors: true, frames: on.frames },
        };
        own.file.run(&own, &task, Watch { progress: &|share| teller.report(share), kept: kept.as_deref() })
    })?;
    let run = run.map_err(|error| match error {
        RunError::Input(error) => linear.refused(error),
        RunError::Analysis(error) => linear.failed(&error),
    })?;
    Ok(Truth { linear, run, seconds: clock.elapsed().as_secs_f64() })
}
