//! A density of sliders of any form, from the same curves as the four parameters.
//!
//! Dissipation per cycle and squared frequency are both linear in the density ρ(φ), in ω0² and in the viscous 2 ζ_v ω0:
//!
//! ```text
//! D(u)  = ∫ ρ(φ) D_φ(u) dφ + π (2 ζ_v ω0) ω u²
//! ω²(u) = ω0² - ∫ ρ(φ) [1 - K_1,φ(u)] dφ
//! ```
//!
//! with D_φ and K_1,φ of one Jenkins element of unit stiffness and strength φ (first-harmonic balance, as in [`predict`](crate::curve_fit::predict)).
//! ρ is taken as linear between points in geometric progression, and all unknowns as >= 0. A straight line through ln D over ln u gives a power law;
//! the regularisation makes the curvature (in ln φ) of the ratio of ρ to this law small: where the curves say nothing, the density goes on as a power
//! law.
//!
//! The regularisation follows the discrepancy principle (V. A. Morozov, 1966; P. C. Hansen, *Rank-Deficient and Discrete Ill-Posed Problems*, 1998,
//! ch. 7): the density is the smoothest one whose mean squared residual, in standard deviations of the curves, is 1. Where no density comes as near
//! as that, it is the smoothest one within 10 % of the least residual.

mod entries;
mod free_form;
mod problem;

use crate::curves::Curves;
use crate::error::Error;
use entries::{Entry, entries};
pub use free_form::{Evidence, FreeForm};
use problem::Problem;

/// Entries that are needed, because a power law, a damper and a frequency have four numbers. Fewer entries are refused.
const NEEDED: usize = 8;

/// The density that matches the curves of one or several force levels best, without an assumption about its form.
///
/// # Errors
/// [`Error::TooShort`] with fewer than eight entries of positive dissipation; [`Error::Refused`] when amplitudes hardly
/// differ or the least-squares problem cannot be solved.
///
/// ```
/// use iwan_core::{Backbone, FourParameter};
/// use iwan_ident::curves::{Curves, ForceAxis};
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let omega = |u: f64| ((124.0 * std::f64::consts::TAU).powi(2) - 4.45e4 + joint.harmonic_stiffness(u)).sqrt();
/// let u: Vec<f64> = (0..60).map(|i| 0.8 * joint.phi_max() * 0.93_f64.powi(i)).collect();
/// let curves = Curves {
///     t: (0..60).map(f64::from).collect(),
///     dissipation: u.iter().map(|&u| joint.dissipation(u)).collect(),
///     frequency: u.iter().map(|&u| omega(u) / std::f64::consts::TAU).collect(),
///     damping_ratio: vec![0.0; 60],
///     force: u.clone(),
///     axis: ForceAxis::Modal,
///     log_dissipation_sd: vec![0.0; 60],
///     frequency_sd: vec![0.0; 60],
///     independent: 60.0,
///     displacement: u,
/// };
/// let found = iwan_ident::density::density(&[curves], iwan_ident::density::Evidence::Both)?;
/// // ρ = R φ^χ in the range seen.
/// let phi = 0.1 * joint.phi_max();
/// assert!((found.at(phi) / (1274290.571 * phi.powf(-0.183)) - 1.0).abs() < 0.03);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn density(curves: &[Curves], evidence: Evidence) -> Result<FreeForm, Error> {
    let entries: Vec<Entry> = curves.iter().flat_map(entries).collect();
    if entries.len() < NEEDED {
        let (what, remedy) = ("entries with a positive dissipation", "record longer or louder");
        return Err(Error::TooShort { what, found: entries.len(), needed: NEEDED, remedy });
    }
    let problem = Problem::new(&entries, evidence)?;
    let solution = problem.solve().ok_or_else(|| Error::Refused {
        finding: "the least-squares problem of the density has no solution".into(),
        remedy: "check the curves for outliers",
    })?;
    Ok(problem.free_form(&solution))
}
