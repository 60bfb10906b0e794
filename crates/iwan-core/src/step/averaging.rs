//! Averaging: slow amplitude and phase instead of the oscillation.
//!
//! da/dt = -D(a)/(2π a ω) - ζ_v ω0 a and dθ/dt = ω(a) with q = a cos θ (M. Shetty and M. S. Allen, Fast
//! simulation of a single degree-of-freedom system consisting of an Iwan element using the method of
//! averaging, J. Vib. Acoust. 142(5), 2020). Here ω² = K_∞ + K_1(a) with the first-harmonic stiffness K_1 in
//! place of the secant, which cuts the mean frequency error many times. First order in the damping: an approximation.

use core::f64::consts::PI;

use super::energy::EnergyBalance;
use super::oscillator::Oscillator;
use super::response::Samples;
use crate::error::{Error, check};
use crate::law::Backbone;

/// Free decay of a mode by averaging.
///
/// ```
/// use iwan_core::{Averaging, Backbone, FourParameter, Oscillator, ResidualStiffness};
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let mode = Oscillator::new(124.0, 0.0, joint.k_t(), ResidualStiffness::Positive)?;
/// let amplitude = 0.1 * joint.phi_max();
/// let mut decay = Averaging::new(&mode, &joint, (amplitude, 0.0))?;
/// // After a tenth of a period the amplitude has fallen at the rate D/(2π a² ω).
/// let t = 0.1 / 124.0;
/// let fallen = (amplitude / decay.at(t).0).ln();
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
    next: Option<(f64, Slow)>,
}

/// Logarithm of the amplitude and phase, with their rates.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Slow {
    log_amplitude: f64,
    phase: f64,
    rates: (f64, f64),
}

impl<'a, B: Backbone> Averaging<'a, B> {
    /// From displacement and velocity `start`, without force.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a value is not finite or K_∞ <= 0.
    pub fn new(oscillator: &Oscillator, law: &'a B, start: (f64, f64)) -> Result<Self, Error> {
        let k_inf = oscillator.k_inf();
        check("k_inf", k_inf, k_inf > 0.0, "averaging needs K_inf = omega0^2 - k_t > 0")?;
        let (q, v) = start;
        check("displacement", q, true, "must be a finite number")?;
        check("velocity", v, true, "must be a finite number")?;
        let unset = Slow { log_amplitude: 0.0, phase: 0.0, rates: (0.0, 0.0) };
        let mut decay =
            Self { oscillator: *oscillator, law, start: unset, time: 0.0, now: unset, next: None };
        // Amplitude and frequency depend on each other, weakly.
        let mut omega = oscillator.omega0();
        for _ in 0..50 {
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
        Slow { log_amplitude, phase, rates: (-self.decay_rate(amplitude), self.frequency(amplitude)) }
    }

    /// The classical Runge-Kutta step of about one cycle, shorter where much is lost in a cycle.
    fn step(&self) -> (f64, Slow) {
        let at = self.now;
        let cycle = 2.0 * PI / at.rates.1;
        let h = cycle / libm::ceil(1.0 - 20.0 * at.rates.0 * cycle / (2.0 * PI));
        let rates = |s: Slow, h: f64| self.slow(at.log_amplitude + h * s.rates.0, at.phase + h * s.rates.1);
        let b = rates(at, 0.5 * h);
        let c = rates(b, 0.5 * h);
        let d = rates(c, h);
        let mean = |r: fn(&Slow) -> f64| (r(&at) + 2.0 * (r(&b) + r(&c)) + r(&d)) / 6.0;
        let log_amplitude = at.log_amplitude + h * mean(|s| s.rates.0);
        (h, self.slow(log_amplitude, at.phase + h * mean(|s| s.rates.1)))
    }

    /// Amplitude a and phase θ at the time `t` since the start, not before the last call's.
    pub fn at(&mut self, t: f64) -> (f64, f64) {
        if self.start.log_amplitude == f64::NEG_INFINITY {
            return (0.0, self.start.phase);
        }
        loop {
            let (h, next) = self.next.unwrap_or_else(|| self.step());
            self.next = Some((h, next));
            if t - self.time <= h {
                let s = (t - self.time) / h;
                let cubic = |a: f64, da: f64, b: f64, db: f64| hermite(s, a, h * da, b, h * db);
                let (now, then) = (self.now, next);
                let log = cubic(now.log_amplitude, now.rates.0, then.log_amplitude, then.rates.0);
                return (libm::exp(log), cubic(now.phase, now.rates.1, then.phase, then.rates.1));
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
        let first = decay.at(0.0).0;
        let mut balance =
            EnergyBalance { initial: elastic(first) + stored(first), ..EnergyBalance::default() };
        let mut last = first;
        let mut from = 0.0;
        while from < t && first > 0.0 {
            let to = (from + decay.step_length()).min(t);
            let middle = decay.at(0.5 * (from + to)).0;
            let end = decay.at(to).0;
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

    fn step_length(&self) -> f64 {
        2.0 * PI / self.now.rates.1
    }

    /// Writes the samples at 0, dt, 2 dt, …: q = a cos θ, q' = -a ω sin θ and the first harmonic of the joint force.
    ///
    /// # Errors
    /// [`Error::Length`], or [`Error::OutOfRange`] when `dt` is not a finite number > 0.
    pub fn sample(&mut self, dt: f64, out: &mut Samples<'_>) -> Result<(), Error> {
        check("time step", dt, dt > 0.0, "must be a finite number of seconds > 0")?;
        for n in 0..out.checked_len()? {
            let (a, theta) = self.at(n as f64 * dt);
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
