//! The nonlinear modes of a scenario.

use iwan_core::{Backbone, Harmonics};
use iwan_input::scenario::SteadyScenario;
use iwan_machine::memory;
use iwan_sim::{JointedModes, Mode, NonlinearMode, SimulationError, backbone, in_parallel, nonlinear_mode};

use super::args::BackboneArgs;
use crate::failure::Failure;

/// Default range of modal amplitudes, as multiples of the amplitude at which macro-slip begins: from where the joints hardly slip to where they are
/// deep in macro-slip.
const RANGE: [f64; 2] = [1e-3, 10.0];

/// A mode with its backbone.
#[derive(Debug)]
pub(crate) struct Traced {
    pub(crate) name: String,
    /// Frequency at small amplitude, Hz.
    pub(crate) frequency: f64,
    /// Modal amplitude at which the first joint enters macro-slip; none without a joint that slips.
    pub(crate) onset: Option<f64>,
    /// Names of the joints' slips; empty but for a structure.
    pub(crate) slips: Vec<String>,
    pub(crate) curve: NonlinearMode,
}

/// The highest harmonic: the one of the option, else the one of the scenario's `[sweep]`, else 1.
pub(super) fn harmonics(args: &BackboneArgs, scenario: &SteadyScenario) -> Result<usize, Failure> {
    let of_sweep = scenario.sweep.as_ref().map(|table| table.sweep.harmonics);
    let highest = args.harmonics.or(of_sweep).unwrap_or(1);
    Harmonics::odd(highest)
        .map_err(|error| Failure::input(format!("--harmonics: {error}"), "give an odd number"))?;
    Ok(highest)
}

/// Asks for the memory of the backbones of `modes` modes, with their table and their page: 300,000 points without harmonics took 280 bytes each,
/// and each further harmonic adds its numbers here and in the table.
pub(super) fn ask(name: &str, points: u32, modes: usize, highest: usize) -> Result<(), Failure> {
    let points = u64::from(points).saturating_mul(modes as u64);
    let bytes = points.saturating_mul(300 + 40 * (highest as u64 / 2));
    memory::ask(format!("{name}: {points} points of backbones"), bytes, "take fewer with --points")
        .map_err(Failure::from)
}

/// The backbones of all modes.
pub(super) fn trace(
    name: &str,
    scenario: &SteadyScenario,
    args: &BackboneArgs,
    highest: usize,
    threads: usize,
) -> Result<Vec<Traced>, Failure> {
    let modes = scenario.modes();
    if !scenario.joints.is_empty() {
        return coupled(name, scenario, args, highest);
    }
    let tasks: Vec<(Mode, Vec<f64>)> = modes
        .into_iter()
        .map(|mode| {
            let onset = mode.joint.as_ref().map(|law| law.strengths().1);
            amplitudes(name, &mode.name, onset, args).map(|amplitudes| (mode, amplitudes))
        })
        .collect::<Result<_, _>>()?;
    let curves = in_parallel(&tasks, threads, &|(mode, amplitudes)| backbone(mode, highest, amplitudes));
    let mut traced = Vec::new();
    for ((mode, _), curve) in tasks.into_iter().zip(curves) {
        let curve = curve.map_err(|error| failed(name, &mode, &error))?;
        let onset = mode.joint.as_ref().map(|law| law.strengths().1);
        traced.push(Traced { name: mode.name, frequency: mode.frequency, onset, slips: Vec::new(), curve });
    }
    Ok(traced)
}

/// The backbones of modes that share joints: each begins at small amplitude as one stuck mode, and the other modes take part as the slips couple
/// them.
fn coupled(
    name: &str,
    scenario: &SteadyScenario,
    args: &BackboneArgs,
    highest: usize,
) -> Result<Vec<Traced>, Failure> {
    let modes = scenario.modes();
    let refused =
        |error: SimulationError| Failure::input(format!("{name}: {error}"), "change this in the scenario");
    let mut traced = Vec::new();
    for (r, mode) in modes.iter().enumerate() {
        let own: Vec<f64> = (0..modes.len()).map(|i| f64::from(u8::from(i == r))).collect();
        let system = JointedModes::of_coupled(&modes, &scenario.joints(), &own).map_err(refused)?;
        let onset = system.macro_slip(r);
        let range = amplitudes(name, &mode.name, onset, args)?;
        let curve =
            nonlinear_mode(&system, r, highest, &range).map_err(|error| failed(name, mode, &error))?;
        let slips = system.joints().iter().map(|joint| joint.name.clone()).collect();
        traced.push(Traced { name: mode.name.clone(), frequency: mode.frequency, onset, slips, curve });
    }
    Ok(traced)
}

/// Amplitudes from the smallest to the largest wanted, evenly spaced on a logarithmic scale.
pub(super) fn amplitudes(
    name: &str,
    mode: &str,
    onset: Option<f64>,
    args: &BackboneArgs,
) -> Result<Vec<f64>, Failure> {
    let (from, to) = match (args.from, args.to, onset) {
        (Some(from), Some(to), _) => (from, to),
        (from, to, Some(onset)) => (from.unwrap_or(RANGE[0] * onset), to.unwrap_or(RANGE[1] * onset)),
        _ => {
            let message = format!("{name}: no joint slips in mode \"{mode}\": its frequency does not change");
            return Err(Failure::input(message, "give --from and --to, or leave the mode out"));
        }
    };
    if from >= to {
        let message = format!("{name}: mode \"{mode}\": from {from:e} to {to:e} is no range of amplitudes");
        return Err(Failure::input(message, "give --from smaller than --to"));
    }
    let count = args.points as usize;
    Ok((0..count).map(|i| from * (to / from).powf(i as f64 / (count - 1) as f64)).collect())
}

fn failed(name: &str, mode: &Mode, error: &SimulationError) -> Failure {
    let message = format!("{name}: mode \"{}\": {error}", mode.name);
    match error {
        SimulationError::Parameter(_) => {
            Failure::input(message, "change this in the scenario").of(error.kind())
        }
        _ => Failure::computation(message).of(error.kind()),
    }
}
