//! Start values read off the curves, as in Sec. 2.5 (Eq. 12-14, Eq. 14 corrected).

use std::f64::consts::TAU;

use crate::curves::{Curves, straight_line};
use crate::error::Error;
use crate::parameters::Parameters;

/// Part of the range of ln force that counts as low force.
const LOW: f64 = 0.4;
/// β between which Eq. 14 is searched for a root.
const BETA: (f64, f64) = (1e-4, 1e3);

/// Start values and how they came about.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// The values.
    pub parameters: Parameters,
    /// Slope χ + 3 of ln D over ln force at low force, before it was brought into range.
    pub slope: f64,
    /// What was assumed, in words: no root of Eq. 14, a slope out of range, a knee that was not seen.
    pub notes: Vec<String>,
}

/// Graphical start values from curves on the modal force axis.
///
/// χ is the slope less 3 at low force (Eq. 12), less the viscous slope 2 it tends to; ω0 the highest frequency seen;
/// K_T = ω0² - ω_∞² (Eq. 13) with ω_∞ at the largest force; F_S the largest joint force (the knee, when macro-slip is
/// seen); β the root of Eq. 14 with K_x = ω0², the stiffness behind a modal force.
///
/// # Errors
/// [`Error::TooShort`] with fewer than eight entries of positive dissipation.
pub fn start(curves: &Curves) -> Result<Start, Error> {
    let usable = |i: &usize| curves.dissipation[*i] > 0.0 && curves.displacement[*i] > 0.0;
    let entries: Vec<usize> = (0..curves.t.len()).filter(usable).collect();
    if entries.len() < 8 {
        let remedy = "record longer or louder";
        return Err(Error::TooShort {
            what: "entries with a positive dissipation",
            found: entries.len(),
            needed: 8,
            remedy,
        });
    }
    let mut notes = Vec::new();
    let force = |i: usize| (TAU * curves.frequency[i]).powi(2) * curves.displacement[i];
    let points: Vec<(f64, f64)> =
        entries.iter().map(|&i| (force(i).ln(), curves.dissipation[i].ln())).collect();
    let ends = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |e, p| (e.0.min(p.0), e.1.max(p.0)));
    let low: Vec<_> = points.iter().copied().filter(|p| p.0 <= ends.0 + LOW * (ends.1 - ends.0)).collect();
    let (slope, intercept) = straight_line(&low).or_else(|| straight_line(&points)).unwrap_or((3.0, 0.0));
    let chi = (slope - 3.0).clamp(-0.9, 0.2);
    if chi != slope - 3.0 {
        notes.push(format!(
            "slope {slope:.3} of dissipation over force gives chi = {:.3}: {chi:.2} taken",
            slope - 3.0
        ));
    }
    let highest = entries.iter().map(|&i| curves.frequency[i]).fold(0.0, f64::max);
    let lowest = entries.iter().map(|&i| curves.frequency[i]).fold(f64::INFINITY, f64::min);
    let omega_squared = (TAU * highest).powi(2);
    let k_t = (omega_squared - (TAU * lowest).powi(2)).clamp(1e-5 * omega_squared, 0.9 * omega_squared);
    let top = entries.iter().map(|&i| curves.displacement[i]).fold(0.0, f64::max);
    let f_s = k_t * top;
    // Through the middle of the points with the slope χ + 3 that is used from here on.
    let middle =
        low.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0 / low.len() as f64, s.1 + p.1 / low.len() as f64));
    let intercept = if chi == slope - 3.0 { intercept } else { middle.1 - (chi + 3.0) * middle.0 };
    let beta = beta_root(intercept, omega_squared, k_t, f_s, chi).unwrap_or_else(|| {
        notes.push(format!(
            "Eq. 14 has no root beta between {} and {} for K_T = {k_t:.6}, F_S = {f_s:.6}, chi = {chi:.3}: 0.3 taken",
            BETA.0, BETA.1
        ));
        0.3
    });
    let damping_ratio = curves.damping_ratio.iter().copied().fold(f64::INFINITY, f64::min).max(0.0) * 0.3;
    let parameters =
        Parameters { frequency: highest, damping_ratio: damping_ratio.min(0.05), k_t, f_s, chi, beta };
    Ok(Start { parameters, slope, notes })
}

/// The root β of Eq. 14, corrected:
/// F_S^(χ+1) = 4 (χ+1) K_T^(χ+2) (β + c)^(χ+1) / (C K_x^(χ+3) (χ+2)(χ+3) (1+β)^(χ+2)) with c = (χ+1)/(χ+2) and ln C the
/// intercept of ln D over ln force; K_x turns displacement into that force. None without a root in 1e-4 .. 1e3.
#[must_use]
pub fn beta_root(intercept: f64, k_x: f64, k_t: f64, f_s: f64, chi: f64) -> Option<f64> {
    let c = (chi + 1.0) / (chi + 2.0);
    let miss = |log_beta: f64| {
        let beta = log_beta.exp();
        (4.0 * (chi + 1.0) / ((chi + 2.0) * (chi + 3.0))).ln()
            + (chi + 2.0) * k_t.ln()
            + (chi + 1.0) * (beta + c).ln()
            - intercept
            - (chi + 3.0) * k_x.ln()
            - (chi + 2.0) * (1.0 + beta).ln()
            - (chi + 1.0) * f_s.ln()
    };
    let (mut low, mut high) = (BETA.0.ln(), BETA.1.ln());
    let sign = miss(low).signum();
    if sign == miss(high).signum() {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if miss(middle).signum() == sign { low = middle } else { high = middle }
    }
    Some((0.5 * (low + high)).exp())
}

#[cfg(test)]
mod tests {
    use iwan_core::{Backbone, FourParameter};

    use super::*;

    #[test]
    fn eq_14_returns_beta_of_table_2() {
        // D = C f^(χ+3) at f = ω0² u exactly, in micro-slip.
        let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
        let k_x = (TAU * 124.0).powi(2);
        let u = 0.1 * joint.phi_max();
        let intercept = joint.dissipation(u).ln() - (-0.183 + 3.0) * (k_x * u).ln();
        let beta = beta_root(intercept, k_x, 4.45e4, 239.4, -0.183).unwrap();
        assert!((beta / 0.3 - 1.0).abs() < 1e-9, "{beta}");
        assert_eq!(beta_root(intercept - 30.0, k_x, 4.45e4, 239.4, -0.183), None);
    }
}
