//! A population of sliders whose friction drops once they slip. Each slider remembers the extension of its spring and whether it slides.
//!
//! A slider sticks until its spring is stretched to the static limit φ, then slides with the spring at θφ until the motion turns round, and
//! sticks again (Mignolet, Song and Wang 2015, doi:10.1016/j.jsv.2015.03.032). So the force drops where a slider breaks loose, and a small
//! motion back and forth still has an effect after its loop closes. Run-length and return-point memory cannot represent this. All
//! [`Spring`]s are visited where one breaks loose and where the motion turns round; in between the population acts as one spring.

use super::hysteresis::{Hysteresis, Trial};
use super::sliders::Sliders;
use crate::error::{Error, check_length};
use crate::law::Backbone;

/// A population of [`Sliders`] with its ratio θ of dynamic to static friction.
///
/// ```
/// use iwan_core::{Hysteresis, Slider, Sliders, Spring, StickSlip};
/// let mut table = [Slider::default(); 3];
/// let sliders = Sliders::from_elements(&[0.1, 0.3], &[2.0, 1.0], &mut table)?.dropping(0.5)?;
/// let joint = StickSlip::new(sliders);
/// let mut state = joint.virgin([Spring::default(); 2])?;
/// // The first slider holds up to 0.1, then slides at half of that.
/// assert!((joint.advance(&mut state, 0.09) - (2.0 * 0.09 + 0.09)).abs() < 1e-15);
/// assert!((joint.advance(&mut state, 0.2) - (2.0 * 0.05 + 0.2)).abs() < 1e-15);
/// // Turned round it sticks; on the way on it needs the whole of 0.1 again.
/// joint.advance(&mut state, 0.19);
/// assert!((joint.advance(&mut state, 0.24) - (2.0 * 0.09 + 0.24)).abs() < 1e-15);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct StickSlip<'a> {
    sliders: Sliders<'a>,
    /// Ratio θ of dynamic to static friction.
    ratio: f64,
}

/// The spring of one slider.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Spring {
    /// Extension of the spring when the state's springs were last visited.
    extension: f64,
    /// Whether the slider slides in the state's direction; its spring then keeps its extension.
    slides: bool,
}

/// The state of [`StickSlip`].
#[derive(Debug, Clone, Copy)]
pub struct Springs<S> {
    u: f64,
    /// Direction of the motion, ±1.
    direction: f64,
    /// Displacement at which the springs were last visited.
    anchor: f64,
    /// Force at `anchor`.
    held: f64,
    /// Stiffness of the springs that stick.
    stiffness: f64,
    /// Direction · displacement at which the next of these springs breaks loose.
    reach: f64,
    list: S,
}

/// Force, tangent and work at the end of a monotone motion.
#[derive(Debug, Clone, Copy, Default)]
struct Ahead {
    force: f64,
    /// Stiffness of the springs that stick at the end of the motion.
    tangent: f64,
    work: f64,
}

impl<'a> StickSlip<'a> {
    /// The memory of the population `sliders`.
    #[must_use]
    pub fn new(sliders: Sliders<'a>) -> Self {
        Self { sliders, ratio: sliders.friction_ratio() }
    }

    /// The virgin state: `springs` has one entry per slider.
    ///
    /// # Errors
    /// [`Error::Length`].
    pub fn virgin<S: AsMut<[Spring]>>(&self, mut springs: S) -> Result<Springs<S>, Error> {
        check_length("springs", springs.as_mut().len(), self.sliders.len())?;
        springs.as_mut().fill(Spring::default());
        let stiffness = self.sliders.elements().map(|(_, k)| k).sum();
        let reach = self.sliders.elements().next().map_or(f64::INFINITY, |(phi, _)| phi);
        Ok(Springs { u: 0.0, direction: 1.0, anchor: 0.0, held: 0.0, stiffness, reach, list: springs })
    }

    /// For each slider at the start of a motion in `direction`: strength, stiffness, extension, and whether it goes on sliding.
    fn at<'b, S: AsRef<[Spring]>>(
        &'b self,
        state: &'b Springs<S>,
        direction: f64,
    ) -> impl Iterator<Item = (f64, f64, f64, bool)> + 'b {
        let (moved, same) = (state.u - state.anchor, direction == state.direction);
        self.sliders.elements().zip(state.list.as_ref()).map(move |((phi, k), spring)| {
            let extension = if spring.slides { spring.extension } else { spring.extension + moved };
            (phi, k, extension, spring.slides && same)
        })
    }

    /// A monotone motion to `u`, slider by slider.
    fn ahead<S: AsRef<[Spring]>>(&self, state: &Springs<S>, u: f64) -> Ahead {
        let du = u - state.u;
        let direction = 1.0_f64.copysign(du);
        let mut end = Ahead::default();
        for (phi, k, x, slides) in self.at(state, direction) {
            // Displacement from here until this slider breaks loose.
            let way = (phi - direction * x).max(0.0);
            if slides {
                end.force += k * x;
                end.work += k * x * du;
            } else if direction * du < way {
                end.force += k * (x + du);
                end.work += k * du * (x + 0.5 * du);
                end.tangent += k;
            } else {
                let (stuck, sliding) = (direction * way, self.ratio * direction * phi);
                end.force += k * sliding;
                end.work += k * (stuck * (x + 0.5 * stuck) + sliding * (du - stuck));
            }
        }
        end
    }

    /// Whether no slider breaks loose in a motion to `u`, so that the population acts as one spring.
    fn glides<S>(state: &Springs<S>, u: f64) -> bool {
        state.direction * (u - state.u) >= 0.0 && state.direction * u < state.reach
    }

    /// Force at `u` while no slider breaks loose.
    fn gliding<S>(state: &Springs<S>, u: f64) -> f64 {
        state.held + state.stiffness * (u - state.anchor)
    }

    /// Force, tangent and distance to the next break after the distance `passed` in `direction`, where every slider that breaks loose by
    /// then slides.
    fn beyond<S: AsRef<[Spring]>>(&self, state: &Springs<S>, direction: f64, passed: f64) -> [f64; 3] {
        let (mut force, mut tangent, mut next) = (0.0, 0.0, f64::INFINITY);
        for (phi, k, x, slides) in self.at(state, direction) {
            let way = phi - direction * x;
            if slides {
                force += direction * k * x;
            } else if way > passed {
                force += k * (direction * x + passed);
                tangent += k;
                next = way.min(next);
            } else {
                force += k * self.ratio * phi;
            }
        }
        [force, tangent, next]
    }
}

impl<S: AsRef<[Spring]> + AsMut<[Spring]>> Hysteresis<Springs<S>> for StickSlip<'_> {
    fn displacement(&self, state: &Springs<S>) -> f64 {
        state.u
    }

    fn joint_force(&self, state: &Springs<S>) -> f64 {
        Self::gliding(state, state.u)
    }

    fn advance(&self, state: &mut Springs<S>, u: f64) -> f64 {
        let du = u - state.u;
        if du == 0.0 || !du.is_finite() {
            return self.joint_force(state);
        }
        if !Self::glides(state, u) {
            let direction = 1.0_f64.copysign(du);
            let (moved, same) = (state.u - state.anchor, direction == state.direction);
            let (mut held, mut stiffness, mut reach) = (0.0, 0.0, f64::INFINITY);
            for ((phi, k), spring) in self.sliders.elements().zip(state.list.as_mut()) {
                let x = if spring.slides { spring.extension } else { spring.extension + moved };
                let mut slides = spring.slides && same;
                let mut extension = if slides { x } else { x + du };
                if !slides && direction * du >= phi - direction * x {
                    (extension, slides) = (self.ratio * direction * phi, true);
                }
                *spring = Spring { extension, slides };
                held += k * extension;
                if !slides {
                    stiffness += k;
                    reach = (phi - direction * extension).min(reach);
                }
            }
            let reach = direction * u + reach;
            (state.direction, state.anchor, state.held) = (direction, u, held);
            (state.stiffness, state.reach) = (stiffness, reach);
        }
        state.u = u;
        self.joint_force(state)
    }

    /// Steps from break to break to the first solution on the way. Behind a break the force is smaller, so there may be further solutions;
    /// they are not looked for.
    fn solve(&self, state: &mut Springs<S>, stiffness: f64, load: f64) -> f64 {
        if !load.is_finite() {
            return f64::NAN;
        }
        let direction = 1.0_f64.copysign(load);
        let before = direction * self.joint_force(state);
        let (goal, mut passed, mut way) = (direction * load, 0.0, 0.0);
        for _ in 0..=self.sliders.len() {
            let [force, tangent, next] = self.beyond(state, direction, passed);
            let rest = goal - stiffness * passed - (force - before);
            way = passed + rest.max(0.0) / (stiffness + tangent);
            if way < next {
                break;
            }
            passed = next;
        }
        let u = state.u + direction * way;
        self.advance(state, u);
        direction * way
    }

    fn stored_energy(&self, state: &Springs<S>) -> f64 {
        self.at(state, state.direction).map(|(_, k, x, _)| 0.5 * k * x * x).sum()
    }
}

impl<S: AsRef<[Spring]> + AsMut<[Spring]>> Trial<Springs<S>> for StickSlip<'_> {
    fn trial(&self, state: &Springs<S>, u: f64) -> (f64, f64) {
        if Self::glides(state, u) {
            return (Self::gliding(state, u), state.stiffness);
        }
        let end = self.ahead(state, u);
        (end.force, end.tangent)
    }

    fn mean_beyond_ends(&self, state: &Springs<S>, u: f64) -> (f64, f64) {
        let du = u - state.u;
        if Self::glides(state, u) || du == 0.0 || !du.is_finite() {
            return (0.0, 0.0);
        }
        let end = self.ahead(state, u);
        let (mean, before) = (end.work / du, self.joint_force(state));
        (mean - 0.5 * (before + end.force), (end.force - mean) / du - 0.5 * end.tangent)
    }
}
