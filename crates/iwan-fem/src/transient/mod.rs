//! Transients of structures with slipping joints, with all unknowns or with a few coordinates in their place.

mod task;
mod joint_states;
mod slip_solver;
mod response;
mod watch;
mod full;
mod reduction;
mod reduced;
mod converged;
mod model;
mod modal_force;
mod run;
mod keep;

pub use converged::Converged;
pub use model::{BasisError, Integrated, Model, StepErrors};
pub use reduction::{Basis, Reduced};
pub use response::{History, SlipHistory, StructureResponse};
pub use run::{Extras, Frame, ModalVelocity, Run};
pub use task::{Output, Transient};
pub use watch::Watch;
