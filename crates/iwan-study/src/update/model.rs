//! The structure's curves compared with the measured ones: residuals with exact derivatives.

use std::f64::consts::TAU;
use std::ops::Range;

use iwan_core::FourParameter;
use iwan_fem::{Adjustable, Adjusted, CurvePoint, Stiffness};
use iwan_ident::estimate::Model;

use super::measured::Point;

/// Ranges of χ and of β/(1+β): the same as in the modal identification.
const CHI_RANGE: (f64, f64) = (-0.99, 0.99);
const MOST_DIRAC: f64 = 0.999;
/// Unit of the coordinate of a damping ratio: a ratio of 0.1 % has the coordinate 1.
pub(super) const DAMPING_UNIT: f64 = 1e-3;
/// Largest viscous damping, in that unit: half of critical.
const MOST_DAMPING: f64 = 0.5 / DAMPING_UNIT;

/// A measured curve with the standard deviations of its points.
#[derive(Debug, Clone)]
pub(super) struct Curve {
    /// Number of the stuck mode among all modes.
    pub(super) mode: usize,
    /// Index of its viscous damping among those of the measured modes; none where the mode has none.
    pub(super) viscous: Option<usize>,
    pub(super) stiffness: Stiffness,
    pub(super) points: Vec<Point>,
    pub(super) frequency_sd: f64,
    pub(super) damping_sd: f64,
}

/// Frequency and damping of the structure at one point, with their derivatives with respect to the coordinates.
#[derive(Debug, Clone)]
pub(super) struct Said {
    pub(super) frequency: f64,
    pub(super) log_damping: f64,
    pub(super) frequency_by: Vec<f64>,
    pub(super) log_damping_by: Vec<f64>,
    /// Largest slip over φ_max of the joints of each group.
    pub(super) slip_ratios: Vec<f64>,
}

/// Structure, unknowns and curves.
#[derive(Debug, Clone)]
pub(super) struct Beside<'a> {
    pub(super) adjustable: &'a Adjustable,
    /// Indices of the slips of each group.
    pub(super) groups: Vec<Vec<usize>>,
    /// Standard deviation of the logarithm of each factor, where it is known beforehand.
    pub(super) priors: Vec<Option<f64>>,
    pub(super) curves: Vec<Curve>,
    pub(super) bounds: Vec<(f64, f64)>,
}

/// Coordinates of a law: ln K_T, ln F_S, χ, β/(1+β).
pub(super) fn coordinates(law: &FourParameter) -> [f64; 4] {
    let chi = law.chi().clamp(CHI_RANGE.0, CHI_RANGE.1);
    [law.k_t().ln(), law.f_s().ln(), chi, (law.beta() / (1.0 + law.beta())).min(MOST_DIRAC)]
}

/// The law of four coordinates.
pub(super) fn law(x: &[f64]) -> Option<FourParameter> {
    FourParameter::new(x[0].exp(), x[1].exp(), x[2], x[3] / (1.0 - x[3])).ok()
}

/// Lower and upper bounds of all coordinates.
pub(super) fn bounds(groups: usize, factors: usize, modes: usize) -> Vec<(f64, f64)> {
    const NONE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
    let of_law = [NONE, NONE, CHI_RANGE, (0.0, MOST_DIRAC)];
    let mut bounds = of_law.repeat(groups);
    bounds.extend(vec![NONE; factors]);
    bounds.extend(vec![(0.0, MOST_DAMPING); modes]);
    bounds
}

impl Beside<'_> {
    /// Index of the first factor among the coordinates.
    pub(super) fn first_factor(&self) -> usize {
        4 * self.groups.len()
    }

    /// Index of the first viscous damping among the coordinates.
    pub(super) fn first_viscous(&self) -> usize {
        self.first_factor() + self.priors.len()
    }

    /// The structure with the unknowns at these coordinates; none where they make no law.
    pub(super) fn adjusted(&self, x: &[f64]) -> Option<Adjusted<'_>> {
        let laws = x[..self.first_factor()].chunks_exact(4).map(law).collect::<Option<Vec<_>>>()?;
        let factors: Vec<f64> =
            x[self.first_factor()..self.first_viscous()].iter().map(|x| x.exp()).collect();
        self.adjustable.at(&self.groups, &laws, &factors).ok()
    }

    /// Frequency and damping that the structure gives a mode at ascending displacements; `viscous` is the index of the mode's damping, where it has
    /// one.
    pub(super) fn said(
        &self,
        adjusted: &Adjusted<'_>,
        x: &[f64],
        (mode, viscous, stiffness): (usize, Option<usize>, Stiffness),
        displacements: &[f64],
    ) -> Option<Vec<Said>> {
        let stuck = adjusted.mode(mode).ok()?;
        let points = stuck.curve(adjusted, displacements, stiffness).ok()?;
        let (own, own_by) = (stuck.omega_squared(), stuck.omega_squared_by());
        let place = viscous.map(|viscous| self.first_viscous() + viscous);
        let one = |point: &CurvePoint| {
            let (square, q) = (point.omega_squared, point.displacement);
            if square <= 0.0 {
                return None;
            }
            let omega = square.sqrt();
            let scale = 1.0 / (TAU * square * q * q);
            let ratio = place.map_or(0.0, |place| DAMPING_UNIT * x[place]);
            let viscous = ratio * (own / square).sqrt();
            let damping = point.dissipation * scale + viscous;
            let (mut frequency_by, mut log_by) = (vec![0.0; x.len()], vec![0.0; x.len()]);
            for (j, by) in point.omega_squared_by.iter().enumerate() {
                let inner = self.inner(x, j);
                frequency_by[j] = inner * by / (2.0 * omega * TAU);
                let of_viscous = 0.5 * viscous * (own_by[j] / own - by / square);
                let of_joints = scale * (point.dissipation_by[j] - point.dissipation * by / square);
                log_by[j] = inner * (of_joints + of_viscous) / damping;
            }
            if let Some(place) = place {
                log_by[place] = DAMPING_UNIT * (own / square).sqrt() / damping;
            }
            Some(Said {
                frequency: omega / TAU,
                log_damping: damping.ln(),
                frequency_by,
                log_damping_by: log_by,
                slip_ratios: self.slip_ratios(x, &point.slips),
            })
        };
        points.iter().map(one).collect()
    }

    /// Derivative of an unknown of the structure with respect to its coordinate: that of β with respect to β/(1+β), else 1.
    fn inner(&self, x: &[f64], j: usize) -> f64 {
        if j < self.first_factor() && j % 4 == 3 { (1.0 - x[j]).powi(-2) } else { 1.0 }
    }

    fn slip_ratios(&self, x: &[f64], slips: &[f64]) -> Vec<f64> {
        let ratio = |(group, x): (&Vec<usize>, &[f64])| {
            let end = law(x).map_or(f64::NAN, |law| law.phi_max());
            group.iter().map(|s| slips[*s].abs() / end).fold(0.0, f64::max)
        };
        self.groups.iter().zip(x.chunks_exact(4)).map(ratio).collect()
    }

    /// Index ranges of the residuals: of each curve first the frequencies, then the damping. Residuals of prior knowledge follow after all curves.
    pub(super) fn series(&self) -> Vec<Range<usize>> {
        let mut from = 0;
        let next = |curve: &Curve| {
            let n = curve.points.len();
            let both = [from..from + n, from + n..from + 2 * n];
            from += 2 * n;
            both
        };
        self.curves.iter().flat_map(next).collect()
    }

    /// Frequency and damping of the structure for all curves.
    pub(super) fn said_of_all(&self, x: &[f64]) -> Option<Vec<Vec<Said>>> {
        let adjusted = self.adjusted(x)?;
        let of = |curve: &Curve| {
            let q: Vec<f64> = curve.points.iter().map(|p| p.displacement).collect();
            self.said(&adjusted, x, (curve.mode, curve.viscous, curve.stiffness), &q)
        };
        self.curves.iter().map(of).collect()
    }
}

impl Model for Beside<'_> {
    fn bounds(&self) -> &[(f64, f64)] {
        &self.bounds
    }

    fn count(&self) -> usize {
        let points: usize = self.curves.iter().map(|curve| curve.points.len()).sum();
        2 * points + self.priors.iter().flatten().count()
    }

    fn evaluate(&self, x: &[f64], residuals: &mut [f64], mut derivatives: Option<&mut [Vec<f64>]>) -> bool {
        let Some(all) = self.said_of_all(x) else { return false };
        let mut from = 0;
        for (curve, said) in self.curves.iter().zip(&all) {
            let n = curve.points.len();
            for (i, (point, said)) in curve.points.iter().zip(said).enumerate() {
                residuals[from + i] = (point.frequency - said.frequency) / curve.frequency_sd;
                residuals[from + n + i] = (point.log_damping - said.log_damping) / curve.damping_sd;
                if let Some(derivatives) = &mut derivatives {
                    for (j, column) in asked_for(derivatives) {
                        column[from + i] = -said.frequency_by[j] / curve.frequency_sd;
                        column[from + n + i] = -said.log_damping_by[j] / curve.damping_sd;
                    }
                }
            }
            from += 2 * n;
        }
        self.known_before(x, from, residuals, derivatives);
        residuals.iter().all(|r| r.is_finite())
    }
}

/// Columns of derivatives that are asked for, each with its unknown.
fn asked_for(derivatives: &mut [Vec<f64>]) -> impl Iterator<Item = (usize, &mut Vec<f64>)> {
    derivatives.iter_mut().enumerate().filter(|(_, column)| !column.is_empty())
}

impl Beside<'_> {
    /// Residuals of the prior knowledge on the factors, written from index `from` on.
    pub(super) fn known_before(
        &self,
        x: &[f64],
        mut from: usize,
        residuals: &mut [f64],
        mut derivatives: Option<&mut [Vec<f64>]>,
    ) {
        for (k, deviation) in self.priors.iter().enumerate() {
            let Some(deviation) = deviation else { continue };
            let place = self.first_factor() + k;
            residuals[from] = x[place] / deviation;
            if let Some(derivatives) = &mut derivatives {
                asked_for(derivatives).for_each(|(j, column)| {
                    column[from] = if j == place { deviation.recip() } else { 0.0 };
                });
            }
            from += 1;
        }
    }
}
