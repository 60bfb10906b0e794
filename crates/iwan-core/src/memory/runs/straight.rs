//! Straight pieces of F(u): between two sliders breaking loose, the force of a population is linear in u.

/// The straight piece of F(u) on which a state stands, in the distance x = u - anchor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Segment {
    pub(crate) anchor: f64,
    /// Force at x = 0 on the extended straight line.
    pub(crate) base: f64,
    /// Slope dF/du.
    pub(crate) stiffness: f64,
    /// Distance direction·x at which the next slider breaks loose.
    pub(crate) reach: f64,
}

/// A straight piece of F(u): while the motion keeps its direction and lies between `start` and `end`, F = base + stiffness·(u - anchor),
/// and the state need not be updated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Straight {
    /// Displacement from which the piece measures its distance.
    pub anchor: f64,
    /// Force at the anchor, on the extended straight line.
    pub base: f64,
    /// Slope dF/du.
    pub stiffness: f64,
    /// Direction of motion, ±1.
    pub direction: f64,
    /// Displacement at which the piece begins: the state's own displacement, or where the last slider breaks loose.
    pub start: f64,
    /// Displacement at which the next slider breaks loose.
    pub end: f64,
}

impl Straight {
    /// Whether a motion in the piece's direction is still on the piece at the displacement `u`.
    #[inline]
    #[must_use]
    pub fn holds(&self, u: f64) -> bool {
        self.direction * (u - self.start) >= 0.0 && self.direction * (self.end - u) >= 0.0
    }

    /// Passes every number of the piece to `see`, as [`Runs::each_number`](crate::Runs::each_number) does.
    pub fn each_number(&mut self, see: &mut dyn FnMut(&mut f64)) {
        let Self { anchor, base, stiffness, direction, start, end } = self;
        [anchor, base, stiffness, direction, start, end].into_iter().for_each(see);
    }

    /// Force at the displacement `u`.
    #[inline]
    #[must_use]
    pub fn force(&self, u: f64) -> f64 {
        self.base + (u - self.anchor) * self.stiffness
    }
}

impl Segment {
    #[inline]
    pub(super) fn towards(&self, direction: f64, start: f64) -> Straight {
        let Self { anchor, base, stiffness, reach } = *self;
        Straight { anchor, base, stiffness, direction, start, end: anchor + direction * reach }
    }

    /// How much the straight line at the displacement `u` lies above `force`.
    #[inline]
    pub(crate) fn gap(&self, u: f64, force: f64) -> f64 {
        self.base + self.stiffness * (u - self.anchor) - force
    }
}
