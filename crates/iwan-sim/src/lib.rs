//! Ring-downs of modes with Iwan joints, where the allocation-free core meets memory.
//!
//! [`Mode`] + [`Pulse`](iwan_core::Pulse) + [`Settings`] -> [`simulate`] -> [`Response`].

mod ensemble;
mod error;
mod event;
mod force_history;
mod free_decay;
mod joint;
mod mode;
mod quality;
mod response;
mod run;
mod settings;
mod simulate;

mod cycles;
mod parallel;

pub use cycles::{Cycle, Extreme, cycles, extremes};
pub use ensemble::{Ensemble, Figures, History, MemberError, Outcome, Watch};
pub use error::SimulationError;
pub use force_history::force_history;
pub use joint::{JointLaw, TabulatedDensity};
pub use mode::{Mode, Point};
pub use parallel::in_parallel;
pub use response::{Quality, Response, superpose};
pub use settings::{JointKind, Method, Settings};
pub use simulate::{Observer, simulate, simulate_all};
