//! Ring-downs of modes with Iwan joints: the core, which allocates nothing, with owned memory, threads and error estimates.
//!
//! [`Mode`] + [`Pulse`](iwan_core::Pulse) + [`Settings`] -> [`simulate`] -> [`Response`].
//!
//! The modules below stand in floors: each imports only from those above it.

// Ground floor, which the other modules use: errors of a simulation, numbers as text.
mod error;
pub mod numbers;

// What the user describes: joint laws, curves, modes, time axis and method.
mod joint_law;
mod curves;
mod mode;
mod settings;

// What a simulation returns, and the cycles in it.
mod response;
mod cycles;

// One mode by one method, with the companion runs that estimate its errors.
mod methods;

// Entry points: a joint driven through displacements, modes under a force, responses of any length, the many members of an ensemble.
mod force_history;
mod simulate;
mod stream;
mod ensemble;

// Time responses of modes that share joints.
mod coupled;

// Steady vibration by harmonic balance: no time steps, no start values.
mod steady;

pub use coupled::{CoupledResponse, JointHistory, SharedJoint, check_coupled, simulate_coupled};
pub use curves::Curves;
pub use cycles::{Cycle, Extreme, cycles, extremes};
pub use ensemble::{Ensemble, Figures, History, MemberError, Outcome};
pub use error::SimulationError;
pub use force_history::force_history;
pub use iwan_machine::threads::in_parallel;
pub use joint_law::{JointLaw, TabulatedDensity};
pub use mode::{Mode, Point};
pub use response::{OutsideCurves, Quality, Response, Totals, superpose};
pub use settings::{Method, Settings};
pub use simulate::{simulate, simulate_all};
pub use steady::{
    BackbonePoint, Control, JointedModes, Jump, NonlinearMode, Residual, SharedLaw, SlipJoint, SteadyCurve,
    SteadyPoint, StuckMode, StuckRange, Superharmonic, Sweep, backbone, forced_response, forced_response_of,
    nonlinear_mode,
};
pub use stream::{Stretch, stream};

// How a joint is evaluated in time is the same question for a mode and for a structure.
pub use iwan_core::Representation;
