//! Branches: the force between a reversal and the point where the loop closes, by Masing's rule.

use crate::law::Backbone;

/// A point at which the motion turned round.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Reversal {
    /// Displacement at the turning point.
    pub(crate) u: f64,
    /// Force at the turning point.
    pub(crate) force: f64,
}

impl Reversal {
    /// Placeholder where there is no reversal yet.
    pub(crate) const NONE: Self = Self { u: 0.0, force: 0.0 };

    pub(crate) const fn new(u: f64, force: f64) -> Self {
        Self { u, force }
    }
}

/// The branch on which a state moves: F = F_a + scale·direction·F_virgin(u'), where u' = (u - u_a)·direction/scale
/// and (u_a, F_a) is `start`.
///
/// With scale 2 this is Masing's rule behind a reversal, with scale 1 the virgin curve; one formula without a case distinction serves both.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Branch {
    /// The point at which the branch began: a reversal, or the origin of the virgin curve.
    pub(crate) start: Reversal,
    /// Factor on the virgin curve: 2 behind a reversal (Masing), 1 on the virgin curve itself.
    pub(crate) scale: f64,
    /// Direction over scale: a displacement from `start` times this is the displacement on the virgin curve.
    to_virgin: f64,
    /// Direction of motion, ±1.
    pub(crate) direction: f64,
    /// Displacement at which the branch closes a loop and ends (infinite on the virgin curve).
    pub(crate) end: f64,
}

impl Branch {
    /// The virgin curve from `origin`.
    pub(super) fn virgin(origin: f64, direction: f64) -> Self {
        let start = Reversal { u: origin, force: 0.0 };
        Self { start, scale: 1.0, to_virgin: direction, direction, end: direction * f64::INFINITY }
    }

    /// The branch that leaves the reversal `start` in `direction`; its loop closes at `end`.
    #[inline]
    pub(crate) fn behind(start: Reversal, direction: f64, end: f64) -> Self {
        Self { start, scale: 2.0, to_virgin: 0.5 * direction, direction, end }
    }

    /// Passes every number of the branch to `see`.
    pub(super) fn each_number(&mut self, see: &mut dyn FnMut(&mut f64)) {
        let Self { start: Reversal { u, force }, scale, to_virgin, direction, end } = self;
        [u, force, scale, to_virgin, direction, end].into_iter().for_each(see);
    }

    /// Displacement on the virgin curve that corresponds to `u`, >= 0.
    #[inline]
    pub(crate) fn virgin_distance(&self, u: f64) -> f64 {
        let distance = self.to_virgin * (u - self.start.u);
        // Not `f64::max`, which takes two more instructions to treat NaN.
        if distance > 0.0 { distance } else { 0.0 }
    }

    #[inline]
    pub(crate) fn force_and_tangent<B: Backbone>(&self, law: &B, u: f64) -> (f64, f64) {
        let (force, tangent) = law.force_and_tangent(self.virgin_distance(u));
        (self.start.force + self.scale * self.direction * force, tangent)
    }

    /// Whether the branch begins at the displacement `u`.
    pub(crate) fn start_is(&self, u: f64) -> bool {
        self.start.u == u
    }

    /// Work ∫F du from the start of the branch to `u`.
    pub(crate) fn work<B: Backbone>(&self, law: &B, u: f64) -> f64 {
        self.start.force * (u - self.start.u) + self.scale * self.scale * law.energy(self.virgin_distance(u))
    }

    /// Whether `u` lies beyond the end of the branch.
    #[inline]
    pub(crate) fn passed_by(&self, u: f64) -> bool {
        self.direction * (u - self.end) > 0.0
    }
}
