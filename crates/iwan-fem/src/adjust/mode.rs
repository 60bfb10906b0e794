//! A stuck mode of an adjusted structure, with the quantities of its static curve and their derivatives.
//!
//! With the modal displacement q held, the slips follow from s + H N(s) = φ_s q, where H is the flexibility of the slips through all other
//! modes and N = F - K_T s. Eigenvectors change by dφ = Σ_i φ_i (φ_iᵀ dK φ)/(ω² - ω_i²) (R. L. Fox and M. P. Kapoor, AIAA J. 6:2426, 1968).

use super::adjusted::Adjusted;
use crate::error::Error;

/// Relative difference of ω² below which two modes count as one eigenspace: the derivative between them would be a quotient of rounding
/// errors, and is set to 0.
const SAME: f64 = 1e-9;

/// A stuck mode, its slips, and the flexibility of the slips through the other modes.
#[derive(Debug, Clone)]
pub struct AdjustedMode {
    pub(super) omega_squared: f64,
    /// φ at the slips.
    pub(super) shape: Vec<f64>,
    /// H, row by row.
    pub(super) flexibility: Vec<f64>,
    pub(super) perturbed: Vec<Perturbed>,
    pub(super) unknowns: usize,
}

/// Derivatives with respect to one logarithm of a stiffness.
#[derive(Debug, Clone)]
pub(super) struct Perturbed {
    pub(super) unknown: usize,
    pub(super) omega_squared: f64,
    pub(super) shape: Vec<f64>,
    pub(super) flexibility: Vec<f64>,
}

impl AdjustedMode {
    pub(super) fn new(adjusted: &Adjusted<'_>, r: usize, sign: f64) -> Self {
        let (values, slips) = (&adjusted.values, &adjusted.slips);
        let (n, count) = (values.len(), slips.len());
        let shape: Vec<f64> = slips.iter().map(|p| sign * p[r]).collect();
        let others = |i: &usize| *i != r;
        let entry = |a: usize, b: usize| {
            (0..n).filter(others).map(|i| slips[a][i] * slips[b][i] / values[i]).sum::<f64>()
        };
        let flexibility = (0..count * count).map(|e| entry(e / count, e % count)).collect();
        let perturbed = (0..adjusted.perturbations.len()).map(|p| Self::perturbed(adjusted, r, sign, p));
        let perturbed = perturbed.collect();
        Self { omega_squared: values[r], shape, flexibility, perturbed, unknowns: adjusted.unknowns() }
    }

    fn perturbed(adjusted: &Adjusted<'_>, r: usize, sign: f64, number: usize) -> Perturbed {
        let (values, slips, x) = (&adjusted.values, &adjusted.slips, &adjusted.perturbations[number]);
        let (n, count, own) = (values.len(), slips.len(), values[r]);
        let distinct = |i: &usize| *i != r && (values[*i] - own).abs() > SAME * own;
        let moved: Vec<f64> =
            (0..n).map(|i| if distinct(&i) { x[(i, r)] / (own - values[i]) } else { 0.0 }).collect();
        let shape: Vec<f64> =
            slips.iter().map(|p| sign * p.iter().zip(&moved).map(|(p, m)| p * m).sum::<f64>()).collect();
        // dG = -P W⁻¹ X W⁻¹ Pᵀ of all modes, minus the derivative of the mode's own part φφᵀ/ω².
        let weighted: Vec<Vec<f64>> =
            slips.iter().map(|p| p.iter().zip(values).map(|(p, w)| p / w).collect()).collect();
        let image = |a: usize| -> Vec<f64> {
            (0..n).map(|j| (0..n).map(|i| weighted[a][i] * x[(i, j)]).sum()).collect()
        };
        let images: Vec<Vec<f64>> = (0..count).map(image).collect();
        let omega_squared = x[(r, r)];
        let at = |a: usize| sign * slips[a][r];
        let entry = |a: usize, b: usize| {
            let all: f64 = images[a].iter().zip(&weighted[b]).map(|(x, p)| x * p).sum();
            let own_part =
                (shape[a] * at(b) + at(a) * shape[b]) / own - at(a) * at(b) * omega_squared / (own * own);
            -all - own_part
        };
        let flexibility = (0..count * count).map(|e| entry(e / count, e % count)).collect();
        Perturbed { unknown: adjusted.unknown_of(number), omega_squared, shape, flexibility }
    }

    /// ω0² of the stuck mode, 1/s².
    #[must_use]
    pub fn omega_squared(&self) -> f64 {
        self.omega_squared
    }

    /// Derivatives of ω0² with respect to the unknowns.
    #[must_use]
    pub fn omega_squared_by(&self) -> Vec<f64> {
        let mut by = vec![0.0; self.unknowns];
        self.perturbed.iter().for_each(|p| by[p.unknown] = p.omega_squared);
        by
    }

    /// Slips of the mode.
    #[must_use]
    pub fn shape(&self) -> &[f64] {
        &self.shape
    }
}

impl Adjusted<'_> {
    /// The stuck mode that resembles stuck mode `mode` of the structure as given most; the index counts all modes, zero modes included.
    ///
    /// # Errors
    /// [`Error::Analysis`] if there is no such elastic mode.
    pub fn mode(&self, mode: usize) -> Result<AdjustedMode, Error> {
        let k = self.adjustable.coordinate(mode)?;
        let like = |i: &usize| self.shapes[(k, *i)].abs();
        let found = (0..self.values.len()).max_by(|a, b| like(a).total_cmp(&like(b))).unwrap_or(k);
        // The shape keeps the sign that it has in the structure as given.
        let sign = if self.shapes[(k, found)] < 0.0 { -1.0 } else { 1.0 };
        Ok(AdjustedMode::new(self, found, sign))
    }
}
