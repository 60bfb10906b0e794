//! Modes with parts in time: closed forms, an independent integration, energy, order, averaging.

#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use std::f64::consts::{FRAC_PI_2, PI};

use iwan_core::{
    Averaging, Continuum, Coulomb, FourParameter, Grid, Jenkins, ModalLaw, Motion, Newmark, NoJoint,
    Oscillator, Part, PartsEnd, Pinning, PowerDamping, PowerSpring, ResidualStiffness, Reversal, Run, Slider,
    Sliders, WithParts,
};

use crate::common::{Buffers, worst};

fn linear(frequency: f64, damping_ratio: f64) -> Oscillator {
    Oscillator::new(frequency, damping_ratio, 0.0, ResidualStiffness::Positive).unwrap()
}

/// A mode without joint, released at `start` under `force`.
fn run(
    scheme: &Newmark,
    mode: &Oscillator,
    parts: &[Part],
    start: Motion,
    force: &[f64],
    samples: usize,
) -> (Buffers, PartsEnd) {
    let mut out = Buffers::new(samples);
    let with = WithParts::new(scheme, mode, parts).unwrap();
    let mut state = start.displacement;
    let end = with.integrate(&NoJoint, &mut state, start.velocity, force, &mut out.samples()).unwrap();
    (out, end)
}

/// Displacement under dry friction on a linear spring: between two turning points a cosine about ±F/k. Each half cycle is smaller by 2 F/k,
/// until the mode sticks within F/k.
fn dry_decay(released: f64, omega: f64, offset: f64, t: f64) -> f64 {
    let (mut amplitude, mut side) = (released, 1.0);
    let mut half_cycles = (t * omega / PI).floor();
    while half_cycles > 0.0 && amplitude > offset {
        (amplitude, side) = (amplitude - 2.0 * offset, -side);
        half_cycles -= 1.0;
    }
    if amplitude <= offset {
        return side * amplitude;
    }
    side * (offset + (amplitude - offset) * (t * omega - PI * (t * omega / PI).floor()).cos())
}

#[test]
fn dry_friction_is_exact_to_rounding_and_sticks() {
    let mode = linear(3.0, 0.0);
    let (omega, k) = (mode.omega0(), mode.k_inf());
    for (released, offset) in [(1.0, 0.013), (1.0, 0.3), (0.05, 0.0501), (-1.0, 0.0499)] {
        let parts = [Part::from(Coulomb::new(offset * k).unwrap())];
        // The times are chosen so that no turning point falls on a sample.
        let (dt, samples) = (0.007_3, 3000);
        let scheme = Newmark::prewarped(dt, omega).unwrap();
        let (out, end) = run(&scheme, &mode, &parts, Motion::held_at(released), &[], samples);
        let [q, v, a, force] = &out.0;
        for (n, q) in q.iter().enumerate() {
            let exact = released.signum() * dry_decay(released.abs(), omega, offset, n as f64 * dt);
            assert!((q - exact).abs() < 2e-11, "{released} {offset} sample {n}: {q} {exact}");
        }
        // The mode has come to rest for good: nothing moves, and friction holds the force of the spring.
        assert_eq!((v[samples - 1], a[samples - 1]), (0.0, 0.0));
        assert!((force[samples - 1] + k * q[samples - 1]).abs() < 1e-12 * k);
        assert!(end.energy.error() < 1e-13, "{:?}", end.energy);
        assert!(end.energy.friction >= 0.0);
    }
}

/// A mode at rest under a slowly rising force breaks loose where the force reaches F, between two samples, and not earlier.
#[test]
fn a_mode_at_rest_departs_when_the_force_exceeds_the_friction() {
    let mode = linear(2.0, 0.0);
    let (omega, k, friction) = (mode.omega0(), mode.k_inf(), 0.7);
    let parts = [Part::from(Coulomb::new(friction).unwrap())];
    let (dt, samples, rate) = (1e-3, 400, 5.0);
    let force: Vec<f64> = (0..samples).map(|n| rate * n as f64 * dt).collect();
    // The plain scheme is used because prewarping scales a lasting force by 1 + (ω0 dt)²/6.
    let scheme = Newmark::average_acceleration(dt).unwrap();
    let (out, end) = run(&scheme, &mode, &parts, Motion::default(), &force, samples);
    let loose = friction / rate;
    for (n, q) in out.0[0].iter().enumerate() {
        let t = n as f64 * dt - loose;
        let exact = if t <= 0.0 { 0.0 } else { rate / k * (t - (omega * t).sin() / omega) };
        // The scheme's period is (ω0 dt)²/12 too long.
        let late = (omega * dt).powi(2) / 12.0 * omega * t.max(0.0);
        assert!((q - exact).abs() <= 1.1 * late * rate / k / omega, "{n}: {q} {exact}");
        assert!(t > 0.0 || *q == 0.0);
    }
    assert!(end.energy.error() < 1e-13, "{:?}", end.energy);
}

/// Under quadratic damping alone a half cycle from A to -B has a first integral: (1 - 2cB) e^(2cB) = (1 + 2cA) e^(-2cA)
/// (J. P. Den Hartog, Mechanical Vibrations).
#[test]
fn quadratic_damping_has_its_exact_decrement() {
    let mode = linear(1.0, 0.0);
    let c = 0.2;
    let parts = [Part::from(PowerDamping::new(c, 2.0).unwrap())];
    let mut misses = [0.0_f64; 2];
    for (steps, miss) in [1000, 2000].into_iter().zip(&mut misses) {
        let dt = 1.0 / f64::from(steps);
        let scheme = Newmark::prewarped(dt, mode.omega0()).unwrap();
        let samples = 4 * steps as usize;
        let (out, end) = run(&scheme, &mode, &parts, Motion::held_at(1.0), &[], samples);
        assert!(end.energy.error() < 1e-12, "{:?}", end.energy);
        let [q, v, ..] = &out.0;
        let mut from = 1.0;
        for n in (2..samples).filter(|&n| v[n - 1] * v[n] < 0.0) {
            // The turning point from the parabola through this sample and the ones before.
            let share = v[n - 1] / (v[n - 1] - v[n]);
            let to = q[n - 1] + 0.5 * share * v[n - 1] * dt;
            let (a, b) = (2.0 * c * from, 2.0 * c * to.abs());
            *miss = miss.max(((1.0 - b) * b.exp() - (1.0 + a) * (-a).exp()).abs());
            from = to.abs();
        }
    }
    assert!(misses[1] < 2e-7 && misses[1] < 0.3 * misses[0], "{misses:?}");
}

/// The period of Duffing's oscillator, 4 K(m)/√(ω0² + k A²) with m = k A²/(2 (ω0² + k A²)), K by the arithmetic-geometric
/// mean (Abramowitz and Stegun 17.6.3).
fn duffing_period(omega0: f64, cubic: f64, amplitude: f64) -> f64 {
    let stiff = omega0 * omega0 + cubic * amplitude * amplitude;
    let m = 0.5 * cubic * amplitude * amplitude / stiff;
    let (mut a, mut b) = (1.0, (1.0 - m).sqrt());
    for _ in 0..20 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    4.0 * FRAC_PI_2 / a / stiff.sqrt()
}

#[test]
fn a_cubic_spring_has_the_period_of_the_elliptic_integral() {
    let mode = linear(1.0, 0.0);
    for cubic in [60.0, -25.0] {
        let parts = [Part::from(PowerSpring::new(cubic, 3.0).unwrap())];
        let period = duffing_period(mode.omega0(), cubic, 1.0);
        let miss = |steps: usize| {
            let scheme = Newmark::average_acceleration(period / steps as f64).unwrap();
            let (out, end) = run(&scheme, &mode, &parts, Motion::held_at(1.0), &[], 5 * steps + 1);
            // The energy is constant to rounding, whatever the step.
            assert!(end.energy.friction.abs() < 1e-11 * end.energy.initial, "{:?}", end.energy);
            assert!(end.energy.error() < 1e-11, "{:?}", end.energy);
            out.0[1][5 * steps].abs() / mode.omega0()
        };
        let (coarse, fine) = (miss(500), miss(1000));
        assert!(fine < 6e-4 && (coarse / fine - 4.0).abs() < 0.1, "{cubic}: {coarse} {fine}");
        // The first-harmonic frequency is within a few thousandths of the exact one at this large amplitude.
        let law = ModalLaw::<Jenkins>::new(mode, None, &parts);
        assert!((law.frequency(1.0) * period / (2.0 * PI) - 1.0).abs() < 0.02, "{cubic}");
    }
}

/// A pendulum with viscous, dry and quadratic damping and a softening cubic spring. The numbers are those of `tests/peers/pendulum.py`, by
/// SciPy's DOP853 with a tolerance of 1e-13, half cycle by half cycle.
#[test]
fn a_pendulum_follows_an_independent_integration() {
    let golden = [
        (5, -5.701627085186e-01),
        (20, 7.292744150926e-02),
        (60, -9.039910537202e-02),
        (200, 3.185928377433e-04),
    ];
    let mode = linear(0.5, 0.002);
    let parts = [
        Part::from(Coulomb::new(0.004).unwrap()),
        Part::from(PowerDamping::new(0.03, 2.0).unwrap()),
        Part::from(PowerSpring::new(-1.64, 3.0).unwrap()),
    ];
    let miss = |steps_a_second: usize| {
        let dt = 1.0 / steps_a_second as f64;
        let scheme = Newmark::prewarped(dt, mode.omega0()).unwrap();
        let samples = 200 * steps_a_second + 1;
        let (out, end) = run(&scheme, &mode, &parts, Motion::held_at(0.8), &[], samples);
        assert!(end.energy.error() < 1e-11, "{:?}", end.energy);
        golden.map(|(t, q)| (out.0[0][t * steps_a_second] - q).abs())
    };
    let (coarse, fine) = (miss(250), miss(1000));
    assert!(fine.iter().all(|miss| *miss < 2e-6), "{fine:?}");
    // The scheme is of second order, dry friction included.
    assert!((coarse[1] / fine[1] - 16.0).abs() < 0.5, "{coarse:?} {fine:?}");
}

/// With all parts beside a joint, under a blow, the energy balance closes to rounding, on sliders and in the continuum.
#[test]
fn the_energy_closes_with_a_joint_and_all_parts() {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    let mode = Oscillator::new(124.0, 2.5e-4, joint.k_t(), ResidualStiffness::Positive).unwrap();
    let parts = [
        Part::from(PowerDamping::new(0.4, 0.6).unwrap()),
        Part::from(PowerDamping::new(0.05, 2.0).unwrap()),
        Part::from(Coulomb::new(2.0).unwrap()),
        Part::from(PowerSpring::new(-3e8, 3.2).unwrap()),
        Part::from(Pinning::new(1e5, 1e-3).unwrap()),
    ];
    let dt = 2e-5;
    let force: Vec<f64> =
        (0..80).map(|n| 500.0 * (1.0 - (2.0 * PI * f64::from(n) * dt / 1.6e-3).cos())).collect();
    let scheme = Newmark::prewarped(dt, mode.omega0()).unwrap();
    let with = WithParts::new(&scheme, &mode, &parts).unwrap();
    let samples = 10_001;
    let mut table = vec![Slider::default(); Sliders::table_len(400)];
    let sliders = Sliders::discretise(&joint, Grid::graded(400), 400, &mut table).unwrap();
    let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
    let mut cut = Buffers::new(samples);
    let end = with.integrate(&sliders, &mut state, 0.0, &force, &mut cut.samples()).unwrap();
    assert!(end.energy.error() < 1e-11, "{:?}", end.energy);
    let law = Continuum::new(joint);
    let mut state = law.virgin(vec![Reversal::default(); 256]).unwrap();
    let mut whole = Buffers::new(samples);
    let end = with.integrate(&law, &mut state, 0.0, &force, &mut whole.samples()).unwrap();
    assert!(end.energy.error() < 1e-11, "{:?}", end.energy);
    // 400 sliders instead of the continuum.
    assert!(worst(&cut.0[0], &whole.0[0]) < 1e-3, "{}", worst(&cut.0[0], &whole.0[0]));
}

/// Without parts, the stepper is Newmark's method to rounding: it differs only by sticking, sliding and springs.
#[test]
fn without_parts_it_is_newmarks_method() {
    let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
    let mode = Oscillator::new(124.0, 2.5e-3, joint.k_t(), ResidualStiffness::Positive).unwrap();
    let law = Continuum::new(joint);
    let scheme = Newmark::prewarped(2e-5, mode.omega0()).unwrap();
    let force = [50.0, 700.0, 900.0, 100.0];
    let (mut plain, mut with) = (Buffers::new(5001), Buffers::new(5001));
    let mut state = law.virgin(vec![Reversal::default(); 256]).unwrap();
    scheme.integrate(&mode, &law, &mut state, 3.0, &force, &mut plain.samples()).unwrap();
    let mut state = law.virgin(vec![Reversal::default(); 256]).unwrap();
    WithParts::new(&scheme, &mode, &[])
        .unwrap()
        .integrate(&law, &mut state, 3.0, &force, &mut with.samples())
        .unwrap();
    for (plain, with) in plain.0.iter().zip(&with.0) {
        assert!(worst(with, plain) < 1e-9, "{}", worst(with, plain));
    }
    assert!(WithParts::new(&Newmark::new(1e-5, 0.3, 0.6).unwrap(), &mode, &[]).is_err());
}

/// A damper whose force is the root of the velocity has an infinite slope at rest. There the steps are of order 3/2: with four times as
/// many, an eighth of the error is left.
#[test]
fn a_root_of_the_velocity_converges() {
    let mode = linear(1.0, 0.0);
    let parts = [Part::from(PowerDamping::new(0.5, 0.5).unwrap())];
    let end = |steps: usize| {
        let scheme = Newmark::prewarped(1.0 / steps as f64, mode.omega0()).unwrap();
        let (out, end) = run(&scheme, &mode, &parts, Motion::held_at(1.0), &[], 6 * steps + 1);
        assert!(end.energy.error() < 1e-11, "{:?}", end.energy);
        out.0[0].iter().step_by(steps / 100).copied().collect::<Vec<_>>()
    };
    let (a, b, c) = (end(400), end(1600), end(6400));
    let (coarse, fine) = (worst(&a, &b), worst(&b, &c));
    assert!(fine < 1e-5 && coarse / fine > 6.0, "{coarse} {fine}");
}

/// Averaging agrees with closed forms of single dampers, and with the stepper for all parts together.
#[test]
fn averaging_follows_closed_forms_and_the_stepper() {
    let mode = linear(10.0, 0.0);
    let omega = mode.omega0();
    let start = Motion::held_at(0.5);
    let at = |parts: &[Part], t: f64| {
        let law = ModalLaw::<Jenkins>::new(mode, None, parts);
        Averaging::of_law(law, start).unwrap().at(t).amplitude
    };
    let quadratic = [Part::from(PowerDamping::new(0.3, 2.0).unwrap())];
    let dry = [Part::from(Coulomb::new(1.5).unwrap())];
    for t in [0.1, 1.0, 3.0] {
        let exact = 0.5 / (1.0 + 4.0 / (3.0 * PI) * 0.3 * omega * 0.5 * t);
        assert!((at(&quadratic, t) / exact - 1.0).abs() < 1e-6, "{t}");
        let exact = 0.5 - 2.0 * 1.5 / (PI * omega) * t;
        assert!((at(&dry, t) / exact - 1.0).abs() < 1e-6, "{t}");
    }
    // Averaging is evaluated long after dry friction has stopped the mode, which must not lead to endless time steps.
    assert!(at(&dry, 1e4) < 1e-100);

    let parts = [
        Part::from(Coulomb::new(0.4).unwrap()),
        Part::from(PowerDamping::new(0.05, 2.0).unwrap()),
        Part::from(PowerSpring::new(-700.0, 3.0).unwrap()),
        Part::from(Pinning::new(200.0, 0.2).unwrap()),
    ];
    let scheme = Newmark::prewarped(1e-4, omega).unwrap();
    let (out, _) = run(&scheme, &mode, &parts, start, &[], 20_001);
    let mut slow = Buffers::new(20_001);
    let mut decay = Averaging::of_law(ModalLaw::<Jenkins>::new(mode, None, &parts), start).unwrap();
    decay.sample(1e-4, &mut slow.samples()).unwrap();
    assert!(decay.energy(2.0).error() < 2e-3, "{:?}", decay.energy(2.0));
    let energy = |out: &Buffers, n: usize| out.0[0][n].hypot(out.0[1][n] / omega);
    for n in (0..20_001).step_by(500) {
        let (a, b) = (energy(&slow, n), energy(&out, n));
        assert!((a / b - 1.0).abs() < 0.02, "{n}: {a} {b}");
    }
    // A spring that softens until no stiffness is left is refused by name.
    let soft = [Part::from(PowerSpring::new(-1e5, 3.0).unwrap())];
    let refused = Averaging::of_law(ModalLaw::<Jenkins>::new(mode, None, &soft), start).unwrap_err();
    assert!(refused.to_string().contains("softens"), "{refused}");
}
