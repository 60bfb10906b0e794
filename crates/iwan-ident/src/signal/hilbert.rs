//! Analytic signal by Fourier transform, and the cut to whole cycles that keeps its errors at the ends small.

use rustfft::FftPlanner;
use rustfft::num_complex::Complex64;

use crate::error::{Error, check_samples};

/// A(t) e^{iθ(t)} at every sample: its modulus is the amplitude, its argument the phase.
pub type Analytic = Vec<Complex64>;

/// Analytic signal x + i H(x), equal to `scipy.signal.hilbert(x)` to 1e-12 of the largest sample.
///
/// The negative frequencies are removed from the discrete Fourier transform. The signal is thereby treated as periodic: where
/// its end does not meet its start, the result is wrong near both ends. [`whole_cycles`] makes the ends meet in phase.
///
/// # Errors
/// [`Error::NotFinite`], [`Error::TooShort`] for an empty slice.
///
/// ```
/// let x: Vec<f64> = (0..64).map(|n| (std::f64::consts::TAU * 4.0 * n as f64 / 64.0).cos()).collect();
/// let z = iwan_ident::signal::analytic_signal(&x)?;
/// assert!(z.iter().all(|z| (z.norm() - 1.0).abs() < 1e-12));
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn analytic_signal(x: &[f64]) -> Result<Analytic, Error> {
    check_samples("record", x, 1, "give a record")?;
    let n = x.len();
    let mut planner = FftPlanner::new();
    let mut z: Vec<Complex64> = x.iter().map(|&v| Complex64::new(v, 0.0)).collect();
    planner.plan_fft_forward(n).process(&mut z);
    let half = 1.0 / n as f64;
    for (k, z) in z.iter_mut().enumerate() {
        // Factor 1 for frequency 0 and, with an even number of samples, for the Nyquist frequency; 2 for positive frequencies, 0 for negative ones.
        *z *= match (2 * k).cmp(&n) {
            _ if k == 0 => half,
            std::cmp::Ordering::Less => 2.0 * half,
            std::cmp::Ordering::Equal => half,
            std::cmp::Ordering::Greater => 0.0,
        };
    }
    planner.plan_fft_inverse(n).process(&mut z);
    Ok(z)
}

/// The longest stretch of `x` that holds whole cycles: from the sample after the first upward zero crossing up to the
/// sample before or at the last one. None when there are fewer than two such crossings.
///
/// ```
/// let x: Vec<f64> = (0..100).map(|n| (0.5 * n as f64 + 1.0).sin()).collect();
/// let cut = iwan_ident::signal::whole_cycles(&x).unwrap();
/// // Seven cycles of 4π samples.
/// assert!((cut.len() as f64 - 28.0 * std::f64::consts::PI).abs() < 1.0);
/// ```
#[must_use]
pub fn whole_cycles(x: &[f64]) -> Option<std::ops::Range<usize>> {
    let upward = |i: &usize| x[i - 1] < 0.0 && x[*i] >= 0.0;
    let first = (1..x.len()).find(upward)?;
    let last = (first + 1..x.len()).rev().find(upward)?;
    Some(first..last)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// SciPy 1.17.1: `hilbert(x[:n]).imag[[0, 1, 17, 100, 250, n-2, n-1]]` for
    /// x[n] = ((37 n + 11) mod 101 - 50)/32 + (n² mod 23)/16, an even and an odd (prime) length.
    #[test]
    fn equals_scipy() {
        let x: Vec<f64> = (0..400_i32)
            .map(|n| f64::from((37 * n + 11) % 101 - 50) / 32.0 + f64::from(n * n % 23) / 16.0)
            .collect();
        let even = [
            0.46863877633662065,
            -1.6521005668482591,
            0.6419747714637455,
            0.052952624717056584,
            0.9724804243666815,
            0.5692560889113284,
            1.2576598970687884,
        ];
        let odd = [
            -0.46485807749070684,
            -1.6042390433910594,
            0.6456554807670959,
            0.04479459242996071,
            0.9764785671634636,
            1.0456296733331563,
            1.4805779985768823,
        ];
        for (n, golden) in [(400, even), (397, odd)] {
            let z = analytic_signal(&x[..n]).unwrap();
            for (i, expected) in [0, 1, 17, 100, 250, n - 2, n - 1].into_iter().zip(golden) {
                assert!((z[i].im - expected).abs() < 1e-12, "{n} {i}: {} {expected}", z[i].im);
            }
            assert!(z.iter().zip(&x).all(|(z, x)| (z.re - x).abs() < 1e-12));
        }
    }

    #[test]
    fn a_record_without_two_crossings_has_no_whole_cycle() {
        assert_eq!(whole_cycles(&[]), None);
        assert_eq!(whole_cycles(&[1.0; 9]), None);
        assert_eq!(whole_cycles(&[-1.0, 1.0, 2.0]), None);
        assert_eq!(whole_cycles(&[-1.0, 1.0, -1.0, 1.0]), Some(1..3));
        assert!(analytic_signal(&[]).is_err());
        assert!(analytic_signal(&[f64::INFINITY]).is_err());
    }
}
