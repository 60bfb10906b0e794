//! What an identification is given.

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

/// How an identification goes about it; `Settings::default()` finds everything itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    /// How the mode is taken out of each record.
    pub options: Options,
    /// The envelope that curves and verdict are made from.
    pub method: Method,
    /// Parameters that keep a given value.
    pub held: Vec<Held>,
}

/// A parameter that keeps its value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Held {
    /// Which one.
    pub parameter: Parameter,
    /// Its value.
    pub value: f64,
}
