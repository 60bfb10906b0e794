//! Average acceleration on a population of sliders, without Newton's method.
//!
//! With s = K_∞ q + F_J(q) and w = (4/h) q', one step of the average-acceleration rule is
//! keff Δq + ΔF_J = r with r = p_n + p_{n+1} + w - 2 s and keff = 4/h² + 2c/h + K_∞. F_J is
//! piecewise linear with slope K(j), so Δq = r / (keff + K(j)) until a slider breaks loose, and the
//! next residual is r' = (p_{n+1} + p_{n+2} - w - 2 s) + g r with g = (8/h² - 2 (K_∞ + K(j))) / (keff + K(j)):
//! between breaks the steps depend on each other through one product and one sum.

use crate::error::Error;
use crate::newmark::Newmark;
use crate::oscillator::Oscillator;
use crate::response::{Samples, force_at};
use crate::runs::{Run, Runs};
use crate::sliders::{Slider, Sliders};

/// The constants of one step while no slider breaks loose.
#[derive(Clone, Copy)]
struct Piece {
    /// Displacement from which x is counted.
    anchor: f64,
    /// Joint force and its slope at x.
    joint: f64,
    joint_slope: f64,
    /// K_∞ q + F_J and its slope at x.
    restoring: f64,
    slope: f64,
    /// 1 / (keff + K) and the gain of the residual.
    inverse: f64,
    gain: f64,
    direction: f64,
    /// End of the piece, in direction·x.
    reach: f64,
}

struct Scheme {
    k_inf: f64,
    stiffness: f64,
    /// 8/h².
    inertia: f64,
}

impl Scheme {
    fn piece<S: AsRef<[Run]> + AsMut<[Run]>>(&self, table: &[Slider], state: &Runs<S>) -> Piece {
        let segment = state.segment(table);
        let slope = self.k_inf + segment.stiffness;
        let inverse = 1.0 / (self.stiffness + segment.stiffness);
        Piece {
            anchor: segment.anchor,
            joint: segment.base,
            joint_slope: segment.stiffness,
            restoring: self.k_inf * segment.anchor + segment.base,
            slope,
            inverse,
            gain: (self.inertia - 2.0 * slope) * inverse,
            direction: state.direction(),
            reach: segment.reach,
        }
    }
}

impl Newmark {
    /// As [`integrate`](Self::integrate) for a population of sliders, an order of magnitude faster.
    ///
    /// Other schemes than average acceleration take the general path. Returns the final velocity.
    ///
    /// # Errors
    /// As [`integrate`](Self::integrate).
    pub fn integrate_sliders<S: AsRef<[Run]> + AsMut<[Run]>>(
        &self,
        oscillator: &Oscillator,
        sliders: &Sliders<'_>,
        state: &mut Runs<S>,
        velocity: f64,
        force: &[f64],
        out: &mut Samples<'_>,
    ) -> Result<f64, Error> {
        if !self.is_average_acceleration() {
            return self.integrate(oscillator, sliders, state, velocity, force, out);
        }
        let samples = out.checked_len()?;
        let stiffness = self.checked_effective_stiffness(oscillator)?;
        let h = self.step();
        let scheme = Scheme { k_inf: oscillator.k_inf(), stiffness, inertia: 8.0 / (h * h) };
        let (c, scale) = (oscillator.viscous(), self.force_scale());
        let (table, to_velocity) = (sliders.table(), 0.25 * h);
        let mut piece = scheme.piece(table, state);
        let mut x = state.displacement() - piece.anchor;
        let mut s = piece.restoring + piece.slope * x;
        let mut w = velocity / to_velocity;
        let mut p = force_at(force, 0);
        let joint = piece.joint + piece.joint_slope * x;
        out.set(0, [piece.anchor + x, velocity, p - c * velocity - s, joint]);
        let mut next = force_at(force, 1);
        let mut r = (scale * (p + next) + w) - 2.0 * s;
        for n in 1..samples {
            p = next;
            next = force_at(force, n + 1);
            let load = scale * (p + next);
            let mut y = x + r * piece.inverse;
            if piece.direction * r >= 0.0 && piece.direction * y <= piece.reach {
                let dq = r * piece.inverse;
                r = ((load - w) - 2.0 * s) + piece.gain * r;
                w = scheme.inertia * dq - w;
                s = piece.restoring + piece.slope * y;
            } else {
                state.rest_at(piece.anchor + x);
                let dq = state.solve_step(table, stiffness, r);
                piece = scheme.piece(table, state);
                y = state.displacement() - piece.anchor;
                w = scheme.inertia * dq - w;
                s = piece.restoring + piece.slope * y;
                r = (load + w) - 2.0 * s;
            }
            x = y;
            let v = to_velocity * w;
            out.set(n, [piece.anchor + x, v, (p - c * v) - s, piece.joint + piece.joint_slope * x]);
        }
        state.rest_at(piece.anchor + x);
        Ok(to_velocity * w)
    }
}
