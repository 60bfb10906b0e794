//! The continuum: the continuous law by Masing's rule with return-point memory, exact and without sliders.
//!
//! The state is a stack of reversal points. On the branch that left the latest point (u_a, F_a) in direction d, the force is F_a + 2 d
//! F_virgin(|u - u_a|/2). Where the branch reaches the reversal before, the loop closes, both points are forgotten and the outer branch
//! continues (G. Masing, 1926; D. J. Segalman and M. J. Starr, Int. J. Non-Linear Mech. 43:74, 2008,
//! doi:10.1016/j.ijnonlinmec.2007.10.010). The outermost loop closes on the virgin curve.

mod branch;
mod reversals;
mod continuum;
mod trial;

pub(crate) use branch::Branch;
pub use branch::Reversal;
pub use continuum::Continuum;
pub use reversals::Reversals;
