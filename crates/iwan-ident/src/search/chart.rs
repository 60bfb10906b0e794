//! The coordinates in which parameters are sought.
//!
//! A ring-down in micro-slip tells the frequency, the damping and, of the joint, the power χ and the level of its
//! softening R u^(χ+1) at the amplitudes seen; where the density ends and how much of it is the Dirac shows only in
//! macro-slip. So these are the coordinates: what every record tells stands apart from what few records tell.

use std::f64::consts::TAU;

use crate::error::Error;
use crate::parameters::{COUNT, Parameter, Parameters};

/// A damping ratio of 0.1 % has the coordinate 1.
const DAMPING_UNIT: f64 = 1e-3;
/// K_T stays below this part of ω0²: K_∞ = ω0² - K_T must be positive.
const MOST_JOINT: f64 = 0.999;
/// Range of χ: the law needs -1 < χ < 1.
const CHI: (f64, f64) = (-0.99, 0.99);
/// Most of K_T that can be the Dirac's, β/(1+β): β = 999, a single slider for every purpose.
const MOST_DIRAC: f64 = 0.999;

/// Which quantities stand third and fifth; the others are ln f, ζ_v, χ and β/(1+β).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scales {
    /// Softening and K_T/ω0²: for every search.
    SofteningAndStiffness,
    /// Softening and F_S: where F_S is given.
    SofteningAndForce,
    /// F_S and K_T/ω0²: where both are given.
    ForceAndStiffness,
}

/// Coordinates about an amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Chart {
    pub(crate) scales: Scales,
    /// Displacement at which the softening is taken.
    pub(crate) amplitude: f64,
}

impl Chart {
    /// The chart in which the parameters that are `held` are coordinates.
    pub(crate) fn holding(held: &[Parameter], amplitude: f64) -> Self {
        let scales = match (held.contains(&Parameter::KT), held.contains(&Parameter::FS)) {
            (true, true) => Scales::ForceAndStiffness,
            (false, true) => Scales::SofteningAndForce,
            (_, false) => Scales::SofteningAndStiffness,
        };
        Self { scales, amplitude }
    }

    /// Index of the coordinate that holds a parameter.
    pub(crate) fn index(&self, parameter: Parameter) -> usize {
        match parameter {
            Parameter::Frequency => 0,
            Parameter::DampingRatio => 1,
            Parameter::FS if self.scales == Scales::ForceAndStiffness => 2,
            Parameter::Chi => 3,
            Parameter::KT | Parameter::FS => 4,
            Parameter::Beta => 5,
        }
    }

    /// Coordinates of parameters, inside the bounds.
    ///
    /// # Errors
    /// [`Error::Model`] when they are no model.
    pub(crate) fn coordinates(&self, p: &Parameters) -> Result<[f64; COUNT], Error> {
        let (oscillator, joint) = p.model()?;
        let softening = joint.r().ln() + (p.chi + 1.0) * self.amplitude.ln();
        let stiffness = (p.k_t / oscillator.omega0().powi(2)).ln();
        let (third, fifth) = match self.scales {
            Scales::SofteningAndStiffness => (softening, stiffness),
            Scales::SofteningAndForce => (softening, p.f_s.ln()),
            Scales::ForceAndStiffness => (p.f_s.ln(), stiffness),
        };
        let mut x =
            [p.frequency.ln(), p.damping_ratio / DAMPING_UNIT, third, p.chi, fifth, p.beta / (1.0 + p.beta)];
        for (x, (low, high)) in x.iter_mut().zip(self.bounds()) {
            *x = x.clamp(low, high);
        }
        Ok(x)
    }

    /// The inverse of [`coordinates`](Self::coordinates).
    pub(crate) fn parameters(&self, x: &[f64]) -> Parameters {
        let (frequency, damping_ratio, chi, dirac) = (x[0].exp(), DAMPING_UNIT * x[1], x[3], x[5]);
        let omega_squared = (TAU * frequency).powi(2);
        let beta = dirac / (1.0 - dirac);
        let c = (chi + 1.0) / (chi + 2.0);
        // φ_max over the chart's amplitude from K_T (1-b) = R φ^(χ+1)/(χ+1) or F_S = R φ^(χ+2) [1/(χ+2) + β/(χ+1)].
        let (k_t, f_s) = match self.scales {
            Scales::SofteningAndStiffness => {
                let k_t = omega_squared * x[4].exp();
                let ratio = ((k_t * (1.0 - dirac) * (chi + 1.0)).ln() - x[2]) / (chi + 1.0);
                (k_t, k_t * self.amplitude * ratio.exp() * (beta + c) / (1.0 + beta))
            }
            Scales::SofteningAndForce => {
                let bracket = 1.0 / (chi + 2.0) + beta / (chi + 1.0);
                let ratio = (x[4] - x[2] - (self.amplitude * bracket).ln()) / (chi + 2.0);
                ((x[2] + (chi + 1.0) * ratio).exp() * (1.0 + beta) / (chi + 1.0), x[4].exp())
            }
            Scales::ForceAndStiffness => (omega_squared * x[4].exp(), x[2].exp()),
        };
        Parameters { frequency, damping_ratio, k_t, f_s, chi, beta }
    }

    /// Lower and upper bounds of the coordinates.
    pub(crate) fn bounds(&self) -> [(f64, f64); COUNT] {
        const NONE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);
        let fifth = match self.scales {
            Scales::SofteningAndForce => NONE,
            _ => (f64::NEG_INFINITY, MOST_JOINT.ln()),
        };
        [NONE, (0.0, 0.5 / DAMPING_UNIT), NONE, CHI, fifth, (0.0, MOST_DIRAC)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_and_back() {
        let mode = Parameters {
            frequency: 124.0,
            damping_ratio: 1e-3,
            k_t: 4.45e4,
            f_s: 239.4,
            chi: -0.183,
            beta: 0.3,
        };
        for scales in [Scales::SofteningAndStiffness, Scales::SofteningAndForce, Scales::ForceAndStiffness] {
            let chart = Chart { scales, amplitude: 2e-4 };
            let back = chart.parameters(&chart.coordinates(&mode).unwrap());
            for p in Parameter::ALL {
                assert!((back.get(p) / mode.get(p) - 1.0).abs() < 1e-12, "{scales:?} {}", p.name());
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
                .filter(|i| held.iter().all(|h| chart.index(*h) != *i) && *i != 0)
                .for_each(|i| x[i] += 0.01);
            let moved = chart.parameters(&x);
            for h in held {
                assert!((moved.get(*h) / mode.get(*h) - 1.0).abs() < 1e-12, "{held:?}");
            }
        }
    }
}
