//! A scenario on a structure: what is recorded, which model is integrated, what companion runs say about the errors.

use std::time::Instant;

use iwan_fem::{Basis, History, Output, Population, Reduced, Transient, TruthResponse};
use iwan_input::StructureFile;

use crate::failure::Failure;
use crate::linear::{Elastic, Linear, explain};
use crate::progress::Progress;
use crate::scenario::{Model, OnStructure, Scenario, population};

/// Elastic modes among which names are looked up.
const NAMED: usize = 40;
/// More numbers than this (8 GB) are not kept in memory.
const MOST_NUMBERS: f64 = 1e9;

/// A response of a structure with all that belongs to it.
#[derive(Debug)]
pub(crate) struct Truth {
    pub(crate) linear: Linear,
    /// The modes that were recorded; their histories come first in the response.
    pub(crate) modes: Vec<Elastic>,
    pub(crate) response: TruthResponse,
    /// Modal joint forces, one per recorded mode.
    pub(crate) joint_forces: Vec<Vec<f64>>,
    /// Modes in the basis of the reduced model; none for the full one.
    pub(crate) basis: Option<usize>,
    /// Estimated error of the reduction, where it was sought, and whether it reached the tolerance.
    pub(crate) basis_error: Option<(f64, bool)>,
    /// Estimated errors of the time step and of cutting the joints into sliders, one per output; the reduced model only.
    pub(crate) errors: Option<(Vec<f64>, Option<Vec<f64>>)>,
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
    let linear = Linear::new(name, file, NAMED)?;
    let modes = chosen(&linear, &on.modes)?;
    let transient = transient(scenario, &linear, &modes)?;
    let failed = |error: iwan_fem::Error| explain(&linear.source, &error);
    let (response, basis, basis_error) = integrate(&linear, on.model, &transient, bar).map_err(failed)?;
    let reduced = basis.map(|n| linear.assembled.reduce(n, Basis::default())).transpose().map_err(failed)?;
    let errors = reduced.as_ref().map(|reduced| errors(reduced, &transient, &response)).transpose();
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

/// The modes that were named, or the first bending modes.
fn chosen(linear: &Linear, names: &[String]) -> Result<Vec<Elastic>, Failure> {
    if names.is_empty() {
        return Ok(linear.first_bending());
    }
    names.iter().map(|name| linear.named(name).cloned()).collect()
}

/// Loads, outputs and time axis.
fn transient<'a>(
    scenario: &'a Scenario,
    linear: &Linear,
    modes: &[Elastic],
) -> Result<Transient<'a>, Failure> {
    let (assembled, file) = (&linear.assembled, &linear.file);
    let failed = |error: iwan_fem::Error| explain(&linear.source, &error);
    if file.loads.is_empty() {
        let message = format!("{}: the structure has no [[load]]: the force acts nowhere", linear.source);
        return Err(Failure::input(message, "add [[load]] with name, nodes and direction"));
    }
    let mut load = vec![0.0; assembled.unknowns()];
    for part in &file.loads {
        let force = part.direction.map(|d| d * part.factor);
        let own = assembled.load(&part.nodes, force).map_err(failed)?;
        load.iter_mut().zip(own).for_each(|(sum, f)| *sum += f);
    }
    let mut outputs: Vec<Output> =
        modes.iter().map(|mode| assembled.modal_output(&mode.name, &linear.stuck, mode.pair.stuck)).collect();
    for output in &file.outputs {
        if modes.iter().any(|mode| mode.name == output.name) {
            let message = format!("{}: output \"{}\" has the name of a mode", linear.source, output.name);
            return Err(Failure::input(
                message,
                "rename the output: columns are called after modes and outputs",
            ));
        }
        outputs.push(assembled.output(&output.name, &output.nodes, output.direction).map_err(failed)?);
    }
    let (dt, duration) = (scenario.settings.dt, scenario.settings.duration);
    let steps = (duration / dt * (1.0 + 1e-12)).floor();
    let numbers = steps * (4 * outputs.len() + 2 * assembled.slips().len()) as f64;
    if numbers > MOST_NUMBERS {
        let message = format!("{steps:.3e} steps would need {:.0} GB of memory", numbers * 8e-9);
        return Err(Failure::input(message, "lengthen step or shorten duration; at most 8 GB are used"));
    }
    let population = population(&scenario.settings.method);
    let pulse = scenario.force.pulse();
    Ok(Transient { dt, steps: steps as usize, pulse, load, initial_velocity: None, population, outputs })
}

/// A response, the modes of its basis, and the error of the reduction where it was sought.
type Integrated = (TruthResponse, Option<usize>, Option<(f64, bool)>);

fn integrate(
    linear: &Linear,
    model: Model,
    transient: &Transient<'_>,
    bar: &Progress,
) -> Result<Integrated, iwan_fem::Error> {
    let assembled = &linear.assembled;
    let mut progress = |share| bar.report(share);
    match model {
        Model::Full => Ok((assembled.transient_observed(transient, &mut progress)?, None, None)),
        Model::Basis(modes) => {
            let modes = modes.min(assembled.unknowns());
            let reduced = assembled.reduce(modes, Basis::default())?;
            Ok((reduced.transient_observed(transient, &mut progress)?, Some(modes), None))
        }
        Model::Tolerance(tolerance) => {
            let found = assembled.reduced_transient(transient, tolerance)?;
            Ok((found.response, Some(found.modes), Some((found.error, found.converged))))
        }
    }
}

/// Errors of the time step (a companion run at twice the step; the scheme is of second order) and of the sliders (one
/// in the continuum), relative to the peak displacement of each output.
fn errors(
    reduced: &Reduced<'_>,
    transient: &Transient<'_>,
    response: &TruthResponse,
) -> Result<(Vec<f64>, Option<Vec<f64>>), iwan_fem::Error> {
    let coarse = Transient { dt: 2.0 * transient.dt, steps: transient.steps / 2, ..transient.clone() };
    let coarse = reduced.transient(&coarse)?;
    let pairs = || response.outputs.iter();
    let step = pairs().zip(&coarse.outputs).map(|(fine, coarse)| difference(fine, coarse, 2) / 3.0).collect();
    let sliders = match transient.population {
        Population::Continuum => None,
        Population::Sliders { .. } => {
            let exact = Transient { population: Population::Continuum, ..transient.clone() };
            let exact = reduced.transient(&exact)?;
            Some(pairs().zip(&exact.outputs).map(|(cut, exact)| difference(cut, exact, 1)).collect())
        }
    };
    Ok((step, sliders))
}

/// Largest difference of displacements at the samples that two histories share, over the peak.
fn difference(of: &History, other: &History, stride: usize) -> f64 {
    let peak = of.displacement.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    let pairs = of.displacement.iter().step_by(stride).zip(&other.displacement);
    let largest = pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    if peak > 0.0 { largest / peak } else { 0.0 }
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
