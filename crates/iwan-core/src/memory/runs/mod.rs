//! Run-length memory: the exact force of N sliders at a cost independent of N.
//!
//! All sliders start unloaded and see the same displacement. So the state of the whole population is a direction d, a frontier (the sliders
//! below it slip in direction d) and a short list of *runs*. A run is a range of sliders that last slipped together, in direction s, and
//! have moved as one since the displacement a at which they stuck. Slider i of a run has the extension s φ_i + (u - a); the virgin run has
//! s = 0. With K(j) = Σ k of the sliders from j on, M(j) = Σ k φ below j, and e the end of the topmost run,
//!
//! F(u) = (d - s) M(j) + s M(e) + C + (u - a) K(j),
//!
//! where C is the force of all older runs at a, fixed when the run was made. The force is a function of the state and not a sum over the
//! past, so rounding errors do not accumulate.

mod straight;
mod state;
mod trial;

pub use state::{Run, Runs};
pub(crate) use straight::Segment;
pub use straight::Straight;
