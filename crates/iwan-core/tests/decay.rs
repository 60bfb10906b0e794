//! Free decay: half-cycle map, averaging and Newmark against the event-driven solution.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a failed test may panic and say why")]

use iwan_core::{
    Averaging, Backbone, Continuum, Decay, EventDriven, FourParameter, Grid, Motion, Newmark, Oscillator,
    Pulse, ResidualStiffness, Reversal, Run, Slider, Sliders, TabledFourParameter,
};

use crate::common::{Buffers, worst};

/// Joint of mode 1, Table 2 of Deaner et al.
fn mode_1() -> FourParameter {
    FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap()
}

/// Mode 1 of Table 2, 124 Hz, with another joint and damper.
fn oscillator(joint: &impl Backbone, zeta: f64) -> Oscillator {
    Oscillator::new(124.0, zeta, joint.initial_stiffness(), ResidualStiffness::Positive).unwrap()
}

fn table(law: &impl Backbone, grid: Grid, bins: usize) -> Vec<(f64, f64)> {
    let mut table = vec![Slider::default(); Sliders::table_len(bins)];
    Sliders::discretise(law, grid, bins, &mut table).unwrap().elements().collect()
}

/// The event-driven response of a population from a displaced start.
fn events(elements: &[(f64, f64)], zeta: f64, start: Motion, dt: f64, samples: usize, angle: f64) -> Buffers {
    let (strength, stiffness): (Vec<_>, Vec<_>) = elements.iter().copied().unzip();
    let mut table = vec![Slider::default(); strength.len() + 1];
    let sliders = Sliders::from_elements(&strength, &stiffness, &mut table).unwrap();
    let oscillator = oscillator(&sliders, zeta);
    let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
    iwan_core::Hysteresis::advance(&sliders, &mut state, start.displacement);
    let mut out = Buffers::new(samples);
    let solver = EventDriven::new(&oscillator, sliders, Pulse::None, 1.0).unwrap().with_angle(angle).unwrap();
    let balance = solver.integrate(&mut state, start.velocity, dt, &mut out.samples()).unwrap();
    assert!(balance.error() < 1e-14 * (elements.len() as f64).max(100.0), "{balance:?}");
    out
}

#[test]
fn event_driven_solution_is_self_consistent() {
    let joint = mode_1();
    let elements = table(&joint, Grid::graded(100), 100);
    for (ratio, zeta) in [(0.05, 0.0), (0.5, 1e-3), (2.0, 1e-2)] {
        let start = Motion::held_at(ratio * joint.phi_max());
        let coarse = events(&elements, zeta, start, 1e-3, 201, 0.5);
        let fine = events(&elements, zeta, start, 1.25e-4, 1601, 0.23);
        let every_eighth: Vec<f64> = fine.0[0].iter().copied().step_by(8).collect();
        assert!(
            worst(&coarse.0[0], &every_eighth) < 1e-11,
            "{ratio} {zeta}: {}",
            worst(&coarse.0[0], &every_eighth)
        );
    }
}

#[test]
fn half_cycle_map_is_exact_on_a_slider_population_without_damper() {
    // The map uses only the virgin curve of the sliders; its turning points must agree to rounding.
    let joint = mode_1();
    let elements = table(&joint, Grid::graded(60), 60);
    let (strength, stiffness): (Vec<_>, Vec<_>) = elements.iter().copied().unzip();
    let mut table = vec![Slider::default(); strength.len() + 1];
    let sliders = Sliders::from_elements(&strength, &stiffness, &mut table).unwrap();
    for ratio in [0.01, 0.3, 1.0, 3.0] {
        let start = Motion::held_at(ratio * joint.phi_max());
        let mut decay =
            Decay::new(&oscillator(&sliders, 0.0), &sliders, 0.0, start, vec![Reversal::default(); 64])
                .unwrap();
        let response = events(&elements, 0.0, start, 1e-6, 40_001, 0.5);
        let q = &response.0[0];
        let turns = (1..q.len() - 1).filter(|&n| (q[n] - q[n - 1]) * (q[n + 1] - q[n]) < 0.0);
        for (n, turn) in turns.zip(std::iter::from_fn(|| decay.next())).take(8) {
            // Parabola through three samples around the turn.
            let (a, b) = (0.5 * (q[n + 1] - q[n - 1]), q[n + 1] - 2.0 * q[n] + q[n - 1]);
            let peak = q[n] - 0.5 * a * a / b;
            println!("{ratio} {:e}", turn.displacement / peak - 1.0);
            assert!((turn.displacement / peak - 1.0).abs() < 1e-7, "{ratio}: {} {peak}", turn.displacement);
        }
    }
}

/// Displacements of one decay at uniform times: (half-cycle map, event-driven reference).
fn map_and_reference(ratio: f64, zeta: f64, samples: usize, dt: f64) -> (Vec<f64>, Vec<f64>) {
    let joint = mode_1();
    let start = Motion::held_at(ratio * joint.phi_max());
    let mut map = Buffers::new(samples);
    Decay::new(&oscillator(&joint, zeta), &joint, 0.0, start, vec![Reversal::default(); 512])
        .unwrap()
        .sample(dt, &mut map.samples())
        .unwrap();
    // Bins in geometric progression from 1e-4 of the amplitude.
    let grid = Grid::Geometric { ratio: (1e4 / ratio).max(1e4).powf(1.0 / 20_000.0) };
    let reference = events(&table(&joint, grid, 20_000), zeta, start, dt, samples, 0.5);
    (map.0[0].clone(), reference.0[0].clone())
}

#[test]
fn half_cycle_map_agrees_with_the_event_driven_solution() {
    for ratio in [0.001, 0.01, 0.1, 0.5, 1.0, 2.0, 5.0] {
        for zeta in [0.0, 2.5e-4, 1e-2] {
            let (map, reference) = map_and_reference(ratio, zeta, 161, 2.5e-4);
            let error = worst(&map, &reference);
            println!("{ratio} {zeta}: {error:.2e}");
            assert!(error < 1e-6, "a/phi_max = {ratio}, zeta = {zeta}: {error:e}");
        }
    }
}

#[test]
fn energy_balance_of_the_map_closes() {
    let joint = mode_1();
    for (ratio, zeta) in [(0.01, 0.0), (0.3, 1e-3), (4.0, 1e-2)] {
        for velocity in [0.0, 0.3, -0.7] {
            let start = Motion { displacement: ratio * joint.phi_max(), velocity };
            let mut decay =
                Decay::new(&oscillator(&joint, zeta), &joint, 3.0, start, vec![Reversal::default(); 128])
                    .unwrap();
            for _ in 0..60 {
                decay.next().unwrap();
            }
            let balance = decay.energy();
            println!("{ratio} {zeta} {velocity} {:e}", balance.error());
            assert!(balance.error() < 1e-10, "{ratio} {zeta} {velocity}: {balance:?}");
            assert!(balance.friction > 0.0);
        }
    }
}

#[test]
fn a_start_in_mid_motion_joins_the_same_decay() {
    // Restarting from a sample of the decay, with its velocity, continues it.
    let joint = mode_1();
    let osc = oscillator(&joint, 1e-3);
    let run = |velocity: f64, dt: f64, samples: usize| {
        let mut out = Buffers::new(samples);
        let start = Motion { displacement: 0.0, velocity };
        Decay::new(&osc, &joint, 0.0, start, vec![Reversal::default(); 128])
            .unwrap()
            .sample(dt, &mut out.samples())
            .unwrap();
        out
    };
    let continuum = Continuum::new(TabledFourParameter::new(joint));
    for velocity in [0.5, -2.0, 12.0] {
        let map = run(velocity, 1e-4, 401);
        let newmark = |dt: f64, stride: usize| {
            let mut out = Buffers::new(400 * stride + 1);
            let mut state = continuum.virgin(vec![Reversal::default(); 128]).unwrap();
            let scheme = Newmark::prewarped(dt, osc.omega0()).unwrap();
            scheme.integrate(&osc, &continuum, &mut state, velocity, &[], &mut out.samples()).unwrap();
            out.0[0].iter().copied().step_by(stride).collect::<Vec<_>>()
        };
        let (coarse, fine) = (newmark(1e-6, 100), newmark(5e-7, 200));
        let reference: Vec<f64> = fine.iter().zip(&coarse).map(|(f, c)| f + (f - c) / 3.0).collect();
        let error = worst(&map.0[0], &reference);
        println!("{velocity}: {error:e}");
        assert!(error < 2e-6, "{velocity}: {error:e}");
    }
}

#[test]
fn averaging_is_as_good_as_published_and_no_better() {
    let joint = mode_1();
    for (ratio, low, high) in [(0.01, 1e-6, 1e-3), (0.1, 1e-4, 1e-2), (0.3, 3e-4, 2e-2)] {
        let osc = oscillator(&joint, 0.0);
        let start = Motion::held_at(ratio * joint.phi_max());
        let mut slow = Averaging::new(&osc, &joint, start).unwrap();
        let mut decay = Decay::new(&osc, &joint, 0.0, start, vec![Reversal::default(); 128]).unwrap();
        let mut error = 0.0_f64;
        for _ in 0..50 {
            let turn = decay.next().unwrap();
            error = error.max((slow.at(turn.time).amplitude / turn.displacement.abs() - 1.0).abs());
        }
        println!("{ratio}: {error:e}");
        assert!((low..high).contains(&error), "{ratio}: envelope error {error:e}");
    }
}
