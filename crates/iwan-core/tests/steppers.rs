//! Time steppers: rounding against double-double, order, period error, the golden time-domain check.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a failed test may panic and say why")]

use std::ops::{Add, Div, Mul, Neg, Sub};

use iwan_core::{
    Backbone, Continuum, EventDriven, FourParameter, Grid, Hysteresis, JointEnergy, Newmark, Oscillator,
    Plain, Pulse, ResidualStiffness, Reversal, Run, Slider, Sliders, TabledFourParameter,
};

use crate::common::{Buffers, worst};

/// Joint of mode 1, Table 2 of Deaner et al.
fn mode_1() -> FourParameter {
    FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap()
}

fn haversine(amplitude: f64) -> Pulse<'static> {
    Pulse::Haversine { amplitude, duration: 1.6e-3 }
}

fn force(pulse: Pulse<'_>, dt: f64, samples: usize) -> Vec<f64> {
    let mut force = vec![0.0; samples];
    let used = pulse.sample(dt, &mut force);
    force.truncate(used);
    force
}

fn with_sliders<T>(grid: Grid, bins: usize, f: impl FnOnce(Sliders<'_>) -> T) -> T {
    let mut table = vec![Slider::default(); Sliders::table_len(bins)];
    f(Sliders::discretise(&mode_1(), grid, bins, &mut table).unwrap())
}

fn run_sliders(
    scheme: &Newmark,
    oscillator: &Oscillator,
    sliders: Sliders<'_>,
    force: &[f64],
    samples: usize,
) -> Buffers {
    let mut out = Buffers::new(samples);
    let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
    scheme.integrate_sliders(oscillator, &sliders, &mut state, 0.0, force, &mut out.samples()).unwrap();
    let stored = JointEnergy { start: 0.0, end: sliders.stored_energy(&state) };
    let balance = scheme.energy(oscillator, stored, force, &out.samples());
    assert!(balance.error() < 1e-10, "{balance:?}");
    out
}

fn run_continuum(scheme: &Newmark, oscillator: &Oscillator, force: &[f64], samples: usize) -> Buffers {
    let joint = Continuum::new(TabledFourParameter::new(mode_1()));
    let mut out = Buffers::new(samples);
    let mut state = joint.virgin(vec![Reversal::default(); 256]).unwrap();
    scheme.integrate(oscillator, &joint, &mut state, 0.0, force, &mut out.samples()).unwrap();
    assert_eq!(state.forgotten(), 0.0);
    out
}

/// Displacement of mode 1 (K_0 = (2π·125)², no damper) at 0.2 s, after a haversine of 1000 and 1.6 ms, by 20,000
/// steps of 1e-5 s of plain average acceleration.
///
/// The numbers come from a program in C and long double that shares nothing with this code: N bins of equal width from 0 to
/// φ_max, each one slider of stiffness ∫ρ and strength ∫ρφ/∫ρ, and one slider of stiffness S at φ_max. In each step it uses
/// Newton's method on (4/h² + K_∞) Δq + Σ k_i (clip(x_i + Δq) - x_i) = p' - K_∞ q - F + (4/h) v + a, with every slider
/// by itself. For the continuum it takes the same step with F_a ± 2 F(|u - u_a|/2) from a list of reversals, from which two are
/// removed where a loop closes. It prints -7.301570209561e-4, -7.303665715664e-4, -7.303699077768e-4 and
/// -7.303701303929e-4.
#[test]
fn golden_displacement_at_the_end_of_the_ring_down() {
    /// One unit of the last digit that is compared.
    const LAST_DIGIT: f64 = 1e-13;
    let oscillator = Oscillator::new(125.0, 0.0, 4.45e4, ResidualStiffness::Positive).unwrap();
    let scheme = Newmark::average_acceleration(1e-5).unwrap();
    let force = force(haversine(1000.0), 1e-5, 20_001);
    for (bins, golden) in [(100, -7.301570210e-4), (800, -7.303665716e-4), (3200, -7.303699078e-4)] {
        let end = with_sliders(Grid::Uniform, bins, |s| run_sliders(&scheme, &oscillator, s, &force, 20_001))
            .0[0][20_000];
        assert!((end - golden).abs() <= LAST_DIGIT, "{bins}: {end:e}");
    }
    let end = run_continuum(&scheme, &oscillator, &force, 20_001).0[0][20_000];
    assert!((end - -7.303701304e-4).abs() <= LAST_DIGIT, "continuum: {end:e}");
}

#[test]
fn fast_stepper_general_stepper_and_plain_loop_agree() {
    let oscillator = Oscillator::new(124.0, 2.5e-4, 4.45e4, ResidualStiffness::Positive).unwrap();
    for amplitude in [10.0, 1000.0, 10_000.0, 100_000.0] {
        let force = force(haversine(amplitude), 2e-5, 2001);
        for scheme in [Newmark::average_acceleration(2e-5), Newmark::prewarped(2e-5, oscillator.omega0())] {
            let scheme = scheme.unwrap();
            with_sliders(Grid::graded(100), 100, |sliders| {
                let fast = run_sliders(&scheme, &oscillator, sliders, &force, 2001);
                let mut general = Buffers::new(2001);
                let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
                scheme
                    .integrate(&oscillator, &sliders, &mut state, 0.0, &force, &mut general.samples())
                    .unwrap();
                let plain = Plain::new(sliders);
                let mut slow = Buffers::new(2001);
                let mut state = plain.virgin(vec![0.0; sliders.len()]).unwrap();
                scheme.integrate(&oscillator, &plain, &mut state, 0.0, &force, &mut slow.samples()).unwrap();
                for quantity in 0..4 {
                    let error = worst(&general.0[quantity], &slow.0[quantity]);
                    assert!(error < 1e-11, "general, {amplitude}, {quantity}: {error:e}");
                    let error = worst(&fast.0[quantity], &slow.0[quantity]);
                    assert!(error < 1e-11, "fast, {amplitude}, {quantity}: {error:e}");
                }
            });
        }
    }
}

#[test]
fn newmark_is_second_order() {
    let oscillator = Oscillator::new(124.0, 1e-3, 4.45e4, ResidualStiffness::Positive).unwrap();
    with_sliders(Grid::graded(40), 40, |sliders| {
        let pulse = haversine(3000.0);
        let mut exact = Buffers::new(101);
        let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
        EventDriven::new(&oscillator, sliders, pulse, 1.0)
            .unwrap()
            .integrate(&mut state, 0.0, 4e-4, &mut exact.samples())
            .unwrap();
        for plain in [true, false] {
            let error = |stride: usize| {
                let (dt, samples) = (4e-4 / stride as f64, 100 * stride + 1);
                let scheme = if plain {
                    Newmark::average_acceleration(dt)
                } else {
                    Newmark::prewarped(dt, oscillator.omega0())
                };
                let out =
                    run_sliders(&scheme.unwrap(), &oscillator, sliders, &force(pulse, dt, samples), samples);
                let thin: Vec<f64> = out.0[0].iter().copied().step_by(stride).collect();
                worst(&thin, &exact.0[0])
            };
            let errors = [10, 20, 40, 80].map(error);
            println!("plain {plain}: {errors:?}");
            for pair in errors.windows(2) {
                let order = (pair[0] / pair[1]).log2();
                assert!((1.8..2.3).contains(&order), "plain {plain}: order {order}, {errors:?}");
            }
        }
    });
}

/// General β and γ: the scheme is of first order with numerical damping for γ > 1/2; the linear-acceleration scheme is tested, too.
#[test]
fn general_newmark_schemes_converge() {
    let oscillator = Oscillator::new(124.0, 1e-3, 4.45e4, ResidualStiffness::Positive).unwrap();
    with_sliders(Grid::graded(40), 40, |sliders| {
        let pulse = haversine(1000.0);
        let mut exact = Buffers::new(51);
        let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
        EventDriven::new(&oscillator, sliders, pulse, 1.0)
            .unwrap()
            .integrate(&mut state, 0.0, 4e-4, &mut exact.samples())
            .unwrap();
        for (beta, gamma, order) in [(1.0 / 6.0, 0.5, 2.0), (0.3025, 0.6, 1.0)] {
            let error = |stride: usize| {
                let (dt, samples) = (4e-4 / stride as f64, 50 * stride + 1);
                let mut out = Buffers::new(samples);
                let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
                let scheme = Newmark::new(dt, beta, gamma).unwrap();
                scheme
                    .integrate_sliders(
                        &oscillator,
                        &sliders,
                        &mut state,
                        0.0,
                        &force(pulse, dt, samples),
                        &mut out.samples(),
                    )
                    .unwrap();
                let thin: Vec<f64> = out.0[0].iter().copied().step_by(stride).collect();
                worst(&thin, &exact.0[0])
            };
            let found = (error(40) / error(80)).log2();
            assert!((found - order).abs() < 0.2, "beta {beta}, gamma {gamma}: order {found}");
        }
    });
}

/// Phase error of the plain scheme over that of the prewarped one, after 200 cycles at dt = 1e-5 and 0.9 of the first strength, where
/// nothing slips. The plain scheme's is 200 cycles times the period error, 400 π (ω dt)²/12 = 6.36e-3 rad.
#[test]
fn prewarping_gains_a_factor_of_400_in_phase() {
    let (frequency, dt, cycles) = (124.0, 1e-5, 200.0);
    let oscillator = Oscillator::new(frequency, 0.0, 4.45e4, ResidualStiffness::Positive).unwrap();
    let samples = (cycles / frequency / dt) as usize + 1;
    // Below the first strength the motion is q = (v0/ω0) sin ω0 t: the phase follows from q and q' at the end.
    let phase_error = |scheme: &Newmark| {
        with_sliders(Grid::Uniform, 100, |sliders| {
            let mut out = Buffers::new(samples);
            let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
            let weakest = sliders.strengths().0;
            let velocity = 0.9 * weakest * oscillator.omega0();
            scheme
                .integrate_sliders(&oscillator, &sliders, &mut state, velocity, &[], &mut out.samples())
                .unwrap();
            let (q, v) = (out.0[0][samples - 1], out.0[1][samples - 1]);
            let exact = oscillator.omega0() * dt * (samples - 1) as f64;
            let phase = (oscillator.omega0() * q).atan2(v);
            let turns = ((exact - phase) / std::f64::consts::TAU).round();
            (phase + turns * std::f64::consts::TAU - exact).abs()
        })
    };
    let plain = phase_error(&Newmark::average_acceleration(dt).unwrap());
    let warped = phase_error(&Newmark::prewarped(dt, oscillator.omega0()).unwrap());
    println!("plain {plain:e}, prewarped {warped:e} rad");
    assert!((plain - 6.3e-3).abs() < 1e-4, "plain {plain:e}");
    assert!(warped * 400.0 < plain, "plain {plain:e}, prewarped {warped:e}");
}

/// The same gain in phase on a ring-down with slip, against the event-driven solution.
#[test]
fn prewarping_gains_with_slip_as_well() {
    let oscillator = Oscillator::new(124.0, 0.0, 4.45e4, ResidualStiffness::Positive).unwrap();
    let (dt, stride, cycles) = (1e-5, 100, 200.0);
    let samples = (cycles / 124.0 / dt) as usize / stride * stride + 1;
    with_sliders(Grid::graded(100), 100, |sliders| {
        let velocity = 0.01 * mode_1().phi_max() * oscillator.omega0();
        let mut exact = Buffers::new((samples - 1) / stride + 1);
        let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
        let solver = EventDriven::new(&oscillator, sliders, Pulse::None, 1.0).unwrap();
        solver.integrate(&mut state, velocity, dt * stride as f64, &mut exact.samples()).unwrap();
        let error = |scheme: Newmark| {
            let mut out = Buffers::new(samples);
            let mut state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
            scheme
                .integrate_sliders(&oscillator, &sliders, &mut state, velocity, &[], &mut out.samples())
                .unwrap();
            let thin: Vec<f64> = out.0[0].iter().copied().step_by(stride).collect();
            worst(&thin, &exact.0[0])
        };
        let plain = error(Newmark::average_acceleration(dt).unwrap());
        let warped = error(Newmark::prewarped(dt, oscillator.omega0()).unwrap());
        println!("with slip: plain {plain:e}, prewarped {warped:e}");
        assert!(warped * 400.0 < plain, "plain {plain:e}, prewarped {warped:e}");
    });
}

/// Double-double arithmetic: 106 bits (T. J. Dekker, Numer. Math. 18:224, 1971, doi:10.1007/BF01397083).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Double(f64, f64);

impl Double {
    fn sum(a: f64, b: f64) -> Self {
        let s = a + b;
        let t = s - a;
        Self(s, (a - (s - t)) + (b - t))
    }
    fn of(a: f64) -> Self {
        Self(a, 0.0)
    }
}

impl Add for Double {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        let s = Self::sum(self.0, o.0);
        let t = Self::sum(self.1, o.1);
        let u = Self::sum(s.0, s.1 + t.0);
        Self::sum(u.0, u.1 + t.1)
    }
}

impl Neg for Double {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl Sub for Double {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for Double {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        let p = self.0 * o.0;
        Self::sum(p, self.0.mul_add(o.0, -p) + (self.0 * o.1 + self.1 * o.0))
    }
}

impl Div for Double {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        let q = self.0 / o.0;
        let rest = self - o * Self::of(q);
        let q = Self::sum(q, rest.0 / o.0);
        let rest = self - o * q;
        q + Self::of(rest.0 / o.0)
    }
}

/// Average acceleration in double-double arithmetic, with every slider by itself; the equation of a step is solved by passing from break to
/// break. The recurrence is that of the fast stepper, but shares no code with it.
fn double_double_run(
    elements: &[(f64, f64)],
    oscillator: &Oscillator,
    h: f64,
    force: &[f64],
    steps: usize,
) -> Vec<f64> {
    let exactly = Double::of;
    let (h, c, k) = (exactly(h), exactly(oscillator.viscous()), exactly(oscillator.k_inf()));
    let keff = exactly(4.0) / (h * h) + exactly(2.0) * c / h + k;
    let mut extension = vec![exactly(0.0); elements.len()];
    let (mut q, mut v) = (exactly(0.0), exactly(0.0));
    let mut out = vec![0.0];
    let total =
        |x: &[Double]| elements.iter().zip(x).fold(exactly(0.0), |s, ((_, k), x)| s + exactly(*k) * *x);
    for n in 0..steps {
        let p = |n: usize| exactly(force.get(n).copied().unwrap_or(0.0));
        let mut r = p(n) + p(n + 1) + exactly(4.0) / h * v - exactly(2.0) * (k * q + total(&extension));
        let sign = if r.0 >= 0.0 { 1.0 } else { -1.0 };
        let mut dq = exactly(0.0);
        loop {
            // Stiffness of the sliders that still stick in this direction, and the distance to the next break.
            let (mut stiffness, mut way) = (keff, exactly(f64::MAX));
            for ((phi, k), x) in elements.iter().zip(&extension) {
                let left = exactly(*phi) - exactly(sign) * *x;
                if left.0 > 0.0 {
                    stiffness = stiffness + exactly(*k);
                    way = if left.0 < way.0 { left } else { way };
                }
            }
            let full = exactly(sign) * r / stiffness;
            let last = full.0 <= way.0;
            let move_by = exactly(sign) * if last { full } else { way };
            for ((phi, _), x) in elements.iter().zip(&mut extension) {
                let moved = *x + move_by;
                *x = if (exactly(sign) * moved - exactly(*phi)).0 >= 0.0 {
                    exactly(sign * phi)
                } else {
                    moved
                };
            }
            dq = dq + move_by;
            r = r - stiffness * move_by;
            if last {
                break;
            }
        }
        q = q + dq;
        v = exactly(2.0) * dq / h - v;
        out.push(q.0);
    }
    out
}

#[test]
fn twenty_thousand_steps_stay_within_1e_11_of_double_double() {
    let oscillator = Oscillator::new(124.0, 2.5e-4, 4.45e4, ResidualStiffness::Positive).unwrap();
    let scheme = Newmark::average_acceleration(1e-5).unwrap();
    let force = force(haversine(1000.0), 1e-5, 20_001);
    for grid in [Grid::graded(100), Grid::Uniform] {
        with_sliders(grid, 100, |sliders| {
            let elements: Vec<_> = sliders.elements().collect();
            let reference = double_double_run(&elements, &oscillator, 1e-5, &force, 20_000);
            let fast = run_sliders(&scheme, &oscillator, sliders, &force, 20_001);
            let error = worst(&fast.0[0], &reference);
            println!("{grid:?}: {error:e}");
            assert!(error < 1e-11, "{grid:?}: {error:e}");
        });
    }
}
