//! How large the discrepancies are: variance components by restricted maximum likelihood.
//!
//! Residuals at the best fit are r = J dx + Σ s_i Z_i u_i + e, with u and e of variance one, the derivatives J with respect to the sought parameters,
//! and the columns Z_i of component i. What J explains is projected out; the sizes s_i maximise the likelihood of what is left, and the variance of e
//! is profiled out (H. D. Patterson, R. Thompson, Biometrika 58:545, 1971). Where the residuals are white all sizes come out as zero or next to it.

use nalgebra::DVector;

use super::fields::Component;
use super::nested::{Nested, OfRecord};

/// Sizes that are tried first, in units of the processes' values: a thousandth of a per cent to 30 %. The search goes on from the best of them by
/// smaller steps (`STEP`).
const FIRST: [f64; 6] = [1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3];
/// Most rounds of the search over the logarithms of all sizes; a round without a better trial halves the step. Where they are spent the best trial so
/// far counts.
const ROUNDS: usize = 60;
/// First and last step of that search, in ln size: a size need not be known better than to a tenth.
const STEP: f64 = 1.2;
const LAST_STEP: f64 = 0.1;
/// Gain of the log likelihood below which a process is left out (its size becomes zero). Twice the gain by noise alone is zero for half of the
/// records and χ² with one degree of freedom for the others (S. G. Self, K.-Y. Liang, J. Am. Stat. Assoc. 82:605, 1987): it passes 4 in 2 records of
/// 100.
const GAIN: f64 = 2.0;

/// Smallest and largest size over which the mean size is taken, in units of the processes' values.
const MEAN_OVER: [f64; 2] = [1e-6, 1.0];
/// Steps between these two, equal in the logarithm: a factor of 1.4 each.
const MEAN_STEPS: usize = 40;

/// The likeliest sizes, and what follows from them.
pub(super) struct Likeliest {
    /// Size of each component, in units of its values.
    pub(super) sizes: Vec<f64>,
    /// What neither unknowns nor processes explain of each record's residuals.
    pub(super) unexplained: Vec<DVector<f64>>,
    /// How many values of the processes the residuals determine: the degrees of freedom that the processes take.
    pub(super) explained: f64,
    /// ln of the restricted likelihood, less the penalty on large sizes, up to a constant.
    pub(super) likelihood: f64,
}

/// The residuals and the processes, for sizes to be found.
pub(super) struct Sizing {
    nested: Nested,
    /// Number of components.
    count: usize,
    /// Degrees of freedom of the residuals.
    freedom: f64,
    /// Size of a process that is expected before the residuals are seen.
    typical: f64,
}

impl Sizing {
    /// For residuals with so many degrees of freedom.
    pub(super) fn new(records: &[OfRecord], components: &[Component], freedom: f64, typical: f64) -> Self {
        Self { nested: Nested::new(records, components), count: components.len(), freedom, typical }
    }

    /// ln of the restricted likelihood up to a constant, for sizes relative to the residuals' standard deviation; and this standard deviation.
    fn likelihood(&self, sizes: &[f64]) -> Option<(f64, f64)> {
        let (ln_determinant, square) = self.nested.ln_determinant_and_square(sizes)?;
        Some((-0.5 * (self.freedom * square.ln() + ln_determinant), (square / self.freedom).sqrt()))
    }

    fn score(&self, sizes: &[f64]) -> f64 {
        let Some((likelihood, deviation)) = self.likelihood(sizes) else { return f64::NEG_INFINITY };
        let prior: f64 = sizes.iter().map(|s| s * deviation / self.typical).sum();
        likelihood - prior
    }

    /// The sizes at which the restricted likelihood, with its penalty, is largest; zero for processes that add nothing.
    pub(super) fn sizes(&self) -> Option<Likeliest> {
        let relative = self.likeliest();
        let (_, deviation) = self.likelihood(&relative)?;
        Some(Likeliest {
            likelihood: self.score(&relative),
            sizes: relative.iter().map(|size| size * deviation).collect(),
            unexplained: self.nested.unexplained(&relative)?,
            explained: self.nested.explained(&relative)?,
        })
    }

    /// The mean of each size, weighted by its likelihood and by what is expected before the residuals are seen; the other sizes are held at their
    /// likeliest values.
    pub(super) fn expected_sizes(&self) -> Option<Vec<f64>> {
        let likeliest = self.likeliest();
        let (_, deviation) = self.likelihood(&likeliest)?;
        let [low, high] = MEAN_OVER.map(|size: f64| (size / deviation).ln());
        let trials: Vec<f64> =
            (0..=MEAN_STEPS).map(|k| (low + (high - low) * k as f64 / MEAN_STEPS as f64).exp()).collect();
        let one = |i: usize| {
            let score = |size: f64| {
                let mut sizes = likeliest.clone();
                sizes[i] = size;
                self.score(&sizes)
            };
            let scores: Vec<f64> = trials.iter().map(|t| score(*t)).collect();
            let top = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            // Equal steps of the logarithm are the longer the larger the size, hence the factor t.
            let weights = || trials.iter().zip(&scores).map(|(t, s)| (t, t * (s - top).exp()));
            let mean = weights().map(|(t, w)| t * w).sum::<f64>() / weights().map(|(_, w)| w).sum::<f64>();
            mean * deviation
        };
        let mean: Vec<f64> = (0..likeliest.len()).map(one).collect();
        mean.iter().all(|m| m.is_finite()).then_some(mean)
    }

    /// The likeliest sizes, relative to the residuals' standard deviation.
    fn likeliest(&self) -> Vec<f64> {
        let count = self.count;
        let score = |sizes: &[f64]| self.score(sizes);
        let none = vec![0.0; count];
        let deviation = self.likelihood(&none).map_or(1.0, |l| l.1);
        // All processes alike, and each process alone with the others next to nothing: what one process explains others explain in part, and the way
        // from one to another leads through less likely sizes.
        let size = |first: f64, own: Option<usize>| -> Vec<f64> {
            (0..count)
                .map(|i| if own.is_none_or(|own| own == i) { first } else { FIRST[0] } / deviation)
                .collect()
        };
        let alone = (0..count).filter(|_| count > 1).map(Some);
        let starts = std::iter::once(None).chain(alone).flat_map(|own| FIRST.map(|first| size(first, own)));
        let scored = starts.map(|sizes| (score(&sizes), sizes));
        let best = scored.max_by(|a, b| a.0.total_cmp(&b.0));
        let (mut top, mut best) = best.unwrap_or_else(|| (score(&none), none.clone()));
        let mut step = STEP;
        for _ in 0..ROUNDS {
            let before = top;
            for i in 0..count {
                for sign in [-1.0, 1.0] {
                    let mut other = best.clone();
                    other[i] *= (sign * step).exp();
                    let likelihood = score(&other);
                    if likelihood > top {
                        (best, top) = (other, likelihood);
                    }
                }
            }
            if top <= before {
                step *= 0.5;
            }
            if step < LAST_STEP {
                break;
            }
        }
        for i in 0..count {
            let mut without = best.clone();
            without[i] = 0.0;
            let likelihood = score(&without);
            if likelihood > top - GAIN {
                (best, top) = (without, likelihood);
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use iwan_core::SplitMix64;
    use nalgebra::DMatrix;

    use super::*;
    use crate::refine::fields::{Kind, Process};

    /// Residuals of variance one on six records of fifty rows, with two processes of six values of which the first has a size; and what they are found to be.
    fn found(size: f64) -> Likeliest {
        let mut random = SplitMix64::new(3);
        // The sum of twelve numbers from -1/2 to 1/2 is nearly normal, of variance one.
        let mut normal = || (0..12).map(|_| 0.5 * random.next_symmetric()).sum::<f64>();
        let mut matrix = |rows, columns| DMatrix::from_fn(rows, columns, |_, _| normal());
        let shared: Vec<_> = (0..6).map(|_| matrix(50, 6)).collect();
        let own: Vec<_> = (0..6).map(|_| matrix(50, 6)).collect();
        let values = matrix(6, 1);
        let one = |x: &DMatrix<f64>| OfRecord {
            r: (matrix(50, 1) + x * (&values * size)).column(0).into_owned(),
            own: matrix(50, 2),
            shared: matrix(50, 3),
        };
        let records: Vec<_> = shared.iter().map(one).collect();
        let all = Process { width: 6, records: (0..6).collect(), columns: shared };
        let alone = |(i, x)| Process { width: 6, records: vec![i], columns: vec![x] };
        let alone: Vec<_> = own.into_iter().enumerate().map(alone).collect();
        let component = |kind, processes| Component { kind, shift: 0.0, processes };
        let components = [component(Kind::Shared, vec![all]), component(Kind::OfRecord, alone)];
        // 300 rows less fifteen unknowns; no size is expected before.
        Sizing::new(&records, &components, 285.0, 1e3).sizes().unwrap()
    }

    #[test]
    fn the_size_of_a_process_is_found_and_white_residuals_have_none() {
        let white = found(0.0);
        assert!(
            white.sizes.iter().all(|size| *size == 0.0) && white.explained.abs() < 1e-6,
            "{:?}",
            white.sizes
        );
        // Six values tell a size to three tenths.
        for size in [0.3, 1.0, 5.0] {
            let Likeliest { sizes, explained, unexplained, .. } = found(size);
            assert!((sizes[0] / size).ln().abs() < 0.7 && sizes[1] == 0.0, "{size}: {sizes:?}");
            assert!(explained > 5.0 && explained < 6.0, "{size}: {explained}");
            let left: f64 = unexplained.iter().map(DVector::norm_squared).sum();
            assert!((left / (285.0 - explained)).ln().abs() < 0.2, "{size}: {left}");
        }
    }
}
