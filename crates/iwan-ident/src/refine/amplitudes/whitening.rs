//! Complex amplitudes in overlapping windows, made independent of each other.

use std::f64::consts::PI;

use rustfft::num_complex::Complex64;
use serde::{Deserialize, Serialize};

use super::windows::OVERLAP;

/// Steps of the midpoint rule for the overlap of two windows. The integrand and its derivatives up to the third vanish at
/// both ends, so that the error falls with the sixth power of the step: 1e-12 with 100 steps, rounding with 400.
const STEPS: i32 = 400;

/// Turns amplitudes of a record with white noise into values with independent noise of equal variance.
///
/// `rows` is the Cholesky factor L of the windows' overlaps, a band of four: z = L y, and E|y|² = 1 for noise of density 1 (the density is the
/// variance of a sample times dt).
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Whitening {
    rows: Vec<[f64; OVERLAP]>,
}

impl Whitening {
    /// For `count` windows, each beginning `hop` seconds after the one before.
    pub(crate) fn of(count: usize, hop: f64) -> Self {
        // ∫ sin⁴(x) sin⁴(x + iπ/4) over the common support, in units of H·4/π.
        let overlap: [f64; OVERLAP] = std::array::from_fn(|i| {
            let shift = i as f64 * 0.25 * PI;
            let h = (PI - shift) / f64::from(STEPS);
            let term = |n: i32| {
                let x = h * (f64::from(n) + 0.5);
                x.sin().powi(4) * (x + shift).sin().powi(4)
            };
            h * (0..STEPS).map(term).sum::<f64>() * hop * 4.0 / PI
        });
        // Row k holds L[k][k-3 ..= k].
        let mut rows: Vec<[f64; OVERLAP]> = Vec::with_capacity(count);
        for k in 0..count {
            let mut row = [0.0; OVERLAP];
            for i in (0..OVERLAP).rev().filter(|i| *i <= k) {
                // Column j = k - i.
                let mut sum = overlap[i];
                for back in i + 1..OVERLAP.min(k + 1) {
                    // L[k][k - back] L[j][k - back], summed over the columns that both rows have.
                    sum -= row[OVERLAP - 1 - back] * rows_at(&rows, &row, k - i, k, back - i);
                }
                row[OVERLAP - 1 - i] = if i == 0 { sum.sqrt() } else { sum / rows[k - i][OVERLAP - 1] };
            }
            rows.push(row);
        }
        Self { rows }
    }

    /// Standard deviation of a window's amplitude in noise of density 1.
    pub(crate) fn of_noise(&self) -> f64 {
        self.rows.first().map_or(0.0, |row| row[OVERLAP - 1])
    }

    /// Solves L y = z in place.
    pub(crate) fn apply(&self, z: &mut [Complex64]) {
        for k in 0..z.len() {
            let row = &self.rows[k];
            let mut sum = z[k];
            for back in 1..OVERLAP.min(k + 1) {
                sum -= z[k - back] * row[OVERLAP - 1 - back];
            }
            z[k] = sum / row[OVERLAP - 1];
        }
    }
}

/// L[j][j - back], where row `k` is the one being made.
fn rows_at(rows: &[[f64; OVERLAP]], row: &[f64; OVERLAP], j: usize, k: usize, back: usize) -> f64 {
    if j == k { row[OVERLAP - 1 - back] } else { rows[j][OVERLAP - 1 - back] }
}

#[cfg(test)]
mod tests {
    use super::super::windows::Windows;
    use super::*;

    #[test]
    fn whitened_noise_is_white() {
        let windows = Windows { omega: 50.0, hop: 0.1, count: 40, tables: true };
        let (dt, whitening) = (1e-3_f64, Whitening::of(windows.count, windows.hop));
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let (mut square, mut neighbour, repetitions) = (0.0, 0.0, 200);
        for _ in 0..repetitions {
            let samples: Vec<f64> = (0..4300).map(|_| (12.0 / dt).sqrt() * uniform()).collect();
            let mut z = windows.of_samples(&samples, dt);
            whitening.apply(&mut z);
            square += z.iter().map(Complex64::norm_sqr).sum::<f64>() / f64::from(40 * repetitions);
            neighbour +=
                z.windows(2).map(|z| (z[0].conj() * z[1]).re).sum::<f64>() / f64::from(39 * repetitions);
        }
        // Density 1 in all: ½ in each quadrature.
        assert!((square - 1.0).abs() < 0.05 && neighbour.abs() < 0.05, "{square} {neighbour}");
    }
}
