//! The fit as a scenario that `iwan frf`, `iwan backbone` and `iwan simulate` run.

use iwan_core::{Motion, Pulse};
use iwan_ident::sweeps::{SteadyData, SteadyFit};
use iwan_input::WrittenLaw;
use iwan_input::scenario::{Force, Scenario, ScenarioMode, SweepTable};
use iwan_sim::{Control, Mode, Point, Settings, Sweep};

use super::measurement::Measurement;

/// Samples per cycle and number of cycles of the release: in this scenario `iwan simulate` computes a ring-down from the largest measured amplitude.
const SAMPLES: f64 = 100.0;
const CYCLES: f64 = 100.0;
/// Name of the measured point, where the measurements are physical and not modal quantities.
const POINT: &str = "measured";

/// The scenario: the mode with its output at the measured point, and a sweep of the levels that were held.
pub(super) fn scenario(
    title: &str,
    mode: &Mode,
    fit: &SteadyFit,
    measurements: &[Measurement],
    mass: Option<f64>,
) -> Scenario {
    let (p, root) = (fit.parameters, mass.unwrap_or(1.0).sqrt());
    let joint = WrittenLaw::FourParameter { k_t: p.k_t, f_s: p.f_s, chi: p.chi, beta: p.beta };
    let outputs = mass.map(|_| Point { name: POINT.into(), shape: 1.0 / root });
    let mode = Mode {
        shape_at_force: 1.0 / root,
        outputs: outputs.into_iter().collect(),
        initial: Motion::held_at(fit.informed[1]),
        ..mode.clone()
    };
    Scenario {
        title: Some(title.into()),
        modes: vec![ScenarioMode { mode, joint: Some(joint), informed: Some(fit.informed) }],
        joints: Vec::new(),
        structure: None,
        force: Force::Formula("none", Pulse::None),
        settings: Settings::new(1.0 / (SAMPLES * p.frequency), CYCLES / p.frequency),
        sweep: sweep(measurements, mass.map(|_| root)),
    }
}

/// A `[sweep]` over the measured band with the levels of the quantity that most of them held; none where no level held anything.
fn sweep(measurements: &[Measurement], root: Option<f64>) -> Option<SweepTable> {
    let held = || measurements.iter().flat_map(|m| &m.levels).filter_map(|level| level.held);
    let count = |control: Control| held().filter(|h| h.0 == control).count();
    let control = held().map(|h| h.0).max_by_key(|control| count(*control))?;
    let scale = match (root, control) {
        (None, _) => 1.0,
        (Some(root), Control::Force) => root,
        (Some(root), _) => 1.0 / root,
    };
    let mut levels: Vec<f64> = held().filter(|h| h.0 == control).map(|h| scale * h.1).collect();
    levels.sort_by(f64::total_cmp);
    let frequencies = || {
        measurements.iter().flat_map(|m| match &m.data {
            SteadyData::Response(points) => points.iter().map(|p| p.frequency).collect::<Vec<_>>(),
            SteadyData::Backbone(_) => Vec::new(),
        })
    };
    let (from, to) = (frequencies().fold(f64::INFINITY, f64::min), frequencies().fold(0.0, f64::max));
    let sweep = Sweep { from, to, control, levels, harmonics: 1, points: Sweep::DEFAULT_POINTS };
    sweep.checked().ok()?;
    Some(SweepTable { sweep, at: root.map(|_| POINT.into()), damping_ratio: None, direction: None })
}

#[cfg(test)]
mod tests {
    use iwan_ident::sweeps::ResponsePoint;

    use super::super::measurement::Level;
    use super::*;

    #[test]
    fn a_sweep_has_the_levels_that_most_of_them_held() {
        let point = |frequency| ResponsePoint { frequency, amplitude: 1e-4, phase: -1.5, force: 1.0 };
        let held = [(Control::Force, 3.0), (Control::Displacement, 2e-4), (Control::Displacement, 1e-4)];
        let level = |held| Level { held: Some(held), points: vec![0, 1] };
        let measurement = Measurement {
            file: "day.csv".into(),
            data: SteadyData::Response(vec![point(112.0), point(128.0)]),
            levels: held.map(level).to_vec(),
        };
        let sweep = sweep(&[measurement], None).map(|table| table.sweep);
        assert!(sweep.is_some_and(|s| s.control == Control::Displacement && s.levels == [1e-4, 2e-4]));
    }
}
