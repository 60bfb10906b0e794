//! A joint driven along a history, with what must hold at every step.

use iwan_core::{Backbone, Hysteresis, Trial};

/// One step of a history.
#[derive(Debug, Clone, Copy)]
pub enum Move {
    /// To a displacement.
    To(f64),
    /// By a displacement.
    By(f64),
    /// To a displacement that is not finite, which moves nothing.
    Nowhere(f64),
    /// One implicit step.
    Load {
        /// Stiffness beside the joint.
        stiffness: f64,
        /// What stiffness and joint take up.
        load: f64,
    },
}

impl Move {
    /// Takes a joint there and returns the way.
    pub fn take<S, J: Hysteresis<S>>(self, joint: &J, state: &mut S) -> f64 {
        let u = joint.displacement(state);
        match self {
            Self::To(to) | Self::Nowhere(to) => _ = joint.advance(state, to),
            Self::By(by) => _ = joint.advance(state, u + by),
            Self::Load { stiffness, load } => return joint.solve(state, stiffness, load),
        }
        joint.displacement(state) - u
    }
}

/// Sizes of a law, which rounding is measured by.
#[derive(Debug, Clone, Copy)]
pub struct Law {
    /// Initial stiffness.
    pub k_t: f64,
    /// Slip force.
    pub f_s: f64,
    /// Strength of the strongest slider.
    pub strongest: f64,
}

impl Law {
    /// The sizes of a law.
    pub fn of<B: Backbone + ?Sized>(law: &B) -> Self {
        Self { k_t: law.initial_stiffness(), f_s: law.slip_force(), strongest: law.strengths().1 }
    }
}

/// A joint with its state, and how far it has been.
pub struct Driven<'a, J, S> {
    joint: &'a J,
    state: S,
    law: Law,
    far: f64,
    steps: f64,
}

impl<J, S: Clone> Clone for Driven<'_, J, S> {
    fn clone(&self) -> Self {
        Self { state: self.state.clone(), ..*self }
    }
}

impl<'a, S: Clone, J: Hysteresis<S>> Driven<'a, J, S> {
    /// From the virgin state.
    pub fn new(joint: &'a J, state: S, law: Law) -> Self {
        Self { joint, state, law, far: 0.0, steps: 1.0 }
    }

    /// Where the joint stands.
    pub fn displacement(&self) -> f64 {
        self.joint.displacement(&self.state)
    }

    /// What rounding may do to the force.
    pub fn rounding(&self) -> f64 {
        let Law { k_t, f_s, strongest } = self.law;
        self.steps * (1e-12 * f_s + 32.0 * f64::EPSILON * k_t * (strongest + self.far))
    }

    /// Takes one step and returns the force behind it.
    ///
    /// # Panics
    /// Where the force leaves the slip force, the energy is not one that springs can hold, friction gives energy back, or an
    /// implicit step does not solve its equation.
    pub fn go(&mut self, go: Move) -> f64 {
        let (u, force) = (self.joint.displacement(&self.state), self.joint.joint_force(&self.state));
        let energy = self.joint.stored_energy(&self.state);
        let du = go.take(self.joint, &mut self.state);
        let (there, then) = (self.joint.displacement(&self.state), self.joint.joint_force(&self.state));
        match go {
            Move::To(_) | Move::By(_) => {}
            Move::Nowhere(_) => assert_eq!((there, then), (u, force)),
            Move::Load { stiffness, load } => {
                let rest = load - stiffness * du - (then - force);
                // A first trial point may lie as far off as the motion has been.
                let reach = u.abs() + there.abs() + self.far;
                let places = 64.0 * f64::EPSILON * (stiffness + self.law.k_t) * reach;
                let room = 1e-9 * load.abs() + places + self.rounding();
                assert!(
                    rest.abs() <= room,
                    "rest {rest} of {go:?} over {room} from {u} {force} to {there} {then}"
                );
            }
        }
        self.steps += 1.0;
        self.hold([u, force, energy], go)
    }

    /// What holds behind a step from a displacement, force and stored energy.
    fn hold(&mut self, [u, force, energy]: [f64; 3], go: Move) -> f64 {
        let (there, then) = (self.joint.displacement(&self.state), self.joint.joint_force(&self.state));
        self.far = self.far.max(there.abs());
        let rounding = self.rounding();
        assert!(then.abs() <= self.law.f_s + rounding, "force {then} of {:?} at {there}, {go:?}", self.law);
        let stored = self.joint.stored_energy(&self.state);
        let places = f64::EPSILON * self.far;
        let room = rounding * (self.law.strongest + places);
        let most = 0.5 * self.law.f_s * self.law.strongest + room;
        assert!(
            (-room..=most).contains(&stored),
            "stored {stored} of {most}, {room} for rounding, {:?} at {there}, {go:?}",
            self.law
        );
        // Along one way the force against the motion only grows: the work is at most its last value times the way.
        let way = there - u;
        let most = then.max(force) * way.max(0.0) - then.min(force) * (-way).max(0.0);
        let gained = stored - energy - most;
        assert!(
            gained <= room + rounding * way.abs() + room,
            "{gained} gained from {u} to {there}, {go:?}, {:?}",
            self.law
        );
        then
    }
}

impl<S: Clone, J: Trial<S>> Driven<'_, J, S> {
    /// As [`go`](Self::go), and the force told ahead is the force met.
    ///
    /// # Panics
    /// As [`go`](Self::go), and where the force ahead is another.
    pub fn go_as_told(&mut self, go: Move) -> f64 {
        let to = match go {
            Move::To(to) => to,
            Move::By(by) => self.joint.displacement(&self.state) + by,
            Move::Nowhere(_) | Move::Load { .. } => return self.go(go),
        };
        let (ahead, tangent) = self.joint.trial(&self.state, to);
        let then = self.go(go);
        let room = self.rounding();
        assert!((ahead - then).abs() <= room, "{ahead} ahead, {then} there, {room} apart at most, {go:?}");
        let k_t = self.law.k_t;
        assert!((-1e-9 * k_t..=k_t * (1.0 + 1e-9)).contains(&tangent), "tangent {tangent} of {k_t} at {to}");
        then
    }
}
