//! The forced responses of the modes that have their resonance in the band.

use std::f64::consts::TAU;

use iwan_input::scenario::{SteadyScenario, SweepTable};
use iwan_machine::memory;
use iwan_sim::{Mode, SharedLaw, SimulationError, SteadyCurve, Sweep, forced_response, in_parallel};

use super::loops::{self, Loop};
use crate::failure::Failure;

/// A mode, or a structure, with its responses.
#[derive(Debug)]
pub(crate) struct Response {
    pub(crate) name: String,
    /// Frequency at small amplitude, Hz; none for a structure with all its modes.
    pub(crate) frequency: Option<f64>,
    /// Smallest and largest amplitude of the response in the records from which the mode was identified; none where the scenario does not say.
    pub(crate) informed: Option<[f64; 2]>,
    /// One curve per level.
    pub(crate) curves: Vec<SteadyCurve>,
    /// Backbones: frequency (Hz) and amplitude of the nonlinear modes without force and damping.
    pub(crate) backbones: Vec<Vec<(f64, f64)>>,
    /// Hysteresis loops of the joints at the peaks of the curves.
    pub(crate) loops: Vec<Loop>,
}

/// Asks for the memory of `curves` curves for each level of the sweep, with their table and their page, before any of them is computed. Two
/// million points without harmonics took 190 bytes each, and each further harmonic adds its numbers here and in the table.
pub(super) fn ask(name: &str, sweep: &Sweep, curves: usize) -> Result<(), Failure> {
    let points =
        (sweep.points as u64).saturating_mul(sweep.levels.len() as u64).saturating_mul(curves as u64);
    let bytes = points.saturating_mul(200 + 40 * (sweep.harmonics as u64 / 2));
    let remedy = "take fewer points, levels or harmonics in [sweep]";
    memory::ask(format!("{name}: {points} points of steady responses"), bytes, remedy).map_err(Failure::from)
}

/// The curves of all levels, computed in parallel, one task per level.
pub(super) fn by_level(
    sweep: &Sweep,
    threads: usize,
    respond: &(dyn Fn(&Sweep) -> Result<Vec<SteadyCurve>, SimulationError> + Sync),
) -> Result<Vec<SteadyCurve>, SimulationError> {
    let each: Vec<Sweep> =
        sweep.levels.iter().map(|&level| Sweep { levels: vec![level], ..sweep.clone() }).collect();
    let found: Result<Vec<Vec<SteadyCurve>>, SimulationError> =
        in_parallel(&each, threads, &|sweep| respond(sweep)).into_iter().collect();
    Ok(found?.concat())
}

/// Points of a backbone: one for every four units of a figure's width.
pub(super) const POINTS: usize = 121;

/// A backbone is drawn beyond the highest and the lowest peak by this ratio, so that its direction is visible.
const BEYOND: f64 = 1.3;

/// Smallest and largest amplitude of a backbone drawn over these curves; none where no curve has a peak.
pub(super) fn backbone_range(curves: &[SteadyCurve]) -> Option<[f64; 2]> {
    let peaks = curves.iter().filter_map(SteadyCurve::peak).map(|peak| peak.amplitude);
    let (low, high) = peaks.fold((f64::INFINITY, 0.0_f64), |(low, high), a| (low.min(a), high.max(a)));
    (high > 0.0 && low > 0.0).then_some([low / BEYOND, high * BEYOND])
}

fn backbone(mode: &Mode, shape: f64, curves: &[SteadyCurve]) -> Vec<(f64, f64)> {
    let Some([low, high]) = backbone_range(curves) else { return Vec::new() };
    let at = |i: usize| {
        let amplitude = low * (high / low).powf(i as f64 / (POINTS - 1) as f64);
        (mode.frequency_at(amplitude / shape.abs()).unwrap_or(f64::NAN), amplitude)
    };
    (0..POINTS).map(at).collect()
}

/// The responses of all modes with their resonance in the band, and notes on the modes that were left out.
pub(super) fn respond(
    name: &str,
    scenario: &SteadyScenario,
    table: &SweepTable,
    threads: usize,
) -> Result<(Vec<Response>, Vec<String>), Failure> {
    let (mut responses, mut notes) = (Vec::new(), Vec::new());
    refuse_of_structures(name, table)?;
    for (mode, informed) in scenario.modes.iter().map(|m| (m.mode.clone(), m.informed)) {
        let shape = shape(name, &mode, table)?;
        let (from, to) = (table.sweep.from, table.sweep.to);
        let [slipping, stuck] = range(&mode).map_err(|error| failed(name, &mode, &error))?;
        if stuck < from || slipping > to {
            notes.push(format!(
                "mode \"{}\" has its resonance outside {from} to {to} Hz, between {slipping:.4} and {stuck:.4} Hz, and was left out",
                mode.name
            ));
            continue;
        }
        let curves = by_level(&table.sweep, threads, &|sweep| forced_response(&mode, sweep, shape));
        let curves = curves.map_err(|error| failed(name, &mode, &error))?;
        let backbones = vec![backbone(&mode, shape, &curves)];
        let law = mode.joint.clone().map(SharedLaw::from);
        let loops = law.map_or_else(Vec::new, |law| loops::of_mode(&law, shape, &curves));
        responses.push(Response {
            name: mode.name,
            frequency: Some(mode.frequency),
            informed: informed.map(|range| range.map(|a| a * shape.abs())),
            curves,
            backbones,
            loops,
        });
    }
    if responses.is_empty() {
        let message =
            format!("{name}: no mode has its resonance in the band of [sweep]: {}", notes.join("; "));
        return Err(Failure::input(message, "choose from and to around a mode's frequency"));
    }
    Ok((responses, notes))
}

/// Frequencies of a mode with its joint slipping and with its joint stuck, Hz.
fn range(mode: &Mode) -> Result<[f64; 2], SimulationError> {
    let oscillator = mode.oscillator()?;
    Ok([oscillator.k_inf().max(0.0).sqrt() / TAU, mode.frequency])
}

/// Refuses, for modes, the two keys of `[sweep]` that only structures have: a damping ratio for all modes, and the direction of base motion.
pub(super) fn refuse_of_structures(name: &str, table: &SweepTable) -> Result<(), Failure> {
    let refused = |key: &str, why: &str, remedy: &str| {
        Err(Failure::input(format!("{name}: [sweep]: {key} is for structures: {why}"), remedy))
    };
    if table.damping_ratio.is_some() {
        return refused("damping_ratio", "each mode has its own", "give damping_ratio in [[mode]]");
    }
    if table.direction.is_some() {
        let remedy = "give each mode's participation as shape_at_force, and remove direction";
        return refused("direction", "a mode says with its participation how its base moves it", remedy);
    }
    Ok(())
}

/// The mode's shape at the output point of the sweep; 1 where the response is the modal displacement.
pub(super) fn shape(name: &str, mode: &Mode, table: &SweepTable) -> Result<f64, Failure> {
    let Some(at) = &table.at else { return Ok(1.0) };
    let found = mode.outputs.iter().find(|point| point.name == *at).map(|point| point.shape);
    found.ok_or_else(|| {
        let message = format!("{name}: [sweep]: mode \"{}\" has no point \"{at}\"", mode.name);
        Failure::input(message, "give the point in outputs of every mode, or leave `at` out")
    })
}

/// A failed computation, in the user's terms.
fn failed(name: &str, mode: &Mode, error: &SimulationError) -> Failure {
    let message = format!("{name}: mode \"{}\": {error}", mode.name);
    match error {
        SimulationError::Interrupted => Failure::Interrupted,
        SimulationError::Parameter(_) => {
            Failure::input(message, "change this in the scenario").of(error.kind())
        }
        _ => Failure::computation(message).of(error.kind()),
    }
}
