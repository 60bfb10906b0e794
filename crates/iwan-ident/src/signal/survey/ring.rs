//! The spectrum of a ring-down from its loudest sample on, in which modes that decay at once stand beside those that last.

use std::f64::consts::PI;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;

use crate::error::{Error, check_dt, check_samples};
use crate::signal::spectrum::{is_peak, vertex};

/// Least number of samples of a record, and of the stretch behind its loudest one; with a shorter stretch the whole record is taken.
const LEAST: usize = 64;
/// Where the stretch behind the loudest sample is shorter than this fraction of the record, it is no ring-down, and the whole record is taken.
const PART: f64 = 0.2;
/// Zeros are appended until lines are at least this many times denser than the stretch's own: peaks and their half-power points are then met within 3 % of
/// the window's width.
const DENSER: usize = 4;

/// Power spectrum of the stretch behind the loudest sample under a window, all channels added.
pub(super) struct RingSpectrum {
    /// Spacing of the lines, Hz.
    pub(super) step: f64,
    /// Length of the stretch, s.
    pub(super) length: f64,
    pub(super) power: Vec<f64>,
    /// Power of the noise in each line: the deviation of the complex line from the straight line through its neighbours on either side. The skirts of
    /// modes are smooth and leave nothing there, noise leaves itself.
    pub(super) noise: Vec<f64>,
}

impl RingSpectrum {
    /// Spectrum of equally long channels sampled every `dt` seconds.
    pub(super) fn new(channels: &[&[f64]], dt: f64, window: Window) -> Result<Self, Error> {
        check_dt(dt)?;
        let n = channels.first().map_or(0, |c| c.len());
        for channel in channels {
            check_samples("record", channel, LEAST.max(n), "record longer, and all channels alike")?;
        }
        let from = loudest(channels, n);
        let stretch = n - from;
        let from = if stretch < LEAST || (stretch as f64) < PART * n as f64 { 0 } else { from };
        let stretch = n - from;
        let padded = (DENSER * stretch).next_power_of_two();
        let fft = FftPlanner::new().plan_fft_forward(padded);
        let (mut power, mut noise) = (vec![0.0; padded / 2 + 1], vec![0.0; padded / 2 + 1]);
        for channel in channels {
            let mut z = windowed(&channel[from..], window);
            z.resize(padded, Complex64::default());
            fft.process(&mut z);
            power.iter_mut().zip(&z).for_each(|(p, z)| *p += z.norm_sqr());
            for (k, noise) in noise.iter_mut().enumerate() {
                // Neighbours four lines of the unpadded stretch away: at that distance the window leaves them nothing in common.
                let (below, above) = (z[(k + padded - 4 * DENSER) % padded], z[(k + 4 * DENSER) % padded]);
                *noise += (below - 2.0 * z[k] + above).norm_sqr() / 6.0;
            }
        }
        Ok(Self { step: 1.0 / (padded as f64 * dt), length: stretch as f64 * dt, power, noise })
    }

    /// Frequency of the peak at line `k`, by a parabola through the logarithms.
    pub(super) fn frequency(&self, k: usize) -> f64 {
        vertex(&self.power, k) * self.step
    }

    pub(super) fn is_peak(&self, k: usize) -> bool {
        is_peak(&self.power, k)
    }
}

/// The sample at which all channels together are farthest from their means.
fn loudest(channels: &[&[f64]], n: usize) -> usize {
    let means: Vec<f64> = channels.iter().map(|c| c.iter().sum::<f64>() / n as f64).collect();
    let energy = |i: usize| channels.iter().zip(&means).map(|(c, m)| (c[i] - m).powi(2)).sum::<f64>();
    (0..n).map(energy).enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i)
}

/// Windows over the stretch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Window {
    /// The half of a Hann window that falls from 1 to 0: it sees what decays at once, but the step at its start makes skirts.
    Falling,
    /// A whole Blackman-Harris window: it is blind at the start, but neither skirts nor side lobes reach above -92 dB.
    Whole,
}

/// Coefficients of the four-term Blackman-Harris window (F. J. Harris, Proc. IEEE 66 (1978) 51-83, doi:10.1109/PROC.1978.10837).
const BLACKMAN_HARRIS: [f64; 4] = [0.358_75, -0.488_29, 0.141_28, -0.011_68];

impl Window {
    /// Value of the window at a part of the stretch, from 0 to 1.
    fn at(self, part: f64) -> f64 {
        match self {
            Self::Falling => (0.5 * PI * part).cos().powi(2),
            Self::Whole => {
                let term = |(k, a): (usize, f64)| a * (2.0 * PI * k as f64 * part).cos();
                BLACKMAN_HARRIS.into_iter().enumerate().map(term).sum()
            }
        }
    }

    /// ∫ e^(-p t) w(t) dt over the stretch, t from 0 to 1; in closed form, because both windows are sums of cosines.
    fn transformed(self, p: Complex64) -> Complex64 {
        let end = (-p).exp();
        let cosine = |turn: f64, ends: Complex64| {
            let below = p * p + turn * turn;
            // At its own frequency a cosine leaves 1/2, and a constant leaves 1.
            let own = if turn == 0.0 { 1.0 } else { 0.5 };
            if below.norm() < 1e-9 { Complex64::new(own, 0.0) } else { p * ends / below }
        };
        match self {
            Self::Falling => 0.5 * (cosine(0.0, 1.0 - end) + cosine(PI, 1.0 + end)),
            Self::Whole => {
                let term = |(k, a): (usize, f64)| a * cosine(2.0 * PI * k as f64, 1.0 - end);
                BLACKMAN_HARRIS.into_iter().enumerate().map(term).sum()
            }
        }
    }
}

/// Samples under the window, less the mean that the window sees.
fn windowed(x: &[f64], window: Window) -> Vec<Complex64> {
    let n = x.len() as f64;
    let window: Vec<f64> = (0..x.len()).map(|i| window.at(i as f64 / n)).collect();
    let mean = x.iter().zip(&window).map(|(x, w)| x * w).sum::<f64>() / window.iter().sum::<f64>();
    x.iter().zip(&window).map(|(x, w)| Complex64::new(w * (x - mean), 0.0)).collect()
}

/// Decay rate (1/s) of the oscillation whose peak is `width` Hz wide at half its power, in a stretch of `length` seconds; none where the
/// window alone is nearly as wide.
pub(super) fn decay_rate(window: Window, width: f64, length: f64) -> Option<f64> {
    // Least width over that of the window alone. Below, the stretch is too short to tell a decay from none: the rate would be known to a quarter at best.
    const TOLD: f64 = 1.1;
    // Whether the peak of e^(-r t), for t from 0 to 1, is wider at half its power than some lines: the power at half that width is more than half of the largest.
    let is_wider = |rate: f64, lines: f64| {
        let power = |offset: f64| window.transformed(Complex64::new(rate, 2.0 * PI * offset)).norm_sqr();
        power(0.5 * lines) > 0.5 * power(0.0)
    };
    let wanted = width * length;
    if is_wider(0.0, wanted / TOLD) {
        return None;
    }
    let (mut low, mut high) = (0.0, 8.0 * wanted + 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if is_wider(middle, wanted) { high = middle } else { low = middle }
    }
    Some(0.5 * (low + high) / length)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half-power width of the peak of e^(-r t) under a window, for t from 0 to 1: twice the offset at which the power is half of its largest value.
    fn width_of(window: Window, rate: f64) -> f64 {
        let power = |offset: f64| window.transformed(Complex64::new(rate, 2.0 * PI * offset)).norm_sqr();
        // Half the width is 0.64 and 0.95 lines for the windows alone; a rate of r adds r/(2π) at most.
        let (mut low, mut high) = (0.0, 2.0 + rate);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if power(middle) > 0.5 * power(0.0) { low = middle } else { high = middle }
        }
        low + high
    }

    /// A decay that is over before the window falls has the width r/π of a Lorentzian.
    #[test]
    fn a_fast_decay_has_a_lorentzian_width() {
        for rate in [300.0, 3000.0] {
            let width = width_of(Window::Falling, rate);
            assert!((width * PI / rate - 1.0).abs() < 3.0 / rate, "{width}");
        }
        for window in [Window::Falling, Window::Whole] {
            let found = decay_rate(window, width_of(window, 12.0) / 7.0, 7.0).unwrap();
            assert!((found - 12.0 / 7.0).abs() < 1e-9);
            assert!(decay_rate(window, width_of(window, 0.0), 1.0).is_none());
        }
        // The whole window has the 1.90 lines of Harris' table.
        assert!((width_of(Window::Whole, 0.0) - 1.90).abs() < 0.005);
    }
}
