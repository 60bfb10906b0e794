//! Poles of free decays by subspaces: the eigensystem realization algorithm (J.-N. Juang, R. S. Pappa, J. Guidance 8:620, 1985) on the
//! products of its Hankel matrix (J.-N. Juang, J. E. Cooper, J. R. Wright, Control Theory Adv. Technol. 4:5, 1988), to which white noise adds
//! nothing but a multiple of the unit matrix.

use std::f64::consts::{PI, TAU};

use nalgebra::{Cholesky, DMatrix};
use rayon::prelude::*;

use super::chart::{Stabilisation, charted};
use crate::error::{Error, check, check_band};
use crate::measure::Channel;
use crate::number::Complex;
use crate::responses::common_length;

/// Largest number of combinations of channels; those of the most energy are taken. More rows in time tell close modes apart better than more
/// combinations than there are modes in a band.
const PATTERNS: usize = 16;
/// Largest number of rows of the Hankel matrix: its products cost the square of it, their eigenvectors the cube.
const ROWS: usize = 320;
/// Least number of rows for each order.
const ROWS_A_POLE: usize = 2;
/// Sampling rate after thinning over the band's upper edge: what folds back then lies above the band by more than the filter needs.
const RATE: f64 = 3.2;
/// Number of taps of the low-pass before thinning, for each sample that is kept, on either side. A Blackman window of that length falls by 70 dB within
/// RATE - 2 times the band's edge.
const TAPS: usize = 8;

/// The stabilisation chart of free decays, each a set of channels sampled together every `dt` seconds: poles between the edges (Hz) of
/// realizations of all even orders up to `highest`. Its candidates, given to [`Analysis::From`](crate::Analysis::From), lead to modes with shapes and standard
/// deviations.
///
/// # Errors
/// As [`free_responses`](crate::responses::free_responses); [`Error::OutOfRange`] for edges and order; [`Error::Refused`] for decays that are too
/// short for the order.
///
/// ```
/// use iwan_modal::measure::{Channel, Freedom};
/// let decay = (0..4096).map(|n| (-2e-4 * n as f64).exp() * (0.25 * n as f64).cos()).collect();
/// let tip = Channel { name: "tip".into(), freedom: Freedom::point("tip"), samples: decay };
/// let chart = iwan_modal::poles::subspace(&[vec![tip]], 1e-3, (20.0, 80.0), 12)?;
/// let pole = chart.candidates[0].pole;
/// assert!((pole.re + 0.2).abs() < 1e-6 && (pole.im - 250.0).abs() < 1e-6);
/// # Ok::<(), iwan_modal::Error>(())
/// ```
pub fn subspace(
    decays: &[Vec<Channel>],
    dt: f64,
    (low, high): (f64, f64),
    highest: usize,
) -> Result<Stabilisation, Error> {
    let samples = common_length(decays, dt)?;
    let nyquist = 0.5 / dt;
    check_band((low, high), high <= nyquist, format!("at most {nyquist} Hz"))?;
    let ok = (4..=ROWS / ROWS_A_POLE).contains(&highest);
    let allowed = format!("4 to {}", ROWS / ROWS_A_POLE);
    check("order", highest as f64, ok, allowed, "three times the number of modes is a good choice")?;
    let stride = ((1.0 / (RATE * high * dt)) as usize).max(1);
    let thinned: Vec<Vec<Vec<f64>>> = decays.iter().map(|d| thinned(d, stride, high * dt)).collect();
    let patterns = patterns(&thinned);
    let kept = thinned[0][0].len();
    let blocks = (ROWS / patterns.ncols()).min(kept / 4).max(2);
    if blocks * patterns.ncols() < ROWS_A_POLE * highest {
        let finding =
            format!("{samples} samples in the band to {high} Hz carry no realization of order {highest}");
        return Err(Error::refused("free decays", finding, "lower --order, or record longer"));
    }
    let shift = Shift::new(&products(&thinned, &patterns, blocks), patterns.ncols(), highest);
    let orders: Vec<usize> = (2..=highest).step_by(2).collect();
    let interval = stride as f64 * dt;
    let inside = |p: &Complex| p.im > 0.0 && (low..=high).contains(&(p.norm() / TAU));
    let poles = |n: &usize| -> Vec<Complex> {
        shift.eigenvalues(*n).into_iter().map(|z| z.ln() / interval).filter(inside).collect()
    };
    let found: Vec<Vec<Complex>> = orders.par_iter().map(poles).collect();
    Ok(charted(&orders, &found, 1.0 / (samples as f64 * dt)))
}

/// Every `stride`-th sample behind a low-pass that has no memory beyond its taps, so that its output is a sum of the same decays.
fn thinned(channels: &[Channel], stride: usize, edge: f64) -> Vec<Vec<f64>> {
    let reach = if stride == 1 { 0 } else { TAPS * stride };
    // Half way between the band's edge and what folds onto it: the Nyquist frequency after thinning.
    let cut = if stride == 1 { 0.5 } else { 0.5 / stride as f64 };
    let tap = |k: usize| {
        let x = k as f64 - reach as f64;
        let sinc = if x == 0.0 { 2.0 * cut } else { (TAU * cut * x).sin() / (PI * x) };
        let phase = PI * (x / (reach as f64 + 1.0) + 1.0);
        sinc * (0.42 - 0.5 * phase.cos() + 0.08 * (2.0 * phase).cos())
    };
    debug_assert!(edge <= cut);
    let taps: Vec<f64> = if reach == 0 { vec![1.0] } else { (0..=2 * reach).map(tap).collect() };
    let one = |channel: &Channel| {
        let mean = channel.samples.iter().sum::<f64>() / channel.samples.len() as f64;
        let places = (0..(channel.samples.len() + 1).saturating_sub(taps.len())).step_by(stride);
        let value =
            |n: usize| taps.iter().zip(&channel.samples[n..]).map(|(h, x)| h * (x - mean)).sum::<f64>();
        places.map(value).collect()
    };
    channels.par_iter().map(one).collect()
}

/// The combinations of the channels with the most energy, one in each column.
fn patterns(decays: &[Vec<Vec<f64>>]) -> DMatrix<f64> {
    let count = decays[0].len();
    let product = |i: usize, j: usize| -> f64 {
        decays.iter().map(|d| d[i].iter().zip(&d[j]).map(|(a, b)| a * b).sum::<f64>()).sum()
    };
    if count <= PATTERNS {
        return DMatrix::identity(count, count);
    }
    let eigen = DMatrix::from_fn(count, count, |i, j| product(i.min(j), i.max(j))).symmetric_eigen();
    let order = by_size(eigen.eigenvalues.as_slice());
    DMatrix::from_fn(count, PATTERNS, |i, j| eigen.eigenvectors[(i, order[j])])
}

/// Indices of the values in descending order.
fn by_size(values: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*b].total_cmp(&values[*a]));
    order
}

/// Sum of H Hᵀ over the Hankel matrices H of all decays, with `blocks` successive samples in each column.
fn products(decays: &[Vec<Vec<f64>>], patterns: &DMatrix<f64>, blocks: usize) -> DMatrix<f64> {
    let width = patterns.ncols();
    let side = blocks * width;
    let mut sum = DMatrix::zeros(side, side);
    for decay in decays {
        let samples = decay[0].len();
        let columns = samples + 1 - blocks;
        let channels = DMatrix::from_fn(samples, decay.len(), |n, c| decay[c][n]);
        let combined = channels * patterns;
        // Lag by lag: the product of two stretches differs from that one sample earlier by the sample that enters and the one that leaves.
        for lag in 0..blocks {
            let mut block = combined.rows(0, columns).tr_mul(&combined.rows(lag, columns));
            for i in 0..blocks - lag {
                if i > 0 {
                    let (enters, leaves) = (i + columns - 1, i - 1);
                    block += combined.row(enters).transpose() * combined.row(enters + lag);
                    block -= combined.row(leaves).transpose() * combined.row(leaves + lag);
                }
                let j = i + lag;
                let mut upper = sum.view_mut((i * width, j * width), (width, width));
                upper += &block;
                if lag > 0 {
                    let mut lower = sum.view_mut((j * width, i * width), (width, width));
                    lower += block.transpose();
                }
            }
        }
    }
    sum
}

/// The subspace of the signal, and its shift by one sample.
struct Shift {
    /// U₁ᵀ U₁ and U₁ᵀ U₂, where U₁ is the basis without its last block of rows and U₂ without its first; their leading parts serve all orders.
    own: DMatrix<f64>,
    cross: DMatrix<f64>,
}

impl Shift {
    fn new(products: &DMatrix<f64>, width: usize, highest: usize) -> Self {
        let eigen = products.clone().symmetric_eigen();
        let order = by_size(eigen.eigenvalues.as_slice());
        let side = products.nrows();
        let basis = DMatrix::from_fn(side, highest, |i, j| eigen.eigenvectors[(i, order[j])]);
        let (first, second) = (basis.rows(0, side - width), basis.rows(width, side - width));
        Self { own: first.tr_mul(&first), cross: first.tr_mul(&second) }
    }

    /// Eigenvalues of the realization of order `n`; an empty list where the subspace carries none.
    fn eigenvalues(&self, n: usize) -> Vec<Complex> {
        let own = self.own.view((0, 0), (n, n)).into_owned();
        let Some(factor) = Cholesky::new(own) else { return Vec::new() };
        let system = factor.solve(&self.cross.view((0, 0), (n, n)).into_owned());
        system.complex_eigenvalues().iter().copied().collect()
    }
}
