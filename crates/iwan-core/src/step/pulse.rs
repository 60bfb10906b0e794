//! Force histories.

use core::f64::consts::PI;

use crate::error::{Error, check};

/// A force f(t) for t >= 0, zero before. Amplitudes in the user's force unit, times in s.
///
/// ```
/// use iwan_core::Pulse;
/// let blow = Pulse::Haversine { amplitude: 1000.0, duration: 1.6e-3 }.checked()?;
/// assert!((blow.at(0.8e-3) - 1000.0).abs() < 1e-9);
/// assert_eq!(blow.at(2e-3), 0.0);
/// assert_eq!(blow.settled(), 1.6e-3);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pulse<'a> {
    /// No force: free decay from the initial conditions.
    None,
    /// A/2 (1 - cos 2πt/T) for t < T: the paper's hammer blow.
    Haversine {
        /// Peak force A.
        amplitude: f64,
        /// Duration T.
        duration: f64,
    },
    /// A sin(πt/T) for t < T.
    HalfSine {
        /// Peak force A.
        amplitude: f64,
        /// Duration T.
        duration: f64,
    },
    /// Force A from t = 0 until t = T (T may be infinite).
    Step {
        /// Force A.
        amplitude: f64,
        /// Duration T.
        duration: f64,
    },
    /// A sin(2πft) for t < T (T may be infinite).
    Sine {
        /// Amplitude A.
        amplitude: f64,
        /// Frequency f, Hz.
        frequency: f64,
        /// Duration T.
        duration: f64,
    },
    /// Samples from t = 0 on, linear in between, zero after the last.
    Sampled {
        /// Time between samples.
        dt: f64,
        /// The samples; at least two.
        samples: &'a [f64],
    },
}

/// A stretch of time on which f(t) = offset + slope·t + amplitude·cos(omega·t + phase), with t measured from its start.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stretch {
    pub(crate) offset: f64,
    pub(crate) slope: f64,
    pub(crate) amplitude: f64,
    pub(crate) omega: f64,
    pub(crate) phase: f64,
    /// Time at which the stretch ends, measured from t = 0 of the pulse.
    pub(crate) until: f64,
}

impl Stretch {
    const fn constant(offset: f64, until: f64) -> Self {
        Self { offset, slope: 0.0, amplitude: 0.0, omega: 0.0, phase: 0.0, until }
    }
}

impl Pulse<'_> {
    /// Checks amplitudes, durations and samples.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], [`Error::Length`] or [`Error::Entry`] with the name of the quantity.
    pub fn checked(self) -> Result<Self, Error> {
        let (amplitude, duration, endless) = match self {
            Self::None => return Ok(self),
            Self::Haversine { amplitude, duration } | Self::HalfSine { amplitude, duration } => {
                (amplitude, duration, false)
            }
            Self::Step { amplitude, duration } => (amplitude, duration, true),
            Self::Sine { amplitude, frequency, duration } => {
                check("force frequency", frequency, frequency > 0.0, "must be a finite number of hertz > 0")?;
                (amplitude, duration, true)
            }
            Self::Sampled { dt, samples } => {
                check("force time step", dt, dt > 0.0, "must be a finite number of seconds > 0")?;
                if samples.len() < 2 {
                    return Err(Error::Length { name: "force samples", needed: 2, found: samples.len() });
                }
                if let Some(index) = samples.iter().position(|p| !p.is_finite()) {
                    let (name, value, allowed) = ("force samples", samples[index], "must be finite");
                    return Err(Error::Entry { name, index, value, allowed });
                }
                return Ok(self);
            }
        };
        check("force amplitude", amplitude, true, "must be a finite number")?;
        if !(endless && duration == f64::INFINITY) {
            check("force duration", duration, duration > 0.0, "must be a finite number of seconds > 0")?;
        }
        Ok(self)
    }

    /// Force at time `t`; 0 before t = 0, when the pulse begins.
    #[must_use]
    pub fn at(&self, t: f64) -> f64 {
        match *self {
            _ if t < 0.0 => 0.0,
            Self::Haversine { amplitude, duration } if t < duration => {
                0.5 * amplitude * (1.0 - libm::cos(2.0 * PI * t / duration))
            }
            Self::HalfSine { amplitude, duration } if t < duration => {
                amplitude * libm::sin(PI * t / duration)
            }
            Self::Step { amplitude, duration } if t < duration => amplitude,
            Self::Sine { amplitude, frequency, duration } if t < duration => {
                amplitude * libm::sin(2.0 * PI * frequency * t)
            }
            Self::Sampled { dt, samples } => {
                let n = libm::floor(t / dt);
                let value = |i: f64| samples.get(i as usize).copied().unwrap_or(0.0);
                if n >= (samples.len() - 1) as f64 {
                    return if t <= dt * n { value(n) } else { 0.0 };
                }
                value(n) + (value(n + 1.0) - value(n)) * (t / dt - n)
            }
            _ => 0.0,
        }
    }

    /// Time after which the force no longer changes; infinite for an endless sine.
    #[must_use]
    pub fn settled(&self) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Haversine { duration, .. }
            | Self::HalfSine { duration, .. }
            | Self::Sine { duration, .. } => duration,
            Self::Step { duration, .. } => {
                if duration.is_finite() {
                    duration
                } else {
                    0.0
                }
            }
            Self::Sampled { dt, samples } => dt * (samples.len() - 1) as f64,
        }
    }

    /// Longest time step, s, at which samples still represent the force: a quarter of a pulse's duration or of a sine's period. At least
    /// three samples then lie within the pulse whatever its phase, and a sine is not mistaken for a slower one. Longer steps are refused by
    /// the callers; the accuracy of a step within the limit is reported with the response.
    #[must_use]
    pub fn longest_step(&self) -> f64 {
        match *self {
            Self::Haversine { duration, .. } | Self::HalfSine { duration, .. } => 0.25 * duration,
            Self::Sine { frequency, .. } => 0.25 / frequency,
            _ => f64::INFINITY,
        }
    }

    /// The stretch that begins at, or contains, the time `t`; its formula measures time from `t`.
    pub(crate) fn stretch(&self, t: f64) -> Stretch {
        let cosine = |offset: f64, amplitude: f64, omega: f64, phase: f64, until: f64| Stretch {
            offset,
            slope: 0.0,
            amplitude,
            omega,
            phase: phase + omega * t,
            until,
        };
        match *self {
            Self::Haversine { amplitude, duration } if t < duration => {
                cosine(0.5 * amplitude, -0.5 * amplitude, 2.0 * PI / duration, 0.0, duration)
            }
            Self::HalfSine { amplitude, duration } if t < duration => {
                cosine(0.0, amplitude, PI / duration, -0.5 * PI, duration)
            }
            Self::Step { amplitude, duration } if t < duration => Stretch::constant(amplitude, duration),
            Self::Sine { amplitude, frequency, duration } if t < duration => {
                cosine(0.0, amplitude, 2.0 * PI * frequency, -0.5 * PI, duration)
            }
            Self::Sampled { dt, samples } => {
                // A time that rounding left just before a sample counts as that sample's time.
                let n = libm::floor(t / dt * (1.0 + 4.0 * f64::EPSILON));
                if n >= (samples.len() - 1) as f64 {
                    return Stretch::constant(0.0, f64::INFINITY);
                }
                let i = n as usize;
                let slope = (samples[i + 1] - samples[i]) / dt;
                let offset = samples[i] + slope * (t - n * dt);
                Stretch { slope, ..Stretch::constant(offset, (n + 1.0) * dt) }
            }
            _ => Stretch::constant(0.0, f64::INFINITY),
        }
    }

    /// Writes f(n dt) for n = 0, 1, …; returns the number of samples after which the force stays zero.
    ///
    /// A force that ends abruptly within a step keeps its impulse: its last sample is weighted so that the trapezoidal rule integrates the
    /// force exactly up to its end. Time stepping then stays second order.
    pub fn sample(&self, dt: f64, out: &mut [f64]) -> usize {
        self.sample_from(0, dt, out)
    }

    /// Does what [`sample`](Self::sample) does for n = `first`, `first` + 1, …, so that a long history can be written in pieces.
    ///
    /// ```
    /// let blow = iwan_core::Pulse::HalfSine { amplitude: 2.0, duration: 1e-3 };
    /// let (mut whole, mut piece) = ([0.0; 20], [0.0; 8]);
    /// assert_eq!(blow.sample(1e-4, &mut whole), 10);
    /// assert_eq!(blow.sample_from(5, 1e-4, &mut piece), 5);
    /// assert_eq!(piece, whole[5..13]);
    /// ```
    pub fn sample_from(&self, first: usize, dt: f64, out: &mut [f64]) -> usize {
        let mut last = 0;
        for (n, value) in out.iter_mut().enumerate() {
            *value = self.at((first + n) as f64 * dt);
            if *value != 0.0 {
                last = n + 1;
            }
        }
        if let Some((end, value)) = self.abrupt_end(dt) {
            let n = libm::floor(end * (1.0 + 4.0 * f64::EPSILON));
            let place = (n as usize).checked_sub(first);
            if let Some((place, sample)) = place.and_then(|place| Some((place, out.get_mut(place)?))) {
                // The first sample stands for half a step only, so its weight is doubled.
                let weight = if n == 0.0 { 2.0 * end } else { 0.5 + (end - n).max(0.0) };
                *sample = value * weight;
                last = last.max(place + 1);
            }
        }
        last
    }

    /// For a force that ends while it is not zero: the time of its end, in steps, and the force at the last sample before the end.
    fn abrupt_end(&self, dt: f64) -> Option<(f64, f64)> {
        let before = |end: f64| libm::floor(end * (1.0 + 4.0 * f64::EPSILON)) * dt;
        let (duration, endless) = match *self {
            Self::Sampled { samples, .. } => {
                let end = self.settled() / dt;
                let (last, at) = (samples[samples.len() - 1], before(end));
                // The last sample itself if the two time axes meet there, otherwise the value on the line that leads to it.
                let value = if at >= self.settled() { last } else { self.at(at) };
                return (last != 0.0).then_some((end, value));
            }
            Self::Step { amplitude, duration } => {
                (duration, Self::Step { amplitude, duration: f64::INFINITY })
            }
            Self::Sine { amplitude, frequency, duration } => {
                (duration, Self::Sine { amplitude, frequency, duration: f64::INFINITY })
            }
            _ => return None,
        };
        let end = duration / dt;
        duration.is_finite().then(|| (end, endless.at(before(end))))
    }
}
