//! How much wider intervals are where the model misses something.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::model::{Model, Squares};
use super::told::PLAUSIBLE;

/// Factors (at least one) by which correlated residuals widen the variance of each unknown in `free`.
///
/// A model that misses something leaves residuals that are alike throughout a stretch of a record. Each stretch then pulls the unknowns its own way, and how
/// far the pulls differ says how far other records of the same structure would move the unknowns. The covariance from clusters of residuals is that of
/// K.-Y. Liang and S. L. Zeger, Biometrika 73 (1986), 13–22; H. White, Econometrica 50 (1982), 1–25 shows that it holds for models that
/// are wrong. `variance` is that of the residuals in their unit, `clusters` are the stretches. Unknowns at a bound are held. All factors are one where there are
/// no derivatives or fewer than two clusters.
pub fn widening<M: Model + ?Sized>(
    model: &M,
    x: &[f64],
    free: &[usize],
    variance: f64,
    clusters: &[Range<usize>],
) -> Vec<f64> {
    let inside = |j: &usize| x[*j] > model.bounds()[*j].0 && x[*j] < model.bounds()[*j].1;
    let moving: Vec<usize> = free.iter().copied().filter(inside).collect();
    let mut residuals = vec![0.0; model.count()];
    let known = model.evaluate(x, &mut residuals, None);
    let of_moving = || {
        let jacobian = Squares(model).derivatives_at(x, &moving).filter(|_| known && clusters.len() > 1)?;
        let p = moving.len();
        let plausible = DMatrix::identity(p, p) * (variance / (PLAUSIBLE * PLAUSIBLE));
        let inverse = (jacobian.transpose() * &jacobian + plausible).try_inverse()?;
        let mut pulls = DMatrix::zeros(p, p);
        for cluster in clusters {
            let residuals = DVector::from_column_slice(&residuals[cluster.clone()]);
            let pull = jacobian.rows(cluster.start, cluster.len()).transpose() * residuals;
            pulls += &pull * pull.transpose();
        }
        let few = clusters.len() as f64 / (clusters.len() as f64 - 1.0);
        let wide = &inverse * pulls * &inverse * few;
        Some((0..p).map(|i| (wide[(i, i)] / (variance * inverse[(i, i)])).max(1.0)).collect::<Vec<_>>())
    };
    let found = of_moving().unwrap_or_else(|| vec![1.0; moving.len()]);
    let of = |j: &usize| moving.iter().position(|m| m == j).map_or(1.0, |at| found[at]);
    free.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::near;

    /// A model of a constant and of a slope along the numbers of the values.
    struct Line(Vec<f64>);

    impl Model for Line {
        fn bounds(&self) -> &[(f64, f64)] {
            &[(-9.0, 9.0), (-9.0, 9.0)]
        }

        fn count(&self) -> usize {
            self.0.len()
        }

        fn evaluate(&self, x: &[f64], residuals: &mut [f64], slopes: Option<&mut [Vec<f64>]>) -> bool {
            let at = |i: usize| i as f64 / self.0.len() as f64 - 0.5;
            for (i, y) in self.0.iter().enumerate() {
                residuals[i] = x[0] + x[1] * at(i) - y;
            }
            if let Some(slopes) = slopes {
                slopes[0].fill(1.0);
                slopes[1].iter_mut().enumerate().for_each(|(i, s)| *s = at(i));
            }
            true
        }
    }

    fn widened(values: Vec<f64>, clusters: usize) -> Vec<f64> {
        let length = values.len() / clusters;
        let model = Line(values);
        let found = near(&model, &[0.0; 2], &[0, 1], (20, 1e-12)).unwrap();
        let variance = found.cost / (model.count() - 2) as f64;
        let clusters: Vec<_> = (0..clusters).map(|k| k * length..(k + 1) * length).collect();
        widening(&model, &found.x, &[0, 1], variance, &clusters)
    }

    /// Offsets that blocks of 50 values share give the mean the variance of 20 values where 1,000 were counted: 50 times as much.
    #[test]
    fn residuals_that_blocks_share_count_once_for_each_block() {
        let offset =
            |block: usize| [1.0, -1.0, -1.0, 1.0, 1.0][block % 5] * (1.0 + 0.1 * (block as f64).cos());
        let shared = widened((0..1000).map(|i| offset(i / 50)).collect(), 20);
        assert!(shared.iter().all(|f| (25.0..75.0).contains(f)), "{shared:?}");
        let alternating = widened((0..1000).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect(), 20);
        assert_eq!(alternating, [1.0, 1.0]);
        let one = widened((0..100).map(|i| offset(i / 5)).collect(), 1);
        assert_eq!(one, [1.0, 1.0]);
    }
}
