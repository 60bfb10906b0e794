//! The lines of frequency responses that a fit uses, weighted so that noise is equally large on all of them.

use nalgebra::DMatrix;

use super::outside::outside;
use crate::error::{Error, check_band};
use crate::number::{Complex, complex, median};
use crate::responses::{FrequencyResponses, laplace};

/// Least number of lines in a band: four for each of two modes, beside the residual terms. A band with fewer is refused.
const FEWEST: usize = 16;

/// Least standard deviation of a response's noise over the median of all: a channel that happens to be fitted too well must not decide the fit alone.
const QUIETEST: f64 = 1e-2;
/// Least standard deviation of the noise over a response's root mean square: rounding in double precision, with four decimal places to spare.
pub(super) const ROUNDING: f64 = 1e-12;

/// A band of lines of all responses.
pub(crate) struct Band<'a> {
    pub(crate) responses: &'a FrequencyResponses,
    /// First line.
    pub(crate) first: usize,
    /// Laplace variable of each line, 1/s.
    pub(crate) s: Vec<Complex>,
    /// e^(-s Δt) and e^(-s T) of each line; empty where the end of the record is not in the model.
    pub(crate) back: Vec<[Complex; 2]>,
    /// Weight of each line, at most 1.
    pub(crate) weights: Vec<f64>,
    /// Weighted responses, one column for each: real parts of all lines above the imaginary parts.
    pub(crate) values: DMatrix<f64>,
    /// Sum of squares of each column.
    pub(crate) squares: Vec<f64>,
    /// Columns of the terms for what lies outside the band, one after another; they are the same for all poles.
    pub(super) outside: Vec<f64>,
    /// Variance of each column's entries by the scatter of hits; 0 where it is not known.
    pub(crate) scatter: Vec<f64>,
}

impl<'a> Band<'a> {
    /// Lines from `low` to `high` Hz.
    pub(crate) fn new(responses: &'a FrequencyResponses, (low, high): (f64, f64)) -> Result<Self, Error> {
        let top = responses.frequency(responses.lines().saturating_sub(1));
        let allowed = format!("above 0 and below the highest line, {top} Hz");
        check_band((low, high), high <= top, allowed)?;
        let first = (low / responses.step).ceil().max(1.0) as usize;
        let last = (high / responses.step).floor() as usize;
        if last < first + FEWEST {
            let finding =
                format!("the band from {low} to {high} Hz holds {} lines", (last + 1).saturating_sub(first));
            return Err(Error::refused("modal fit", finding, "widen the band, or record longer"));
        }
        let lines = first..=last;
        let frequencies: Vec<f64> = lines.clone().map(|k| responses.frequency(k)).collect();
        let s: Vec<Complex> =
            lines.clone().map(|k| laplace(responses.frequency(k), responses.decay)).collect();
        let back = responses.record.iter().flat_map(|r| s.iter().map(|s| r.turns(-s))).collect();
        let strongest = responses.force.get(first..=last).into_iter().flatten().copied().fold(0.0, f64::max);
        let weight = |k: usize| if strongest > 0.0 { responses.force[k] / strongest } else { 1.0 };
        let weights: Vec<f64> = lines.map(weight).collect();
        let count = weights.len();
        let mut values = DMatrix::zeros(2 * count, responses.functions.len());
        for (mut column, function) in values.column_iter_mut().zip(&responses.functions) {
            for (k, (value, weight)) in function.values[first..=last].iter().zip(&weights).enumerate() {
                column[k] = value.re * weight;
                column[count + k] = value.im * weight;
            }
        }
        let scatter = responses.functions.iter().map(|f| {
            let parts = f.variance.get(first..=last).into_iter().flatten().zip(&weights);
            parts.map(|(v, w)| 0.5 * v * w * w).sum::<f64>() / count as f64
        });
        let scatter = scatter.collect();
        let outside = outside(&frequencies, &s, &weights, responses.motion.derivatives() - 2);
        let squares = values.column_iter().map(|c| c.norm_squared()).collect();
        Ok(Self { responses, first, s, back, weights, values, squares, outside, scatter })
    }

    /// Variance of each response's entries: by the scatter of hits, or the mean square of the response itself where the scatter is not known.
    pub(crate) fn noise(&self) -> Vec<f64> {
        let rows = self.values.nrows() as f64;
        let size = |c: usize| self.squares[c] / rows;
        let all = self.scatter.iter().all(|s| *s > 0.0);
        let own = |c: usize| if all { self.scatter[c].max(ROUNDING * ROUNDING * size(c)) } else { size(c) };
        floored((0..self.values.ncols()).map(own).collect())
    }

    /// Weighted value of a response at a line.
    pub(crate) fn value(&self, line: usize, response: usize) -> Complex {
        at(&self.values, line, response)
    }

    /// Number of lines.
    pub(crate) fn lines(&self) -> usize {
        self.s.len()
    }

    /// Frequency of a line of the band, Hz.
    pub(crate) fn frequency(&self, line: usize) -> f64 {
        self.responses.frequency(self.first + line)
    }

    /// Lowest and highest frequency of the band, Hz.
    pub(crate) fn edges(&self) -> (f64, f64) {
        (self.frequency(0), self.frequency(self.lines() - 1))
    }
}

/// Entry of a matrix in which real parts stand above imaginary parts.
pub(crate) fn at(values: &DMatrix<f64>, line: usize, column: usize) -> Complex {
    complex(values[(line, column)], values[(values.nrows() / 2 + line, column)])
}

/// Raises variances that lie far below the median of all.
pub(super) fn floored(mut noise: Vec<f64>) -> Vec<f64> {
    let least = (QUIETEST * QUIETEST * median(&noise)).max(f64::MIN_POSITIVE);
    for v in &mut noise {
        *v = v.max(least);
    }
    noise
}
