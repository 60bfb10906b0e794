#![doc = include_str!("../README.md")]

pub use iwan_core as core;
pub use iwan_io as io;
pub use iwan_sim as sim;
