//! Three modes that share one joint against the structure that they come from: the paper's beam, configuration A.

#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use std::sync::LazyLock;

use iwan_core::progress::UNWATCHED;
use iwan_core::{Backbone, Pulse, Representation};
use iwan_fem::{Extras, Model, NamedModes};
use iwan_input::scenario::{Overrides, Scenario, to_toml};
use iwan_input::{InputText, StructureFile, StructureTask, built_in_structure};
use iwan_sim::{CoupledResponse, Response, Settings, cycles, simulate_coupled};

const DT: f64 = 1e-5;
const DURATION: f64 = 0.2;

struct Beam {
    file: StructureFile,
    named: NamedModes,
    scenario: Scenario,
}

/// Computed once for all tests.
static BEAM: LazyLock<Beam> = LazyLock::new(|| {
    let file = StructureFile::read(&built_in_structure("paper-a").unwrap()).unwrap();
    let named = NamedModes::new(&file.structure, 12).unwrap();
    let scenario = file.coupled(&named, &named.first_bending()).unwrap().scenario;
    Beam { file, named, scenario }
});

impl Beam {
    /// Modal coordinates of the structure, and of the coupled modes, under a blow.
    fn under(&self, amplitude: f64) -> (Vec<Response>, CoupledResponse) {
        let blow = Pulse::Haversine { amplitude, duration: 1.6e-3 };
        let task = StructureTask {
            force: Some(blow),
            velocity: &[],
            dt: DT,
            duration: DURATION,
            representation: Representation::Continuum,
            model: Model::Basis(50),
            modes: &[],
            extras: Extras::default(),
        };
        let run = self.file.run(&self.named, &task, UNWATCHED).unwrap();
        let truth =
            run.response.outputs.iter().zip(run.joint_forces).take(3).map(|(history, joint_force)| {
                Response {
                    dt: DT,
                    displacement: history.displacement.clone(),
                    velocity: history.velocity.clone(),
                    acceleration: history.acceleration.clone(),
                    joint_force,
                    ..Response::default()
                }
            });
        let settings = Settings { dt: DT, duration: DURATION, quality: false, ..self.scenario.settings };
        let (modes, joints) = (self.scenario.modes(), self.scenario.joints());
        let coupled = simulate_coupled(&modes, &joints, &blow, &settings, 1, UNWATCHED).unwrap();
        (truth.collect(), coupled)
    }

    /// Dissipation per cycle of a mode alone, by static loads on the structure, against its amplitude.
    fn alone(&self, mode: usize, amplitudes: &[f64]) -> Vec<f64> {
        let named = &self.named.first_bending()[mode];
        self.named.static_curves(named, amplitudes, true).unwrap().dissipation
    }
}

fn misfit(model: &[f64], truth: &[f64]) -> f64 {
    let square = |x: f64| x * x;
    let off: f64 = model.iter().zip(truth).map(|(a, b)| square(a - b)).sum();
    (off / truth.iter().map(|b| square(*b)).sum::<f64>()).sqrt()
}

/// Dissipation per cycle against amplitude, on a line of logarithms between points.
struct Curve(Vec<(f64, f64)>);

impl Curve {
    fn new(beam: &Beam, mode: usize) -> Self {
        let onset = beam.named.onset(&beam.named.first_bending()[mode]).unwrap();
        let amplitudes: Vec<f64> = (0..13).map(|n| onset * 10.0_f64.powf(f64::from(n) / 4.0 - 3.0)).collect();
        let losses = beam.alone(mode, &amplitudes);
        Self(amplitudes.iter().zip(losses).map(|(q, d)| (q.ln(), d.ln())).collect())
    }

    fn at(&self, q: f64) -> f64 {
        let x = q.ln();
        let next = self.0.partition_point(|(at, _)| *at < x).clamp(1, self.0.len() - 1);
        let ((x0, y0), (x1, y1)) = (self.0[next - 1], self.0[next]);
        (y0 + (y1 - y0) * (x - x0) / (x1 - x0)).exp()
    }
}

/// D over that of the mode alone, in the cycles within 20 ms of a time: modes hand energy to and fro between cycles.
fn loss_ratio(alone: &Curve, response: &Response, at: f64) -> f64 {
    let near: Vec<_> = cycles(response, 1.6e-3).into_iter().filter(|c| (c.t - at).abs() < 0.02).collect();
    let lost: f64 = near.iter().map(|cycle| cycle.dissipation).sum();
    lost / near.iter().map(|cycle| alone.at(cycle.amplitude)).sum::<f64>()
}

/// What uncoupled modes are off by 3 to 120 % (`iwan reproduce`), one joint and three modes follow.
#[test]
fn three_modes_and_one_joint_follow_the_structure() {
    let beam = &*BEAM;
    let curves = [0, 2].map(|mode| Curve::new(beam, mode));
    for (amplitude, first, third) in [(10.0, 2e-4, 1e-3), (100.0, 0.001, 0.01), (1000.0, 0.01, 0.12)] {
        let (truth, coupled) = beam.under(amplitude);
        assert!(coupled.energy.error() < 1e-13, "{amplitude} lbf: {:e}", coupled.energy.error());
        for (mode, allowed) in [(0, first), (2, third)] {
            let off = misfit(&coupled.modes[mode].acceleration, &truth[mode].acceleration);
            println!("{amplitude} lbf, mode {}: rms {off:.2e} of {allowed}", mode + 1);
            assert!(off <= allowed, "{amplitude} lbf, mode {}: {off:e}", mode + 1);
        }
        if amplitude > 100.0 {
            continue;
        }
        for (mode, alone, allowed) in [(0, &curves[0], 0.01), (2, &curves[1], 0.02)] {
            for at in [0.03, 0.1, 0.17] {
                let [model, of_truth] =
                    [&coupled.modes[mode], &truth[mode]].map(|r| loss_ratio(alone, r, at));
                println!("{amplitude} lbf, mode {}, {at} s: {model:.4} {of_truth:.4}", mode + 1);
                assert!(
                    (model / of_truth - 1.0).abs() <= allowed,
                    "{amplitude} {mode} {at}: {model} {of_truth}"
                );
            }
        }
    }
}

/// Under the static load of one mode the model dissipates as the structure does.
#[test]
fn static_loads_dissipate_as_on_the_structure() {
    let beam = &*BEAM;
    let (modes, joint) = (beam.scenario.modes(), &beam.scenario.joints()[0]);
    let law = &joint.law;
    for mode in [0, 2] {
        // s = b q - (ρ + Σ b²/ω² of the other modes) N(s), from s = 0 up.
        let others = modes.iter().zip(&joint.participation).enumerate().filter(|(r, _)| *r != mode);
        let flexibility: f64 =
            others.map(|(_, (m, b))| (b / (std::f64::consts::TAU * m.frequency)).powi(2)).sum::<f64>()
                + joint.compliance[0];
        let missing = |s: f64| law.force(s) - law.initial_stiffness() * s;
        let b = joint.participation[mode].abs();
        let onset = law.strengths().1 / b;
        let shares = [(1e-3, 1e-4), (0.01, 1e-4), (0.1, 1e-4), (0.5, 1e-2), (1.0, 1e-2), (2.0, 1e-2)];
        let truth = beam.alone(mode, &shares.map(|(share, _)| share * onset));
        for ((share, allowed), truth) in shares.into_iter().zip(truth) {
            let q = share * onset;
            let (mut low, mut high) = (0.0, 2.0 * b * q + 1e3 * law.strengths().1);
            for _ in 0..200 {
                let s = 0.5 * (low + high);
                if s + flexibility * missing(s) > b * q { high = s } else { low = s }
            }
            let own = law.dissipation(low);
            println!("mode {}, {share} of the onset: {:.2e}", mode + 1, own / truth - 1.0);
            assert!((own / truth - 1.0).abs() <= allowed, "mode {}, {share}: {own:e} {truth:e}", mode + 1);
        }
    }
}

/// What is written is read again to the last bit.
#[test]
fn the_scenario_survives_writing() {
    let scenario = BEAM.scenario.clone();
    let text = to_toml(&scenario, "");
    let read = Scenario::read(&InputText::built_in("coupled.toml", &text), &Overrides::default()).unwrap();
    assert_eq!(read, scenario, "{text}");
}
