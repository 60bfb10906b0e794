//! A second component in the band of a mode: two modes next to each other, or a line that a smooth curve leaves.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, Matrix2, Vector2};
use rustfft::num_complex::Complex64;

use crate::error::Error;
use crate::signal::isolated::{Isolated, MAX_ORDER};
use crate::signal::spectrum::strongest_line;
use crate::signal::transients::Gate;
use crate::smooth::{Points, Polynomial, Smooth};

/// A second component is noted from this relative residual on, when one spectral line makes most of the residual: damping then beats by as much as the residual times
/// the ratio of beat to decay. A judgement.
const NOTED: f64 = 0.01;
/// From this relative residual on the record is refused: the instantaneous frequency of the sum is no longer that of a mode. A judgement.
const REFUSED: f64 = 0.1;
/// Least share of the residual's power in one line for it to be a component and not noise; a quarter and three quarters name the
/// same components in the records tried (second modes of 3 to 50 %).
const SHARE: f64 = 0.5;
/// Number of values of the slow amplitude (the complex amplitude relative to the reference frequency) in which two modes are looked for: sixteen a beat of modes that a spectrum
/// does not resolve, which beat eight times at most.
const VALUES: usize = 128;
/// Two linear modes must leave less than this fraction of what cubics through log amplitude and phase leave. Both have the same number of parameters; cubics follow one mode
/// whose frequency and damping depend on its amplitude.
const BETTER: f64 = 1.0 / 3.0;
/// Two linear modes must also leave less than this fraction of the whole slow amplitude: a record that neither they nor cubics describe is not judged here.
const LEFT: f64 = 0.1;
/// Least number of beats of the two modes in the window: with fewer, their sum is a curve like others.
const BEATS: f64 = 1.0;
/// The frequency of a sum of two modes goes up and down once a beat; that of one mode goes one way as it decays. So of two modes the smaller of the two excursions is at least
/// this fraction of the larger one. The test is needed at the knee of dry friction, which two modes describe better than cubics do: one of them dies away there before the
/// other has gone round it. Without it ten of forty records with a Jenkins element were taken for two modes, and five of forty with a cubic spring and quadratic damping. A
/// judgement.
const GOES_BACK: f64 = 0.25;

/// Two linear modes whose sum describes the slow amplitude of a record, the larger one first.
struct Pair {
    /// Complex amplitude of each mode at the first value.
    sizes: [Complex64; 2],
    /// Complex rate of each mode, 1/s: growth of ln A (real part) and of the phase (imaginary part, rad/s).
    rates: [Complex64; 2],
    /// Norms of what both modes leave and of what cubics leave, relative to the whole.
    left: [f64; 2],
}

impl Pair {
    /// Amplitude of the smaller mode over that of the larger at the start.
    fn relative(&self) -> f64 {
        self.sizes[1].norm() / self.sizes[0].norm()
    }
}

impl Isolated {
    /// Notes or refuses a second component: two modes next to each other, or a spectral line in what the smooth envelope leaves over.
    pub(in crate::signal) fn refuse_second_line(&mut self) -> Result<(), Error> {
        if let Some(pair) = self.pair().filter(|pair| pair.relative() > NOTED) {
            let [a, b] = pair.rates.map(|rate| self.band.peak + rate.im / TAU);
            let finding = format!(
                "two components at {a:.4} and {b:.4} Hz, the second {:.1} % of the first where they begin, leave {:.2} % of the record where one with smooth curves leaves {:.1} %: the \
                 envelope beats",
                100.0 * pair.relative(),
                100.0 * pair.left[0],
                100.0 * pair.left[1]
            );
            let remedy = "separate them by mode shapes (modal filter), or choose a window in which one of them has died away (--from)";
            return self.note_or_refuse(finding, pair.relative(), remedy);
        }
        let raw = &self.raw;
        let weight = vec![1.0; raw.t.len()];
        let fits = [&raw.log_amplitude, &raw.phase]
            .map(|y| Polynomial::fit(&self.points(&raw.t, y, &weight), None, MAX_ORDER));
        let left: Vec<_> = (0..raw.t.len())
            .map(|i| {
                let [log, phase] = [&fits[0], &fits[1]].map(|fit| fit.at(raw.t[i]).value);
                let ratio = Complex64::new(raw.log_amplitude[i] - log, raw.phase[i] - phase);
                ratio.exp() - 1.0
            })
            .collect();
        let rms = norm(&left) / (left.len() as f64).sqrt();
        let line = strongest_line(&left, raw.t[1] - raw.t[0]);
        // Where a line is there throughout, the residual is less than its amplitude; a larger residual is what a curve leaves where the mode has nearly gone.
        let size = rms.min(line.relative);
        if size < NOTED || line.share < SHARE {
            return Ok(());
        }
        let finding = format!(
            "a second component {:.3} Hz from {:.3} Hz is {:.1} % of the first: the envelope beats",
            line.offset.abs(),
            self.band.peak,
            100.0 * line.relative
        );
        let remedy = "narrow the band to one mode, or separate the modes by mode shapes (modal filter)";
        self.note_or_refuse(finding, size, remedy)
    }

    fn note_or_refuse(&mut self, finding: String, size: f64, remedy: &'static str) -> Result<(), Error> {
        if size < REFUSED {
            self.notes.push(finding);
            return Ok(());
        }
        Err(Error::Refused { finding, remedy })
    }

    /// The two linear modes that describe the slow amplitude much better than smooth curves do, by the matrix pencil (Y. Hua, T. K. Sarkar, IEEE Trans. Acoust. Speech Signal
    /// Process. 38:814, 1990, doi:10.1109/29.56027); none where there are no such modes.
    fn pair(&self) -> Option<Pair> {
        let raw = &self.raw;
        let length = raw.t.len().div_ceil(VALUES);
        let loudest = raw.log_amplitude.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let value = |i: usize| Complex64::from_polar((raw.log_amplitude[i] - loudest).exp(), raw.phase[i]);
        let z: Vec<Complex64> = (0..raw.t.len() / length)
            .map(|k| (k * length..(k + 1) * length).map(value).sum::<Complex64>() / length as f64)
            .collect();
        let poles = poles(&z)?;
        let powers = |n: usize| poles.map(|p| p.powu(n as u32));
        let mut normal = Matrix2::<Complex64>::zeros();
        let mut right = Vector2::<Complex64>::zeros();
        for (n, z) in z.iter().enumerate() {
            let row = powers(n);
            for i in 0..2 {
                right[i] += row[i].conj() * z;
                (0..2).for_each(|j| normal[(i, j)] += row[i].conj() * row[j]);
            }
        }
        let size = normal.try_inverse()? * right;
        let mode = |i: usize| (0..z.len()).map(|n| size[i] * powers(n)[i]).collect::<Vec<_>>();
        let modes = [mode(0), mode(1)];
        let whole = norm(&z);
        let left = |n: usize| z[n] - modes[0][n] - modes[1][n];
        let left = norm(&(0..z.len()).map(left).collect::<Vec<_>>()) / whole;
        let cubics = self.left_by_cubics(&z) / whole;
        let beats = (poles[0] / poles[1]).arg().abs() * z.len() as f64 / TAU;
        let sum: Vec<Complex64> = (0..z.len()).map(|n| modes[0][n] + modes[1][n]).collect();
        let quarter = ((0.25 * z.len() as f64 / beats.max(1.0)) as usize).max(1);
        let [back, forth] = back_and_forth(&sum, quarter);
        let found = left < BETTER * cubics && left < LEFT && beats > BEATS && back > GOES_BACK * forth;
        // Each value is the mean of a block of samples of the analytic signal; the amplitude at the start of the first block follows from it.
        let step = raw.t[1] - raw.t[0];
        let begin = |i: usize| {
            let block: Complex64 = (0..length).map(|k| poles[i].powf(k as f64 / length as f64)).sum();
            size[i] * loudest.exp() * length as f64 / block
        };
        let order = if norm(&modes[0]) < norm(&modes[1]) { [1, 0] } else { [0, 1] };
        found.then(|| Pair {
            sizes: order.map(begin),
            rates: order.map(|i| poles[i].ln() / (length as f64 * step)),
            left: [left, cubics],
        })
    }

    /// The smaller of the two linear modes that describe the slow amplitude, as it was before the filter: at all samples, with zeros before the start of the decay. None where
    /// there are no two modes.
    pub(in crate::signal) fn smaller_of_two(&self, gate: &Gate) -> Option<Vec<f64>> {
        let Pair { sizes: [_, size], rates: [_, rate], .. } = self.pair()?;
        let rate = rate + Complex64::new(0.0, TAU * self.band.peak);
        let passed = gate.filter.gain(rate.im / TAU).powi(2);
        // The phase of the slow amplitude is relative to the reference frequency, counted from the first sample of the record on.
        let first = self.raw.t[0];
        let size = size / passed * Complex64::from_polar(1.0, TAU * (self.band.peak * first).fract());
        let at = |n: usize| (size * (rate * (self.time(n) - first)).exp()).re;
        Some((0..self.samples.len()).map(|n| if n < gate.begin { 0.0 } else { at(n) }).collect())
    }

    /// Norm of what cubics through log amplitude and phase leave of the slow amplitudes `z`.
    fn left_by_cubics(&self, z: &[Complex64]) -> f64 {
        let t: Vec<f64> = (0..z.len()).map(|n| n as f64).collect();
        let weight: Vec<f64> = z.iter().map(Complex64::norm_sqr).collect();
        let log: Vec<f64> = z.iter().map(|z| z.norm().max(f64::MIN_POSITIVE).ln()).collect();
        let mut phase = vec![];
        for z in z {
            let last = phase.last().copied().unwrap_or(0.0);
            phase.push(z.arg() - TAU * ((z.arg() - last) / TAU).round());
        }
        let effective = self.effective(z.len());
        let [log, phase] = [&log, &phase]
            .map(|y| Polynomial::fit(&Points { t: &t, y, weight: &weight, effective }, Some(3), 3));
        let one = |n: usize| z[n] - Complex64::new(log.at(t[n]).value, phase.at(t[n]).value).exp();
        norm(&(0..z.len()).map(one).collect::<Vec<_>>())
    }
}

fn norm(z: &[Complex64]) -> f64 {
    z.iter().map(Complex64::norm_sqr).sum::<f64>().sqrt()
}

/// The smaller and the larger of the largest rise and the largest fall of the frequency of slow amplitudes `z`, taken as a running mean over `over` values.
fn back_and_forth(z: &[Complex64], over: usize) -> [f64; 2] {
    let mut phase = vec![0.0];
    for pair in z.windows(2) {
        phase.push(phase[phase.len() - 1] + (pair[1] * pair[0].conj()).arg());
    }
    let frequency: Vec<f64> = phase.windows(over + 1).map(|p| p[over] - p[0]).collect();
    let farthest = |sign: f64| {
        let (mut lowest, mut rise) = (f64::INFINITY, 0.0_f64);
        for f in frequency.iter().map(|f| sign * f) {
            lowest = lowest.min(f);
            rise = rise.max(f - lowest);
        }
        rise
    };
    let (up, down) = (farthest(1.0), farthest(-1.0));
    [up.min(down), up.max(down)]
}

/// The two poles of evenly spaced values: complex factors from one value to the next.
fn poles(z: &[Complex64]) -> Option<[Complex64; 2]> {
    let rows = z.len() / 2;
    let hankel = DMatrix::from_fn(rows, z.len() - rows, |i, j| z[i + j]);
    let left = hankel.svd(true, false).u?;
    let (above, below) = (left.view((0, 0), (rows - 1, 2)), left.view((1, 0), (rows - 1, 2)));
    let normal = above.adjoint() * above;
    let shift = normal.try_inverse()? * (above.adjoint() * below);
    let (half, product) = (0.5 * (shift[(0, 0)] + shift[(1, 1)]), shift.determinant());
    let root = (half * half - product).sqrt();
    Some([half + root, half - root])
}
