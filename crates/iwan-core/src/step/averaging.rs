//! Averaging: slow amplitude and phase instead of the oscillation.
//!
//! da/dt = -D(a)/(2π a ω) - ζ_v ω0 a and dθ/dt = ω(a) with q = a cos θ (M. Shetty and M. S. Allen, Fast
//! simulation of a single degree-of-freedom system consisting of an Iwan element using the method of
//! averaging, J. Vib. Acoust. 142(5), 2020). Here ω² = K_∞ + K_1(a) with the first-harmonic stiffness K_1 in
//! place of the secant, which cuts the mean frequency error many times. First order in the damping: an approximation.

use core::f64::consts::PI;

use super::energy::EnergyBalance;
use super::motion::Motion;
use super::oscillator::Oscillator;
use super::response::Samples;
use crate::error::{Error, check};
use crate::law::Backbone;

/// Free decay of a mode by averaging.
///
/// ```
/// use iwan_core::{Averaging, Backbone, FourParameter, Motion, Oscillator, ResidualStiffness};
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let mode = Oscillator::new(124.0, 0.0, joint.k_t(), ResidualStiffness::Positive)?;
/// let amplitude = 0.1 * joint.phi_max();
/// let mut decay = Averaging::new(&mode, &joint, Motion::held_at(amplitude))?;
/// // After a tenth of a period the amplitude has fallen at the rate D/(2π a² ω).
/// let t = 0.1 / 124.0;
/// let fallen = (amplitude / decay.at(t).amplitude).ln();
/// assert!((fallen / (t * decay.decay_rate(amplitude)) - 1.0).abs() < 1e-3);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Averaging<'a, B> {
    oscillator: Oscillator,
    law: &'a B,
    start: Slow,
    time: f64,
    now: Slow,
    next: Option<Step>,
}

/// Amplitude a and phase θ of a motion q = a cos θ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmplitudePhase {
    /// Amplitude a >= 0 (mass^½·length).
    pub amplitude: f64,
    /// Phase θ, rad: grows without bound.
    pub phase: f64,
}

/// Logarithm of the amplitude and phase, with their rates.
///
/// Why the logarithm: its rate is the decay rate, which changes slowly over a ring-down while a falls by decades,
/// and a step can never overshoot into a negative amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Slow {
    log_amplitude: f64,
    phase: f64,
    /// d(ln a)/dt <= 0, 1/s.
    growth: f64,
    /// dθ/dt = ω, rad/s.
    omega: f64,
}

/// One step: its length in s and where it ends.
#[derive(Debug, Clone, Copy)]
struct Step {
    length: f64,
    end: Slow,
}

/// Most rounds in which amplitude and frequency at the start are made to agree. The frequency depends on the
/// amplitude weakly, so each round gains digits; should these not do, the last is taken, which is in error by less
/// than averaging is.
const MOST_ROUNDS: u32 = 50;

/// Steps a cycle for what is lost in it: 1 + 20 ζ, rounded up, which is two up to a damping ratio of 5 %. The steps
/// are then in error by 1e-8 (ζ <= 1 %) to 5e-8 (10 %) up to φ_max and by 1e-5 beyond, where averaging itself is by
/// 1e-5 to 1e-2. Anything from 5 to 80 does as well.
const STEPS_A_CYCLE: f64 = 20.0;

impl<'a, B: Backbone> Averaging<'a, B> {
    /// From the motion `start`, without force.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a value is not finite or K_∞ <= 0.
    pub fn new(oscillator: &Oscillator, law: &'a B, start: Motion) -> Result<Self, Error> {
        let k_inf = oscillator.k_inf();
        check("k_inf", k_inf, k_inf > 0.0, "averaging needs K_inf = omega0^2 - k_t > 0")?;
        let Motion { displacement: q, velocity: v } = start;
        check("displacement", q, true, "must be a finite number")?;
        check("velocity", v, true, "must be a finite number")?;
        let unset = Slow { log_amplitude: 0.0, phase: 0.0, growth: 0.0, omega: 0.0 };
        let mut decay =
            Self { oscillator: *oscillator, law, start: unset, time: 0.0, now: unset, next: None };
        // The amplitude of a start in motion depends on the frequency, and that on the amplitude.
        let mut omega = oscillator.omega0();
        for _ in 0..MOST_ROUNDS {
            let before = omega;
            omega = decay.frequency(libm::hypot(q, v / omega));
            if libm::fabs(omega - before) <= f64::EPSILON * omega {
                break;
            }
        }
        decay.start = decay.slow(libm::log(libm::hypot(q, v / omega)), libm::atan2(-v / omega, q));
        decay.now = decay.start;
        Ok(decay)
    }

    /// Circular frequency ω(a), rad/s.
    #[must_use]
    pub fn frequency(&self, amplitude: f64) -> f64 {
        libm::sqrt(self.oscillator.k_inf() + self.law.harmonic_stiffness(amplitude))
    }

    /// Decay rate -a'/a, 1/s.
    #[must_use]
    pub fn decay_rate(&self, amplitude: f64) -> f64 {
        let viscous = 0.5 * self.oscillator.viscous();
        // Where a² underflows, friction has long vanished beside it.
        if amplitude * amplitude <= f64::MIN_POSITIVE {
            return viscous;
        }
        self.law.dissipation(amplitude) / (2.0 * PI * amplitude * amplitude * self.frequency(amplitude))
            + viscous
    }

    fn slow(&self, log_amplitude: f64, phase: f64) -> Slow {
        let amplitude = libm::exp(log_amplitude);
        let (growth, omega) = (-self.decay_rate(amplitude), self.frequency(amplitude));
        Slow { log_amplitude, phase, growth, omega }
    }

    /// The classical Runge-Kutta step of about one cycle, shorter where much is lost in a cycle.
    fn step(&self) -> Step {
        let at = self.now;
        let cycle = 2.0 * PI / at.omega;
        let h = cycle / libm::ceil(1.0 - STEPS_A_CYCLE * at.growth * cycle / (2.0 * PI));
        let rates = |s: Slow, h: f64| self.slow(at.log_amplitude + h * s.growth, at.phase + h * s.omega);
        let b = rates(at, 0.5 * h);
        let c = rates(b, 0.5 * h);
        let d = rates(c, h);
        let mean = |r: fn(&Slow) -> f64| (r(&at) + 2.0 * (r(&b) + r(&c)) + r(&d)) / 6.0;
        let log_amplitude = at.log_amplitude + h * mean(|s| s.growth);
        let end = self.slow(log_amplitude, at.phase + h * mean(|s| s.omega));
        Step { length: h, end }
    }

    /// Amplitude and phase at the time `t` since the start, not before the last call's.
    pub fn at(&mut self, t: f64) -> AmplitudePhase {
        if self.start.log_amplitude == f64::NEG_INFINITY {
            return AmplitudePhase { amplitude: 0.0, phase: self.start.phase };
        }
        loop {
            let step = self.next.unwrap_or_else(|| self.step());
            self.next = Some(step);
            let Step { length: h, end: next } = step;
            if t - self.time <= h {
                let s = (t - self.time) / h;
                let cubic = |a: f64, da: f64, b: f64, db: f64| hermite(s, a, h * da, b, h * db);
                let (now, then) = (self.now, next);
                let log = cubic(now.log_amplitude, now.growth, then.log_amplitude, then.growth);
                let phase = cubic(now.phase, now.omega, then.phase, then.omega);
                return AmplitudePhase { amplitude: libm::exp(log), phase };
            }
            self.time += h;
            (self.now, self.next) = (next, None);
        }
    }

    /// Energy balance from the start to the time `t` in terms of the amplitude: what friction and damper took by the
    /// averaged equations against the energy at the turning points ½ K_∞ a² + G(a). The residual is averaging's own.
    #[must_use]
    pub fn energy(&self, t: f64) -> EnergyBalance {
        let mut decay = Self { time: 0.0, now: self.start, next: None, ..*self };
        let elastic = |a: f64| 0.5 * self.oscillator.k_inf() * a * a;
        let stored = |a: f64| self.law.energy(a) - 0.25 * self.law.dissipation(a);
        // Powers of friction and damper.
        let powers = |a: f64| {
            let omega = self.frequency(a);
            let damper = 0.5 * self.oscillator.viscous() * (omega * a) * (omega * a);
            [self.law.dissipation(a) * omega / (2.0 * PI), damper]
        };
        let first = decay.at(0.0).amplitude;
        let mut balance =
            EnergyBalance { initial: elastic(first) + stored(first), ..EnergyBalance::default() };
        let mut last = first;
        let mut from = 0.0;
        while from < t && first > 0.0 {
            let to = (from + decay.step_length()).min(t);
            let middle = decay.at(0.5 * (from + to)).amplitude;
            let end = decay.at(to).amplitude;
            let [a, b, c] = [last, middle, end].map(powers);
            let simpson = |k: usize| (to - from) / 6.0 * (a[k] + 4.0 * b[k] + c[k]);
            balance.friction += simpson(0);
            balance.viscous += simpson(1);
            (last, from) = (end, to);
        }
        (balance.elastic, balance.stored, balance.scale) = (elastic(last), stored(last), balance.initial);
        let left = balance.elastic + balance.stored;
        balance.residual = balance.initial - left - balance.friction - balance.viscous;
        balance
    }

    /// Interval of Simpson's rule in the balance: one cycle.
    fn step_length(&self) -> f64 {
        2.0 * PI / self.now.omega
    }

    /// Writes the samples at 0, dt, 2 dt, …: q = a cos θ, q' = -a ω sin θ and the first harmonic of the joint force.
    ///
    /// # Errors
    /// [`Error::Length`], or [`Error::OutOfRange`] when `dt` is not a finite number > 0.
    pub fn sample(&mut self, dt: f64, out: &mut Samples<'_>) -> Result<(), Error> {
        check("time step", dt, dt > 0.0, "must be a finite number of seconds > 0")?;
        for n in 0..out.checked_len()? {
            let AmplitudePhase { amplitude: a, phase: theta } = self.at(n as f64 * dt);
            if a * a <= f64::MIN_POSITIVE {
                out.set(n, [0.0; 4]);
                continue;
            }
            let omega = self.frequency(a);
            let (q, v) = (a * libm::cos(theta), -a * omega * libm::sin(theta));
            let damper = self.law.dissipation(a) / (PI * omega * a * a);
            let joint = self.law.harmonic_stiffness(a) * q + damper * v;
            let acceleration = -self.oscillator.viscous() * v - self.oscillator.k_inf() * q - joint;
            out.set(n, [q, v, acceleration, joint]);
        }
        Ok(())
    }
}

/// Cubic Hermite interpolation on 0 <= s <= 1.
fn hermite(s: f64, a: f64, da: f64, b: f64, db: f64) -> f64 {
    let r = 1.0 - s;
    r * r * ((1.0 + 2.0 * s) * a + s * da) + s * s * ((1.0 + 2.0 * r) * b - r * db)
}
