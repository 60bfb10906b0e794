//! Frequency and damping ratio of a mode against amplitude, as smooth curves through given points.

use core::f64::consts::PI;

use super::slopes::{Secant, end, hermite, inner};
use crate::error::{Error, check_length};

/// One point of the curves.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CurvePoint {
    log_amplitude: f64,
    /// Circular frequency and damping ratio.
    values: [f64; 2],
    /// Derivatives of the values with respect to the logarithm of the amplitude.
    slopes: [f64; 2],
}

/// Frequency and damping at one amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rate {
    /// Circular frequency ω, rad/s, undamped.
    pub omega: f64,
    /// Damping ratio ζ.
    pub damping_ratio: f64,
}

/// A mode given by curves through points: monotone cubics (PCHIP) in the logarithm of the amplitude, which stay within the values of
/// neighbouring points and have no extremum between them.
///
/// Beyond the points the values of the nearest point are held. [`range`](Self::range) tells where the points end; callers that run the mode
/// report it when the motion leaves the range. `P` holds the points: a slice lends the caller's memory, an array or vector owns it.
///
/// ```
/// use iwan_core::{CurvePoint, ModeCurves};
/// let curves = ModeCurves::new(&[1e-4, 1e-2], &[124.0, 122.0], &[0.001, 0.005], [CurvePoint::default(); 2])?;
/// let middle = curves.at(1e-3);
/// assert!((middle.omega / (2.0 * core::f64::consts::PI) - 123.0).abs() < 1e-12);
/// assert!((middle.damping_ratio - 0.003).abs() < 1e-15);
/// // At a turning point the amplitude is the displacement, in the middle the velocity over ω.
/// assert!((curves.amplitude(1e-3, 0.0) - 1e-3).abs() < 1e-18);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeCurves<P> {
    points: P,
}

/// Largest change of the frequency between two points, as a share of the lower frequency and per factor e of the amplitude; a larger change
/// is refused. The cubic is at most three times as steep as the line between the points. With less than a third, the product a ω(a)
/// therefore rises everywhere, and a displacement with a velocity has exactly one amplitude. Joints change their frequency by a tenth of
/// that.
const STEEPEST: f64 = 1.0 / 3.0;

/// Largest number of rounds in which the amplitude and the frequency of a state are made consistent. Each round leaves at most the share |d
/// ln ω/d ln a| < 1 of the error, for a joint a hundredth of it, so a few rounds suffice; after the last one the amplitude is used as it
/// is.
const MOST_ROUNDS: u32 = 200;

impl<P: AsRef<[CurvePoint]> + AsMut<[CurvePoint]>> ModeCurves<P> {
    /// From two or more points: `amplitude` > 0 (modal displacement, mass^½·length), ascending; `frequency` > 0 in Hz;
    /// 0 <= `damping_ratio` < 1 (0.01 = 1 %). `buffer` has as many entries as there are points.
    ///
    /// # Errors
    /// [`Error::Length`], or [`Error::Entry`] with the first entry out of order or range.
    pub fn new(
        amplitude: &[f64],
        frequency: &[f64],
        damping_ratio: &[f64],
        mut buffer: P,
    ) -> Result<Self, Error> {
        let points = buffer.as_mut();
        if amplitude.len() < 2 {
            return Err(Error::Length { name: "amplitude", needed: 2, found: amplitude.len() });
        }
        check_length("frequency", frequency.len(), amplitude.len())?;
        check_length("damping_ratio", damping_ratio.len(), amplitude.len())?;
        check_length("buffer", points.len(), amplitude.len())?;
        for (index, ((&a, &f), &zeta)) in amplitude.iter().zip(frequency).zip(damping_ratio).enumerate() {
            let rises = index == 0 || a > amplitude[index - 1];
            let entry = |name, value, ok: bool, allowed| {
                if ok { Ok(()) } else { Err(Error::Entry { name, index, value, allowed }) }
            };
            let positive = a > 0.0 && a.is_finite();
            entry("amplitude", a, positive && rises, "must be finite, > 0 and ascending")?;
            entry("frequency", f, f > 0.0 && f.is_finite(), "must be a finite number of hertz > 0")?;
            let ratio = (0.0..1.0).contains(&zeta);
            entry("damping_ratio", zeta, ratio, "must satisfy 0 <= damping_ratio < 1 (0.01 = 1 %)")?;
            let log_amplitude = libm::log(a);
            if let Some(before) = index.checked_sub(1).map(|i| points[i]) {
                let (now, then) = (2.0 * PI * f, before.values[0]);
                let width = log_amplitude - before.log_amplitude;
                let gentle = libm::fabs(now - then) < STEEPEST * width * now.min(then);
                let allowed = "must change by less than a third per factor e of amplitude";
                entry("frequency", f, gentle, allowed)?;
            }
            points[index] = CurvePoint { log_amplitude, values: [2.0 * PI * f, zeta], slopes: [0.0; 2] };
        }
        set_slopes(points);
        Ok(Self { points: buffer })
    }
}

fn set_slopes(points: &mut [CurvePoint]) {
    let last = points.len() - 1;
    for which in 0..2 {
        for i in 0..=last {
            let secant = |i: usize| {
                let (a, b) = (points[i], points[i + 1]);
                let width = b.log_amplitude - a.log_amplitude;
                Secant { width, slope: (b.values[which] - a.values[which]) / width }
            };
            points[i].slopes[which] = if i == 0 {
                end(secant(0), (last > 1).then(|| secant(1)))
            } else if i == last {
                end(secant(last - 1), (last > 1).then(|| secant(last - 2)))
            } else {
                inner(secant(i - 1), secant(i))
            };
        }
    }
}

impl<P: AsRef<[CurvePoint]>> ModeCurves<P> {
    /// Smallest and largest amplitude of the points.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        let points = self.points.as_ref();
        (libm::exp(points[0].log_amplitude), libm::exp(points[points.len() - 1].log_amplitude))
    }

    /// Highest circular frequency at any amplitude, rad/s: that of one of the points, because the cubics have no extremum between points.
    #[must_use]
    pub fn fastest(&self) -> f64 {
        self.points.as_ref().iter().fold(0.0, |most: f64, point| most.max(point.values[0]))
    }

    /// Frequency and damping ratio at the amplitude `a`; beyond the points, the values of the nearest point.
    #[must_use]
    pub fn at(&self, a: f64) -> Rate {
        let points = self.points.as_ref();
        let log = libm::log(a);
        let rate = |[omega, damping_ratio]: [f64; 2]| Rate { omega, damping_ratio };
        let next = points.partition_point(|point| point.log_amplitude <= log);
        if next == 0 {
            return rate(points[0].values);
        }
        let (low, Some(high)) = (&points[next - 1], points.get(next)) else {
            return rate(points[next - 1].values);
        };
        let width = high.log_amplitude - low.log_amplitude;
        let s = (log - low.log_amplitude) / width;
        let value = |k: usize| {
            hermite(s, [low.values[k], width * low.slopes[k]], [high.values[k], width * high.slopes[k]])
        };
        rate([value(0), value(1)])
    }

    /// Amplitude a of the analytic signal of a motion, with a² = q² + (v/ω(a))²: the amplitude of the harmonic motion at the mode's own
    /// frequency that has this displacement and velocity.
    #[must_use]
    pub fn amplitude(&self, q: f64, v: f64) -> f64 {
        self.amplitude_near(q, v, self.points.as_ref()[0].values[0])
    }

    /// The same amplitude, with the search started at the circular frequency `omega`.
    pub(super) fn amplitude_near(&self, q: f64, v: f64, omega: f64) -> f64 {
        let mut amplitude = libm::hypot(q, v / omega);
        for _ in 0..MOST_ROUNDS {
            let next = libm::hypot(q, v / self.at(amplitude).omega);
            let step = libm::fabs(next - amplitude);
            amplitude = next;
            if step <= f64::EPSILON * amplitude {
                break;
            }
        }
        amplitude
    }
}
