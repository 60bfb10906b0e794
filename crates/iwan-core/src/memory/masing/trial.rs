//! The force that a continuum under return-point memory would have at another displacement, without moving the state.

use super::branch::{Branch, Reversal};
use super::continuum::Continuum;
use super::reversals::Reversals;
use crate::law::Backbone;
use crate::memory::hysteresis::Trial;

impl<S: AsRef<[Reversal]> + AsMut<[Reversal]>> Reversals<S> {
    /// The branch on which a motion to `u` would end: the same as [`reverse`](Self::reverse) with closing of loops, but the state stays
    /// unchanged.
    fn branch_towards(&self, u: f64, strongest: f64) -> Branch {
        let mut branch = self.branch;
        let (mut depth, mut origin) = (self.depth, self.origin);
        if (u - self.u) * branch.direction < 0.0 {
            let (travelled, back) = (branch.virgin_distance(self.u), -branch.direction);
            if travelled == 0.0 {
                depth = depth.saturating_sub(1);
                branch = self.branch_at(depth, back);
            } else {
                if travelled >= strongest {
                    (depth, origin) = (0, self.u + back * strongest);
                }
                let end = if depth == 0 { 2.0 * origin - self.u } else { self.stack.as_ref()[depth - 1].u };
                let start = Reversal { u: self.u, force: self.force };
                branch = Branch::behind(start, back, end);
                depth += 1;
            }
        }
        while branch.passed_by(u) {
            depth = depth.saturating_sub(2);
            let next = self.branch_at(depth, branch.direction);
            branch = if depth == 0 { Branch::virgin(origin, branch.direction) } else { next };
        }
        branch
    }
}

impl<B: Backbone, S: AsRef<[Reversal]> + AsMut<[Reversal]>> Trial<Reversals<S>> for Continuum<B> {
    /// The result equals that of the motion itself, except with a full stack: the motion would forget a loop that is still remembered here.
    fn trial(&self, state: &Reversals<S>, u: f64) -> (f64, f64) {
        if u == state.u {
            return (state.force, state.tangent);
        }
        state.branch_towards(u, self.law().strengths().1).force_and_tangent(self.law(), u)
    }
}
