//! What a mode, and what modes outside the band, contribute to responses: columns of a real least-squares problem.

use nalgebra::DMatrix;
use rayon::prelude::*;

use super::band::Band;
use crate::number::{Complex, I, complex};

/// Complex terms for what lies outside the band: s^(d-2) times a cubic in frequency, d = 0, 1, 2 for displacement, velocity, acceleration.
/// The first is rigid motion and the modes below, the third the modes above; the other two take up what modes just outside the band
/// make of it.
pub(super) const OUTSIDE: usize = 4;

/// Columns of a set of poles in a band; weighted, real parts above imaginary parts.
pub(super) struct Columns {
    /// Number of poles.
    pub(super) poles: usize,
    /// Two for each pole (real and imaginary part of its residue), two for each term outside, then two for each pole with the slopes.
    pub(super) matrix: DMatrix<f64>,
}

impl Columns {
    /// Of `poles`, 1/s, upper half plane; `slopes` adds the derivatives with respect to the poles.
    pub(super) fn new(band: &Band, poles: &[Complex], slopes: bool) -> Self {
        let pairs: Vec<[Vec<Complex>; 2]> = poles.par_iter().map(|p| mode(band, *p)).collect();
        let outside = outside(band);
        let mut columns: Vec<&[Complex]> = Vec::new();
        let [mut values, mut derivatives] = [Vec::new(), Vec::new()];
        for [value, slope] in &pairs {
            values.push(value.as_slice());
            derivatives.push(slope.as_slice());
        }
        columns.extend(values);
        columns.extend(outside.iter().map(Vec::as_slice));
        if slopes {
            columns.extend(derivatives);
        }
        let (lines, n) = (band.lines(), poles.len());
        let mut matrix = DMatrix::zeros(2 * lines, 2 * columns.len());
        for (j, column) in columns.iter().enumerate() {
            let own = (n..n + OUTSIDE).contains(&j);
            for k in 0..lines {
                // A mode stands as what multiplies the residue and what multiplies its conjugate; a term outside has no conjugate.
                let (x, conjugate) =
                    if own { (column[k], complex(0.0, 0.0)) } else { (column[2 * k], column[2 * k + 1]) };
                let (re, im) = (x + conjugate, I * (x - conjugate));
                let w = band.weights[k];
                matrix[(k, 2 * j)] = w * re.re;
                matrix[(lines + k, 2 * j)] = w * re.im;
                matrix[(k, 2 * j + 1)] = w * im.re;
                matrix[(lines + k, 2 * j + 1)] = w * im.im;
            }
        }
        Self { poles: n, matrix }
    }

    /// Columns whose coefficients are sought: all but the slopes.
    pub(super) fn linear(&self) -> usize {
        2 * (self.poles + OUTSIDE)
    }
}

/// For each line what multiplies a residue and what multiplies its conjugate; and the slopes of both.
fn mode(band: &Band, pole: Complex) -> [Vec<Complex>; 2] {
    let count = 2 * band.lines();
    let (mut values, mut slopes) = (Vec::with_capacity(count), Vec::with_capacity(count));
    let record = band.responses.record.as_ref();
    let both = [pole, pole.conj()].map(|p| (p, record.map(|r| r.at(p))));
    for (k, s) in band.s.iter().enumerate() {
        for (p, at) in &both {
            let (value, slope) = if let Some(at) = at {
                at.value(band.first + k, *s, band.back[k])
            } else {
                let direct = (s - p).inv();
                (direct, direct * direct)
            };
            values.push(value);
            slopes.push(slope);
        }
    }
    [values, slopes]
}

fn outside(band: &Band) -> Vec<Vec<Complex>> {
    let (low, high) = band.edges();
    let top = band.s[band.lines() - 1].norm();
    let power = band.responses.motion.derivatives() - 2;
    let term = |degree: usize| {
        let at = |k: usize| {
            let x = (2.0 * band.frequency(k) - low - high) / (high - low);
            (band.s[k] / top).powi(power) * chebyshev(degree, x)
        };
        (0..band.lines()).map(at).collect()
    };
    (0..OUTSIDE).map(term).collect()
}

fn chebyshev(degree: usize, x: f64) -> f64 {
    (degree as f64 * x.clamp(-1.0, 1.0).acos()).cos()
}
