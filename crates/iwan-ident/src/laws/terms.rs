//! The terms that a law is made of, and the coordinates in which their parameters are sought.
//!
//! A damper is sought as its share of the decay rate and a spring as its share of the frequency's shift, both at the amplitude in the middle of those
//! seen. So all coordinates are of order one, and an exponent does not change what the coefficient beside it stands for.

use std::f64::consts::TAU;

use iwan_core::{Backbone, Coulomb, FourParameter, Jenkins, Part, Pinning, PowerDamping, PowerSpring};

use super::mode::{Joint, LawMode};
use crate::parameters::Parameters;

/// Largest part of ω0² that K_T may be, as in every search: K_∞ = ω0² - K_T must be positive. Above it there is no model.
const MOST_JOINT: f64 = 0.999;

/// One ingredient of a law beside the stiffness and the viscous damper that every law has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Term {
    /// Dry friction, F sign v.
    Coulomb,
    /// Quadratic damping c |v| v.
    Quadratic,
    /// Damping by a power of the velocity, c |v|^n sign v.
    PowerDamping,
    /// Cubic spring k u³.
    Cubic,
    /// Power-law spring k |u|^(m-1) u.
    PowerSpring,
    /// A spring beyond a gap.
    Pinning,
    /// One Jenkins element.
    Jenkins,
    /// Segalman's four-parameter Iwan joint.
    Iwan,
}

/// A coordinate: its range, and how far it is expected to lie from its start before a record is seen.
#[derive(Debug, Clone, Copy)]
pub(super) struct Coordinate {
    pub(super) bounds: (f64, f64),
    /// Standard deviation of the prior, which evidence needs: of order one by the choice of coordinates.
    pub(super) width: f64,
    /// Values at which searches begin.
    pub(super) starts: &'static [f64],
}

const fn coordinate(low: f64, high: f64, width: f64, starts: &'static [f64]) -> Coordinate {
    Coordinate { bounds: (low, high), width, starts }
}

/// Frequency at small amplitude less the frequency at the amplitude in the middle, in units of the shift.
const FREQUENCY: Coordinate = coordinate(-1e3, 1e3, 10.0, &[0.0]);
/// Share of a damper in the decay rate at the amplitude in the middle: none is negative.
const SHARE: Coordinate = coordinate(0.0, 1e3, 1.0, &[0.3]);
/// Share of a spring in the frequency's shift at the amplitude in the middle, of either sign. The smaller start is for records of two decades of
/// amplitude: a cubic spring that makes a third of the shift in the middle would have used up all stiffness at their end.
const SPRING: Coordinate = coordinate(-1e3, 1e3, 1.0, &[-0.3, -3e-3]);

impl Term {
    /// The coordinates of the term.
    pub(super) const fn coordinates(self) -> &'static [Coordinate] {
        /// Share and exponent of the velocity. Towards exponent 0 a damper becomes dry friction, and 4 is beyond any fluid's.
        const DAMPING: [Coordinate; 2] = [SHARE, coordinate(0.02, 4.0, 1.0, &[0.4, 1.6, 2.4])];
        /// Share, and ln of the exponent less 1: the exponent is above 1, so that the spring has no stiffness at small amplitude.
        const POWER: [Coordinate; 2] = [SPRING, coordinate(-4.0, 2.0, 1.0, &[-1.2, -0.3, 0.6])];
        /// Stiffness (of a Jenkins element its logarithm) over the stiffness that shifts the frequency by its range, and ln of gap or slip
        /// displacement over the amplitude in the middle.
        const PINNING: [Coordinate; 2] =
            [coordinate(0.0, 1e3, 1.0, &[0.3]), coordinate(-3.0, 3.0, 1.0, &[-0.7, 0.0, 0.7])];
        const JENKINS: [Coordinate; 2] =
            [coordinate(-6.0, 12.0, 2.0, &[0.0, 2.0]), coordinate(-5.0, 5.0, 1.0, &[-1.0, 0.0, 1.0])];
        /// ln of the softening, χ, ln of the knee, and the Dirac's share β/(1+β).
        const IWAN: [Coordinate; 4] = [
            coordinate(-12.0, 8.0, 2.0, &[0.5]),
            coordinate(-0.99, 0.99, 0.5, &[-0.6, -0.2, 0.3]),
            coordinate(-4.0, 12.0, 2.0, &[0.0, 3.0]),
            coordinate(0.0, 0.999, 0.5, &[0.2]),
        ];
        match self {
            Self::Coulomb | Self::Quadratic => &[SHARE],
            Self::Cubic => &[SPRING],
            Self::PowerDamping => &DAMPING,
            Self::PowerSpring => &POWER,
            Self::Pinning => &PINNING,
            Self::Jenkins => &JENKINS,
            Self::Iwan => &IWAN,
        }
    }
}

impl Term {
    /// Place, among the term's coordinates, of the one that says where its curves have a knee: along it the sum of squares has creases (bends) and
    /// several local minima.
    pub(super) const fn knee(self) -> Option<usize> {
        match self {
            Self::Pinning | Self::Jenkins => Some(1),
            Self::Iwan => Some(2),
            _ => None,
        }
    }
}

/// Place of the knee among all coordinates of a law with these terms, if a term has a knee.
pub(super) fn knee(terms: &[Term]) -> Option<usize> {
    let mut place = 2;
    for term in terms {
        if let Some(own) = term.knee() {
            return Some(place + own);
        }
        place += term.coordinates().len();
    }
    None
}

/// Coordinates of a law with these terms: first the two that every law has, then those of the terms in order.
pub(super) fn coordinates(terms: &[Term]) -> Vec<Coordinate> {
    let own = terms.iter().flat_map(|term| term.coordinates().iter().copied());
    [FREQUENCY, SHARE].into_iter().chain(own).collect()
}

/// The values that coordinates are relative to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Scales {
    /// Displacement amplitude in the middle of those that the records saw.
    pub(super) amplitude: f64,
    /// Circular frequency at that amplitude, rad/s.
    pub(super) omega: f64,
    /// Decay rate at that amplitude, 1/s.
    pub(super) rate: f64,
    /// Range of the circular frequency over the amplitudes that the records saw, 1/s.
    pub(super) shift: f64,
}

impl Scales {
    /// The mode at the coordinates `x`; none where there is no such model.
    pub(super) fn mode(&self, terms: &[Term], x: &[f64]) -> Option<LawMode> {
        let omega0 = self.omega + x[0] * self.shift;
        let viscous = x[1] * self.rate / omega0;
        let mut mode =
            LawMode { frequency: omega0 / TAU, damping_ratio: viscous, joint: None, parts: vec![] };
        let mut rest = &x[2..];
        for term in terms {
            let own;
            (own, rest) = rest.split_at(term.coordinates().len());
            self.add(*term, own, &mut mode)?;
        }
        (omega0 > 0.0 && (0.0..1.0).contains(&viscous)).then_some(mode)
    }

    fn add(&self, term: Term, x: &[f64], mode: &mut LawMode) -> Option<()> {
        let part = match term {
            Term::Coulomb => self.damper(x[0], |c| Coulomb::new(c).map(Part::from))?,
            Term::Quadratic => self.damper(x[0], |c| PowerDamping::new(c, 2.0).map(Part::from))?,
            Term::PowerDamping => self.damper(x[0], |c| PowerDamping::new(c, x[1]).map(Part::from))?,
            Term::Cubic => self.spring(x[0], |k| PowerSpring::new(k, 3.0).map(Part::from))?,
            Term::PowerSpring => {
                self.spring(x[0], |k| PowerSpring::new(k, 1.0 + x[1].exp()).map(Part::from))?
            }
            Term::Pinning => {
                let k = 2.0 * self.omega * self.shift * x[0];
                Pinning::new(k, self.amplitude * x[1].exp()).ok()?.into()
            }
            Term::Jenkins => {
                let k_t = self.stiffness(x[0]);
                let joint = Jenkins::new(k_t, k_t * self.amplitude * x[1].exp()).ok()?;
                mode.joint = Some(Joint::Jenkins(joint));
                return (k_t < MOST_JOINT * (TAU * mode.frequency).powi(2)).then_some(());
            }
            Term::Iwan => {
                let (chi, phi_max) = (x[1], self.amplitude * x[2].exp());
                let r = self.stiffness(x[0]) / self.amplitude.powf(chi + 1.0);
                let s = r * phi_max.powf(chi + 1.0) / (chi + 1.0) * x[3] / (1.0 - x[3]);
                let joint = FourParameter::from_density(r, chi, phi_max, s).ok()?;
                let room = joint.initial_stiffness() < MOST_JOINT * (TAU * mode.frequency).powi(2);
                mode.joint = Some(Joint::FourParameter(joint));
                return room.then_some(());
            }
        };
        mode.parts.push(part);
        Some(())
    }

    /// A stiffness from the logarithm of its ratio to the stiffness that shifts the frequency by its range.
    fn stiffness(&self, log: f64) -> f64 {
        2.0 * self.omega * self.shift * log.exp()
    }

    /// A damper that makes this share of the decay rate at the amplitude in the middle.
    fn damper<E>(&self, share: f64, make: impl Fn(f64) -> Result<Part, E>) -> Option<Part> {
        let unit = make(1.0).ok()?.dissipation(self.amplitude, self.omega);
        make(share * self.rate * TAU * self.amplitude.powi(2) * self.omega / unit).ok()
    }

    /// A spring that makes this share of the frequency's shift at the amplitude in the middle.
    fn spring<E>(&self, share: f64, make: impl Fn(f64) -> Result<Part, E>) -> Option<Part> {
        let unit = make(1.0).ok()?.harmonic_stiffness(self.amplitude, self.omega);
        make(share * 2.0 * self.omega * self.shift / unit).ok()
    }

    /// Coordinates of the law of an Iwan joint with a viscous damper, cut to their ranges; none where the parameters are no model.
    pub(super) fn of_iwan(&self, p: &Parameters) -> Option<Vec<f64>> {
        let (_, joint) = p.model().ok()?;
        let omega0 = TAU * p.frequency;
        let softening = joint.r() * self.amplitude.powf(p.chi + 1.0) / self.stiffness(0.0);
        let knee = (joint.phi_max() / self.amplitude).ln();
        let (offset, viscous) = ((omega0 - self.omega) / self.shift, p.damping_ratio * omega0 / self.rate);
        let x = [offset, viscous, softening.ln(), p.chi, knee, p.beta / (1.0 + p.beta)];
        let all = coordinates(&[Term::Iwan]);
        Some(x.iter().zip(all).map(|(x, c)| x.clamp(c.bounds.0, c.bounds.1)).collect())
    }
}
