//! Half cycles: free decay from one turning point to the next, without time steps.

mod phase;
mod micro_slip;
mod macro_slip;
mod map;
mod dormand_prince;
mod decay;
mod march;

pub use decay::{Decay, PathNode, TurningPoint};
pub use map::HalfCycleTables;
