//! Joints of a structure from frequency and damping of several of its modes against amplitude.
//!
//! The forward model computes quasi-static curves of the reduced structure ([`iwan_fem::Adjustable`]), in which each joint is a law over its slip, so
//! that information on a joint from one mode holds for all modes. The unknowns are the parameters of each group of joints, factors on parts of the
//! linear stiffness, and the viscous damping of each measured mode.

mod measured;
mod group;
mod model;
mod fitted;
mod verdict;
mod predicted;
mod further;
mod task;
mod mistakes;
mod explain;
mod outcome;
mod run;
mod blows;

pub use blows::{BlowTask, MeasuredBlow, update_from_blows};
pub use explain::LinearCorrection;
pub use fitted::{Estimated, JointUpdate};
pub use further::{NextMode, TradeOff};
pub use group::{JointGroup, StartLaw, groups_that_move_alike};
pub use measured::MeasuredCurve;
pub use outcome::{ComparedBlow, ComparedCurve, Told, Update};
pub use predicted::Prediction;
pub use run::update;
pub use task::UpdateTask;
pub use verdict::{Departure, Quantity, StructureVerdict};
