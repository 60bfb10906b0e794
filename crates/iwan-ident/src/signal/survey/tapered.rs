//! Spectra under a window whose side lobes lie below the rounding of 24-bit samples: what falls beside a line in them was not made by the window.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;

/// Parameter of the window of Kaiser (J. F. Kaiser, *Nonrecursive digital filter design using the I0-sinh window function*, Proc. IEEE Int. Symp. Circuits and Systems, 1974).
/// Its side lobes begin 116 dB below the line and sink further.
const BETA: f64 = 16.0;
/// Half the width of a line's main lobe, in lines: √(1 + (β/π)²).
pub(super) const LOBE: f64 = 5.2;

/// Power spectrum of a stretch from which its straight line was subtracted.
pub(super) struct Tapered {
    /// Spacing of the lines, Hz.
    pub(super) step: f64,
    /// Power of each line over the power of the window: white noise has its variance in every line.
    pub(super) power: Vec<f64>,
}

impl Tapered {
    /// Spectrum of at least two samples, `dt` seconds apart.
    pub(super) fn new(x: &[f64], dt: f64) -> Self {
        let n = x.len();
        let middle = 0.5 * (n as f64 - 1.0);
        let place = |i: usize| i as f64 - middle;
        let mean = x.iter().sum::<f64>() / n as f64;
        let moment = |f: &dyn Fn(usize) -> f64| (0..n).map(|i| place(i) * f(i)).sum::<f64>();
        let slope = moment(&|i| x[i]) / moment(&place);
        let window: Vec<f64> = (0..n).map(|i| kaiser(place(i) / middle)).collect();
        let line = |i: usize| Complex64::new(window[i] * (x[i] - mean - slope * place(i)), 0.0);
        let mut z: Vec<Complex64> = (0..n).map(line).collect();
        FftPlanner::new().plan_fft_forward(n).process(&mut z);
        let whole = window.iter().map(|w| w * w).sum::<f64>();
        Self {
            step: 1.0 / (n as f64 * dt),
            power: z[..=n / 2].iter().map(|z| z.norm_sqr() / whole).collect(),
        }
    }
}

/// Value of the window at a place from -1 to 1, 1 in the middle.
pub(super) fn kaiser(place: f64) -> f64 {
    bessel(BETA * (1.0 - place * place).max(0.0).sqrt()) / bessel(BETA)
}

/// The modified Bessel function I0 by its power series, whose terms are all positive.
fn bessel(x: f64) -> f64 {
    let (mut sum, mut term) = (1.0, 1.0);
    let mut k = 1.0;
    while term > f64::EPSILON * sum {
        term *= (0.5 * x / k).powi(2);
        sum += term;
        k += 1.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn a_line_leaves_nothing_beside_its_lobe() {
        // I0(1) and I0(16) of Abramowitz and Stegun's tables.
        assert!((bessel(1.0) - 1.266_065_877_752_008).abs() < 1e-14);
        assert!((LOBE - (1.0 + (BETA / PI).powi(2)).sqrt()).abs() < 0.02);
        let x: Vec<f64> = (0..1000).map(|n| 3.0 + 0.01 * f64::from(n) + (0.2 * f64::from(n)).cos()).collect();
        let found = Tapered::new(&x, 1e-3);
        let own = 0.2 / (2.0 * PI * 1e-3) / found.step;
        let top = found.power.iter().copied().fold(0.0, f64::max);
        // At 0 Hz stands what the straight line leaves, which the cosine bends a little.
        for (k, power) in found.power.iter().enumerate().skip(8) {
            assert!((k as f64 - own).abs() < LOBE + 1.0 || *power < 4e-12 * top, "{k}: {power:e}");
        }
    }
}
