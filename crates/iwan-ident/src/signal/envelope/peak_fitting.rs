//! Peak finding and fitting (after M. Jin, W. Chen, M. R. W. Brake, H. Song, Identification of instantaneous frequency
//! and damping from transient decay data, J. Vib. Acoust. 142(5), 051111, 2020, doi:10.1115/1.4047416).
//!
//! As there, a curve is fitted to the samples around each positive and negative peak, amplitudes are taken from both
//! signs, and the frequency from the time between a peak and the trough behind it. The curve is a sinusoid with an
//! exponential factor, and damping comes from moving least squares instead of differences.

use std::f64::consts::{FRAC_PI_3, TAU};

use nalgebra::{Matrix4, Vector4};

use super::super::extrema::{Extremum, extrema};
use super::super::isolated::{Isolated, Stretch};
use super::peaks::{check_rate, half_turns};
use super::traces::Trace;
use crate::error::Error;

/// Times and logarithms of the fitted peaks in the trusted window.
pub(super) fn fitted_peaks(mode: &Isolated) -> Result<Trace, Error> {
    check_rate(mode)?;
    let Stretch { first, samples: x } = mode.stretch();
    let omega = TAU * mode.band.peak * mode.dt;
    let fit = |rough: &Extremum| fit_peak(x, rough.time, omega);
    let peaks = extrema(x, omega);
    let point = |peak: Extremum| ((first as f64 + peak.time) * mode.dt, peak.height.ln());
    Ok(peaks.iter().filter_map(fit).map(point).collect())
}

/// Phase at the peaks, half a turn apart, less that of the reference frequency.
pub(super) fn half_cycle_phases(mode: &Isolated, peaks: &Trace) -> Trace {
    half_turns(&peaks.t, mode.band.peak)
}

/// The crest near the sample `n`, with its time (in samples) and height: that of the least-squares curve (a + b s) cos ωs + (c + d s) sin ωs
/// through the samples within a sixth of a cycle, s counted from `n`. None where these samples reach beyond the record, or the crest is too far from `n`.
fn fit_peak(x: &[f64], n: f64, omega: f64) -> Option<Extremum> {
    let reach = (FRAC_PI_3 / omega).max(2.0);
    let from = (n - reach).ceil();
    let to = (n + reach).floor();
    if from < 0.0 || to > (x.len() - 1) as f64 {
        return None;
    }
    let (mut matrix, mut right) = (Matrix4::zeros(), Vector4::zeros());
    for (i, x) in x[from as usize..=to as usize].iter().enumerate() {
        let s = from + i as f64 - n;
        let (sine, cosine) = (omega * s).sin_cos();
        let row = Vector4::new(cosine, s / reach * cosine, sine, s / reach * sine);
        matrix += row * row.transpose();
        right += row * *x;
    }
    let c = matrix.cholesky()?.solve(&right);
    let shift = (c[2] / c[0]).atan() / omega;
    let (in_phase, quadrature) = (c[0] + c[1] * shift / reach, c[2] + c[3] * shift / reach);
    let shift = (quadrature / in_phase).atan() / omega;
    (shift.abs() < 0.5 * reach).then(|| Extremum { time: n + shift, height: in_phase.hypot(quadrature) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_crest_of_a_decaying_wave() {
        let (omega, lambda) = (0.1, 2e-4);
        let wave = |n: usize| (-lambda * n as f64).exp() * (omega * n as f64 + 0.7).cos();
        let x: Vec<f64> = (0..400).map(wave).collect();
        let crest = (4.0 * std::f64::consts::PI - 0.7) / omega;
        let found = fit_peak(&x, crest.round(), omega).unwrap();
        assert!((found.time - crest).abs() < 1e-3, "{found:?} {crest}");
        assert!((found.height / (-lambda * found.time).exp() - 1.0).abs() < 1e-6, "{found:?}");
        assert_eq!(fit_peak(&x, 3.0, omega), None);
    }
}
