//! Iwan friction models and modal single-degree-of-freedom ring-down, without an allocator.
//!
//! The modules below stand in floors: each imports only from those above it.
#![no_std]

// Ground floor, which the rest of the crate uses: errors, progress of long work, functions at compile time, line search, Gauss-Legendre
// rules.
mod error;
pub mod progress;
mod random;
mod elementary;
mod line_search;
pub mod quadrature;

// Laws: a joint law is given by its virgin curve (backbone), from which its cycles follow.
mod law;

// Parts: dampers and springs beside a joint, without memory.
mod parts;

// Memories: the hysteretic force of a law along any history of displacement.
mod memory;

// Steps: motion of one mode with a joint, by time steps or from event to event.
mod step;

// Coupled modes: linear oscillators that share joints.
mod coupled;

// Half cycles: free decay from one turning point to the next, without time steps.
mod half_cycle;

// Curves: a mode known by its frequency and damping against amplitude, without a law.
mod curves;

// Steady vibration: the joint in the frequency domain, without time steps.
mod steady;

pub use coupled::{
    CoupledEnergy, CoupledJoint, CoupledMode, CoupledModes, CoupledMotion, CoupledRows, JointsInMotion,
    LANES, Lanes, OneJoint, SeveralJoints, groups,
};
pub use curves::{AveragedCurves, CurveNewmark, CurvePoint, CurvesEnd, ModeCurves, Rate};
pub use error::Error;
pub use half_cycle::{Decay, HalfCycleTables, PathNode, TurningPoint};
pub use law::{
    Backbone, DensityPoint, FiveParameter, FixedPower, FourParameter, Grid, Jenkins, LawSlopes, PowerLaw,
    Representation, TabledFourParameter, Tabulated, Uniform,
};
pub use line_search::search_line;
pub use memory::{
    Continuum, Extensions, Hysteresis, NoJoint, Plain, Reversal, Reversals, Run, Runs, Slider, Sliders,
    Spring, Springs, StickSlip, Straight, Trial,
};
pub use parts::{Coulomb, Part, Pinning, PowerDamping, PowerSpring, sum_of_parts};
pub use progress::Progress;
pub use random::SplitMix64;
pub use steady::{Harmonics, MOST_HARMONICS, SteadyWork, one_harmonic, steady_force};
pub use step::{
    AmplitudePhase, Averaging, EnergyBalance, EventDriven, JointEnergy, ModalLaw, Motion, Newmark,
    Oscillator, PartsEnd, Pulse, ResidualStiffness, Samples, WithParts,
};
