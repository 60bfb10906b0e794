//! The pulse of the hammer in the record of its force.

use crate::number::{Complex, complex, median};

/// The force counts from where it exceeds its noise by this many standard deviations: in 10⁶ samples of normal noise none does.
const DEVIATIONS: f64 = 7.0;
/// The force must also exceed this fraction of its largest value: the part below carries 1e-5 of the energy.
const PART: f64 = 5e-3;
/// Number of samples kept on either side, beside a quarter of the pulse's own length: the foot of the pulse and the filter's answer to it.
const MARGIN: usize = 4;
/// Root mean square of normal noise over its median magnitude.
const NORMAL: f64 = 1.482_6;

/// The stretch of a force record in which the hammer touches the structure; outside of it the force is zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Pulse {
    /// First sample that counts.
    pub start: usize,
    /// Force from there on, less its zero line.
    pub force: Vec<f64>,
    /// Number of samples of the whole record.
    pub samples: usize,
    /// Sampling interval, s.
    pub dt: f64,
}

impl Pulse {
    /// Cuts the pulse out of a record (a force window) and subtracts the zero line. With `whole` only the zero line is subtracted.
    ///
    /// ```
    /// let mut force = vec![0.5; 400];
    /// force[100] = 10.5;
    /// let pulse = iwan_modal::measure::Pulse::of(&force, 1e-3, false);
    /// assert!(pulse.start > 90 && pulse.start + pulse.force.len() < 110);
    /// assert_eq!(pulse.force.iter().sum::<f64>(), 10.0);
    /// ```
    #[must_use]
    pub fn of(force: &[f64], dt: f64, whole: bool) -> Self {
        let zero = median(force);
        let centred: Vec<f64> = force.iter().map(|f| f - zero).collect();
        let samples = force.len();
        if whole {
            return Self { start: 0, force: centred, samples, dt };
        }
        let level = Self::threshold(&centred);
        let first = centred.iter().position(|f| f.abs() > level).unwrap_or(0);
        let last = centred.iter().rposition(|f| f.abs() > level).unwrap_or(samples - 1);
        let margin = (last - first) / 4 + MARGIN;
        let (start, end) = (first.saturating_sub(margin), (last + margin).min(samples - 1));
        Self { start, force: centred[start..=end].to_vec(), samples, dt }
    }

    /// Magnitude of the force above which a sample belongs to the pulse; `centred` is the force less its zero line.
    pub(crate) fn threshold(centred: &[f64]) -> f64 {
        let magnitudes: Vec<f64> = centred.iter().map(|f| f.abs()).collect();
        let peak = magnitudes.iter().copied().fold(0.0, f64::max);
        (DEVIATIONS * NORMAL * median(&magnitudes)).max(PART * peak)
    }

    /// Laplace transform of the force at `s` (1/s), with time 0 at the first sample of the record, and its derivative with respect to -s.
    pub(crate) fn transform(&self, s: Complex) -> (Complex, Complex) {
        let turn = (-s * self.dt).exp();
        let mut factor = (-s * (self.start as f64 * self.dt)).exp() * self.dt;
        let (mut sum, mut moment) = (complex(0.0, 0.0), complex(0.0, 0.0));
        for (m, f) in self.force.iter().enumerate() {
            sum += factor * *f;
            moment += factor * (*f * (self.start + m) as f64 * self.dt);
            factor *= turn;
        }
        (sum, moment)
    }

    /// The whole record of the force, zero outside the pulse, times e^(-decay t).
    pub(crate) fn record(&self, decay: f64) -> Vec<f64> {
        let mut record = vec![0.0; self.samples];
        for (m, f) in self.force.iter().enumerate() {
            let n = self.start + m;
            record[n] = f * (-decay * n as f64 * self.dt).exp();
        }
        record
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transform_of_an_impulse_is_known() {
        let pulse = Pulse { start: 3, force: vec![0.0, 2.0], samples: 10, dt: 0.5 };
        let s = complex(-0.2, 1.0);
        let (sum, moment) = pulse.transform(s);
        let exact = (-s * 2.0).exp();
        assert!((sum - exact).norm() < 1e-14 && (moment - exact * 2.0).norm() < 1e-14);
    }

    #[test]
    fn noise_after_the_pulse_is_cut_off() {
        let mut force: Vec<f64> = (0..2000).map(|n| 1e-3 * f64::from((n * 7919) % 101 - 50)).collect();
        (0..40)
            .for_each(|i| force[500 + i] += (std::f64::consts::PI * i as f64 / 40.0).sin().powi(2) * 100.0);
        let pulse = Pulse::of(&force, 1e-4, false);
        assert!(pulse.start >= 480 && pulse.start <= 503, "{}", pulse.start);
        assert!(pulse.force.len() < 80, "{}", pulse.force.len());
        assert_eq!(Pulse::of(&force, 1e-4, true).force.len(), 2000);
    }
}
