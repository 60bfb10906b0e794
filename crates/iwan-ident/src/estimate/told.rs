//! Which combinations of unknowns the data tell, and how certain a prediction is.

use nalgebra::{DMatrix, DVector};

use super::minimum::Found;
use super::model::{Model, Squares};
use crate::error::Error;

/// Standard deviation that is taken for granted of each unknown, in its own (logarithmic) unit: a factor of e^3.5 = 33 either way at
/// one standard deviation, of 1,100 at two, beyond which no engineer would call a value plausible. It keeps the uncertainty of unknowns that no residual feels
/// finite, and is no prior of the fit.
pub(super) const PLAUSIBLE: f64 = 3.5;

/// A direction in the space of the unknowns, with the accuracy to which the data determine it.
#[derive(Debug, Clone, PartialEq)]
pub struct Combination {
    /// Standard deviation along the direction; infinite where no residual feels it.
    pub deviation: f64,
    /// The direction, of length 1, as components of the unknowns that were free.
    pub direction: Vec<f64>,
}

/// What the data determine next to a minimum, from the curvature there.
#[derive(Debug, Clone)]
pub struct Told {
    free: Vec<usize>,
    /// (JᵀJ/σ² + 1/plausible²)⁻¹.
    covariance: DMatrix<f64>,
    combinations: Vec<Combination>,
}

/// The unknowns that hardly change the residuals, by linearisation: moved through all plausible values they
/// change the sum of squares by less than one standard deviation's worth. A search may hold them without loss.
///
/// # Errors
/// [`Error::Refused`] where there are no derivatives.
pub fn silent<M: Model + ?Sized>(model: &M, x: &[f64], variance: f64) -> Result<Vec<usize>, Error> {
    let all: Vec<usize> = (0..x.len()).collect();
    let jacobian = Squares(model).derivatives_at(x, &all).ok_or_else(|| Error::Refused {
        finding: "the values have no derivatives".into(),
        remedy: "leave out the largest amplitudes",
    })?;
    let moves = |j: &usize| 2.0 * PLAUSIBLE * jacobian.column(*j).norm() >= variance.sqrt();
    Ok(all.into_iter().filter(|j| !moves(j)).collect())
}

impl Told {
    /// About a minimum over the unknowns in `free`; `variance` is that of the residuals in their unit.
    ///
    /// # Errors
    /// [`Error::Refused`] where the minimum has no derivatives.
    pub fn about<M: Model + ?Sized>(
        model: &M,
        found: &Found,
        free: &[usize],
        variance: f64,
    ) -> Result<Self, Error> {
        let refused = || Error::Refused {
            finding: "the best values have no derivatives".into(),
            remedy: "leave out the largest amplitudes",
        };
        let jacobian = Squares(model).derivatives_at(&found.x, free).ok_or_else(refused)?;
        let square = jacobian.transpose() * &jacobian / variance.max(f64::MIN_POSITIVE);
        let eigen = square.clone().symmetric_eigen();
        let mut combinations: Vec<Combination> = eigen
            .eigenvalues
            .iter()
            .enumerate()
            .map(|(i, value)| Combination {
                deviation: if *value > 0.0 { value.sqrt().recip() } else { f64::INFINITY },
                direction: eigen.eigenvectors.column(i).iter().copied().collect(),
            })
            .collect();
        combinations.sort_by(|a, b| a.deviation.total_cmp(&b.deviation));
        let plausible = DMatrix::identity(free.len(), free.len()) / (PLAUSIBLE * PLAUSIBLE);
        let covariance = (square + plausible).try_inverse().ok_or_else(refused)?;
        Ok(Self { free: free.to_vec(), covariance, combinations })
    }

    /// Directions of the unknowns, the most certain first.
    #[must_use]
    pub fn combinations(&self) -> &[Combination] {
        &self.combinations
    }

    /// Standard deviation of a prediction whose derivatives with respect to all unknowns are `slopes`.
    #[must_use]
    pub fn deviation(&self, slopes: &[f64]) -> f64 {
        let slopes = self.of_free(slopes);
        (slopes.transpose() * &self.covariance * slopes)[0].max(0.0).sqrt()
    }

    /// Standard deviation of each free unknown.
    #[must_use]
    pub fn deviations(&self) -> Vec<f64> {
        self.covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect()
    }

    /// Standard deviations of the free unknowns once further residuals were measured whose derivatives with respect to all unknowns are
    /// `slopes[residual]`, each in units of its noise.
    #[must_use]
    pub fn deviations_with(&self, slopes: &[Vec<f64>]) -> Vec<f64> {
        // Kalman's update: C - C Aᵀ (A C Aᵀ + 1)⁻¹ A C.
        let rows: Vec<DVector<f64>> = slopes.iter().map(|s| self.of_free(s)).collect();
        let a = DMatrix::from_fn(rows.len(), self.free.len(), |i, j| rows[i][j]);
        let inner = &a * &self.covariance * a.transpose() + DMatrix::identity(rows.len(), rows.len());
        let Some(inverse) = inner.try_inverse() else { return self.deviations() };
        let gain = &self.covariance * a.transpose();
        let covariance = &self.covariance - &gain * inverse * gain.transpose();
        covariance.diagonal().iter().map(|v| v.max(0.0).sqrt()).collect()
    }

    fn of_free(&self, slopes: &[f64]) -> DVector<f64> {
        DVector::from_iterator(self.free.len(), self.free.iter().map(|j| slopes[*j]))
    }
}
