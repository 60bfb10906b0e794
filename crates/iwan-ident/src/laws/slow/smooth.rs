//! Smooth curves of frequency and damping against amplitude, with bands: a model of every record.

use iwan_core::{CurvePoint, ModeCurves};
use nalgebra::{DMatrix, DVector};

use super::between::Scatter;
use super::flow::Rates;
use super::grid::Grid;
use super::linear::Information;
use super::process::{Covariances, Likeliest};

/// Curves on a grid: decay rates and circular frequencies, with the covariance of their values.
#[derive(Debug, Clone)]
pub(crate) struct Smooth {
    pub(crate) rates: Rates,
    /// Covariance of the values: decay rates first, then circular frequencies.
    pub(crate) covariance: DMatrix<f64>,
}

impl Smooth {
    /// The mean of the curves' prior: constant values, the means over curves `near` those sought. With the envelope's curves as the mean, the result
    /// would keep their wiggles and seem certain of them.
    pub(crate) fn mean(near: &Rates) -> DVector<f64> {
        let n = near.decay.len();
        let level = (near.decay.iter().map(|d| d.ln()).sum::<f64>() / n as f64).exp();
        let omega = near.omega.iter().sum::<f64>() / n as f64;
        DVector::from_fn(2 * n, |i, _| if i < n { level } else { omega })
    }

    /// The curves that all information together makes likeliest; the prior is relative to curves `near` them.
    pub(crate) fn new(information: &Information, covariances: &Covariances, near: &Rates) -> Option<Self> {
        let Information { factor, target } = information;
        let (n, mean) = (near.decay.len(), Self::mean(near));
        let surprise = target - factor * &mean;
        let seen = covariances.each(|m| factor * m * factor.transpose());
        let Likeliest { decay, omega, factor: whole, .. } = seen.likeliest(&surprise, 1.0)?;
        let prior = covariances.whole(decay, omega);
        let across = &prior * factor.transpose();
        let values = mean + &across * whole.solve(&surprise);
        let covariance = &prior - &across * whole.solve(&across.transpose());
        let rates = Rates {
            decay: values.rows(0, n).as_slice().to_vec(),
            omega: values.rows(n, n).as_slice().to_vec(),
        };
        Some(Self { rates, covariance })
    }

    /// Standard deviation of the decay rate at amplitude `i` of the grid, 1/s.
    pub(crate) fn decay_sd(&self, i: usize) -> f64 {
        self.covariance[(i, i)].max(0.0).sqrt()
    }

    /// Standard deviation of the circular frequency at amplitude `i` of the grid, rad/s.
    pub(crate) fn omega_sd(&self, i: usize) -> f64 {
        let i = i + self.rates.omega.len();
        self.covariance[(i, i)].max(0.0).sqrt()
    }
}

/// Frequency and damping ratio against amplitude with bands of 95 %, by ascending amplitude, from the smallest to the largest amplitude of the records'
/// free decays: the largest is that at the first sample of the loudest record. Amplitudes at either end whose damping may be zero are left out. All vectors have the same length. From several hits, the bands are those of
/// a further hit on the specimen; from one hit they are its own, and do not know how the next would differ.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Backbone {
    /// Displacement amplitude, mass-normalised.
    pub amplitude: Vec<f64>,
    /// Frequency, Hz.
    pub frequency: Vec<f64>,
    /// Damping ratio: decay rate over circular frequency.
    pub damping_ratio: Vec<f64>,
    /// Lower end of the frequency's band, Hz.
    pub frequency_low: Vec<f64>,
    /// Upper end of the frequency's band, Hz.
    pub frequency_high: Vec<f64>,
    /// Lower end of the damping ratio's band.
    pub damping_ratio_low: Vec<f64>,
    /// Upper end of the damping ratio's band.
    pub damping_ratio_high: Vec<f64>,
    /// How far the hits stray from each other.
    pub scatter: Scatter,
}

/// Half width of an interval of 95 %, in standard deviations.
pub(crate) const HALF_WIDTH: f64 = 1.959_964;

impl Backbone {
    /// Whether a mode can have these curves ([`ModeCurves`]): there is more than one amplitude, which records that are trusted for an instant only do not leave, and the
    /// frequency jumps nowhere, as it does where samples were written twice.
    #[must_use]
    pub fn is_curve(&self) -> bool {
        let n = self.amplitude.len();
        let points = vec![CurvePoint::default(); n];
        ModeCurves::new(&self.amplitude, &self.frequency, &vec![0.0; n], points).is_ok()
    }

    /// What several hits say about the specimen's repeatability; none for one hit.
    #[must_use]
    pub fn scatter_in_words(&self) -> Option<String> {
        let Scatter { decay, frequency, hits } = self.scatter;
        let middle = self.frequency.get(self.frequency.len() / 2)?;
        (hits > 1).then(|| {
            format!(
                "the curves of these {hits} hits stray from each other by {:.2} % in damping and {:.4} Hz (standard deviations): the bands of the smooth curves are those of a further hit",
                100.0 * decay,
                frequency * middle
            )
        })
    }

    /// The backbone of `smooth` curves on a grid from one value of ln a to another, with the scatter of hits and its covariance.
    pub(crate) fn new(
        grid: &Grid,
        smooth: &Smooth,
        span: (f64, f64),
        (scatter, straying): (Scatter, &DMatrix<f64>),
    ) -> Self {
        let mut out = Self { scatter, ..Self::default() };
        let turn = std::f64::consts::TAU;
        let (n, wide) = (grid.count(), scatter.half_width());
        for log in grid.within(span) {
            let place = grid.place(log);
            let half = |from: usize| {
                let own = wide * place.variance(straying, from).sqrt();
                (HALF_WIDTH * place.variance(&smooth.covariance, from).sqrt()).hypot(own)
            };
            let (decay, omega) = (place.of(&smooth.rates.decay), place.of(&smooth.rates.omega));
            let (d, w) = (half(0), half(n));
            out.amplitude.push(log.exp());
            out.frequency.push(omega / turn);
            out.frequency_low.push((omega - w) / turn);
            out.frequency_high.push((omega + w) / turn);
            out.damping_ratio.push(decay / omega);
            out.damping_ratio_low.push((decay - d) / omega);
            out.damping_ratio_high.push((decay + d) / omega);
        }
        out.without_untold_ends();
        out
    }

    /// Leaves out amplitudes at either end whose damping may be zero, if it is told at others: there a decay has sunk into noise.
    fn without_untold_ends(&mut self) {
        let told = |low: &f64| *low > 0.0;
        let (first, last) =
            (self.damping_ratio_low.iter().position(told), self.damping_ratio_low.iter().rposition(told));
        let (Some(first), Some(last)) = (first, last) else { return };
        let Self { amplitude, frequency, damping_ratio, .. } = self;
        let bands = [
            &mut self.frequency_low,
            &mut self.frequency_high,
            &mut self.damping_ratio_low,
            &mut self.damping_ratio_high,
        ];
        for values in [amplitude, frequency, damping_ratio].into_iter().chain(bands) {
            values.truncate(last + 1);
            values.drain(..first);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A record in which 64 samples stand twice ended a fit: its smooth curves were no mode's.
    #[test]
    fn curves_that_jump_are_no_curves_of_a_mode() {
        let of = |frequency: &[f64]| Backbone {
            amplitude: (1..=frequency.len()).map(|i| 1e-3 * i as f64).collect(),
            frequency: frequency.to_vec(),
            ..Backbone::default()
        };
        assert!(of(&[50.0, 49.9, 49.7]).is_curve());
        assert!(!of(&[50.0, 99.0, 49.7]).is_curve() && !of(&[50.0]).is_curve() && !of(&[]).is_curve());
    }
}
