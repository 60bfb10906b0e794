//! Reasons why a simulation failed, in the user's terms.

use iwan_sim::SimulationError;

use crate::failure::Failure;

/// A failed simulation in the user's terms: a scenario that cannot be set up is bad input, any other error a failed computation.
pub(super) fn explain(name: &str, error: &SimulationError) -> Failure {
    let root = match error {
        SimulationError::Mode { source, .. } | SimulationError::Joint { source, .. } => source,
        other => other,
    };
    match root {
        SimulationError::Interrupted => Failure::Interrupted,
        SimulationError::Memory(short) => Failure::lacking(&format!("{name}: {short}")),
        SimulationError::Parameter(_) => Failure::input(
            format!("{name}: {error}"),
            "change this in the scenario, or choose another method",
        )
        .of(root.kind()),
        _ => Failure::computation(format!("{name}: {error}")).of(root.kind()),
    }
}
