//! The slips of a mode at a given modal displacement, and their derivatives with respect to the unknowns.

use iwan_core::LawSlopes;

use super::adjusted::Adjusted;
use super::mode::AdjustedMode;
use crate::algebra::solve_small;

/// Residual of the slips' equilibrium, as a part of the largest slip, at which the iteration ends; it is close to rounding.
const SETTLED: f64 = 1e-13;
/// Largest number of steps of Newton's method, as for the curves of the structure itself. Up to 8 find the slips; if they do not suffice,
/// parts slide freely and there is no equilibrium.
const MOST_ROUNDS: usize = 60;
/// Largest number of halvings of a step: after 30 it is rounding.
const MOST_HALVINGS: usize = 30;

/// The slips in equilibrium, with their laws' values and derivatives at these slips.
pub(super) struct Equilibrium {
    pub(super) slips: Vec<f64>,
    /// Law of each slip; N and its derivatives have the sign of the slip.
    pub(super) laws: Vec<LawSlopes>,
}

/// The law of slip `i` at the slip `s`, of either sign.
fn law_at(adjusted: &Adjusted<'_>, i: usize, s: f64) -> LawSlopes {
    let u = s.abs();
    let mut slopes = if let Some(group) = adjusted.group[i] {
        adjusted.laws[group].slopes(u)
    } else {
        let law = &adjusted.adjustable.laws[i];
        let k = law.initial_stiffness();
        LawSlopes {
            missing: law.force(u) - k * u,
            missing_slope: law.tangent(u) - k,
            missing_by: [0.0; 4],
            dissipation: law.dissipation(u),
            // D = 8 G - 4 u F, so that dD/du = 4 (F - u K).
            dissipation_slope: 4.0 * (law.force(u) - u * law.tangent(u)),
            dissipation_by: [0.0; 4],
        }
    };
    if s < 0.0 {
        slopes.missing = -slopes.missing;
        slopes.missing_by = slopes.missing_by.map(|by| -by);
        slopes.dissipation_slope = -slopes.dissipation_slope;
    }
    slopes
}

impl AdjustedMode {
    /// Solves s + H N(s) = φ_s q by Newton's method from the slips `start`; none if no static load holds the parts.
    pub(super) fn equilibrium(
        &self,
        adjusted: &Adjusted<'_>,
        q: f64,
        start: Vec<f64>,
    ) -> Option<Equilibrium> {
        let n = self.shape.len();
        let size = self.shape.iter().fold(0.0_f64, |most, phi| most.max((phi * q).abs()));
        let evaluate = |slips: &[f64]| -> (Vec<LawSlopes>, Vec<f64>, f64) {
            let laws: Vec<LawSlopes> = (0..n).map(|i| law_at(adjusted, i, slips[i])).collect();
            let row = |i: usize| {
                let bent: f64 = (0..n).map(|j| self.flexibility[i * n + j] * laws[j].missing).sum();
                self.shape[i] * q - slips[i] - bent
            };
            let residual: Vec<f64> = (0..n).map(row).collect();
            let norm = residual.iter().map(|r| r * r).sum::<f64>().sqrt();
            (laws, residual, norm)
        };
        let mut slips = start;
        let (mut laws, mut residual, mut norm) = evaluate(&slips);
        for _ in 0..MOST_ROUNDS {
            if norm <= SETTLED * size {
                return Some(Equilibrium { slips, laws });
            }
            let mut step = residual.clone();
            if !solve_small(&mut self.matrix(&laws), &mut step, n, 1) {
                return None;
            }
            let mut length = 1.0;
            let better = (0..MOST_HALVINGS).find_map(|_| {
                let moved: Vec<f64> = (0..n).map(|i| slips[i] + length * step[i]).collect();
                length *= 0.5;
                let (laws, residual, shorter) = evaluate(&moved);
                (shorter < norm).then_some((moved, laws, residual, shorter))
            });
            // Where slips cancel in the sum, rounding leaves a residual that is some units larger than the tolerance.
            let Some(found) = better else {
                return (norm <= 100.0 * SETTLED * size).then_some(Equilibrium { slips, laws });
            };
            (slips, laws, residual, norm) = found;
        }
        None
    }

    /// The matrix I + H dN/ds.
    fn matrix(&self, laws: &[LawSlopes]) -> Vec<f64> {
        let n = laws.len();
        let mut matrix: Vec<f64> =
            (0..n * n).map(|e| self.flexibility[e] * laws[e % n].missing_slope).collect();
        (0..n).for_each(|i| matrix[i * n + i] += 1.0);
        matrix
    }

    /// Derivatives of the slips with respect to the unknowns, slip by slip, at the modal displacement `q`; none if the matrix of the
    /// equilibrium is singular.
    pub(super) fn slips_by(&self, adjusted: &Adjusted<'_>, q: f64, at: &Equilibrium) -> Option<Vec<f64>> {
        let (n, unknowns) = (self.shape.len(), self.unknowns);
        if unknowns == 0 {
            return Some(Vec::new());
        }
        let mut right = vec![0.0; n * unknowns];
        for p in &self.perturbed {
            for i in 0..n {
                let bent: f64 = (0..n).map(|j| p.flexibility[i * n + j] * at.laws[j].missing).sum();
                right[i * unknowns + p.unknown] += p.shape[i] * q - bent;
            }
        }
        for (j, group) in adjusted.group.iter().enumerate() {
            let Some(group) = group else { continue };
            for (parameter, by) in at.laws[j].missing_by.iter().enumerate() {
                for i in 0..n {
                    right[i * unknowns + 4 * group + parameter] -= self.flexibility[i * n + j] * by;
                }
            }
        }
        solve_small(&mut self.matrix(&at.laws), &mut right, n, unknowns).then_some(right)
    }
}
