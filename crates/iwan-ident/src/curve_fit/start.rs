//! Start values read off the curves, as in Sec. 2.5 (Eq. 12-14, Eq. 14 corrected).

use std::f64::consts::TAU;

use crate::curves::{Curves, Line, straight_line};
use crate::error::Error;
use crate::parameters::Parameters;

/// Entries of positive dissipation that are needed for a line at low force and a range of frequency. Fewer are refused.
const NEEDED: usize = 8;
/// Part of the range of ln force that counts as low force: it lies below the knee wherever there is one, and is long enough for a slope. A judgement,
/// for a start that the fit improves.
const LOW: f64 = 0.4;
/// Least χ of a start; a smaller one is raised to it, with a note. Measured joints lie between -0.9 and a little above 0.
const CHI_LOW: f64 = -0.9;
/// Largest χ of a start; a larger one is lowered to it, with a note. The slope of a viscous damper beside a joint looks like a χ a little above 0.
const CHI_HIGH: f64 = 0.2;
/// Least K_T over ω0² of a start, to which a smaller value is raised: the shift of a frequency that is known to five digits.
const LEAST_JOINT: f64 = 1e-5;
/// Largest K_T over ω0² of a start, so that K_∞ stays well positive.
const MOST_JOINT: f64 = 0.9;
/// Least β at which Eq. 14 is searched for a root: no Dirac for every purpose.
const BETA_LOW: f64 = 1e-4;
/// Largest β at which Eq. 14 is searched for a root: nothing but the Dirac.
const BETA_HIGH: f64 = 1e3;
/// β that is taken where Eq. 14 has no root: that of the paper's first mode (Table 2).
const BETA_WITHOUT_ROOT: f64 = 0.3;
/// Halvings of the range of ln β: the range of 16 comes down to 1e-17.
const HALVINGS: usize = 60;
/// ζ_v of a start over the smallest damping ratio of the curve: friction is never quite gone at the quiet end. A judgement, for a start.
const VISCOUS_SHARE: f64 = 0.3;
/// Largest ζ_v of a start: above 5 % there is no ring-down to speak of.
const MOST_VISCOUS: f64 = 0.05;

/// Start values and how they came about.
#[derive(Debug, Clone, PartialEq)]
pub struct Start {
    /// The start values.
    pub parameters: Parameters,
    /// Slope χ + 3 of ln D over ln force at low force, before it was brought into range.
    pub slope: f64,
    /// What was assumed, in words: no root of Eq. 14, a slope out of range, a knee that was not seen.
    pub notes: Vec<String>,
}

/// Graphical start values from curves on the modal force axis.
///
/// χ is the slope less 3 at low force (Eq. 12); ω0 the highest frequency seen;
/// K_T = ω0² - ω_∞² (Eq. 13) with ω_∞ at the lowest frequency seen; F_S is K_T times the largest displacement, which is the
/// knee when macro-slip is seen; β the root of Eq. 14 with K_x = ω0², the stiffness behind a modal force; ζ_v a part of the
/// smallest damping ratio.
///
/// # Errors
/// [`Error::TooShort`] with fewer than eight entries of positive dissipation.
pub fn start(curves: &Curves) -> Result<Start, Error> {
    let usable = |i: &usize| curves.dissipation[*i] > 0.0 && curves.displacement[*i] > 0.0;
    let entries: Vec<usize> = (0..curves.t.len()).filter(usable).collect();
    if entries.len() < NEEDED {
        let (what, remedy) = ("entries with a positive dissipation", "record longer or louder");
        return Err(Error::TooShort { what, found: entries.len(), needed: NEEDED, remedy });
    }
    let mut notes = Vec::new();
    let LowForce { slope, chi, intercept } = low_force(curves, &entries, &mut notes);
    let highest = entries.iter().map(|&i| curves.frequency[i]).fold(0.0, f64::max);
    let lowest = entries.iter().map(|&i| curves.frequency[i]).fold(f64::INFINITY, f64::min);
    let omega_squared = (TAU * highest).powi(2);
    let loss = omega_squared - (TAU * lowest).powi(2);
    let k_t = loss.clamp(LEAST_JOINT * omega_squared, MOST_JOINT * omega_squared);
    let top = entries.iter().map(|&i| curves.displacement[i]).fold(0.0, f64::max);
    let f_s = k_t * top;
    let beta = beta_root(intercept, omega_squared, k_t, f_s, chi).unwrap_or_else(|| {
        notes.push(format!(
            "Eq. 14 has no root beta between {BETA_LOW} and {BETA_HIGH} for K_T = {k_t:.6}, F_S = {f_s:.6}, chi = {chi:.3}: \
             {BETA_WITHOUT_ROOT} taken"
        ));
        BETA_WITHOUT_ROOT
    });
    let damping_ratio =
        curves.damping_ratio.iter().copied().fold(f64::INFINITY, f64::min).max(0.0) * VISCOUS_SHARE;
    let parameters = Parameters {
        frequency: highest,
        damping_ratio: damping_ratio.min(MOST_VISCOUS),
        k_t,
        f_s,
        chi,
        beta,
    };
    Ok(Start { parameters, slope, notes })
}

/// What the curve says at low force.
struct LowForce {
    /// Slope of ln D over ln force, as it was found.
    slope: f64,
    /// This slope less 3, brought into the range of a start.
    chi: f64,
    /// ln D at a force of 1 on the line of slope χ + 3.
    intercept: f64,
}

fn low_force(curves: &Curves, entries: &[usize], notes: &mut Vec<String>) -> LowForce {
    let force = |i: usize| (TAU * curves.frequency[i]).powi(2) * curves.displacement[i];
    let points: Vec<(f64, f64)> =
        entries.iter().map(|&i| (force(i).ln(), curves.dissipation[i].ln())).collect();
    let ends = points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |e, p| (e.0.min(p.0), e.1.max(p.0)));
    let low: Vec<_> = points.iter().copied().filter(|p| p.0 <= ends.0 + LOW * (ends.1 - ends.0)).collect();
    let Line { slope, intercept } =
        straight_line(&low).or_else(|| straight_line(&points)).unwrap_or(Line { slope: 3.0, intercept: 0.0 });
    let chi = (slope - 3.0).clamp(CHI_LOW, CHI_HIGH);
    if chi == slope - 3.0 {
        return LowForce { slope, chi, intercept };
    }
    notes.push(format!(
        "slope {slope:.3} of dissipation over force gives chi = {:.3}: {chi:.2} taken",
        slope - 3.0
    ));
    // The line through the middle of the points, with the slope χ + 3 that is used from here on.
    let middle =
        low.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0 / low.len() as f64, s.1 + p.1 / low.len() as f64));
    LowForce { slope, chi, intercept: middle.1 - (chi + 3.0) * middle.0 }
}

/// The root β of Eq. 14, corrected: F_S^(χ+1) = 4 (χ+1) K_T^(χ+2) (β + c)^(χ+1) / (C K_x^(χ+3) (χ+2)(χ+3) (1+β)^(χ+2)) with c = (χ+1)/(χ+2). ln C is
/// the `intercept` of ln D over ln force, and K_x the stiffness that turns displacement into this force. None where there is no root between 1e-4 and
/// 1e3.
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
    let (mut low, mut high) = (BETA_LOW.ln(), BETA_HIGH.ln());
    let sign = miss(low).signum();
    if sign == miss(high).signum() {
        return None;
    }
    for _ in 0..HALVINGS {
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
        // In micro-slip D = C f^(χ+3) holds exactly at f = ω0² u.
        let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3).unwrap();
        let k_x = (TAU * 124.0).powi(2);
        let u = 0.1 * joint.phi_max();
        let intercept = joint.dissipation(u).ln() - (-0.183 + 3.0) * (k_x * u).ln();
        let beta = beta_root(intercept, k_x, 4.45e4, 239.4, -0.183).unwrap();
        assert!((beta / 0.3 - 1.0).abs() < 1e-9, "{beta}");
        assert_eq!(beta_root(intercept - 30.0, k_x, 4.45e4, 239.4, -0.183), None);
    }
}
