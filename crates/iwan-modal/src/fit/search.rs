//! The search for the poles.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::band::{Band, ROUNDING, at, floored};
use super::certainty::Certainty;
use super::linear::Linear;
use crate::error::Error;
use crate::number::{Complex, complex};

/// Largest number of steps: from start values within a half-power bandwidth five to ten are enough.
const STEPS: usize = 40;
/// The search ends where no pole has more than this fraction of its decay left to move: a thousandth of what records usually tell.
const STILL: f64 = 1e-7;
/// Largest number of trials for a step, each with ten times the damping of Levenberg and Marquardt of the one before, and so shorter.
const TRIALS: usize = 12;
/// A step counts as no worse while the remaining sum of squares grows by no more than this fraction, which is rounding.
const NO_HIGHER: f64 = 1e-10;
/// The first search, whose remainder sets the weights of the responses for the second, ends where no pole has more than this fraction of its decay left to move: the weights are then
/// right to some 1e-7, and the second search goes on from there.
const FOR_WEIGHTS: f64 = 1e-4;
/// Largest number of steps of a search that only asks whether a mode is there.
const FEW: usize = 6;
/// Such a search ends where no pole has more than this fraction of its decay left to move, and so does one that asks for shapes to a thousandth.
const NEARLY_STILL: f64 = 1e-2;

/// Poles fitted to all responses of a band.
#[derive(Debug, Clone)]
pub struct Fitted {
    /// Poles in the upper half plane, 1/s, by ascending frequency.
    pub poles: Vec<nalgebra::Complex<f64>>,
    /// Residues, one row for each pole, one entry for each response: motion per force times 1/s.
    pub residues: Vec<Vec<nalgebra::Complex<f64>>>,
    /// Variance of each response's weighted real and imaginary parts: what the fit leaves, and no less than the scatter of hits.
    pub noise: Vec<f64>,
    /// Standard deviations of poles and residues.
    pub certainty: Certainty,
    /// Root mean square of the residuals of each response over that of the response, weighted as the fit was.
    pub left: Vec<f64>,
    /// First line of the band.
    pub first: usize,
    /// The fitted responses at the lines of the band, one list for each response.
    pub curves: Vec<Vec<nalgebra::Complex<f64>>>,
    /// Root mean square of the residuals of all responses together over that of the responses.
    pub misfit: f64,
}

/// Moves poles from `start` (upper half plane, 1/s) until the responses between the edges (Hz) are fitted best.
///
/// # Errors
/// [`Error::OutOfRange`] for the band; [`Error::Refused`] where the lines cannot tell the poles apart.
pub fn fit(
    responses: &crate::responses::FrequencyResponses,
    edges: (f64, f64),
    start: &[nalgebra::Complex<f64>],
) -> Result<Fitted, Error> {
    let band = Band::new(responses, edges)?;
    Fitted::new(&band, start)
}

impl Fitted {
    pub(crate) fn new(band: &Band, start: &[Complex]) -> Result<Self, Error> {
        let (fitted, linear) = Self::with_products(band, start)?;
        Ok(fitted.drawn(band, &linear.rest(band)))
    }

    /// The fit without its curves, and the least squares that it ends with.
    pub(crate) fn with_products(band: &Band, start: &[Complex]) -> Result<(Self, Linear), Error> {
        Self::searched(band, start, &[(STEPS, FOR_WEIGHTS), (STEPS, STILL)])
    }

    /// A fit to a hundredth of the poles' decays, without its curves.
    pub(crate) fn near(band: &Band, start: &[Complex]) -> Result<Self, Error> {
        Ok(Self::searched(band, start, &[(STEPS, NEARLY_STILL), (STEPS, NEARLY_STILL)])?.0)
    }

    /// A fit with few steps, near enough to tell whether a mode is there; `curves` stays empty.
    pub(crate) fn rough(band: &Band, start: &[Complex]) -> Result<(Self, Linear), Error> {
        Self::searched(band, start, &[(FEW, NEARLY_STILL)])
    }

    /// The fit with its curves; `rest` is what they leave of the responses.
    pub(crate) fn drawn(self, band: &Band, rest: &DMatrix<f64>) -> Self {
        Self { curves: curves(band, rest), ..self }
    }

    fn searched(band: &Band, start: &[Complex], rounds: &[(usize, f64)]) -> Result<(Self, Linear), Error> {
        let mut poles = start.to_vec();
        poles.sort_by(|a, b| a.im.total_cmp(&b.im));
        let mut linear = Linear::new(band, &poles, true)?;
        let mut noise = band.noise();
        let mut pace = 1.0;
        for (steps, still) in rounds {
            (poles, linear) = search(band, poles, linear, &noise, (*steps, *still), &mut pace)?;
            noise = left_over(band, &linear);
        }
        if !poles.is_sorted_by(|a, b| a.im <= b.im) {
            poles.sort_by(|a, b| a.im.total_cmp(&b.im));
            linear = Linear::new(band, &poles, true)?;
        }
        let size = |c: usize| band.squares[c].max(f64::MIN_POSITIVE);
        let (total, rest): (f64, f64) =
            linear.left.iter().enumerate().fold((0.0, 0.0), |(t, r), (c, l)| (t + size(c), r + l));
        let residues = |p: usize| (0..band.values.ncols()).map(|c| linear.residue(p, c)).collect();
        let fitted = Self {
            residues: (0..poles.len()).map(residues).collect(),
            left: linear.left.iter().enumerate().map(|(c, l)| (l / size(c)).sqrt()).collect(),
            first: band.first,
            curves: Vec::new(),
            misfit: (rest / total).sqrt(),
            certainty: Certainty::new(band, &poles, &linear, &noise),
            noise,
            poles,
        };
        Ok((fitted, linear))
    }
}

/// The fitted curve of each response at the lines of the band, without weights.
fn curves(band: &Band, rest: &DMatrix<f64>) -> Vec<Vec<Complex>> {
    let value = |k: usize, response: usize| {
        let weight = band.weights[k].max(f64::MIN_POSITIVE);
        (band.value(k, response) - at(rest, k, response)) / weight
    };
    let curve = |response: usize| (0..band.lines()).map(|k| value(k, response)).collect();
    (0..band.values.ncols()).map(curve).collect()
}

/// Variance of each response's entries: what the fit leaves, and no less than the scatter of hits.
pub(crate) fn left_over(band: &Band, linear: &Linear) -> Vec<f64> {
    let rows = band.values.nrows() as f64;
    let free = rows - linear.coefficients.nrows() as f64;
    let size = |c: usize| ROUNDING * ROUNDING * band.squares[c] / rows;
    let own = |c: usize| (linear.left[c] / free).max(band.scatter[c]).max(size(c));
    floored((0..band.values.ncols()).map(own).collect())
}

fn cost(linear: &Linear, precision: &[f64]) -> f64 {
    linear.left.iter().zip(precision).map(|(l, p)| l * p).sum()
}

/// Moves poles, with their least squares, to a smaller weighted sum of squares. `pace` is the largest move of the step before, relative to a pole's decay. Near its end the search
/// moves poles by a constant fraction of the step before; what is left is then the rest of a geometric series, and the search ends where that is small.
fn search(
    band: &Band,
    mut poles: Vec<Complex>,
    mut linear: Linear,
    noise: &[f64],
    (steps, still): (usize, f64),
    pace: &mut f64,
) -> Result<(Vec<Complex>, Linear), Error> {
    if poles.is_empty() {
        return Ok((poles, linear));
    }
    let precision: Vec<f64> = noise.iter().map(|v| v.recip()).collect();
    let mut damping = 1e-4;
    for _ in 0..steps {
        let Some(slopes) = &linear.slopes else { break };
        let (matrix, gradient) = slopes.normal(&linear, &precision);
        let before = cost(&linear, &precision);
        let mut better = None;
        for _ in 0..TRIALS {
            let Some(step) = step(&matrix, &gradient, damping) else {
                damping *= 10.0;
                continue;
            };
            let moved = moved(&poles, &step);
            let largest = furthest(&poles, &moved);
            let tried = match Linear::new(band, &moved, true) {
                Ok(tried) => tried,
                Err(lacking @ Error::Memory(_)) => return Err(lacking),
                // Where a step brings two poles onto each other, or one away from the lines, a shorter step is tried.
                Err(_) => {
                    damping *= 10.0;
                    continue;
                }
            };
            if cost(&tried, &precision) <= before * (1.0 + NO_HIGHER) {
                better = Some((moved, tried, largest));
                damping = (damping * 0.1).max(1e-12);
                break;
            }
            if largest < still {
                break;
            }
            damping *= 10.0;
        }
        let Some((next, found, largest)) = better else { break };
        (poles, linear) = (next, found);
        let ratio = largest / *pace;
        *pace = largest;
        if largest < still || (ratio < 1.0 && largest * ratio / (1.0 - ratio) < still) {
            break;
        }
    }
    Ok((poles, linear))
}

fn step(matrix: &DMatrix<f64>, gradient: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    let n = gradient.len();
    let scale: Vec<f64> = (0..n).map(|i| matrix[(i, i)].max(f64::MIN_POSITIVE).sqrt().recip()).collect();
    let damped = DMatrix::from_fn(n, n, |i, j| {
        matrix[(i, j)] * scale[i] * scale[j] + if i == j { damping } else { 0.0 }
    });
    let right = DVector::from_fn(n, |i, _| gradient[i] * scale[i]);
    let solved = Cholesky::new(damped)?.solve(&right);
    let step = DVector::from_fn(n, |i, _| solved[i] * scale[i]);
    step.iter().all(|x| x.is_finite()).then_some(step)
}

/// The poles after a step. None crosses an axis: in one step a pole loses at most nine tenths of its decay and half of its frequency.
fn moved(poles: &[Complex], step: &DVector<f64>) -> Vec<Complex> {
    let one = |(p, pole): (usize, &Complex)| {
        let re = (pole.re + step[2 * p]).min(0.1 * pole.re);
        let im = (pole.im + step[2 * p + 1]).max(0.5 * pole.im);
        complex(re, im)
    };
    poles.iter().enumerate().map(one).collect()
}

/// Largest move of any pole, relative to its decay.
fn furthest(from: &[Complex], to: &[Complex]) -> f64 {
    from.iter().zip(to).map(|(a, b)| (b - a).norm() / a.re.abs().max(1e-9 * a.norm())).fold(0.0, f64::max)
}
