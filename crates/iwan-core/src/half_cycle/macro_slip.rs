//! Half cycles through macro-slip under a power law.
//!
//! Beyond φ_max the force stays at F_S. So only the part of the gained energy P(y) = s y - ½ K_∞ y² - 4 G(y/2) below y = 2 φ_max depends on
//! the power law. For a travel L beyond 2 φ_max, P(L) = W with the damping W/L² is a quadratic equation, and the phase needs powers only at
//! the nodes of its first panel.

use core::array::from_fn;

use super::phase::{MOST_PASSES, NODES, Node, PANELS, Phase, Share};
use crate::law::{Backbone, PowerLaw};

/// Relative change of the travel at which the passes over the damping end: after three passes at ζ_v = 1 %, after four at 10 %; turning
/// points are then exact to 5e-12. A value of 1e-8 would save two passes and leave errors of 1e-8.
const TRAVEL_TOLERANCE: f64 = 1e-12;
/// Largest relative change of a share for which its power is updated by three terms of a series, which leave out less than 1e-4^4 = 1e-16,
/// instead of being computed anew. This saves powers in the later passes; with any value from 0 to 1e-2 turning points agree to rounding.
const NEAR: f64 = 1e-4;

/// The macro-slip half cycles of a mode.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MacroSlip {
    k_inf: f64,
    viscous: f64,
    /// φ_max.
    limit: f64,
    slip_force: f64,
    /// Work on the virgin curve up to φ_max.
    energy: f64,
    /// ½ K_T φ_max.
    half_force: f64,
    /// Part of `energy` that is lost to softening, over φ_max.
    softening: f64,
    /// p = χ + 2.
    exponent: f64,
}

/// A half cycle in macro-slip, as the solver finds it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Slip {
    pub(crate) length: f64,
    /// Work of the damper over the square of the travel, W/L².
    pub(crate) damping: f64,
    pub(crate) phase: Phase,
}

/// The powers at the shares below φ_max, as last computed.
struct Powers {
    exponent: f64,
    shares: [f64; NODES],
    values: [f64; NODES],
}

impl MacroSlip {
    /// The solver for a mode; none if the force still rises beyond the limit of the power law.
    pub(crate) fn new<B: Backbone>(k_inf: f64, viscous: f64, law: &B, power: &PowerLaw) -> Option<Self> {
        let (limit, p) = (power.limit, power.exponent);
        let softening = power.coefficient * libm::pow(limit, p) / (p + 1.0);
        let half_force = 0.5 * power.stiffness * limit;
        let ends = law.strengths().1 <= limit;
        ends.then(|| Self {
            k_inf,
            viscous,
            limit,
            slip_force: law.slip_force(),
            energy: (half_force - softening) * limit,
            half_force,
            softening,
            exponent: p,
        })
    }

    /// The half cycle under `pull`, with the search started from a guess of its damping W/L²; none if the half cycle does not reach
    /// macro-slip.
    pub(crate) fn half_cycle(&self, pull: f64, guess: f64) -> Option<Slip> {
        let mut slip =
            Slip { length: self.travel(pull, guess)?, damping: guess, phase: Phase::single([0.0; NODES]) };
        let mut powers = Powers { exponent: self.exponent, shares: [0.0; NODES], values: [0.0; NODES] };
        let mut work = 0.0;
        for pass in 0..MOST_PASSES {
            let cut = 2.0 * libm::asin(libm::sqrt(2.0 * self.limit / slip.length));
            if pass == 0 {
                slip.phase = Phase::cut(0.0, cut);
            } else {
                slip.phase.cut_again(cut);
            }
            let nodes = self.nodes(&slip, cut, &mut powers);
            work = slip.phase.settle(&nodes, self.viscous, work);
            slip.damping = 0.25 * self.viscous * work;
            let length = self.travel(pull, slip.damping)?;
            let change = libm::fabs(length - slip.length);
            slip.length = length;
            if change <= TRAVEL_TOLERANCE * length {
                break;
            }
        }
        Some(slip)
    }

    /// Travel L with P(L) = damping·L²; none unless it exceeds 2 φ_max. The equation is
    /// (½ K_∞ + damping) L² - (s - 2 F_S) L - 4 (F_S φ_max - G(φ_max)) = 0.
    fn travel(&self, pull: f64, damping: f64) -> Option<f64> {
        let (a, b) = (0.5 * self.k_inf + damping, pull - 2.0 * self.slip_force);
        let c = 4.0 * (self.slip_force * self.limit - self.energy);
        let root = libm::sqrt(b * b + 4.0 * a * c);
        let length = if b > 0.0 { (b + root) / (2.0 * a) } else { 2.0 * c / (root - b) };
        (length > 2.0 * self.limit).then_some(length)
    }

    fn nodes(&self, slip: &Slip, cut: f64, powers: &mut Powers) -> [[Node; NODES]; PANELS] {
        let length = slip.length;
        let per_arm = 16.0 / (length * length);
        let whole = self.energy + self.slip_force * (0.5 * length - self.limit);
        let left = self.slip_force * self.limit - self.energy;
        let mut nodes = [[Node::default(); NODES]; PANELS];
        for (panel, nodes) in slip.phase.panels().iter().zip(&mut nodes) {
            let shares = panel.shares();
            let slipping = panel.from >= cut;
            let micro = shares.map(|share| share.gone * 0.5 * length / self.limit);
            let power = if slipping { [0.0; NODES] } else { powers.at(&micro) };
            *nodes = from_fn(|i| {
                let Share { gone: x, left: rest } = shares[i];
                let joint = if slipping {
                    rest * left
                } else {
                    x * (whole - 0.5 * length * (self.half_force * micro[i] - self.softening * power[i]))
                };
                Node::new(shares[i], 2.0 * self.k_inf * x * rest + per_arm * joint)
            });
        }
        nodes
    }
}

impl Powers {
    /// x^p at the shares, from the stored powers if no share has changed by more than [`NEAR`].
    fn at(&mut self, shares: &[f64; NODES]) -> [f64; NODES] {
        let p = self.exponent;
        let moved: [f64; NODES] = from_fn(|i| (shares[i] - self.shares[i]) / self.shares[i]);
        if moved.iter().any(|d| libm::fabs(*d) > NEAR || d.is_nan()) {
            self.shares = *shares;
            self.values = shares.map(|x| libm::pow(x, p));
            return self.values;
        }
        from_fn(|i| {
            let d = moved[i];
            self.values[i] * (1.0 + p * d * (1.0 + (p - 1.0) * 0.5 * d * (1.0 + (p - 2.0) / 3.0 * d)))
        })
    }
}
