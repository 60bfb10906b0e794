//! Dynamic friction below static friction: closed forms against quadrature and against loops slider by slider; the memory against a plain
//! loop; time steps; averaging; and refusals by methods that rest on Masing's rule.
#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use std::f64::consts::{PI, TAU};

use iwan_core::quadrature::Rule;
use iwan_core::{
    Averaging, Backbone, Continuum, Error, FiveParameter, FourParameter, Grid, Hysteresis, Motion, Newmark,
    Oscillator, PartsEnd, Plain, ResidualStiffness, Reversal, Run, Slider, Sliders, SplitMix64, Spring,
    Springs, StickSlip, Trial, WithParts, one_harmonic,
};

use crate::common::Buffers;

const LAWS: [[f64; 4]; 5] = [
    [4.45e4, 239.4, -0.183, 0.3],
    [2.75e5, 300.0, -0.3, 0.02],
    [1e3, 5.0, -0.9, 0.0],
    [2e3, 1.0, 0.5, 4.0],
    [1.0, 1.0, 0.0, 1.0],
];
const RATIOS: [f64; 5] = [1.0, 0.9, 0.6, 0.3, 0.05];

fn laws() -> impl Iterator<Item = FiveParameter> {
    LAWS.into_iter().flat_map(|[k_t, f_s, chi, beta]| {
        RATIOS.map(|theta| FiveParameter::new(k_t, f_s, chi, beta, theta).unwrap())
    })
}

/// The sliders of a law; the caller owns their `table`.
fn population<'a>(law: &FiveParameter, bins: usize, table: &'a mut Vec<Slider>) -> Sliders<'a> {
    table.resize(Sliders::table_len(bins), Slider::default());
    Sliders::discretise(law, Grid::graded(bins), bins, table).unwrap()
}

#[test]
fn without_a_drop_it_is_the_four_parameter_joint() {
    for [k_t, f_s, chi, beta] in LAWS {
        let four = FourParameter::new(k_t, f_s, chi, beta).unwrap();
        let five = FiveParameter::new(k_t, f_s, chi, beta, 1.0).unwrap();
        for ratio in [1e-6, 1e-3, 0.1, 0.5, 0.99, 1.0, 1.01, 1.5, 4.0, 1e3] {
            let u = ratio * four.phi_max();
            for five in [five, five.after(f64::INFINITY), five.after(2.0 * u)] {
                let near = |found: f64, exact: f64, scale: f64| {
                    assert!((found - exact).abs() <= 1e-13 * scale, "{five:?} {ratio}: {found} {exact}");
                };
                near(five.force(u), four.force(u), four.force(u));
                near(five.tangent(u), four.tangent(u), k_t);
                near(five.energy(u), four.energy(u), four.energy(u));
                // The closed form of micro-slip divides by a quantity that is computed here as a difference.
                near(five.dissipation(u), four.dissipation(u), 20.0 * four.dissipation(u));
                near(five.energy_at_turn(u), four.energy_at_turn(u), four.energy(u));
                near(five.harmonic_stiffness(u), four.harmonic_stiffness(u), k_t.min(20.0 * four.secant(u)));
            }
        }
    }
}

/// Force of one slider that slides, divided by its stiffness, on the way down from the turning point of a cycle of amplitude `u`.
fn coming_down(theta: f64, phi: f64, u: f64, at: f64) -> f64 {
    let stuck = theta * phi - (u - at);
    if stuck > -phi { stuck } else { -theta * phi }
}

/// Dissipation and first-harmonic stiffness of one slider in a cycle, by quadrature on both sides of the point where it breaks loose.
fn one_cycle(theta: f64, phi: f64, u: f64) -> [f64; 2] {
    const RULE: Rule<16> = Rule::gauss_legendre();
    let breaks = (1.0 - (1.0 + theta) * phi / u).clamp(-1.0, 1.0).acos();
    let mut sums = [0.0; 2];
    for (from, to) in [(0.0, breaks), (breaks, PI)] {
        for panel in 0..8 {
            let at = |i: i32| from + (to - from) * f64::from(i) / 8.0;
            let force = |psi: f64| coming_down(theta, phi, u, u * psi.cos());
            sums[0] -= RULE.integrate(at(panel), at(panel + 1), |psi| 2.0 * force(psi) * u * psi.sin());
            sums[1] += RULE.integrate(at(panel), at(panel + 1), |psi| force(psi) * psi.cos());
        }
    }
    [sums[0], 2.0 / (PI * u) * sums[1]]
}

/// D and K_1 by quadrature over the density of the sliders that slide in a cycle of amplitude `u`, after a cycle of amplitude `largest`.
fn by_quadrature(law: &FiveParameter, u: f64, largest: f64) -> [f64; 2] {
    const RULE: Rule<16> = Rule::gauss_legendre();
    let (theta, four) = (law.theta(), law.sticking());
    let reach = u.max(largest.min(2.0 * u / (1.0 + theta)));
    let strongest = reach.min(law.phi_max());
    // φ = strongest · s^q removes the corner of φ^χ; s = t (2 - t) removes that of the root where the strongest slider just breaks loose.
    let q = (4.0 / (four.chi() + 1.0)).ceil();
    let mut sums = [0.0, four.k_t()];
    let panels = 64;
    for n in 0..panels {
        let at = |n: i32| f64::from(n) / f64::from(panels);
        for which in 0..2 {
            sums[which] += RULE.integrate(at(n), at(n + 1), |t| {
                let s = t * (2.0 - t);
                let phi = strongest * s.powf(q);
                let weight = four.density(phi) * strongest * q * s.powf(q - 1.0) * 2.0 * (1.0 - t);
                let one = one_cycle(theta, phi, u);
                if weight.is_finite() { weight * (one[which] - which as f64) } else { 0.0 }
            });
        }
    }
    if reach >= law.phi_max() {
        let [d, k] = one_cycle(theta, law.phi_max(), u);
        sums = [sums[0] + four.s() * d, sums[1] + four.s() * (k - 1.0)];
    }
    sums
}

#[test]
fn dissipation_and_stiffness_are_those_of_the_sliders_by_quadrature() {
    for law in laws() {
        for ratio in [0.01, 0.3, 0.8, 1.0 + 1e-9, 1.2, 3.0, 40.0] {
            let u = ratio * law.phi_max();
            for largest in [0.0, 1.1 * u, f64::INFINITY] {
                let [d, k] = by_quadrature(&law, u, largest);
                let law = law.after(largest);
                let (found, stiffness) = (law.dissipation(u), law.harmonic_stiffness(u));
                assert!((found / d - 1.0).abs() < 1e-10, "{law:?} {ratio}: D {found} {d}");
                let scale = law.initial_stiffness().min(law.sticking().f_s() / u);
                assert!((stiffness - k).abs() < 1e-9 * scale, "{law:?} {ratio}: K {stiffness} {k}");
            }
        }
    }
}

#[test]
fn the_virgin_curve_is_that_of_its_sliders() {
    const RULE: Rule<16> = Rule::gauss_legendre();
    for law in laws() {
        let mut table = Vec::new();
        let sliders = population(&law, 40_000, &mut table);
        for ratio in [0.01, 0.3, 0.9, 1.5] {
            let u = ratio * law.phi_max();
            let scale = law.force(u).abs().max(law.theta() * law.slip_force());
            assert!((sliders.force(u) - law.force(u)).abs() < 1e-3 * scale, "{law:?} {ratio}");
            assert!((sliders.dissipation(u) / law.dissipation(u) - 1.0).abs() < 2e-3, "{law:?} {ratio}");
            // The work is the integral of the force, and the slope is its derivative.
            let below = u.min(law.phi_max() * (1.0 - 1e-12));
            let panels = (0..16).map(|n| f64::from(n) / 16.0 * below);
            let work: f64 = panels.map(|a| RULE.integrate(a, a + below / 16.0, |u| law.force(u))).sum();
            let work = work + law.force(u) * (u - below);
            assert!((law.energy(u) / work - 1.0).abs() < 1e-6, "{law:?} {ratio}: {} {work}", law.energy(u));
            if ratio < 1.0 {
                let slope = (law.force(u * 1.0001) - law.force(u * 0.9999)) / (2e-4 * u);
                assert!((slope - law.tangent(u)).abs() < 1e-5 * law.initial_stiffness(), "{law:?} {ratio}");
            }
        }
    }
}

/// Every slider computed by itself, as defined: it sticks up to the static limit, slides at the dynamic one, and sticks again when the
/// motion turns round.
struct PlainLoop {
    elements: Vec<(f64, f64)>,
    theta: f64,
    u: f64,
    springs: Vec<(f64, f64)>,
}

impl PlainLoop {
    fn new(elements: Vec<(f64, f64)>, theta: f64) -> Self {
        let springs = vec![(0.0, 0.0); elements.len()];
        Self { elements, theta, u: 0.0, springs }
    }

    fn advance(&mut self, u: f64) -> f64 {
        let du = u - self.u;
        for ((phi, _), (x, sliding)) in self.elements.iter().zip(&mut self.springs) {
            if du != 0.0 && *sliding != du.signum() {
                *sliding = 0.0;
            }
            if *sliding == 0.0 {
                *x += du;
                if x.abs() >= *phi && *x * du >= 0.0 && du != 0.0 {
                    *x = self.theta * phi * du.signum();
                    *sliding = du.signum();
                }
            }
        }
        self.u = u;
        self.elements.iter().zip(&self.springs).map(|((_, k), (x, _))| k * x).sum()
    }
}

fn history(seed: u64, steps: usize, scale: f64) -> Vec<f64> {
    let mut random = SplitMix64::new(seed);
    let mut u = 0.0;
    (0..steps)
        .map(|n| {
            // Small and large steps, with stretches in one direction and returns to the same point.
            let size = scale * 10.0_f64.powf(-2.0 * (0.5 + 0.5 * random.next_symmetric()));
            u += size * if n % 7 < 4 { random.next_symmetric() } else { 1.0 };
            u -= if u.abs() > 3.0 * scale { u } else { 0.0 };
            u
        })
        .collect()
}

#[test]
fn the_memory_is_the_plain_loop_over_any_history() {
    for (n, law) in laws().enumerate() {
        let mut table = Vec::new();
        let sliders = population(&law, 60, &mut table);
        let joint = StickSlip::new(sliders);
        let mut state = joint.virgin(vec![Spring::default(); sliders.len()]).unwrap();
        let mut plain = PlainLoop::new(sliders.elements().collect(), law.theta());
        let mut random = SplitMix64::new(n as u64);
        for u in history(n as u64, 4000, law.phi_max()) {
            let before = joint.joint_force(&state);
            let (ahead, tangent) = joint.trial(&state, u);
            assert_eq!(joint.joint_force(&state), before);
            let (force, exact) = (joint.advance(&mut state, u), plain.advance(u));
            assert!((force - exact).abs() < 1e-11 * law.slip_force(), "{law:?} {u}: {force} {exact}");
            assert!((ahead - force).abs() < 1e-11 * law.slip_force(), "{law:?} {u}: {ahead} {force}");
            assert!((0.0..=1.000_001 * law.initial_stiffness()).contains(&tangent));
            let extension = plain.elements.iter().zip(&plain.springs).map(|((_, k), (x, _))| 0.5 * k * x * x);
            let stored: f64 = extension.sum();
            assert!((joint.stored_energy(&state) - stored).abs() < 1e-11 * law.energy(law.phi_max()));
            // A step computed from the equation of motion: the equation holds at the end of the step.
            let mut stepped = state.clone();
            let stiffness = law.initial_stiffness() * (0.1 + random.next_symmetric().abs());
            let load = 2.0 * law.slip_force() * random.next_symmetric();
            let du = joint.solve(&mut stepped, stiffness, load);
            let rest = stiffness * du + joint.joint_force(&stepped) - joint.joint_force(&state) - load;
            assert!(rest.abs() < 1e-9 * law.slip_force(), "{law:?}: {rest}");
        }
    }
}

#[test]
fn work_on_a_way_is_stored_or_rubbed_away_and_never_comes_from_friction() {
    let law = FiveParameter::new(4.45e4, 239.4, -0.183, 0.3, 0.6).unwrap();
    let mut table = Vec::new();
    let sliders = population(&law, 60, &mut table);
    let joint = StickSlip::new(sliders);
    let mut state = joint.virgin(vec![Spring::default(); sliders.len()]).unwrap();
    let (mut rubbed, mut fine) = (0.0, joint.virgin(vec![Spring::default(); sliders.len()]).unwrap());
    let mut work = 0.0;
    for u in history(3, 500, law.phi_max()) {
        let (from, before, stored) =
            (joint.displacement(&state), joint.joint_force(&state), joint.stored_energy(&state));
        let beyond = joint.mean_beyond_ends(&state, u).0;
        let force = joint.advance(&mut state, u);
        let done = (0.5 * (before + force) + beyond) * (u - from);
        let lost = done - (joint.stored_energy(&state) - stored);
        assert!(lost > -1e-12 * law.energy(law.phi_max()), "{lost}");
        rubbed += lost;
        // The work over the same way in a thousand steps, by the trapezoidal rule.
        let mut last = joint.joint_force(&fine);
        for n in 1..=1000 {
            let force = joint.advance(&mut fine, from + (u - from) * f64::from(n) / 1000.0);
            work += 0.5 * (last + force) * (u - from) / 1000.0;
            last = force;
        }
        work -= done;
    }
    assert!(work.abs() < 1e-3 * rubbed, "{work} of {rubbed}");
}

/// Dissipation and first-harmonic stiffness of the last of several cycles with these `amplitudes`.
fn driven(law: &FiveParameter, bins: usize, amplitudes: &[f64]) -> [f64; 2] {
    const STEPS: i32 = 4000;
    let mut table = Vec::new();
    let sliders = population(law, bins, &mut table);
    let joint = StickSlip::new(sliders);
    let mut state = joint.virgin(vec![Spring::default(); sliders.len()]).unwrap();
    let mut found = [0.0; 2];
    joint.advance(&mut state, amplitudes[0]);
    for (n, &a) in amplitudes.iter().enumerate() {
        joint.advance(&mut state, a);
        if n + 1 < amplitudes.len() {
            joint.advance(&mut state, -a);
            continue;
        }
        let mut last = (a, joint.joint_force(&state));
        for n in 1..=STEPS {
            let psi = TAU * f64::from(n) / f64::from(STEPS);
            let u = a * psi.cos();
            let beyond = joint.mean_beyond_ends(&state, u).0;
            let force = joint.advance(&mut state, u);
            found[0] += (0.5 * (force + last.1) + beyond) * (u - last.0);
            found[1] += force * psi.cos() * 2.0 / (a * f64::from(STEPS));
            last = (u, force);
        }
    }
    found
}

#[test]
fn cycles_depend_on_what_was_before() {
    for theta in [0.9, 0.6, 0.3] {
        let law = FiveParameter::new(4.45e4, 239.4, -0.183, 0.3, theta).unwrap();
        for ratio in [0.1, 0.4, 0.9] {
            let u = ratio * law.phi_max();
            let near = |found: [f64; 2], law: FiveParameter| {
                let exact = [law.dissipation(u), law.harmonic_stiffness(u)];
                assert!((found[0] / exact[0] - 1.0).abs() < 5e-3, "{law:?} {ratio}: {found:?} {exact:?}");
                assert!((found[1] - exact[1]).abs() < 5e-3 * (law.initial_stiffness() - exact[1]).max(1.0));
            };
            // From rest, and after large cycles that die away slowly.
            near(driven(&law, 5000, &[u, u]), law);
            let loud: Vec<f64> =
                (0..=3000).map(|n| u * (3.0_f64).powf(1.0 - f64::from(n) / 3000.0)).collect();
            near(driven(&law, 5000, &loud), law.after(3.0 * u));
            // After a cycle of only a little larger amplitude, the sliders between the two amplitudes stick.
            let little = [1.05 * u, u, u];
            near(driven(&law, 5000, &little), law.after(1.05 * u));
        }
    }
}

struct Released {
    out: Buffers,
    end: PartsEnd,
}

fn released(law: &FiveParameter, bins: usize, dt: f64, samples: usize, at: f64) -> Released {
    let mut table = Vec::new();
    let sliders = population(law, bins, &mut table);
    let mode = Oscillator::new(124.0, 2.5e-4, law.initial_stiffness(), ResidualStiffness::Positive).unwrap();
    let joint = StickSlip::new(sliders);
    let mut state: Springs<Vec<Spring>> = joint.virgin(vec![Spring::default(); sliders.len()]).unwrap();
    joint.advance(&mut state, at);
    let scheme = Newmark::prewarped(dt, mode.omega0()).unwrap();
    let mut out = Buffers::new(samples);
    let with = WithParts::new(&scheme, &mode, &[]).unwrap();
    let end = with.integrate(&joint, &mut state, 0.0, &[], &mut out.samples()).unwrap();
    Released { out, end }
}

#[test]
fn steps_are_of_second_order_across_breaks_and_their_balance_closes() {
    // Through macro-slip, where the Dirac element with a third of the stiffness breaks loose and its force drops by 40 %.
    let law = FiveParameter::new(4.45e4, 239.4, -0.183, 0.5, 0.6).unwrap();
    let at = 1.5 * law.phi_max();
    let run = |fraction: usize| released(&law, 20, 1e-4 / fraction as f64, 400 * fraction + 1, at);
    let finest = run(64);
    let error = |fraction: usize| {
        let found = run(fraction);
        assert!(found.end.energy.error() < 1e-12, "{:?}", found.end.energy);
        assert!(found.end.energy.friction > 0.0);
        let pairs = found.out.0[0].iter().step_by(fraction).zip(finest.out.0[0].iter().step_by(64));
        pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs())) / at
    };
    let errors = [1, 2, 4, 8].map(error);
    assert!(errors[3] < errors[0] / 20.0 && errors[0] < 2e-3, "{errors:?}");
}

#[test]
fn without_a_drop_the_steps_are_those_of_the_plain_memory() {
    let law = FiveParameter::new(4.45e4, 239.4, -0.183, 0.3, 1.0).unwrap();
    let at = 1.3 * law.phi_max();
    let found = released(&law, 50, 1e-4, 2000, at);
    let mut table = Vec::new();
    let sliders = population(&law, 50, &mut table);
    let mode = Oscillator::new(124.0, 2.5e-4, law.initial_stiffness(), ResidualStiffness::Positive).unwrap();
    let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
    sliders.advance(&mut state, at);
    let scheme = Newmark::prewarped(1e-4, mode.omega0()).unwrap();
    let mut out = Buffers::new(2000);
    scheme.integrate_sliders(&mode, &sliders, &mut state, 0.0, &[], &mut out.samples()).unwrap();
    // A kink within a step gives both schemes an error of second order, but not the same error.
    let pairs = found.out.0[0].iter().zip(&out.0[0]);
    let worst = pairs.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    assert!(worst < 2e-3 * at, "{}", worst / at);
}

#[test]
fn averaging_follows_the_steps_of_a_decay() {
    // Averaging is of first order in the damping, which is large in macro-slip.
    for (theta, ratio, tolerance) in [(0.8, 0.3, 0.01), (0.5, 0.3, 0.02), (0.8, 3.0, 0.04)] {
        let law = FiveParameter::new(4.45e4, 239.4, -0.183, 0.0, theta).unwrap();
        let at = ratio * law.phi_max();
        let found = released(&law, 400, 2e-5, 25_001, at);
        let mode =
            Oscillator::new(124.0, 2.5e-4, law.initial_stiffness(), ResidualStiffness::Positive).unwrap();
        let after = law.after(at);
        let mut slow = Averaging::new(&mode, &after, Motion::held_at(at)).unwrap();
        let mut out = Buffers::new(25_001);
        slow.sample(2e-5, &mut out.samples()).unwrap();
        // Peaks of the last tenth of the record are compared: amplitudes, without the phase.
        let last = |q: &[f64]| q[22_500..].iter().fold(0.0_f64, |m, q| m.max(q.abs()));
        let (steps, averaged) = (last(&found.out.0[0]), last(&out.0[0]));
        assert!((averaged / steps - 1.0).abs() < tolerance, "{theta} {ratio}: {averaged} {steps}");
    }
}

#[test]
fn what_rests_on_masing_s_rule_refuses_it() {
    let law = FiveParameter::new(4.45e4, 239.4, -0.183, 0.3, 0.8).unwrap();
    let mut table = Vec::new();
    let sliders = population(&law, 10, &mut table);
    let refused = |error: Option<Error>| {
        let text = error.unwrap().to_string();
        assert!(text.contains("Masing's rule") && text.contains("Newmark"), "{text}");
    };
    refused(sliders.virgin(vec![Run::default(); sliders.len()]).err());
    refused(Plain::new(sliders).virgin(vec![0.0; sliders.len()]).err());
    refused(Continuum::new(law).virgin(vec![Reversal::default(); 8]).err());
    refused(one_harmonic(&law, 1e-3, &mut [0.0], &mut [0.0]).err());
    // Without a drop of friction the law obeys Masing's rule.
    let four = FiveParameter::new(4.45e4, 239.4, -0.183, 0.3, 1.0).unwrap();
    assert!(Continuum::new(four).virgin(vec![Reversal::default(); 8]).is_ok());
    for theta in [0.0, -0.1, 1.1, f64::NAN] {
        let error = FiveParameter::new(4.45e4, 239.4, -0.183, 0.3, theta).unwrap_err();
        assert!(error.to_string().contains("theta"), "{error}");
        assert!(sliders.dropping(theta).is_err());
    }
}
