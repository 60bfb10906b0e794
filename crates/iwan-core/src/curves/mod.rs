//! Curves: a mode known by its frequency and damping ratio against amplitude, without a joint law behind them.

mod slopes;
mod mode_curves;
mod averaging;
mod newmark;

pub use averaging::AveragedCurves;
pub use mode_curves::{CurvePoint, ModeCurves, Rate};
pub use newmark::{CurveNewmark, CurvesEnd};
