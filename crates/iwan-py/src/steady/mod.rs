//! Steady vibration of modes: forced responses and backbones.

pub(crate) mod frf;
pub(crate) mod backbone;
pub(crate) mod coupled;
