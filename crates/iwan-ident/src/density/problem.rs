//! The linear least-squares problem behind the density.

use std::f64::consts::{PI, TAU};

use iwan_core::{Backbone, DensityPoint, Tabulated};
use nalgebra::{DMatrix, DVector};

use super::entries::Entry;
use super::free_form::{Evidence, FreeForm};
use crate::curves::straight_line;
use crate::error::Error;
use crate::search::solve_non_negative;

/// Points of the density in a factor of ten: neighbours lie 18 % apart, closer than two features that curves of ring-downs could tell apart. The
/// regularisation keeps more points from showing more.
const PER_DECADE: f64 = 14.0;
/// Part of the smallest amplitude at which the density begins. Weaker sliders slip at every amplitude seen and add next to nothing to the
/// dissipation; with χ = -0.9 they would hold (1/300)^0.1 = 57 % of the softening, which goes into ω0.
const BELOW: f64 = 1.0 / 300.0;
/// Least weight of the regularisation relative to the curves' part of the problem, as a power of ten: the regularisation no longer acts.
const LEAST_WEIGHT: f64 = -10.0;
/// Largest weight, as a power of ten: the power law alone is left. Between the two lies the weight that the discrepancy principle asks for.
const MOST_WEIGHT: f64 = 4.0;
/// Halvings of the range between these two: 14 decades come down to 1.3e-8 of a decade.
const HALVINGS: usize = 30;
/// Mean squared residual over the least possible one that is accepted where noise does not explain the least: the smoothest density within a tenth of
/// the best is taken. A judgement.
const NEARLY: f64 = 1.1;
/// Part of the largest diagonal entry that is added to the diagonal, which keeps the problem definite: a few hundred times rounding, far below what
/// the curves say.
const RIDGE: f64 = 1e-13;
/// Least ratio of the largest to the smallest amplitude: a slope needs two ends. Below it the record is refused.
const APART: f64 = 1.2;
/// Least χ of the power law that the density is relative to.
const CHI_LOW: f64 = -0.9;
/// Largest χ of that power law. A slope beyond these two comes from noise or from another law; the density then bends away from the power law, at the
/// price of its roughness.
const CHI_HIGH: f64 = 0.5;
/// Unit of ω0² above its reference, as a part of ω², where the frequency does not change: any small number does, because it only scales an unknown.
const LEAST_SHIFT: f64 = 1e-6;
/// Factor on the standard deviations of the frequency where dissipation alone is to be matched: with a weight of 1e-8 of the usual one the frequency
/// decides nothing, and its unknown stays definite.
const IGNORED: f64 = 1e4;

/// The linear problem. The unknowns are the ratios of ρ to a power law at the strengths, the viscous damper, and ω0² above a reference.
pub(super) struct Problem<'a> {
    entries: &'a [Entry],
    strength: Vec<f64>,
    /// Density of the power law at the strengths.
    law: Vec<f64>,
    /// Value of 2 ζ_v ω0 (1/s) where the damper's unknown is 1.
    viscous: f64,
    /// A value of ω² below all measured ones, from which ω0² is counted.
    reference: f64,
    /// Unit in which ω0² is counted from there.
    shift: f64,
    informed: (f64, f64),
    evidence: Evidence,
    /// Residual = matrix x - right, in standard deviations: first the dissipations, then the squared frequencies.
    matrix: DMatrix<f64>,
    right: DVector<f64>,
}

/// The solution with a given regularisation.
pub(super) struct Regularised {
    x: DVector<f64>,
    /// Mean squared residual of the curves that are to be matched.
    mean_square: f64,
    /// Weight of the regularisation relative to the curves.
    weight: f64,
}

impl<'a> Problem<'a> {
    pub(super) fn new(entries: &'a [Entry], evidence: Evidence) -> Result<Self, Error> {
        let ends = |value: fn(&Entry) -> f64| {
            entries.iter().map(value).fold((f64::INFINITY, 0.0_f64), |e, v| (e.0.min(v), e.1.max(v)))
        };
        let informed = ends(|e| e.displacement);
        let points: Vec<(f64, f64)> =
            entries.iter().map(|e| (e.displacement.ln(), e.dissipation.ln())).collect();
        let line = straight_line(&points).filter(|_| informed.1 > APART * informed.0);
        let line = line.ok_or_else(|| Error::Refused {
            finding: format!("the amplitudes hardly differ: {:.4e} to {:.4e}", informed.0, informed.1),
            remedy: "record longer or at several force levels",
        })?;
        let strength = grid(informed);
        let law = power_law(&points, (line.slope - 3.0).clamp(CHI_LOW, CHI_HIGH), &strength);
        let omega = ends(|e| e.omega * e.omega);
        let shift = (omega.1 - omega.0).max(LEAST_SHIFT * omega.1);
        let smallest = entries.iter().map(|e| e.dissipation / (PI * e.omega * e.displacement.powi(2)));
        let viscous = smallest.fold(f64::INFINITY, f64::min);
        let (rows, columns) = (2 * entries.len(), strength.len() + 2);
        let mut problem = Self {
            entries,
            strength,
            law,
            viscous,
            reference: omega.0 - shift,
            shift,
            informed,
            evidence,
            matrix: DMatrix::zeros(rows, columns),
            right: DVector::zeros(rows),
        };
        problem.fill()?;
        Ok(problem)
    }

    /// Fills the rows of all entries.
    fn fill(&mut self) -> Result<(), Error> {
        let (n, count) = (self.entries.len(), self.strength.len());
        for j in 0..count {
            let hat = self.hat(j)?;
            for (i, e) in self.entries.iter().enumerate() {
                let softening = hat.initial_stiffness() - hat.harmonic_stiffness(e.displacement);
                self.matrix[(i, j)] = hat.dissipation(e.displacement) / (e.dissipation * e.log_sd);
                self.matrix[(n + i, j)] = -softening / self.deviation(e);
            }
        }
        for (i, e) in self.entries.iter().enumerate() {
            let lost = PI * self.viscous * e.omega * e.displacement.powi(2);
            let scale = self.deviation(e);
            self.matrix[(i, count)] = lost / (e.dissipation * e.log_sd);
            self.matrix[(n + i, count + 1)] = self.shift / scale;
            self.right[i] = 1.0 / e.log_sd;
            self.right[n + i] = (e.omega * e.omega - self.reference) / scale;
        }
        Ok(())
    }

    /// Standard deviation that ω² counts with.
    fn deviation(&self, e: &Entry) -> f64 {
        let factor = if self.evidence == Evidence::Both { 1.0 } else { IGNORED };
        2.0 * e.omega * e.omega_sd * factor
    }

    /// The law whose density is the power law's at point `j`, falls linearly to its neighbours and is zero beyond.
    fn hat(&self, j: usize) -> Result<Tabulated<[DensityPoint; 3]>, Error> {
        let ratio = self.strength[1] / self.strength[0];
        // The first and the last point have a neighbour on one side only: half a hat, without density beyond them.
        let last = self.strength.len() - 1;
        let (at, height) = (self.strength[j], self.law[j]);
        let strength = match j {
            0 => [at, at * ratio.sqrt(), at * ratio],
            _ if j == last => [at / ratio, at / ratio.sqrt(), at],
            _ => [at / ratio, at, at * ratio],
        };
        let share = (strength[1] - strength[0]) / (strength[2] - strength[0]);
        let density = match j {
            0 => [height, height * (1.0 - share), 0.0],
            _ if j == last => [0.0, height * share, height],
            _ => [0.0, height, 0.0],
        };
        Ok(Tabulated::new(&strength, &density, 0.0, [DensityPoint::default(); 3])?)
    }

    /// Sum of squared second differences of the ratios to the power law, as a quadratic form of the unknowns.
    fn roughness(&self) -> DMatrix<f64> {
        let size = self.matrix.ncols();
        let mut sum = DMatrix::zeros(size, size);
        for j in 1..self.strength.len() - 1 {
            for (a, p) in [(j - 1, 1.0), (j, -2.0), (j + 1, 1.0)] {
                for (b, q) in [(j - 1, 1.0), (j, -2.0), (j + 1, 1.0)] {
                    sum[(a, b)] += p * q;
                }
            }
        }
        sum
    }

    /// Mean squared residual of the curves that are to be matched.
    fn mean_square(&self, x: &DVector<f64>) -> f64 {
        let rows = if self.evidence == Evidence::Both { self.right.len() } else { self.entries.len() };
        let residual = &self.matrix * x - &self.right;
        residual.rows(0, rows).norm_squared() / rows as f64
    }

    /// The smoothest solution that explains the curves; none where the problem has no solution.
    pub(super) fn solve(&self) -> Option<Regularised> {
        let (normal, right) = (self.matrix.tr_mul(&self.matrix), self.matrix.tr_mul(&self.right));
        let roughness = self.roughness();
        let scale = normal.trace() / self.strength.len() as f64;
        let ridge = DMatrix::identity(normal.nrows(), normal.ncols()) * (RIDGE * normal.diagonal().max());
        let mut positive = vec![true; normal.nrows()];
        let mut at = |power: f64| {
            let weight = 10_f64.powf(power);
            let sum = &normal + &ridge + &roughness * (weight * scale);
            let x = solve_non_negative(&sum, &right, &mut positive)?;
            Some(Regularised { mean_square: self.mean_square(&x), x, weight })
        };
        let (mut low, mut high) = (LEAST_WEIGHT, MOST_WEIGHT);
        let mut best = at(low)?;
        let target = (NEARLY * best.mean_square).max(1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match at(middle) {
                Some(found) if found.mean_square <= target => (best, low) = (found, middle),
                _ => high = middle,
            }
        }
        Some(best)
    }

    pub(super) fn free_form(&self, solution: &Regularised) -> FreeForm {
        let x = &solution.x;
        let (n, count) = (self.entries.len(), self.strength.len());
        let omega0 = (self.reference + self.shift * x[count + 1]).sqrt();
        let residual = &self.matrix * x - &self.right;
        let (mut dissipation, mut frequency) = (0.0, 0.0);
        for (i, e) in self.entries.iter().enumerate() {
            dissipation += (1.0 + residual[i] * e.log_sd).max(f64::MIN_POSITIVE).ln().powi(2) / n as f64;
            frequency += (residual[n + i] * self.deviation(e) / (2.0 * e.omega * TAU)).powi(2) / n as f64;
        }
        FreeForm {
            density: self.law.iter().zip(x.iter()).map(|(law, ratio)| law * ratio).collect(),
            strength: self.strength.clone(),
            frequency: omega0 / TAU,
            damping_ratio: self.viscous * x[count] / (2.0 * omega0),
            informed: self.informed,
            mean_square: solution.mean_square,
            dissipation_misfit: dissipation.sqrt(),
            frequency_misfit: frequency.sqrt(),
            evidence: self.evidence,
            regularisation: solution.weight,
        }
    }
}

/// Strengths in geometric progression, from below the smallest amplitude to the largest.
fn grid((smallest, largest): (f64, f64)) -> Vec<f64> {
    let first = BELOW * smallest;
    let steps = ((largest / first).log10() * PER_DECADE).ceil();
    (0..=steps as usize).map(|i| first * (largest / first).powf(i as f64 / steps)).collect()
}

/// The power law R φ^χ at the strengths, through the mean of ln D: D = 4 R u^(χ+3) / ((χ+2)(χ+3)).
fn power_law(points: &[(f64, f64)], chi: f64, strength: &[f64]) -> Vec<f64> {
    let level = points.iter().map(|(u, d)| d - (chi + 3.0) * u).sum::<f64>() / points.len() as f64;
    let r = 0.25 * (chi + 2.0) * (chi + 3.0);
    strength.iter().map(|phi| r * (level + chi * phi.ln()).exp()).collect()
}
