//! Ring-down of bolted structures with Iwan friction models: one door to all crates.
pub use iwan_core as core;
pub use iwan_sim as sim;
