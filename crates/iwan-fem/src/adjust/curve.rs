//! Frequency and dissipation of a mode at a modal displacement, with exact derivatives.

use std::f64::consts::PI;

use iwan_core::quadrature::Rule;

use super::adjusted::Adjusted;
use super::equilibrium::Equilibrium;
use super::mode::AdjustedMode;
use crate::error::{Error, check};

/// The stiffness from which the frequency of a curve is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stiffness {
    /// The first-harmonic stiffness of a closed loop, which a ring-down or a steady vibration shows.
    #[default]
    FirstHarmonic,
    /// The secant stiffness α/q of the virgin curve, which `iwan quasi-static` writes.
    Secant,
}

/// A point of a modal curve. Derivatives are with respect to the unknowns of [`Adjusted`].
#[derive(Debug, Clone, PartialEq)]
pub struct CurvePoint {
    /// Modal displacement.
    pub displacement: f64,
    /// ω², 1/s².
    pub omega_squared: f64,
    /// Derivatives of ω².
    pub omega_squared_by: Vec<f64>,
    /// Dissipation per cycle in the joints.
    pub dissipation: f64,
    /// Derivatives of the dissipation.
    pub dissipation_by: Vec<f64>,
    /// Slips at the modal displacement.
    pub slips: Vec<f64>,
}

/// Quadrature of the first harmonic, with the angle θ = π s². One panel leaves an error of 3e-12 for a four-parameter law in micro-slip; in
/// macro-slip the corner at φ_max leaves 1e-4 of the loss of stiffness.
const RULE: Rule<16> = Rule::gauss_legendre();

/// The modal force φ_sᵀ N, by which the joints' forces differ from stuck ones, and its derivatives.
struct Missing {
    force: f64,
    by: Vec<f64>,
}

impl AdjustedMode {
    /// The curve at modal displacements > 0, in ascending order.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a displacement that is not a finite number > 0; [`Error::Analysis`] if no static load holds the structure
    /// at the displacement.
    ///
    /// ```
    /// use iwan_fem::{Adjustable, Basis, Stiffness, mesh::beam::Configuration, paper};
    /// let assembled = paper::structure(Configuration::A, 1)?.assemble()?;
    /// let adjustable = Adjustable::new(&assembled.reduce(40, Basis::default())?, &[])?;
    /// let adjusted = adjustable.at(&[vec![0, 2]], &[paper::joint()?], &[])?;
    /// let point = &adjusted.mode(6)?.curve(&adjusted, &[1.989e-4], Stiffness::Secant)?[0];
    /// // The values agree with static loads on the structure itself.
    /// assert!((point.omega_squared.sqrt() / std::f64::consts::TAU - 132.2419).abs() < 0.01);
    /// assert!((point.dissipation / 4.726e-5 - 1.0).abs() < 0.01);
    /// // A larger slip force reduces slip.
    /// assert!(point.dissipation_by[1] < 0.0 && point.omega_squared_by[1] > 0.0);
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn curve(
        &self,
        adjusted: &Adjusted<'_>,
        displacements: &[f64],
        stiffness: Stiffness,
    ) -> Result<Vec<CurvePoint>, Error> {
        let one = |&q: &f64| {
            check("modal displacement", q, q > 0.0, "must be a finite number > 0")?;
            self.point(adjusted, q, stiffness).ok_or_else(|| Error::Analysis {
                analysis: "curves of an adjusted structure",
                finding: format!("no static load holds the modal displacement {q:.3e}"),
                remedy: "choose smaller displacements: the joints slide freely before",
            })
        };
        displacements.iter().map(one).collect()
    }

    fn point(&self, adjusted: &Adjusted<'_>, q: f64, stiffness: Stiffness) -> Option<CurvePoint> {
        let mut omega_squared = self.omega_squared;
        let mut omega_squared_by = self.omega_squared_by();
        let mut add = |missing: &Missing, weight: f64| {
            omega_squared += weight * missing.force;
            omega_squared_by.iter_mut().zip(&missing.by).for_each(|(sum, by)| *sum += weight * by);
        };
        let mut start: Option<(f64, Vec<f64>)> = None;
        let mut reach = |at: f64| {
            let begin = match &start {
                Some((before, slips)) => slips.iter().map(|s| s * at / before).collect(),
                None => self.shape.iter().map(|phi| phi * at).collect(),
            };
            let found = self.equilibrium(adjusted, at, begin)?;
            start = Some((at, found.slips.clone()));
            Some(found)
        };
        if stiffness == Stiffness::FirstHarmonic {
            // K_1 = -(4/πq) ∫ F(q sin²(θ/2)) cos θ dθ from 0 to π; the linear part of F gives ω0².
            for (node, weight) in nodes() {
                let theta = PI * node * node;
                let half = (0.5 * theta).sin();
                let at = q * half * half;
                let found = reach(at)?;
                let share = -4.0 / (PI * q) * weight * 2.0 * PI * node * theta.cos();
                add(&self.missing(adjusted, at, &found)?, share);
            }
        }
        let found = reach(q)?;
        if stiffness == Stiffness::Secant {
            add(&self.missing(adjusted, q, &found)?, 1.0 / q);
        }
        let (dissipation, dissipation_by) = self.dissipation(adjusted, q, &found)?;
        let slips = found.slips;
        Some(CurvePoint {
            displacement: q,
            omega_squared,
            omega_squared_by,
            dissipation,
            dissipation_by,
            slips,
        })
    }

    fn missing(&self, adjusted: &Adjusted<'_>, q: f64, at: &Equilibrium) -> Option<Missing> {
        let moved = self.slips_by(adjusted, q, at)?;
        let mut by = vec![0.0; self.unknowns];
        let mut force = 0.0;
        for (i, (phi, law)) in self.shape.iter().zip(&at.laws).enumerate() {
            force += phi * law.missing;
            for (unknown, by) in by.iter_mut().enumerate() {
                *by += phi * law.missing_slope * moved[i * self.unknowns + unknown];
            }
            if let Some(group) = adjusted.group[i] {
                (0..4).for_each(|p| by[4 * group + p] += phi * law.missing_by[p]);
            }
        }
        for p in &self.perturbed {
            by[p.unknown] += p.shape.iter().zip(&at.laws).map(|(phi, law)| phi * law.missing).sum::<f64>();
        }
        Some(Missing { force, by })
    }

    fn dissipation(&self, adjusted: &Adjusted<'_>, q: f64, at: &Equilibrium) -> Option<(f64, Vec<f64>)> {
        let moved = self.slips_by(adjusted, q, at)?;
        let mut by = vec![0.0; self.unknowns];
        for (i, law) in at.laws.iter().enumerate() {
            for (unknown, by) in by.iter_mut().enumerate() {
                *by += law.dissipation_slope * moved[i * self.unknowns + unknown];
            }
            if let Some(group) = adjusted.group[i] {
                (0..4).for_each(|p| by[4 * group + p] += law.dissipation_by[p]);
            }
        }
        Some((at.laws.iter().map(|law| law.dissipation).sum(), by))
    }
}

/// Nodes and weights between 0 and 1, ascending.
fn nodes() -> impl Iterator<Item = (f64, f64)> {
    RULE.nodes.iter().zip(&RULE.weights).map(|(x, w)| (0.5 + 0.5 * x, 0.5 * w))
}
