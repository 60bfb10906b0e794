//! The structure with other joints and another stiffness, and its stuck modes.

use faer::Mat;
use iwan_core::FourParameter;

use super::adjustable::Adjustable;
use crate::algebra::{product, symmetric_eigen};
use crate::error::{Error, check};

/// An adjusted structure. The unknowns are, in this order, ln K_T, ln F_S, χ, β of the first group of slips, then of the next groups, then
/// the logarithms of the factors on the corrected parts of the stiffness.
#[derive(Debug)]
pub struct Adjusted<'a> {
    pub(super) adjustable: &'a Adjustable,
    /// Group of each slip; none for a slip that keeps its own law.
    pub(super) group: Vec<Option<usize>>,
    pub(super) laws: Vec<FourParameter>,
    /// ω² of the stuck modes.
    pub(super) values: Vec<f64>,
    /// Slips of the stuck modes, by slip and mode.
    pub(super) slips: Vec<Vec<f64>>,
    /// Φ by coordinate and mode.
    pub(super) shapes: Mat<f64>,
    /// Derivatives of the stiffness with respect to the logarithm of each K_T and of each factor, in the coordinates of the adjusted modes.
    pub(super) perturbations: Vec<Mat<f64>>,
}

impl Adjustable {
    /// The structure with other laws at groups of slips (indices into [`slips`](Self::slips)) and with these factors on the corrected
    /// parts.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a factor that is not > 0; [`Error::Analysis`] for lists of the wrong length, a slip in two groups, or an
    /// unstable structure.
    pub fn at(
        &self,
        groups: &[Vec<usize>],
        laws: &[FourParameter],
        factors: &[f64],
    ) -> Result<Adjusted<'_>, Error> {
        let failed = |finding: String| Error::Analysis {
            analysis: "adjusted structure",
            finding,
            remedy: "give one law for each group, one factor for each correction, and each slip once",
        };
        if laws.len() != groups.len() || factors.len() != self.corrections.len() {
            return Err(failed(format!(
                "{} laws for {} groups, {} factors",
                laws.len(),
                groups.len(),
                factors.len()
            )));
        }
        let mut group = vec![None; self.laws.len()];
        for (g, slips) in groups.iter().enumerate() {
            for &slip in slips {
                let place = group.get_mut(slip).filter(|place| place.is_none());
                *place.ok_or_else(|| failed(format!("slip {slip} is in two groups, or there is none")))? =
                    Some(g);
            }
        }
        for &factor in factors {
            check("factor on a stiffness", factor, factor > 0.0, "must be a finite number > 0")?;
        }
        let stiffness = self.stiffness(&group, laws, factors);
        let eigen = symmetric_eigen(&stiffness).filter(|eigen| eigen.values[0] > 0.0);
        let eigen = eigen.ok_or_else(|| failed("with these joints it is not stable".into()))?;
        let n = self.eigenvalues.len();
        let slip = |b: &Vec<f64>| -> Vec<f64> {
            (0..n).map(|i| (0..n).map(|k| b[k] * eigen.vectors[(k, i)]).sum()).collect()
        };
        let slips: Vec<Vec<f64>> = self.participation.iter().map(slip).collect();
        let mut perturbations: Vec<Mat<f64>> = Vec::new();
        for (g, law) in laws.iter().enumerate() {
            let members: Vec<&Vec<f64>> = groups[g].iter().map(|&s| &slips[s]).collect();
            let entry = |i: usize, j: usize| members.iter().map(|p| p[i] * p[j]).sum::<f64>();
            perturbations.push(Mat::from_fn(n, n, |i, j| law.k_t() * entry(i, j)));
        }
        for (part, factor) in self.corrections.iter().zip(factors) {
            let inner =
                product(product(eigen.vectors.transpose(), part.as_ref()).as_ref(), eigen.vectors.as_ref());
            perturbations.push(Mat::from_fn(n, n, |i, j| factor * inner[(i, j)]));
        }
        let laws = laws.to_vec();
        let (values, shapes) = (eigen.values, eigen.vectors);
        Ok(Adjusted { adjustable: self, group, laws, values, slips, shapes, perturbations })
    }

    fn stiffness(&self, group: &[Option<usize>], laws: &[FourParameter], factors: &[f64]) -> Mat<f64> {
        let n = self.eigenvalues.len();
        let mut stiffness = Mat::from_fn(n, n, |i, j| if i == j { self.eigenvalues[i] } else { 0.0 });
        for ((b, law), group) in self.participation.iter().zip(&self.laws).zip(group) {
            let Some(group) = group else { continue };
            let more = laws[*group].k_t() - law.initial_stiffness();
            for j in 0..n {
                (0..n).for_each(|i| stiffness[(i, j)] += more * b[i] * b[j]);
            }
        }
        for (part, factor) in self.corrections.iter().zip(factors) {
            for j in 0..n {
                (0..n).for_each(|i| stiffness[(i, j)] += (factor - 1.0) * part[(i, j)]);
            }
        }
        stiffness
    }
}

impl Adjusted<'_> {
    /// Number of unknowns.
    #[must_use]
    pub fn unknowns(&self) -> usize {
        4 * self.laws.len() + self.adjustable.corrections.len()
    }

    /// Index of the unknown to which the perturbation with this index belongs.
    pub(super) fn unknown_of(&self, perturbation: usize) -> usize {
        let groups = self.laws.len();
        if perturbation < groups { 4 * perturbation } else { 4 * groups + perturbation - groups }
    }
}
