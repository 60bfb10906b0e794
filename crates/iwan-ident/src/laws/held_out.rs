//! Cross-validation: each law is fitted without a stretch of amplitudes, and compared with the curves there.

use nalgebra::{DMatrix, DVector};

use super::fit::{Fitted, Problem};
use super::mode::LawMode;
use super::slow::Rates;

/// Number of stretches into which the seen amplitudes are cut, equal in ln amplitude; each is left out in turn. The lowest and the highest stretch
/// ask for extrapolation, the middle one for interpolation.
const STRETCHES: usize = 3;
/// Amplitudes that a stretch needs: with fewer it says nothing that the fit does not. Records that saw too few amplitudes have no cross-validation.
const FEWEST: usize = 3;
/// Part of the largest singular value below which the records do not see a direction of the curves in a stretch.
const UNSEEN: f64 = 1e-9;

/// Misfit of a law at amplitudes to which it was not fitted: root mean squares over all stretches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// Misfit of ln D (D: dissipation per cycle).
    pub dissipation: f64,
    /// Misfit of the frequency, Hz.
    pub frequency: f64,
}

/// The stretches of the `seen` amplitudes, as indices on the grid; none where the records saw too few amplitudes.
pub(super) fn stretches(seen: &[usize]) -> Vec<&[usize]> {
    if seen.len() < STRETCHES * FEWEST {
        return Vec::new();
    }
    (0..STRETCHES).map(|k| &seen[k * seen.len() / STRETCHES..(k + 1) * seen.len() / STRETCHES]).collect()
}

impl Problem<'_> {
    /// The misfit of the law fitted without each of the `stretches` in turn, against the `smooth` curves at those of `cycles` (indices on the grid)
    /// that lie in the stretch. None where there are no stretches, or the law cannot be continued into one of them.
    pub(super) fn held_out(
        &self,
        fitted: &Fitted<'_>,
        stretches: &[&[usize]],
        smooth: &Rates,
        cycles: &[usize],
    ) -> Option<HeldOut> {
        let (mut dissipation, mut frequency, mut count) = (0.0, 0.0, 0.0);
        for stretch in stretches {
            let rates = self.without(fitted, stretch)?.rates(self.amplitudes).ok()?;
            for &i in cycles.iter().filter(|i| stretch.contains(i)) {
                let (law, own) = (rates[i], (smooth.decay[i], smooth.omega[i]));
                if law.decay <= 0.0 || own.0 <= 0.0 {
                    continue;
                }
                dissipation += (law.decay * law.omega / (own.0 * own.1)).ln().powi(2);
                frequency += ((law.omega - own.1) / std::f64::consts::TAU).powi(2);
                count += 1.0;
            }
        }
        let mean = |sum: f64| (sum / count).sqrt();
        (count > 0.0).then(|| HeldOut { dissipation: mean(dissipation), frequency: mean(frequency) })
    }

    /// The law fitted without what the records say about the amplitudes of a stretch: its curves may be anything there, so that the residuals'
    /// directions which they move are taken out.
    fn without(&self, fitted: &Fitted<'_>, stretch: &[usize]) -> Option<LawMode> {
        let whitener = fitted.whitener;
        let seen = whitener.matrix(&self.information.factor);
        let places: Vec<usize> = stretch.iter().flat_map(|i| [*i, *i + self.amplitudes.len()]).collect();
        let hidden = directions(&seen.select_columns(&places))?;
        let residuals = |x: &[f64], out: &mut [f64]| {
            let Some(residuals) = self.residuals(x) else { return false };
            let whole = whitener.vector(&residuals);
            let left: DVector<f64> = &whole - &hidden * (hidden.transpose() * &whole);
            out.copy_from_slice(left.as_slice());
            true
        };
        let found = self.likeliest_by(residuals, &fitted.at.x)?;
        self.scales.mode(self.terms, &found)
    }
}

/// Orthonormal directions that span the columns of a matrix.
fn directions(columns: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let svd = columns.clone().svd(true, false);
    let most = svd.singular_values.max();
    let known: Vec<usize> =
        (0..svd.singular_values.len()).filter(|&i| svd.singular_values[i] > UNSEEN * most).collect();
    Some(svd.u?.select_columns(&known))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thirds_hold_all_places_once_and_few_make_none() {
        let seen: Vec<usize> = (3..14).collect();
        let cut = stretches(&seen);
        assert_eq!(cut.concat(), seen);
        assert!(cut.iter().all(|s| s.len() >= FEWEST));
        assert!(stretches(&seen[..8]).is_empty());
    }

    #[test]
    fn directions_are_orthonormal_and_span_the_columns() {
        let columns =
            DMatrix::from_column_slice(4, 3, &[1.0, 2.0, 0.0, 1.0, 2.0, 4.0, 0.0, 2.0, 0.0, 1.0, 3.0, -1.0]);
        let found = directions(&columns).expect("directions");
        assert_eq!(found.ncols(), 2);
        assert!((found.transpose() * &found - DMatrix::identity(2, 2)).norm() < 1e-12);
        assert!((&found * (found.transpose() * &columns) - &columns).norm() < 1e-12);
    }
}
