//! Cross-validation: each law fitted without a stretch of amplitudes, and held against the curves there.

use nalgebra::{DMatrix, DVector};

use super::fit::{Fitted, Problem};
use super::mode::LawMode;
use super::slow::Rates;

/// Stretches into which the logarithms of the amplitudes are cut, each left out in turn: the lowest and the highest ask for extrapolation, the
/// middle one for interpolation.
const STRETCHES: usize = 3;
/// Amplitudes that a stretch needs: with fewer it says nothing that the fit does not.
const FEWEST: usize = 3;
/// Part of the largest singular value below which a direction of the curves in a stretch is not seen by the records.
const UNSEEN: f64 = 1e-9;

/// What a law misses of amplitudes that it was not fitted to: root mean squares over all stretches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeldOut {
    /// Of ln D.
    pub dissipation: f64,
    /// Of the frequency, Hz.
    pub frequency: f64,
}

/// The stretches of amplitudes by places on the grid, of those `seen`; none where records saw too few.
pub(super) fn stretches(seen: &[usize]) -> Vec<&[usize]> {
    if seen.len() < STRETCHES * FEWEST {
        return Vec::new();
    }
    (0..STRETCHES).map(|k| &seen[k * seen.len() / STRETCHES..(k + 1) * seen.len() / STRETCHES]).collect()
}

impl Problem<'_> {
    /// The law without each of the `stretches`, against the `smooth` curves at the places of the `cycles` in it; none where there are no stretches, or
    /// the law cannot be continued into one of them.
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

    /// The law fitted to what the records say beside the amplitudes of a stretch: its curves there may be any, so that their directions are
    /// taken out of all residuals.
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

/// Orthonormal directions that the columns of a matrix span.
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
