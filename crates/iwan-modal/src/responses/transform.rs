//! Fourier transforms of real records, two at a time: one record is the real part of what is transformed, the other the imaginary part.

use std::sync::Arc;

use rustfft::{Fft, FftPlanner};

use crate::number::{Complex, complex, extent, sum};

/// Records give up at most one sample in this many to reach a length of small prime factors: the transform of 20,001 samples (3 · 59 · 113) takes four
/// times as long as that of 20,000, and a thousandth of a record carries a thousandth of what it tells.
const GIVEN_UP: usize = 1000;
/// Prime factors with which the transforms are quick.
const SMALL_FACTORS: [usize; 5] = [2, 3, 5, 7, 11];

/// The largest length, at most a thousandth below `samples`, that has small prime factors alone; `samples` where there is none.
pub(super) fn quick_length(samples: usize) -> usize {
    (samples - samples / GIVEN_UP..=samples).rev().find(|n| is_quick(*n)).unwrap_or(samples)
}

/// The least length from `least` to `most` that has small prime factors alone; `most` where there is none.
pub(super) fn quick_length_from(least: usize, most: usize) -> usize {
    (least..=most).find(|n| is_quick(*n)).unwrap_or(most)
}

fn is_quick(n: usize) -> bool {
    let left = SMALL_FACTORS.iter().fold(n, |mut left, factor| {
        while left > 0 && left.is_multiple_of(*factor) {
            left /= factor;
        }
        left
    });
    left == 1
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
    pub(super) fn one(&self, record: &[f64]) -> Vec<Complex> {
        let mut found = Vec::new();
        self.each([Record::of(record)], None, &mut self.room(), |_, spectrum| found = spectrum.to_vec());
        found
    }

    /// Room in which [`Transform::each`] works: a task needs one, and can use it again and again.
    pub(super) fn room(&self) -> Room {
        let zeros = |n: usize| vec![complex(0.0, 0.0); n];
        Room {
            buffer: zeros(self.fft.len()),
            scratch: zeros(self.fft.get_inplace_scratch_len()),
            spectra: [zeros(self.lines()), zeros(self.lines())],
        }
    }

    /// Calls `take` with number and spectrum of each record, in order; all records are multiplied by `window`, whose values are at most 1. Each record is scaled by a power of
    /// two to a largest value between 1 and 2 before it shares a transform with the next, so that a loud record leaves no rounding in a soft one.
    pub(super) fn each<'a>(
        &self,
        records: impl IntoIterator<Item = Record<'a>>,
        window: Option<&[f64]>,
        room: &mut Room,
        mut take: impl FnMut(usize, &[Complex]),
    ) {
        let Room { buffer, scratch, spectra } = room;
        let mut records = records.into_iter();
        let mut number = 0;
        while let Some(a) = records.next() {
            let b = records.next();
            let other = b.unwrap_or(Record { scale: 0.0, ..a });
            let filled = buffer.iter_mut().zip(a.samples.iter().zip(other.samples));
            let value = |x: &f64, y: &f64| complex((x - a.zero) * a.scale, (y - other.zero) * other.scale);
            match window {
                Some(window) => filled.zip(window).for_each(|((z, (x, y)), w)| *z = value(x, y) * *w),
                None => filled.for_each(|(z, (x, y))| *z = value(x, y)),
            }
            self.fft.process_with_scratch(buffer, scratch);
            let half = [a, other].map(|r| if r.scale > 0.0 { 0.5 * self.dt / r.scale } else { 0.0 });
            let split = |z: &Complex, m: &Complex| {
                let first = complex(half[0] * (z.re + m.re), half[0] * (z.im - m.im));
                (first, complex(half[1] * (z.im + m.im), half[1] * (m.re - z.re)))
            };
            let [first, second] = spectra;
            (first[0], second[0]) = split(&buffer[0], &buffer[0]);
            // The line k and its mirror image n - k.
            let mirrored = buffer[1..].iter().zip(buffer[1..].iter().rev());
            for ((first, second), (z, m)) in first[1..].iter_mut().zip(&mut second[1..]).zip(mirrored) {
                (*first, *second) = split(z, m);
            }
            take(number, &spectra[0]);
            if b.is_some() {
                take(number + 1, &spectra[1]);
            }
            number += 2;
        }
    }
}

/// Memory for the work of a [`Transform`].
pub(super) struct Room {
    buffer: Vec<Complex>,
    scratch: Vec<Complex>,
    /// Spectra of the two records that share a transform.
    spectra: [Vec<Complex>; 2],
}

/// Samples on their way into a transform.
#[derive(Clone, Copy)]
pub(super) struct Record<'a> {
    samples: &'a [f64],
    /// What is subtracted from each sample.
    zero: f64,
    /// A power of two that brings the largest sample to between 1 and 2.
    scale: f64,
}

impl<'a> Record<'a> {
    /// The samples as they are.
    pub(super) fn of(samples: &'a [f64]) -> Self {
        Self::above(samples, 0.0)
    }

    /// The samples less their mean.
    pub(super) fn centred(samples: &'a [f64]) -> Self {
        Self::above(samples, sum(samples) / samples.len() as f64)
    }

    fn above(samples: &'a [f64], zero: f64) -> Self {
        let (low, high) = extent(samples);
        let largest = (high - zero).max(zero - low);
        // Beyond these exponents neither the power nor its inverse is a normal number; the scale of such a record then stays a little off, which does no harm.
        let exponent = if largest > 0.0 { largest.log2().floor().clamp(-1000.0, 1000.0) as i32 } else { 0 };
        Self { samples, zero, scale: 2.0_f64.powi(-exponent) }
    }
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
            transform.each(
                records.iter().map(|x| Record::of(x)),
                None,
                &mut transform.room(),
                |i, spectrum| {
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
                },
            );
            assert_eq!((count, transform.lines()), (3, n / 2 + 1));
        }
    }

    #[test]
    fn lengths_lose_a_thousandth_at_most() {
        // 20,001 = 3 · 59 · 113; nothing below 1,009 is within a thousandth of it but 1,008 = 2⁴ · 3² · 7.
        for (samples, quick) in [(20_001, 20_000), (8192, 8192), (1009, 1008), (997, 997), (0, 0)] {
            assert_eq!(quick_length(samples), quick);
        }
        assert_eq!([quick_length_from(2093, 8192), quick_length_from(13, 13)], [2100, 13]);
    }
}
