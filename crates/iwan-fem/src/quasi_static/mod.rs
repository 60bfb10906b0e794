//! Modal curves without a transient: frequency and dissipation over amplitude from static loads.

mod curves;
mod range;

pub use curves::{ModalCurves, QuasiStatic};
