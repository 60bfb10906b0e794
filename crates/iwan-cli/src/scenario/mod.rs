//! Scenario files: modes, force, time axis and method, read with messages that say where and what helps.

mod built_in;
mod force;
mod method;
mod mode;
mod structure;
mod read;
mod write;

#[cfg(test)]
mod schema_tests;

pub(crate) use built_in::{SCHEMA, built_in};
pub(crate) use force::Force;
pub(crate) use iwan_input::{InputText, WrittenLaw};
pub(crate) use method::{Overrides, Representation};
pub(crate) use mode::ScenarioMode;
pub(crate) use read::Scenario;
pub(crate) use structure::{OnStructure, population};
pub(crate) use write::to_toml;
