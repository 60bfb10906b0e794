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

use std::f64::consts::{PI, TAU};

use iwan_core::{Backbone, DensityPoint, Oscillator, ResidualStiffness, Tabulated};
use nalgebra::{DMatrix, DVector};

use crate::curves::{Curves, straight_line};
use crate::error::Error;
use crate::fit::Fit;
use crate::non_negative::solve;

/// Points of the density in a factor of ten.
const PER_DECADE: f64 = 14.0;
/// The density begins at this part of the smallest amplitude: weaker sliders are part of the first points.
const BELOW: f64 = 1.0 / 300.0;
/// Least relative standard deviation of a dissipation and of a frequency: what averaging neglects, as in the fit.
const FLOORS: (f64, f64) = (5e-3, 1e-5);
/// Entries of one curve that are used, at most: neighbours say the same.
const ENTRIES: usize = 150;
/// Entries that are needed.
const NEEDED: usize = 8;
/// Range of the regularisation as powers of ten, relative to the curves' part of the problem.
const RANGE: (f64, f64) = (-10.0, 4.0);
/// Halvings of that range.
const HALVINGS: usize = 30;
/// Mean squared residual over the least there is, where noise does not explain the least.
const NEARLY: f64 = 1.1;
/// Mean squared residual up to which the curves count as explained.
const EXPLAINED: f64 = 2.0;
/// Part of the largest diagonal that keeps the problem definite: far below what the curves say.
const RIDGE: f64 = 1e-13;

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

/// Factor on the deviations of the frequency when dissipation alone is to be matched.
const IGNORED: f64 = 1e4;

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
fn entries(curves: &Curves) -> Vec<Entry> {
    let stride = curves.t.len().div_ceil(ENTRIES).max(1);
    let entry = |i: usize| {
        let omega = TAU * curves.frequency[i];
        Entry {
            displacement: curves.displacement[i],
            dissipation: curves.dissipation[i],
            log_sd: curves.log_dissipation_sd[i].max(FLOORS.0),
            omega,
            omega_sd: (TAU * curves.frequency_sd[i]).max(FLOORS.1 * omega),
        }
    };
    let usable = |e: &Entry| {
        let all = [e.displacement, e.dissipation, e.log_sd, e.omega, e.omega_sd];
        all.iter().all(|v| v.is_finite()) && e.displacement > 0.0 && e.dissipation > 0.0
    };
    (0..curves.t.len()).step_by(stride).map(entry).filter(usable).collect()
}

/// The linear problem: unknowns are the ratios of ρ to a power law, the viscous damper, and ω0² above a reference.
struct Problem<'a> {
    entries: &'a [Entry],
    strength: Vec<f64>,
    /// The power law at the strengths.
    law: Vec<f64>,
    /// Value of 2 ζ_v ω0 for an unknown of 1.
    viscous: f64,
    /// ω² below all others, and the value of ω0² - that for an unknown of 1.
    omega_squared: (f64, f64),
    informed: (f64, f64),
    evidence: Evidence,
    /// Residual = matrix x - right, in standard deviations: first dissipations, then frequencies.
    matrix: DMatrix<f64>,
    right: DVector<f64>,
}

impl<'a> Problem<'a> {
    fn new(entries: &'a [Entry], evidence: Evidence) -> Result<Self, Error> {
        let ends = |of: fn(&Entry) -> f64| {
            entries.iter().map(of).fold((f64::INFINITY, 0.0_f64), |e, v| (e.0.min(v), e.1.max(v)))
        };
        let informed = ends(|e| e.displacement);
        let points: Vec<(f64, f64)> =
            entries.iter().map(|e| (e.displacement.ln(), e.dissipation.ln())).collect();
        let line = straight_line(&points).filter(|_| informed.1 > 1.2 * informed.0);
        let (slope, _) = line.ok_or_else(|| Error::Refused {
            finding: format!("the amplitudes hardly differ: {:.4e} to {:.4e}", informed.0, informed.1),
            remedy: "record longer or at several force levels",
        })?;
        let strength = grid(informed);
        let law = power_law(&points, (slope - 3.0).clamp(-0.9, 0.5), &strength);
        let omega = ends(|e| e.omega * e.omega);
        let shift = (omega.1 - omega.0).max(1e-6 * omega.1);
        let smallest = entries.iter().map(|e| e.dissipation / (PI * e.omega * e.displacement.powi(2)));
        let viscous = smallest.fold(f64::INFINITY, f64::min);
        let (rows, columns) = (2 * entries.len(), strength.len() + 2);
        let mut problem = Self {
            entries,
            strength,
            law,
            viscous,
            omega_squared: (omega.0 - shift, shift),
            informed,
            evidence,
            matrix: DMatrix::zeros(rows, columns),
            right: DVector::zeros(rows),
        };
        problem.fill()?;
        Ok(problem)
    }

    /// The rows of all entries.
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
            self.matrix[(n + i, count + 1)] = self.omega_squared.1 / scale;
            self.right[i] = 1.0 / e.log_sd;
            self.right[n + i] = (e.omega * e.omega - self.omega_squared.0) / scale;
        }
        Ok(())
    }

    /// Standard deviation of ω², as it counts.
    fn deviation(&self, e: &Entry) -> f64 {
        let factor = if self.evidence == Evidence::Both { 1.0 } else { IGNORED };
        2.0 * e.omega * e.omega_sd * factor
    }

    /// The law whose density is the power law at one point, and zero at its neighbours.
    fn hat(&self, j: usize) -> Result<Tabulated<[DensityPoint; 3]>, Error> {
        let ratio = self.strength[1] / self.strength[0];
        // Beside the first and the last point stand none: half a hat, and next to nothing.
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

    /// Squared second differences of the ratios to the power law.
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

    /// Mean squared residual of what is to be matched.
    fn mean_square(&self, x: &DVector<f64>) -> f64 {
        let rows = if self.evidence == Evidence::Both { self.right.len() } else { self.entries.len() };
        let residual = &self.matrix * x - &self.right;
        residual.rows(0, rows).norm_squared() / rows as f64
    }

    /// The smoothest solution that explains the curves, and the weight of its smoothness.
    fn solve(&self) -> Option<(DVector<f64>, f64)> {
        let (normal, right) = (self.matrix.tr_mul(&self.matrix), self.matrix.tr_mul(&self.right));
        let roughness = self.roughness();
        let scale = normal.trace() / self.strength.len() as f64;
        let ridge = DMatrix::identity(normal.nrows(), normal.ncols()) * (RIDGE * normal.diagonal().max());
        let mut positive = vec![true; normal.nrows()];
        let mut at = |power: f64| {
            let weight = 10_f64.powf(power);
            let sum = &normal + &ridge + &roughness * (weight * scale);
            solve(&sum, &right, &mut positive).map(|x| (self.mean_square(&x), x, weight))
        };
        let (mut low, mut high) = RANGE;
        let mut best = at(low)?;
        let target = (NEARLY * best.0).max(1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match at(middle) {
                Some(found) if found.0 <= target => (best, low) = (found, middle),
                _ => high = middle,
            }
        }
        Some((best.1, best.2))
    }

    fn free_form(&self, x: &DVector<f64>, regularisation: f64) -> FreeForm {
        let (n, count) = (self.entries.len(), self.strength.len());
        let omega0 = (self.omega_squared.0 + self.omega_squared.1 * x[count + 1]).sqrt();
        let residual = &self.matrix * x - &self.right;
        let mut squares = (0.0, 0.0);
        for (i, e) in self.entries.iter().enumerate() {
            squares.0 += (1.0 + residual[i] * e.log_sd).max(f64::MIN_POSITIVE).ln().powi(2) / n as f64;
            squares.1 += (residual[n + i] * self.deviation(e) / (2.0 * e.omega * TAU)).powi(2) / n as f64;
        }
        FreeForm {
            density: self.law.iter().zip(x.iter()).map(|(law, ratio)| law * ratio).collect(),
            strength: self.strength.clone(),
            frequency: omega0 / TAU,
            damping_ratio: self.viscous * x[count] / (2.0 * omega0),
            informed: self.informed,
            mean_square: self.mean_square(x),
            dissipation_misfit: squares.0.sqrt(),
            frequency_misfit: squares.1.sqrt(),
            evidence: self.evidence,
            regularisation,
        }
    }
}

/// Strengths in geometric progression from below the smallest to the largest amplitude.
fn grid((smallest, largest): (f64, f64)) -> Vec<f64> {
    let first = BELOW * smallest;
    let steps = ((largest / first).log10() * PER_DECADE).ceil();
    (0..=steps as usize).map(|i| first * (largest / first).powf(i as f64 / steps)).collect()
}

/// The power law R φ^χ through the middle of the dissipations: D = 4 R u^(χ+3) / ((χ+2)(χ+3)).
fn power_law(points: &[(f64, f64)], chi: f64, strength: &[f64]) -> Vec<f64> {
    let level = points.iter().map(|(u, d)| d - (chi + 3.0) * u).sum::<f64>() / points.len() as f64;
    let r = 0.25 * (chi + 2.0) * (chi + 3.0);
    strength.iter().map(|phi| r * (level + chi * phi.ln()).exp()).collect()
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
    pub fn words(&self, four: &Fit) -> String {
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
            "free-form density {what}: dissipation is missed by {:.2} % (four-parameter {:.2} %), frequency by {:.4} Hz \
             (four-parameter {:.4} Hz); strengths from {:.4e} to {:.4e} are informed by the record: {verdict}",
            100.0 * self.dissipation_misfit,
            100.0 * four.dissipation_misfit,
            self.frequency_misfit,
            four.frequency_misfit,
            self.informed.0,
            self.informed.1
        )
    }
}
