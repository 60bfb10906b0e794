//! Columns for the modes outside the band, which all fits of a band share.

use crate::number::Complex;

/// Number of complex terms for what lies outside the band: s^(d-2) times a cubic in frequency, d = 0, 1, 2 for displacement, velocity, acceleration.
/// The first term is rigid motion and the modes below, the third the modes above; the other two take up how modes just outside the band
/// bend these.
pub(super) const OUTSIDE: usize = 4;

/// Columns of these terms at the `frequencies` (Hz) of a band's lines, for real and imaginary part of each coefficient; `power` is the d-2 of the motion.
pub(super) fn outside(frequencies: &[f64], s: &[Complex], weights: &[f64], power: i32) -> Vec<f64> {
    let lines = s.len();
    let (low, high) = (frequencies[0], frequencies[lines - 1]);
    let top = s[lines - 1].norm();
    let mut columns = vec![0.0; 4 * OUTSIDE * lines];
    for (degree, column) in columns.chunks_mut(4 * lines).enumerate() {
        for k in 0..lines {
            let x = (2.0 * frequencies[k] - low - high) / (high - low);
            let value = (s[k] / top).powi(power) * chebyshev(degree, x) * weights[k];
            column[k] = value.re;
            column[lines + k] = value.im;
            column[2 * lines + k] = -value.im;
            column[3 * lines + k] = value.re;
        }
    }
    columns
}

fn chebyshev(degree: usize, x: f64) -> f64 {
    (degree as f64 * x.clamp(-1.0, 1.0).acos()).cos()
}
