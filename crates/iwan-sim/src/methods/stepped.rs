//! One mode in time steps, which can be continued one stretch of samples after another.

use iwan_core::{
    Backbone, Continuum, CurveNewmark, CurvePoint, EnergyBalance, Error, Hysteresis, JointEnergy, Motion,
    Newmark, NoJoint, Oscillator, Representation, Reversals, Run, Samples, Slider, Sliders, Spring,
    StickSlip, TabledFourParameter, Trial, WithParts,
};

use crate::error::SimulationError;
use crate::joint_law::JointLaw;
use crate::joint_law::with_law;
use crate::methods::task::{Room, Task};
use crate::mode::Mode;

/// A mode at one of its samples, from which it can be stepped further.
pub(crate) trait Stepped {
    /// Steps over the samples of `out`, of which the first is the present sample; `force` begins at that sample.
    fn advance(&mut self, force: &[f64], out: &mut Samples<'_>) -> Result<(), Error>;

    /// The energy balance of the latest steps. A caller asks for it either after each `advance` or never.
    fn balance(&mut self, force: &[f64], out: &Samples<'_>) -> EnergyBalance;

    /// Bound on the error of the joint's force from reversals that were forgotten because memory was full; 0 means exact.
    fn forgotten(&self) -> f64 {
        0.0
    }
}

/// The mode of a task at its first sample, for Newmark's scheme with the joint in the given representation.
pub(crate) fn begin<'a>(
    task: Task<'a>,
    scheme: &Newmark,
    joint: Representation,
    room: &'a mut Room,
) -> Result<Box<dyn Stepped + 'a>, SimulationError> {
    let mode = task.mode;
    if let Some(curves) = &mode.curves {
        let stepper = CurveNewmark::new(curves.points(), task.dt, scheme.is_prewarped())?;
        return Ok(Box::new(ByCurves { stepper, at: mode.initial, energy: EnergyBalance::default() }));
    }
    let oscillator = mode.oscillator()?;
    let begun = Begun { mode, scheme: *scheme, oscillator };
    let Some(law) = &mode.joint else { return begun.with(NoJoint, 0.0, |_| 0.0) };
    match joint {
        Representation::Sliders { bins, grid } => {
            room.table.resize(Sliders::table_len(bins), Slider::default());
            let sliders = with_law!(law, law => Sliders::discretise(law, grid, bins, &mut room.table))?;
            if mode.friction_drops() {
                let joint = StickSlip::new(sliders);
                let state = joint.virgin(vec![Spring::default(); sliders.len()])?;
                return begun.beside_parts(joint, state, |_| 0.0);
            }
            let state = sliders.virgin(vec![Run::default(); sliders.len()])?;
            if !mode.parts.is_empty() {
                return begun.with(sliders, state, |_| 0.0);
            }
            let step = move |j: &Sliders<'_>, s: &mut _, v, f: &[f64], out: &mut Samples<'_>| {
                begun.scheme.integrate_sliders(&begun.oscillator, j, s, v, f, out)
            };
            Ok(Box::new(begun.jointed(sliders, state, step, |_| 0.0)))
        }
        Representation::Continuum => match law {
            JointLaw::FourParameter(law) if mode.parts.is_empty() => {
                begun.continuum(TabledFourParameter::new(*law), room.reversals)
            }
            law => with_law!(law, law => begun.continuum(law, room.reversals)),
        },
    }
}

/// Data with which every kind of mode stepped by Newmark's method begins.
#[derive(Clone, Copy)]
struct Begun<'a> {
    mode: &'a Mode,
    scheme: Newmark,
    oscillator: Oscillator,
}

impl<'a> Begun<'a> {
    /// The mode with its joint in the continuum, with room for `reversals` reversals.
    fn continuum<B: Backbone + 'a>(
        self,
        law: B,
        reversals: usize,
    ) -> Result<Box<dyn Stepped + 'a>, SimulationError> {
        let joint = Continuum::new(law);
        let state = joint.virgin(vec![iwan_core::Reversal::default(); reversals])?;
        self.with(joint, state, Reversals::forgotten)
    }

    /// The mode on the path for any joint, with the mode's parts if it has some.
    fn with<S: 'a, J: Trial<S> + 'a>(
        self,
        joint: J,
        state: S,
        forgotten: fn(&S) -> f64,
    ) -> Result<Box<dyn Stepped + 'a>, SimulationError> {
        if self.mode.parts.is_empty() {
            let step = move |j: &J, s: &mut S, v, f: &[f64], out: &mut Samples<'_>| {
                self.scheme.integrate(&self.oscillator, j, s, v, f, out)
            };
            return Ok(Box::new(self.jointed(joint, state, step, forgotten)));
        }
        self.beside_parts(joint, state, forgotten)
    }

    /// The mode on the path for parts, even if it has none: this path handles joint forces that jump.
    fn beside_parts<S: 'a, J: Trial<S> + 'a>(
        self,
        joint: J,
        mut state: S,
        forgotten: fn(&S) -> f64,
    ) -> Result<Box<dyn Stepped + 'a>, SimulationError> {
        let with = WithParts::new(&self.scheme, &self.oscillator, &self.mode.parts)?;
        joint.advance(&mut state, self.mode.initial.displacement);
        Ok(Box::new(BesideParts {
            with,
            joint,
            state,
            velocity: self.mode.initial.velocity,
            energy: EnergyBalance::default(),
            forgotten,
        }))
    }

    fn jointed<S, J: Hysteresis<S>, F>(
        self,
        joint: J,
        mut state: S,
        step: F,
        forgotten: fn(&S) -> f64,
    ) -> Jointed<J, S, F> {
        joint.advance(&mut state, self.mode.initial.displacement);
        let Self { mode, scheme, oscillator } = self;
        let stored = joint.stored_energy(&state);
        Jointed { scheme, oscillator, joint, state, velocity: mode.initial.velocity, stored, step, forgotten }
    }
}

/// A mode with a joint and no parts.
struct Jointed<J, S, F> {
    scheme: Newmark,
    oscillator: Oscillator,
    joint: J,
    state: S,
    velocity: f64,
    /// Energy of the joint's springs at the end of the last balance. It is kept because computing it takes as long as many steps if there
    /// are many reversals.
    stored: f64,
    /// Steps the mode from a velocity; returns the final velocity.
    step: F,
    forgotten: fn(&S) -> f64,
}

impl<J, S, F> Stepped for Jointed<J, S, F>
where
    J: Hysteresis<S>,
    F: FnMut(&J, &mut S, f64, &[f64], &mut Samples<'_>) -> Result<f64, Error>,
{
    fn advance(&mut self, force: &[f64], out: &mut Samples<'_>) -> Result<(), Error> {
        self.velocity = (self.step)(&self.joint, &mut self.state, self.velocity, force, out)?;
        Ok(())
    }

    fn balance(&mut self, force: &[f64], out: &Samples<'_>) -> EnergyBalance {
        let end = self.joint.stored_energy(&self.state);
        let stored = JointEnergy { start: std::mem::replace(&mut self.stored, end), end };
        self.scheme.energy(&self.oscillator, stored, force, out)
    }

    fn forgotten(&self) -> f64 {
        (self.forgotten)(&self.state)
    }
}

/// A mode with parts beside its joint.
struct BesideParts<'a, J, S> {
    with: WithParts<'a>,
    joint: J,
    state: S,
    velocity: f64,
    /// Energy balance of the latest steps.
    energy: EnergyBalance,
    forgotten: fn(&S) -> f64,
}

impl<J: Trial<S>, S> Stepped for BesideParts<'_, J, S> {
    fn advance(&mut self, force: &[f64], out: &mut Samples<'_>) -> Result<(), Error> {
        let end = self.with.integrate(&self.joint, &mut self.state, self.velocity, force, out)?;
        (self.velocity, self.energy) = (end.velocity, end.energy);
        Ok(())
    }

    fn balance(&mut self, _: &[f64], _: &Samples<'_>) -> EnergyBalance {
        self.energy
    }

    fn forgotten(&self) -> f64 {
        (self.forgotten)(&self.state)
    }
}

/// A mode given by curves.
struct ByCurves<'a, P> {
    stepper: CurveNewmark<'a, P>,
    at: Motion,
    /// Energy balance of the latest steps.
    energy: EnergyBalance,
}

impl<P: AsRef<[CurvePoint]>> Stepped for ByCurves<'_, P> {
    fn advance(&mut self, force: &[f64], out: &mut Samples<'_>) -> Result<(), Error> {
        let end = self.stepper.integrate(self.at, force, out)?;
        (self.at, self.energy) = (end.motion, end.energy);
        Ok(())
    }

    fn balance(&mut self, _: &[f64], _: &Samples<'_>) -> EnergyBalance {
        self.energy
    }
}
