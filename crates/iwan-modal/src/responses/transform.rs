//! Fourier transforms of real records, two at a time: one record is the real part of what is transformed, the other the imaginary part.

use std::sync::Arc;

use rustfft::{Fft, FftPlanner};

use crate::number::{Complex, complex, extent};

/// Records give up at most one sample in this many to reach a length of small prime factors: the transform of 20,001 samples (3 · 59 · 113) takes four
/// times as long as that of 20,000, and a thousandth of a record carries a thousandth of what it tells.
const GIVEN_UP: usize = 1000;
/// Prime factors with which the transforms are quick.
const SMALL_FACTORS: [usize; 5] = [2, 3, 5, 7, 11];

/// The largest length, at most a thousandth below `samples`, that has small prime factors alone; `samples` where there is none.
pub(super) fn quick_length(samples: usize) -> usize {
    let is_quick = |n: &usize| {
        let left = SMALL_FACTORS.iter().fold(*n, |mut left, factor| {
            while left > 0 && left.is_multiple_of(*factor) {
                left /= factor;
            }
            left
        });
        left == 1
    };
    (samples - samples / GIVEN_UP..=samples).rev().find(is_quick).unwrap_or(samples)
}

/// The transform of records of one length, planned once.
pub(super) struct Transform {
    fft: Arc<dyn Fft<f64>>,
    dt: f64,
}

impl Transform {
    /// Plans the transform of `samples` samples every `dt` seconds.
    pub(super) fn new(samples: usize, dt: f64) -> Self {
        Self { fft: FftPlanner::new().plan_fft_forward(samples), dt }
    }

    /// Number of lines from 0 to the Nyquist frequency.
    pub(super) fn lines(&self) -> usize {
        self.fft.len() / 2 + 1
    }

    /// The spectrum of one record at the lines from 0 to the Nyquist frequency, unit times s.
    pub(super) fn one(&self, record: Vec<f64>) -> Vec<Complex> {
        let mut found = Vec::new();
        self.each(std::iter::once(record), |_, spectrum| found.extend_from_slice(spectrum));
        found
    }

    /// Calls `take` with number and spectrum of each record, in order. Each record is scaled by a power of two to a largest value between 1 and 2 before it
    /// shares a transform with the next, so that a loud record leaves no rounding in a soft one.
    pub(super) fn each(
        &self,
        records: impl IntoIterator<Item = Vec<f64>>,
        mut take: impl FnMut(usize, &[Complex]),
    ) {
        let zero = complex(0.0, 0.0);
        let (n, lines) = (self.fft.len(), self.lines());
        let mut buffer = vec![zero; n];
        let mut scratch = vec![zero; self.fft.get_inplace_scratch_len()];
        let mut spectrum = vec![zero; lines];
        let mut records = records.into_iter();
        let mut number = 0;
        while let Some(a) = records.next() {
            let b = records.next();
            let (up, back) = scale(&a);
            if let Some(b) = &b {
                let (b_up, b_back) = scale(b);
                for (z, (x, y)) in buffer.iter_mut().zip(a.iter().zip(b)) {
                    *z = complex(x * up, y * b_up);
                }
                self.fft.process_with_scratch(&mut buffer, &mut scratch);
                let half = [0.5 * self.dt * back, 0.5 * self.dt * b_back];
                let mirrored = |k: usize| buffer[if k == 0 { 0 } else { n - k }];
                for (k, value) in spectrum.iter_mut().enumerate() {
                    let (z, m) = (buffer[k], mirrored(k));
                    *value = complex(half[0] * (z.re + m.re), half[0] * (z.im - m.im));
                }
                take(number, &spectrum);
                for (k, value) in spectrum.iter_mut().enumerate() {
                    let (z, m) = (buffer[k], mirrored(k));
                    *value = complex(half[1] * (z.im + m.im), half[1] * (m.re - z.re));
                }
                take(number + 1, &spectrum);
            } else {
                for (z, x) in buffer.iter_mut().zip(&a) {
                    *z = complex(x * up, 0.0);
                }
                self.fft.process_with_scratch(&mut buffer, &mut scratch);
                for (value, z) in spectrum.iter_mut().zip(&buffer) {
                    *value = z * (self.dt * back);
                }
                take(number, &spectrum);
            }
            number += 2;
        }
    }
}

/// A power of two that brings the largest value to between 1 and 2, and its inverse.
fn scale(x: &[f64]) -> (f64, f64) {
    let (low, high) = extent(x);
    let largest = high.max(-low);
    // Beyond these exponents neither the power nor its inverse is a normal number; the scale of such a record then stays a little off, which does no harm.
    let exponent = if largest > 0.0 { largest.log2().floor().clamp(-1000.0, 1000.0) as i32 } else { 0 };
    (2.0_f64.powi(-exponent), 2.0_f64.powi(exponent))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_at_once_are_what_each_is_by_itself() {
        let record =
            |size: f64, w: f64| -> Vec<f64> { (0..126).map(|n| size * (w * f64::from(n)).cos()).collect() };
        // An even length and an odd one, loud beside soft, the last one alone.
        for n in [126, 125] {
            let records = [record(1e8, 0.3), record(1e-8, 0.7), record(3.0, 1.1)].map(|x| x[..n].to_vec());
            let transform = Transform::new(n, 0.5);
            let mut count = 0;
            transform.each(records.clone(), |i, spectrum| {
                count += 1;
                let size: f64 = records[i].iter().map(|x| x.abs()).sum();
                for (k, found) in spectrum.iter().enumerate() {
                    let turn = |m: usize| {
                        let angle = -std::f64::consts::TAU * ((k * m) % n) as f64 / n as f64;
                        Complex::from_polar(0.5, angle)
                    };
                    let sum: Complex = records[i].iter().enumerate().map(|(m, x)| turn(m) * *x).sum();
                    assert!((found - sum).norm() < 1e-15 * size, "{i} {k}: {found} {sum}");
                }
            });
            assert_eq!((count, transform.lines()), (3, n / 2 + 1));
        }
    }

    #[test]
    fn lengths_lose_a_thousandth_at_most() {
        // 20,001 = 3 · 59 · 113; nothing below 1,009 is within a thousandth of it but 1,008 = 2⁴ · 3² · 7.
        for (samples, quick) in [(20_001, 20_000), (8192, 8192), (1009, 1008), (997, 997), (0, 0)] {
            assert_eq!(quick_length(samples), quick);
        }
    }
}
