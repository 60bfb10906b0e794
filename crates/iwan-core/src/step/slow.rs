//! Slow motion of a free oscillation: its amplitude and phase, from the decay rate and the frequency at each amplitude.

use core::f64::consts::PI;

use super::motion::Motion;
use crate::error::{Error, check};

/// Rates of the slow motion as functions of the amplitude a.
pub(crate) trait Rates {
    /// Circular frequency ω(a), rad/s.
    fn frequency(&self, amplitude: f64) -> f64;

    /// Decay rate -a'/a, 1/s.
    fn decay_rate(&self, amplitude: f64) -> f64;
}

/// Amplitude a and phase θ of a motion q = a cos θ.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AmplitudePhase {
    /// Amplitude a >= 0 (mass^½·length).
    pub amplitude: f64,
    /// Phase θ, rad: grows without bound.
    pub phase: f64,
}

/// The slow motion from a given start, integrated step by step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SlowMotion<R> {
    pub(crate) rates: R,
    start: Slow,
    time: f64,
    now: Slow,
    next: Option<Step>,
}

/// Logarithm of the amplitude and phase, with their rates.
///
/// Why the logarithm: its rate is the decay rate, which changes slowly over a ring-down while the amplitude falls by decades; and a step
/// can never overshoot into a negative amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Slow {
    log_amplitude: f64,
    phase: f64,
    /// d(ln a)/dt <= 0, 1/s.
    growth: f64,
    /// dθ/dt = ω, rad/s.
    omega: f64,
}

/// One step: its length (s) and the state at its end.
#[derive(Debug, Clone, Copy)]
struct Step {
    length: f64,
    end: Slow,
}

/// Largest number of rounds in which amplitude and frequency at the start are made consistent. The frequency depends weakly on the
/// amplitude, so each round gains digits. If the rounds do not suffice, the last result is used; its error is smaller than that of
/// averaging.
const MOST_ROUNDS: u32 = 50;

/// Growth of the number of steps per cycle with the damping ratio ζ: there are 1 + 20 ζ steps, rounded up, which is two up to a damping
/// ratio of 5 %. The error of the steps is then 1e-8 (ζ <= 1 %) to 5e-8 (10 %) up to φ_max and 1e-5 beyond, where averaging itself has
/// errors of 1e-5 to 1e-2. Any value from 5 to 80 does as well.
const STEPS_A_CYCLE: f64 = 20.0;

impl<R: Rates + Copy> SlowMotion<R> {
    /// The slow motion that begins with the motion `start`, without force. The search for the frequency at the start begins at `omega0`
    /// (rad/s).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a value is not finite, or when the mode has no stiffness at the start.
    pub(crate) fn new(rates: R, omega0: f64, start: Motion) -> Result<Self, Error> {
        let Motion { displacement: q, velocity: v } = start;
        check("displacement", q, true, "must be a finite number")?;
        check("velocity", v, true, "must be a finite number")?;
        let unset = Slow { log_amplitude: 0.0, phase: 0.0, growth: 0.0, omega: 0.0 };
        let mut decay = Self { rates, start: unset, time: 0.0, now: unset, next: None };
        // For a start in motion the amplitude depends on the frequency, and the frequency on the amplitude.
        let mut omega = omega0;
        for _ in 0..MOST_ROUNDS {
            let before = omega;
            omega = decay.rates.frequency(libm::hypot(q, v / omega));
            if libm::fabs(omega - before) <= f64::EPSILON * omega {
                break;
            }
        }
        let allowed = "must leave the mode a stiffness > 0: a spring that softens has taken all of it";
        check("amplitude", libm::hypot(q, v / omega0), omega > 0.0, allowed)?;
        decay.start = decay.slow(libm::log(libm::hypot(q, v / omega)), libm::atan2(-v / omega, q));
        decay.now = decay.start;
        Ok(decay)
    }

    fn slow(&self, log_amplitude: f64, phase: f64) -> Slow {
        let amplitude = libm::exp(log_amplitude);
        let (growth, omega) = (-self.rates.decay_rate(amplitude), self.rates.frequency(amplitude));
        Slow { log_amplitude, phase, growth, omega }
    }

    /// One classical Runge-Kutta step of about one cycle, shorter where the motion loses much in a cycle.
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

    /// Amplitude and phase at the time `t` since the start; `t` must not be earlier than in the last call.
    pub(crate) fn at(&mut self, t: f64) -> AmplitudePhase {
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

    /// Works of two powers, given as functions of the amplitude, from the start to the time `t`, by Simpson's rule on intervals of one
    /// cycle; and the amplitudes at the start and at `t`.
    pub(crate) fn works(&self, t: f64, powers: impl Fn(f64) -> [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let mut decay = Self { time: 0.0, now: self.start, next: None, ..*self };
        let first = decay.at(0.0).amplitude;
        let (mut last, mut from, mut works) = (first, 0.0, [0.0; 2]);
        while from < t && first > 0.0 {
            let to = (from + 2.0 * PI / self.now.omega).min(t);
            let middle = decay.at(0.5 * (from + to)).amplitude;
            let end = decay.at(to).amplitude;
            let [a, b, c] = [last, middle, end].map(&powers);
            for (k, work) in works.iter_mut().enumerate() {
                *work += (to - from) / 6.0 * (a[k] + 4.0 * b[k] + c[k]);
            }
            (last, from) = (end, to);
        }
        (works, [first, last])
    }
}

/// Cubic Hermite interpolation on 0 <= s <= 1.
fn hermite(s: f64, a: f64, da: f64, b: f64, db: f64) -> f64 {
    let r = 1.0 - s;
    r * r * ((1.0 + 2.0 * s) * a + s * da) + s * s * ((1.0 + 2.0 * r) * b - r * db)
}
