//! The coordinates in which parameters are sought.
//!
//! A ring-down in micro-slip tells the frequency at the amplitudes seen, the damping and, of the joint, the power χ and the level of its softening
//! R u^(χ+1) there. Where the density ends (the knee φ_max) and how much of it is the Dirac shows only in macro-slip. So these are the coordinates:
//! what every record tells stands apart from what few records tell. The knee is a coordinate of its own because the sum of squares has a crease (a
//! bend) wherever an amplitude of the ring-down equals φ_max, and nowhere else: with the knee held, all other coordinates are sought on a smooth
//! surface.
//!
//! The frequency is that at one of the amplitudes seen, by the secant of the virgin curve. The frequency at rest, far from what a record shows, follows every change of the
//! softening, whose logarithm is a coordinate: searches that had it for a coordinate went along a narrow and bent valley by small steps.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::parameters::{COUNT, Parameter, Parameters};

/// Unit of the damping coordinate: a damping ratio of 0.1 % has the coordinate 1.
const DAMPING_UNIT: f64 = 1e-3;
/// Largest part of ω0² that K_T may be: K_∞ = ω0² - K_T must be positive. Above it there is no model.
const MOST_JOINT: f64 = 0.999;
/// Range of χ: the law needs -1 < χ < 1.
const CHI_RANGE: (f64, f64) = (-0.99, 0.99);
/// Largest share β/(1+β) of K_T that the Dirac may have: β = 999, a single slider for every purpose.
const MOST_DIRAC: f64 = 0.999;
/// Place of the frequency's logarithm among the coordinates.
pub(crate) const FREQUENCY: usize = 0;
/// Place of the damping ratio among the coordinates.
pub(crate) const DAMPING: usize = 1;
/// Place of the softening among the coordinates, where the softening is one.
pub(crate) const SOFTENING: usize = 2;
/// Place of χ among the coordinates.
pub(crate) const CHI: usize = 3;
/// Place of the knee among the coordinates, where the knee is one.
pub(crate) const KNEE: usize = 4;
/// Place of the Dirac's share β/(1+β) among the coordinates.
pub(crate) const DIRAC: usize = 5;

/// The quantities in the third and fifth place; the other coordinates are ln of a frequency, ζ_v (in `DAMPING_UNIT`), χ and β/(1+β).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Scales {
    /// Softening and knee: for every search without given K_T and F_S.
    SofteningAndKnee,
    /// K_T and knee: where K_T is given.
    StiffnessAndKnee,
    /// F_S and knee: where F_S is given.
    ForceAndKnee,
    /// K_T and F_S, where both are given: the knee follows.
    StiffnessAndForce,
}

/// The coordinates: what they are, and the amplitude that they are relative to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Chart {
    pub(crate) scales: Scales,
    /// Whether the first coordinate is the frequency at rest; otherwise it is the frequency at `amplitude`.
    at_rest: bool,
    /// Displacement at which softening and frequency are taken, and to which the knee is relative.
    pub(crate) amplitude: f64,
}

impl Chart {
    /// The chart in which the parameters that are `held` are coordinates.
    pub(crate) fn holding(held: &[Parameter], amplitude: f64) -> Self {
        let scales = match (held.contains(&Parameter::KT), held.contains(&Parameter::FS)) {
            (true, true) => Scales::StiffnessAndForce,
            (true, false) => Scales::StiffnessAndKnee,
            (false, true) => Scales::ForceAndKnee,
            (false, false) => Scales::SofteningAndKnee,
        };
        Self { scales, at_rest: held.contains(&Parameter::Frequency), amplitude }
    }

    /// Place of the coordinate that holds a parameter; none where the parameter is no coordinate.
    pub(crate) fn index(&self, parameter: Parameter) -> Option<usize> {
        match (parameter, self.scales) {
            (Parameter::Frequency, _) => self.at_rest.then_some(FREQUENCY),
            (Parameter::DampingRatio, _) => Some(DAMPING),
            (Parameter::KT, Scales::StiffnessAndKnee | Scales::StiffnessAndForce)
            | (Parameter::FS, Scales::ForceAndKnee) => Some(2),
            (Parameter::Chi, _) => Some(3),
            (Parameter::FS, Scales::StiffnessAndForce) => Some(4),
            (Parameter::Beta, _) => Some(DIRAC),
            (Parameter::KT | Parameter::FS, _) => None,
        }
    }

    /// Place of the knee; none where K_T and F_S are given, which fix the knee.
    pub(crate) fn knee(&self) -> Option<usize> {
        (self.scales != Scales::StiffnessAndForce).then_some(KNEE)
    }

    /// Coordinates of parameters, cut to their bounds.
    ///
    /// # Errors
    /// [`Error::Model`] when the parameters are no model.
    pub(crate) fn coordinates(&self, p: &Parameters) -> Result<[f64; COUNT], Error> {
        let (_, joint) = p.model()?;
        let third = match self.scales {
            Scales::SofteningAndKnee => joint.r().ln() + (p.chi + 1.0) * self.amplitude.ln(),
            Scales::StiffnessAndKnee | Scales::StiffnessAndForce => p.k_t.ln(),
            Scales::ForceAndKnee => p.f_s.ln(),
        };
        let fifth = match self.scales {
            Scales::StiffnessAndForce => p.f_s.ln(),
            _ => (joint.phi_max() / self.amplitude).ln(),
        };
        let mut x = [
            p.frequency.ln() + 0.5 * (-self.stiffness_lost(p) / (TAU * p.frequency).powi(2)).ln_1p(),
            p.damping_ratio / DAMPING_UNIT,
            third,
            p.chi,
            fifth,
            p.beta / (1.0 + p.beta),
        ];
        for (x, (low, high)) in x.iter_mut().zip(Self::bounds()) {
            *x = x.clamp(low, high);
        }
        Ok(x)
    }

    /// The inverse of [`coordinates`](Self::coordinates).
    pub(crate) fn parameters(&self, x: &[f64]) -> Parameters {
        let (damping_ratio, chi, dirac) = (DAMPING_UNIT * x[DAMPING], x[CHI], x[DIRAC]);
        let c = (chi + 1.0) / (chi + 2.0);
        // F_S = φ_max K_T (d + c (1-d)) and K_T (1-d) = R φ_max^(χ+1)/(χ+1), where d is the Dirac's share of K_T.
        let shape = dirac + c * (1.0 - dirac);
        let phi_max = self.amplitude * x[4].exp();
        let (k_t, f_s) = match self.scales {
            Scales::SofteningAndKnee => {
                let k_t = (x[2] + (chi + 1.0) * x[4]).exp() / ((chi + 1.0) * (1.0 - dirac));
                (k_t, phi_max * k_t * shape)
            }
            Scales::StiffnessAndKnee => (x[2].exp(), phi_max * x[2].exp() * shape),
            Scales::ForceAndKnee => (x[2].exp() / (phi_max * shape), x[2].exp()),
            Scales::StiffnessAndForce => (x[2].exp(), x[4].exp()),
        };
        let frequency = x[FREQUENCY].exp();
        let p = Parameters { frequency, damping_ratio, k_t, f_s, chi, beta: dirac / (1.0 - dirac) };
        let more = self.stiffness_lost(&p) / (TAU * frequency).powi(2);
        Parameters { frequency: frequency * (1.0 + more).sqrt(), ..p }
    }

    /// By how much the secant of the virgin curve lies below K_T where the frequency is taken: K_T less F(u)/u, with the virgin curve F that follows
    /// from the density (D. J. Segalman, J. Appl. Mech. 72:752, 2005, doi:10.1115/1.1989354). A test holds it beside `FourParameter::force`.
    fn stiffness_lost(&self, p: &Parameters) -> f64 {
        if self.at_rest {
            return 0.0;
        }
        let dirac = p.beta / (1.0 + p.beta);
        let over_knee =
            self.amplitude * p.k_t * (dirac + (1.0 - dirac) * (p.chi + 1.0) / (p.chi + 2.0)) / p.f_s;
        if over_knee < 1.0 {
            p.k_t * (1.0 - dirac) * over_knee.powf(p.chi + 1.0) / (p.chi + 2.0)
        } else {
            p.k_t - p.f_s / self.amplitude
        }
    }

    /// The part of K_T at which K_T is this `part` of ω0², where the first coordinate and the joint's form stay as they are at `x`.
    pub(crate) fn stiffness_up_to(&self, x: &[f64], part: f64) -> f64 {
        let p = self.parameters(x);
        let lost = self.stiffness_lost(&p);
        let omega_squared = (TAU * p.frequency).powi(2) - lost;
        part * omega_squared / (p.k_t - part * lost)
    }

    /// Whether K_∞ is positive at these coordinates, so that there is a model.
    pub(crate) fn leaves_residual_stiffness(&self, x: &[f64]) -> bool {
        let p = self.parameters(x);
        p.k_t < MOST_JOINT * (TAU * p.frequency).powi(2)
    }

    /// Lower and upper bounds of the coordinates.
    pub(crate) fn bounds() -> [(f64, f64); COUNT] {
        const NONE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
        [NONE, (0.0, 0.5 / DAMPING_UNIT), NONE, CHI_RANGE, NONE, (0.0, MOST_DIRAC)]
    }
}

#[cfg(test)]
mod tests {
    use iwan_core::Backbone;

    use super::*;

    const MODE: Parameters =
        Parameters { frequency: 124.0, damping_ratio: 1e-3, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };

    #[test]
    fn coordinates_and_back() {
        let frequency = [Parameter::Frequency];
        for held in [&[][..], &[Parameter::KT], &[Parameter::FS], &[Parameter::KT, Parameter::FS], &frequency]
        {
            for amplitude in [2e-4, 2e-3, 2e-2] {
                let chart = Chart::holding(held, amplitude);
                let back = chart.parameters(&chart.coordinates(&MODE).unwrap());
                for p in Parameter::ALL {
                    assert!((back.get(p) / MODE.get(p) - 1.0).abs() < 1e-12, "{held:?} {}", p.name());
                }
            }
        }
    }

    #[test]
    fn the_frequency_is_that_of_the_secant() {
        let (_, joint) = MODE.model().unwrap();
        for over_knee in [1e-3, 0.1, 0.999, 1.001, 5.0] {
            let amplitude = over_knee * joint.phi_max();
            let x = Chart::holding(&[], amplitude).coordinates(&MODE).unwrap();
            let secant = joint.force(amplitude) / amplitude;
            let omega_squared = (TAU * MODE.frequency).powi(2) - MODE.k_t + secant;
            assert!((x[FREQUENCY] - (omega_squared.sqrt() / TAU).ln()).abs() < 1e-13, "{over_knee}");
            let at_rest = Chart::holding(&[Parameter::Frequency], amplitude).coordinates(&MODE).unwrap();
            assert!((at_rest[FREQUENCY] - MODE.frequency.ln()).abs() < 1e-14);
        }
    }

    #[test]
    fn stiffness_is_scaled_to_a_part_of_all() {
        let mode =
            Parameters { frequency: 1.0, damping_ratio: 0.0, k_t: 35.0, f_s: 3.0, chi: -0.5, beta: 0.5 };
        for held in [&[][..], &[Parameter::Frequency]] {
            for amplitude in [0.01, 1.0] {
                let chart = Chart::holding(held, amplitude);
                let mut x = chart.coordinates(&mode).unwrap();
                x[SOFTENING] += chart.stiffness_up_to(&x, 0.6).ln();
                let p = chart.parameters(&x);
                assert!((p.k_t / (TAU * p.frequency).powi(2) - 0.6).abs() < 1e-12, "{held:?} {amplitude}");
            }
        }
    }

    #[test]
    fn held_parameters_are_coordinates() {
        use Parameter::{Beta, FS, KT};
        for held in [&[KT][..], &[FS], &[KT, FS], &[Beta, FS]] {
            let chart = Chart::holding(held, 1.0);
            let mode =
                Parameters { frequency: 1.0, damping_ratio: 0.0, k_t: 2.0, f_s: 3.0, chi: -0.5, beta: 0.5 };
            let mut x = chart.coordinates(&mode).unwrap();
            (0..COUNT)
                .filter(|i| held.iter().all(|h| chart.index(*h) != Some(*i)))
                .for_each(|i| x[i] += 0.01);
            let moved = chart.parameters(&x);
            for h in held {
                assert!((moved.get(*h) / mode.get(*h) - 1.0).abs() < 1e-12, "{held:?}");
            }
        }
    }
}
