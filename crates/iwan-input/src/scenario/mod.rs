//! Scenario files: modes, force, time axis and method, read with messages that name the place and what helps.

mod built_in;
mod force;
mod method;
mod part;
mod curves;
mod mode;
mod joint;
mod structure;
mod sweep;
mod read;
mod steady;
mod write;

#[cfg(test)]
mod schema_tests;

pub use built_in::{BuiltIn, SCHEMA, built_in};
pub use force::{Force, ForceFile};
pub use joint::ScenarioJoint;
pub use method::{JointChoice, MOST_SLIDERS, Overrides};
pub use mode::ScenarioMode;
pub use read::Scenario;
pub use steady::SteadyScenario;
pub use structure::{OnStructure, Origin, representation};
pub use sweep::SweepTable;
pub use write::to_toml;
