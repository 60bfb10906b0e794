//! Modal coordinates from a few displacements: the pseudo-inverse of the mode shapes (Deaner et al., Eq. 18).
//!
//! With all unknowns known, q = φᵀ M x is exact ([`Assembled::modal_output`]). With sensors at a few displacements only, the shapes there
//! may not distinguish all modes; rank and condition number of the filter tell how well they do.

use faer::Mat;

use super::linear::Modes;
use crate::algebra::{dot, thin_svd};
use crate::error::Error;
use crate::matrices::Assembled;

/// Singular values below this part of the largest count as zero, and the combinations of modes that belong to them are left out. Rounding
/// leaves 1e-15. Of the 50 modes of the paper's beam seen along z on its top face, the smallest singular value that counts is 3e-5, and the
/// other three are below this limit.
const RANK_TOLERANCE: f64 = 1e-9;

/// Modal filter q = Φ⁺ x for displacements (or accelerations) x at given degrees of freedom.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalFilter {
    /// Φ⁺ row by row, one row per mode.
    inverse: Vec<f64>,
    channels: usize,
    rank: usize,
    condition: f64,
}

impl Assembled {
    /// The filter that computes all `modes` from displacements; the degree of freedom of a node along an axis has the number 3 node + axis.
    ///
    /// # Errors
    /// [`Error::Analysis`] for no degrees of freedom, one that does not exist, or shapes that vanish at all of them.
    ///
    /// ```
    /// use iwan_fem::{Limit, mesh::beam::Configuration, paper};
    /// let assembled = paper::structure(Configuration::A, 1)?.assemble()?;
    /// let modes = assembled.modes(Limit::Stuck, 8)?;
    /// let filter = assembled.modal_filter(&modes, &(0..3 * 1554).collect::<Vec<_>>())?;
    /// let q = filter.apply(&assembled.displacements(modes.shape(6)));
    /// assert!((q[6] - 1.0).abs() < 1e-10 && q[7].abs() < 1e-10);
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn modal_filter(&self, modes: &Modes, degrees_of_freedom: &[usize]) -> Result<ModalFilter, Error> {
        let refused = |finding: String| {
            let remedy = "name displacements 3 node + axis of nodes that move in the modes";
            Error::Analysis { analysis: "modal filter", finding, remedy }
        };
        let all = 3 * self.structure().mesh.positions.len();
        if let Some(dof) = degrees_of_freedom.iter().find(|dof| **dof >= all) {
            return Err(refused(format!("degree of freedom {dof} does not exist: there are {all}")));
        }
        let shapes: Vec<Vec<f64>> = (0..modes.len()).map(|i| self.displacements(modes.shape(i))).collect();
        let matrix =
            Mat::from_fn(degrees_of_freedom.len(), modes.len(), |i, j| shapes[j][degrees_of_freedom[i]]);
        let (values, left, right) =
            thin_svd(&matrix).ok_or_else(|| refused("the shapes are not finite".into()))?;
        let largest = values.first().copied().unwrap_or(0.0);
        let rank = values.iter().take_while(|s| **s > RANK_TOLERANCE * largest).count();
        if rank == 0 {
            return Err(refused("no mode moves any of the degrees of freedom".into()));
        }
        let entry = |mode: usize, channel: usize| -> f64 {
            (0..rank).map(|k| right[(mode, k)] / values[k] * left[(channel, k)]).sum()
        };
        let channels = degrees_of_freedom.len();
        let inverse = (0..modes.len() * channels).map(|k| entry(k / channels, k % channels)).collect();
        Ok(ModalFilter { inverse, channels, rank, condition: largest / values[rank - 1] })
    }
}

impl ModalFilter {
    /// Number of modes that the displacements distinguish.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Condition number: largest over smallest non-zero singular value. Noise is amplified against the signal by at most this factor.
    #[must_use]
    pub fn condition(&self) -> f64 {
        self.condition
    }

    /// Modal coordinates of one sample.
    ///
    /// # Panics
    /// When `x` does not have one value per degree of freedom.
    #[must_use]
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        self.inverse.chunks_exact(self.channels).map(|row| dot(row, x)).collect()
    }
}
