//! The readable reference implementation: it visits every slider at every step.

use super::hysteresis::Hysteresis;
use super::sliders::Sliders;
use crate::error::{Error, check_length};
use crate::law::check_masing;

/// The plain loop over a population; the fast kernels are tested against it.
///
/// ```
/// use iwan_core::{Hysteresis, Plain, Slider, Sliders};
/// let mut table = [Slider::default(); 3];
/// let sliders = Sliders::from_elements(&[0.1, 0.3], &[2.0, 1.0], &mut table)?;
/// let plain = Plain::new(sliders);
/// let mut state = plain.virgin([0.0; 2])?;
/// assert!((plain.advance(&mut state, 0.2) - (2.0 * 0.1 + 1.0 * 0.2)).abs() < 1e-15);
/// assert!((plain.advance(&mut state, 0.15) - (2.0 * 0.05 + 1.0 * 0.15)).abs() < 1e-15);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Plain<'a> {
    sliders: Sliders<'a>,
}

/// The state of [`Plain`]: displacement and the extension x_i of each spring.
#[derive(Debug, Clone, Copy)]
pub struct Extensions<S> {
    u: f64,
    extension: S,
}

impl<'a> Plain<'a> {
    /// The plain loop over `sliders`.
    #[must_use]
    pub const fn new(sliders: Sliders<'a>) -> Self {
        Self { sliders }
    }

    /// The virgin state: `extension` has one entry per slider and is set to zero.
    ///
    /// # Errors
    /// [`Error::Length`]; [`Error::Unsupported`] where friction drops once a slider slips: see [`StickSlip`](crate::StickSlip).
    pub fn virgin<S: AsMut<[f64]>>(&self, mut extension: S) -> Result<Extensions<S>, Error> {
        check_masing(&self.sliders)?;
        check_length("extension", extension.as_mut().len(), self.sliders.len())?;
        extension.as_mut().fill(0.0);
        Ok(Extensions { u: 0.0, extension })
    }
}

impl<S: AsRef<[f64]> + AsMut<[f64]>> Hysteresis<Extensions<S>> for Plain<'_> {
    fn displacement(&self, state: &Extensions<S>) -> f64 {
        state.u
    }

    /// F = Σ k_i x_i (Deaner et al., Eq. 1).
    fn joint_force(&self, state: &Extensions<S>) -> f64 {
        self.sliders.elements().zip(state.extension.as_ref()).map(|((_, k), x)| k * x).sum()
    }

    /// Each extension follows the displacement and stops at its slider's strength (Eq. 2).
    fn advance(&self, state: &mut Extensions<S>, u: f64) -> f64 {
        let du = u - state.u;
        if du.is_finite() {
            for ((phi, _), x) in self.sliders.elements().zip(state.extension.as_mut()) {
                *x = (*x + du).max(-phi).min(phi);
            }
            state.u = u;
        }
        self.joint_force(state)
    }

    /// Newton's method on a concave, piecewise-linear function: started from zero it never overshoots, and it ends at the exact solution
    /// after at most one round per slider.
    fn solve(&self, state: &mut Extensions<S>, stiffness: f64, load: f64) -> f64 {
        if !load.is_finite() {
            return f64::NAN;
        }
        let direction = 1.0_f64.copysign(load);
        let mut du = 0.0;
        for _ in 0..=self.sliders.len() {
            let (mut balance, mut tangent) = (load - stiffness * du, stiffness);
            for ((phi, k), x) in self.sliders.elements().zip(state.extension.as_ref()) {
                let moved = (x + du).max(-phi).min(phi);
                balance -= k * (moved - x);
                if direction * moved < phi {
                    tangent += k;
                }
            }
            let step = balance / tangent;
            if direction * step <= f64::EPSILON * du.abs() {
                break;
            }
            du += step;
        }
        let u = state.u + du;
        self.advance(state, u);
        du
    }

    fn stored_energy(&self, state: &Extensions<S>) -> f64 {
        self.sliders.elements().zip(state.extension.as_ref()).map(|((_, k), x)| 0.5 * k * x * x).sum()
    }
}
