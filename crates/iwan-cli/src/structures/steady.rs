//! A structure prepared for harmonic balance.

use iwan_fem::Model;
use iwan_input::{Drive, RunError, SteadyStructure, SteadyTask};

use super::linear::Linear;
use crate::failure::Failure;
use crate::progress::Bar;

/// The settings of the steady vibration.
#[derive(Debug, Clone)]
pub(crate) struct Asked {
    pub(crate) drive: Drive,
    /// Name of the output whose motion is the response.
    pub(crate) at: Option<String>,
    /// Viscous damping ratio of every elastic mode.
    pub(crate) damping_ratio: f64,
    pub(crate) model: Model,
}

/// Reduces the structure; `bar` shows the progress, and Ctrl-C ends the work.
pub(crate) fn steady(linear: &Linear, asked: Asked, bar: &Bar) -> Result<SteadyStructure, Failure> {
    let (own, teller) = (linear.clone(), bar.teller());
    let found = bar.wait(move || {
        let Asked { drive, at, damping_ratio, model } = asked;
        let task = SteadyTask { drive, at: at.as_deref(), damping_ratio, model };
        own.file.steady(&own, &task, &|share: f64| teller.report(share))
    })?;
    found.map_err(|error| match error {
        RunError::Analysis(error) => linear.failed(&error),
        RunError::Input(error) => linear.refused(error),
    })
}
