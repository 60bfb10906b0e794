//! A density of sliders of any form, from the same curves as the four parameters.
//!
//! Dissipation per cycle and squared frequency are both linear in the density ρ(φ), in ω0² and in the viscous 2 ζ_v ω0:
//!
//! ```text
//! D(u)  = ∫ ρ(φ) D_φ(u) dφ + π (2 ζ_v ω0) ω u²
//! ω²(u) = ω0² - ∫ ρ(φ) [1 - K_1,φ(u)] dφ
//! ```
//!
//! with D_φ and K_1,φ of one Jenkins element of unit stiffness and strength φ (first-harmonic balance, as in
//! [`fit`](mod@crate::fit)). ρ is taken as linear between points in geometric progression, all unknowns as >= 0. A
//! straight line through ln D over ln u gives a power law; the curvature of ρ over that law (in ln φ) is what the
//! regularisation makes small: where the curves say nothing, the density goes on as a power law.
//!
//! Regularisation: the discrepancy principle (V. A. Morozov, 1966; P. C. Hansen, *Rank-Deficient and Discrete Ill-Posed
//! Problems*, 1998, ch. 7): the smoothest density whose mean squared residual, in standard deviations of the curves, is 1.
//! Where no density comes as near as that, the smoothest one within 10 % of the least residual there is.

mod problem;

use std::f64::consts::{PI, TAU};

use iwan_core::{Backbone, DensityPoint, Oscillator, ResidualStiffness, Tabulated};

use crate::curves::Curves;
use crate::error::Error;
use crate::verdict::Verdict;
use problem::Problem;

/// Least relative standard deviation of a dissipation and of a frequency: what averaging neglects, as in the fit.
const FLOORS: (f64, f64) = (5e-3, 1e-5);
/// Entries of one curve that are used, at most: neighbours say the same.
const ENTRIES: usize = 150;
/// Part of a curve that is left out at either end: smooth curves through records know only one side there.
const ENDS: f64 = 0.04;
/// A slope d ln ω/d ln u beyond this is noise.
const STEEPEST: f64 = 0.3;
/// Entries that are needed.
const NEEDED: usize = 8;
/// Mean squared residual up to which the curves count as explained.
const EXPLAINED: f64 = 2.0;

/// What the density is to match.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Evidence {
    /// Dissipation and frequency, each by its standard deviation.
    #[default]
    Both,
    /// Dissipation alone, which determines the density by itself: D'' = 4 u ρ(u). What frequency it predicts shows whether
    /// sliders explain both. Only ω0 is taken from the frequency.
    Dissipation,
}

/// A density of any form, and how well it matches the curves.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeForm {
    /// Strengths φ of the points, ascending, in the unit of displacement.
    pub strength: Vec<f64>,
    /// Density ρ >= 0 at the points, linear in between, in stiffness per displacement.
    pub density: Vec<f64>,
    /// Small-amplitude frequency, Hz: an extrapolation to amplitudes at which the weakest sliders stick.
    pub frequency: f64,
    /// Viscous damping ratio.
    pub damping_ratio: f64,
    /// Smallest and largest amplitude seen. Sliders stronger than the largest never slipped: their stiffness is part of
    /// K_∞. Of those weaker than the smallest only the slip force of all together is known.
    pub informed: (f64, f64),
    /// Mean squared residual in standard deviations of the curves, at least those that averaging neglects: 1 where the
    /// density explains the curves.
    pub mean_square: f64,
    /// Root-mean-square misfit of ln D.
    pub dissipation_misfit: f64,
    /// Root-mean-square misfit of the frequency, Hz.
    pub frequency_misfit: f64,
    /// What it was to match.
    pub evidence: Evidence,
    /// Weight of the regularisation relative to the curves.
    pub regularisation: f64,
}

/// An entry of a curve.
#[derive(Debug, Clone, Copy)]
struct Entry {
    displacement: f64,
    dissipation: f64,
    log_sd: f64,
    omega: f64,
    omega_sd: f64,
}

/// The density that matches the curves of one or several force levels best, without an assumption on its form.
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
    problem.solve().map(|(x, regularisation)| problem.free_form(&x, regularisation)).ok_or_else(|| {
        Error::Refused {
            finding: "the least-squares problem of the density has no solution".into(),
            remedy: "check the curves for outliers",
        }
    })
}

/// The usable entries of a curve, thinned.
///
/// Curves take the energy of a cycle from the velocity amplitude v = ω u (Eq. 7); where ω falls with u, v falls slower than
/// u does. The energy itself falls as the work of the force at the tips, (K_∞ + F(u)/u) u du, which is ω² u du but for
/// a hundredth of the softening: D of a cycle is that of the curves over 1 + d ln ω/d ln u.
fn entries(curves: &Curves) -> Vec<Entry> {
    let stride = curves.t.len().div_ceil(ENTRIES).max(1);
    let last = curves.t.len().saturating_sub(1);
    let log_ratio = |v: &[f64], i: usize| (v[(i + 1).min(last)] / v[i.saturating_sub(1)]).ln();
    let slope = |i: usize| {
        let slope = log_ratio(&curves.frequency, i) / log_ratio(&curves.displacement, i);
        if slope.abs() < STEEPEST { slope } else { 0.0 }
    };
    let entry = |i: usize| {
        let omega = TAU * curves.frequency[i];
        Entry {
            displacement: curves.displacement[i],
            dissipation: curves.dissipation[i] / (1.0 + slope(i)),
            log_sd: curves.log_dissipation_sd[i].max(FLOORS.0),
            omega,
            omega_sd: (TAU * curves.frequency_sd[i]).max(FLOORS.1 * omega),
        }
    };
    let usable = |e: &Entry| {
        let all = [e.displacement, e.dissipation, e.log_sd, e.omega, e.omega_sd];
        all.iter().all(|v| v.is_finite()) && e.displacement > 0.0 && e.dissipation > 0.0
    };
    let cut = (ENDS * curves.t.len() as f64) as usize;
    (cut..curves.t.len() - cut).step_by(stride).map(entry).filter(usable).collect()
}

impl FreeForm {
    /// Density at a strength: straight lines between the points, 0 outside.
    #[must_use]
    pub fn at(&self, strength: f64) -> f64 {
        let next = self.strength.partition_point(|s| *s <= strength);
        match next {
            0 => 0.0,
            n if n == self.strength.len() => {
                if strength == self.strength[n - 1] {
                    self.density[n - 1]
                } else {
                    0.0
                }
            }
            n => {
                let (a, b) = (self.strength[n - 1], self.strength[n]);
                self.density[n - 1] + (strength - a) / (b - a) * (self.density[n] - self.density[n - 1])
            }
        }
    }

    /// The joint that has this density: a law of iwan-core that every stepper runs, as a continuum or cut into sliders.
    ///
    /// # Errors
    /// [`Error::Model`] when the whole density is zero: the record needs no joint.
    pub fn law(&self) -> Result<Tabulated<Vec<DensityPoint>>, Error> {
        let points = vec![DensityPoint::default(); self.strength.len()];
        Ok(Tabulated::new(&self.strength, &self.density, 0.0, points)?)
    }

    /// The oscillator and the joint in it.
    ///
    /// # Errors
    /// [`Error::Model`] when the density is zero or takes more stiffness than ω0².
    pub fn model(&self) -> Result<(Oscillator, Tabulated<Vec<DensityPoint>>), Error> {
        let law = self.law()?;
        let k_t = law.initial_stiffness();
        let positive = ResidualStiffness::Positive;
        Ok((Oscillator::new(self.frequency, self.damping_ratio, k_t, positive)?, law))
    }

    /// Dissipation per cycle and frequency (Hz) at a displacement amplitude, as in [`predict`](crate::fit::predict).
    ///
    /// # Errors
    /// As [`model`](Self::model).
    pub fn predict(&self, displacement: f64) -> Result<(f64, f64), Error> {
        let (oscillator, law) = self.model()?;
        let omega = (oscillator.k_inf() + law.harmonic_stiffness(displacement)).sqrt();
        let viscous = PI * oscillator.viscous() * omega * displacement * displacement;
        Ok((law.dissipation(displacement) + viscous, omega / TAU))
    }

    /// What the free form says about the four-parameter one, in words and numbers.
    #[must_use]
    pub fn words(&self, four: &Verdict) -> String {
        let explains = self.mean_square < EXPLAINED;
        let verdict = match (self.evidence, explains) {
            (Evidence::Both, true) if four.adequate => "both forms match",
            (Evidence::Both, true) => {
                "a density of another form matches where the four-parameter one does not"
            }
            (Evidence::Both, false) if four.adequate => {
                "no density comes nearer: what is left over is not the form of the density"
            }
            (Evidence::Both, false) => {
                "no density of sliders matches dissipation and frequency together: what is missed is not the form of the \
                 density, but something that is no Iwan joint with a viscous damper"
            }
            (Evidence::Dissipation, _) => "this is the frequency that the dissipation asks for",
        };
        let what =
            if self.evidence == Evidence::Both { "to both curves" } else { "to the dissipation alone" };
        format!(
            "free-form density {what}: dissipation is missed by {:.2} % (four parameters fitted to the same curves: \
             {:.2} %), frequency by {:.4} Hz ({:.4} Hz); strengths from {:.4e} to {:.4e} are informed by the record: {verdict}",
            100.0 * self.dissipation_misfit,
            100.0 * four.dissipation_misfit,
            self.frequency_misfit,
            four.frequency_misfit,
            self.informed.0,
            self.informed.1
        )
    }
}
