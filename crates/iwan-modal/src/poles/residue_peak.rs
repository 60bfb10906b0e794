//! The strongest peak of the residuals of responses, and the pole under it.

use std::f64::consts::TAU;

use nalgebra::DMatrix;

use crate::fit::{Band, at};
use crate::number::{Complex, complex, median};

/// A peak is tried as a mode when it is at least this many times the median of the lines around it; the fit decides whether it is one.
const HEIGHT: f64 = 2.0;
/// Fraction of the band on either side over which that median is taken: a damped peak may be a good part of it wide.
const AROUND: f64 = 0.125;
/// The pole is found from the lines around the peak in which the composite is above this fraction of the peak.
const FOOT: f64 = 0.25;
/// Least number of such lines on either side.
const LEAST: usize = 4;
/// Largest number of such lines on either side.
const MOST: usize = 200;
/// Number of rounds in which lines are weighted by the inverse of their distance from the pole (C. Sanathanan, J. Koerner, IEEE Trans. Automatic Control 8:56, 1963).
const ROUNDS: usize = 6;

/// A peak of a composite response.
#[derive(Debug, Clone, Copy)]
pub(super) struct Peak {
    /// Pole, 1/s.
    pub(super) pole: Complex,
    /// Height over the median of the lines around it.
    pub(super) height: f64,
}

/// The strongest peak of `rest`, which is arranged as the band's values; lines near the frequencies in `passed` (Hz) are left out, and responses are weighted by their noise.
pub(super) fn strongest_peak(
    band: &Band,
    rest: &DMatrix<f64>,
    noise: &[f64],
    passed: &[f64],
) -> Option<Peak> {
    let lines = band.lines();
    let mut composite = vec![0.0; lines];
    for (column, variance) in rest.column_iter().zip(noise) {
        for (k, power) in composite.iter_mut().enumerate() {
            *power += complex(column[k], column[lines + k]).norm_sqr() / variance;
        }
    }
    for power in &mut composite {
        *power = power.sqrt();
    }
    let reach = (AROUND * lines as f64) as usize + 1;
    let around = |k: usize| median(&composite[k.saturating_sub(reach)..(k + reach + 1).min(lines)]);
    let free = |k: &usize| passed.iter().all(|f| (band.frequency(*k) - f).abs() > 2.5 * band.responses.step);
    let crest = |k: &usize| composite[*k] >= composite[k - 1] && composite[*k] >= composite[k + 1];
    let crests = (2..lines - 2).filter(crest).filter(free);
    let top = crests.max_by(|&a, &b| composite[a].total_cmp(&composite[b]))?;
    let height = composite[top] / around(top).max(f64::MIN_POSITIVE);
    if height < HEIGHT {
        return None;
    }
    let side = |towards: &mut dyn Iterator<Item = usize>| {
        towards.take_while(|&k| composite[k] > FOOT * composite[top]).count().clamp(LEAST, MOST)
    };
    let (left, right) = (side(&mut (0..top).rev()), side(&mut (top + 1..lines)));
    let (first, last) = (top.saturating_sub(left), (top + right).min(lines - 1));
    let pole = pole(band, rest, noise, (first, top, last))?;
    Some(Peak { pole, height })
}

/// One pole λ for all responses H, from s H = λ H + c0 + c1 s + c2 s², with another polynomial for each response.
fn pole(
    band: &Band,
    rest: &DMatrix<f64>,
    noise: &[f64],
    (first, top, last): (usize, usize, usize),
) -> Option<Complex> {
    let decay = band.responses.decay;
    let width = TAU * band.responses.step * (last - first) as f64;
    let mut pole = complex(-0.1 * width, band.s[top].im);
    for _ in 0..ROUNDS {
        let weight: Vec<f64> =
            (first..=last).map(|k| (band.s[k] - pole).norm().recip() / band.weights[k].max(1e-12)).collect();
        let basis = orthonormal(band, &weight, first);
        let (mut product, mut power) = (complex(0.0, 0.0), 0.0);
        for (c, variance) in noise.iter().enumerate() {
            let own: Vec<Complex> = (first..=last).map(|k| at(rest, k, c) * weight[k - first]).collect();
            let turned: Vec<Complex> =
                own.iter().enumerate().map(|(i, h)| h * (band.s[first + i] - band.s[top])).collect();
            let (own, turned) = (freed(own, &basis), freed(turned, &basis));
            product += own.iter().zip(&turned).map(|(a, b)| a.conj() * b).sum::<Complex>() / *variance;
            power += own.iter().map(Complex::norm_sqr).sum::<f64>() / variance;
        }
        pole = band.s[top] + product / power;
        if pole.re.is_nan() {
            return None;
        }
        pole.re = pole.re.min(decay - 1e-4 * width);
    }
    let inside = pole.im >= band.s[first].im && pole.im <= band.s[last].im;
    // The decay of an exponential window is no damping.
    let least = -1e-6 * pole.im;
    inside.then(|| complex(pole.re.min(least), pole.im))
}

/// Orthonormal basis of the weighted polynomials 1, x, x² over the lines.
fn orthonormal(band: &Band, weight: &[f64], first: usize) -> Vec<Vec<Complex>> {
    let (count, middle) = (weight.len(), first + weight.len() / 2);
    let scale = (band.s[first + count - 1] - band.s[first]).norm();
    let mut basis: Vec<Vec<Complex>> = Vec::new();
    for degree in 0..3 {
        let x = |i: usize| ((band.s[first + i] - band.s[middle]) / scale).powi(degree) * weight[i];
        let mut column = freed((0..count).map(x).collect(), &basis);
        let norm = column.iter().map(Complex::norm_sqr).sum::<f64>().sqrt();
        for v in &mut column {
            *v /= norm;
        }
        basis.push(column);
    }
    basis
}

/// A column without its part in the space of the basis.
fn freed(mut column: Vec<Complex>, basis: &[Vec<Complex>]) -> Vec<Complex> {
    for unit in basis {
        let part: Complex = unit.iter().zip(&column).map(|(u, x)| u.conj() * x).sum();
        column.iter_mut().zip(unit).for_each(|(x, u)| *x -= u * part);
    }
    column
}
