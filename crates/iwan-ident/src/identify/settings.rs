//! The input of an identification.

use crate::curves::Quantity;
use crate::parameters::Parameter;
use crate::signal::{Method, Options};

/// A record of one mode, mass-normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModeRecord<'a> {
    /// Uniform samples.
    pub samples: &'a [f64],
    /// Sampling interval, s.
    pub dt: f64,
    /// What was measured.
    pub quantity: Quantity,
}

/// Settings of an identification; `Settings::default()` finds everything by itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    /// How the mode is isolated in each record.
    pub options: Options,
    /// The envelope from which curves and verdict are made.
    pub method: Method,
    /// Parameters that keep a given value.
    pub held: Vec<Held>,
}

/// A parameter that keeps a given value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Held {
    /// The parameter.
    pub parameter: Parameter,
    /// Its value.
    pub value: f64,
}
