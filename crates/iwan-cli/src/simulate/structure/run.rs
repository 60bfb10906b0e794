//! A scenario on a structure: what is recorded, the run with its errors, pictures of the motion.

use std::time::Instant;

use iwan_fem::{Integrated, NamedMode, Output, Reduced, StepErrors, Transient, TruthResponse};
use iwan_input::StructureFile;
use iwan_input::scenario::{OnStructure, Scenario, population};

use crate::failure::Failure;
use crate::progress::Progress;
use crate::structures::Linear;

/// Elastic modes among which names are looked up.
const NAMED: usize = 40;

/// A response of a structure with all that belongs to it.
#[derive(Debug)]
pub(crate) struct Truth {
    pub(crate) linear: Linear,
    /// The modes that were recorded; their histories come first in the response.
    pub(crate) modes: Vec<NamedMode>,
    pub(crate) response: TruthResponse,
    /// Modal joint forces, one per recorded mode.
    pub(crate) joint_forces: Vec<Vec<f64>>,
    /// Modes in the basis of the reduced model; none for the full one.
    pub(crate) basis: Option<usize>,
    /// Estimated error of the reduction, where it was sought, and whether it reached the tolerance.
    pub(crate) basis_error: Option<(f64, bool)>,
    /// Estimated errors; the reduced model only.
    pub(crate) errors: Option<StepErrors>,
    /// Displacements of all nodes at evenly spaced times.
    pub(crate) frames: Vec<(f64, Vec<f64>)>,
    pub(crate) seconds: f64,
}

/// Runs the scenario.
pub(crate) fn run(
    scenario: &Scenario,
    on: &OnStructure,
    (name, file): (String, StructureFile),
    bar: &Progress,
) -> Result<Truth, Failure> {
    let clock = Instant::now();
    let mut progress = |share| bar.report(share);
    let linear = Linear::observed(name, file, NAMED, &mut progress)?;
    let failed = |error: iwan_fem::Error| linear.failed(&error);
    let modes = linear.chosen(&on.modes).map_err(failed)?;
    let transient = transient(scenario, &linear, &modes)?;
    let integrated = linear.assembled.integrate(on.model, &transient, &mut progress).map_err(failed)?;
    let basis = integrated.basis();
    let Integrated { response, reduced, basis_error } = integrated;
    let errors =
        reduced.as_ref().map(|reduced| reduced.step_errors(&transient, &response, &mut progress)).transpose();
    let errors = errors.map_err(failed)?;
    let frames = match &reduced {
        Some(reduced) if on.frames > 0 => frames(reduced, &transient, on.frames).map_err(failed)?,
        _ => Vec::new(),
    };
    let joint_forces = modes.iter().zip(&response.outputs).map(|(mode, history)| {
        let stuck = (&linear.stuck, mode.pair.stuck);
        linear.assembled.modal_joint_force(&response, history, stuck, mode.pair.k_t)
    });
    let joint_forces = joint_forces.collect();
    let seconds = clock.elapsed().as_secs_f64();
    Ok(Truth { linear, modes, response, joint_forces, basis, basis_error, errors, frames, seconds })
}

/// Loads, outputs and time axis.
fn transient<'a>(
    scenario: &'a Scenario,
    linear: &Linear,
    modes: &[NamedMode],
) -> Result<Transient<'a>, Failure> {
    let load = linear.file.forces(&linear.assembled).map_err(|e| linear.refused(e))?;
    let outputs = linear.file.recorded(linear, modes).map_err(|e| linear.refused(e))?;
    let (dt, duration) = (scenario.settings.dt, scenario.settings.duration);
    Ok(Transient {
        dt,
        steps: Transient::steps_in(dt, duration),
        pulse: scenario.force.pulse(),
        load,
        initial_velocity: None,
        population: population(&scenario.settings.method),
        outputs,
    })
}

/// Displacements of all nodes at `count` evenly spaced times, from the coordinates of the reduced model.
fn frames(
    reduced: &Reduced<'_>,
    transient: &Transient<'_>,
    count: usize,
) -> Result<Vec<(f64, Vec<f64>)>, iwan_fem::Error> {
    let assembled = reduced.assembled();
    let coordinate =
        |k: usize| Output { name: k.to_string(), coefficients: assembled.mass().times(reduced.column(k)) };
    let outputs = (0..reduced.coordinates()).map(coordinate).collect();
    let response = reduced.transient(&Transient { outputs, ..transient.clone() })?;
    let frame = |n: usize| {
        let sample = if count > 1 { n * transient.steps / (count - 1) } else { 0 };
        let mut unknowns = vec![0.0; assembled.unknowns()];
        for (k, history) in response.outputs.iter().enumerate() {
            let q = history.displacement[sample];
            unknowns.iter_mut().zip(reduced.column(k)).for_each(|(x, v)| *x += q * v);
        }
        (sample as f64 * transient.dt, assembled.displacements(&unknowns))
    };
    Ok((0..count).map(frame).collect())
}
