//! The files of a simulation: their names, and the columns of the response.

use iwan_input::scenario::{Force, Scenario};
use iwan_sim::Response;

use crate::args::Format;
use crate::failure::Failure;
use crate::session::{PAGE, SUMMARY, Session};

/// The run as it was, to be repeated.
pub(super) const SCENARIO: &str = "scenario.toml";

/// Name under which a force history from a file is handed on.
pub(super) const FORCE: &str = "force.csv";

/// Displacement, velocity and acceleration at a named point.
pub(crate) type PointResponse = (String, [Vec<f64>; 3]);

/// Names of the files of a run, the response first.
pub(super) fn names(scenario: &Scenario, format: Format) -> Vec<String> {
    let mut names = vec![format.file("response"), SUMMARY.into(), PAGE.into(), SCENARIO.into()];
    if matches!(scenario.force, Force::File(_)) {
        names.push(FORCE.into());
    }
    names
}

/// Writes what repeats the run: the scenario as run, and the file it takes its force from.
pub(super) fn write_input(session: &mut Session, scenario: &Scenario, toml: &str) -> Result<(), Failure> {
    session.file(SCENARIO, toml.as_bytes())?;
    match &scenario.force {
        Force::File(file) => session.file(FORCE, &file.bytes),
        Force::Formula(..) => Ok(()),
    }
}

/// The columns of the response: time, modes, points.
pub(crate) fn response_columns<'a>(
    times: &'a [f64],
    scenario: &Scenario,
    responses: &'a [Response],
    points: &'a [PointResponse],
) -> Vec<(String, &'a [f64])> {
    let mut columns = vec![("t".to_string(), times)];
    let mut add = |name: &str, quantity: &str, values: &'a [f64]| {
        columns.push((format!("{name}.{quantity}"), values));
    };
    for (mode, response) in scenario.modes.iter().zip(responses) {
        add(&mode.mode.name, "displacement", &response.displacement);
        add(&mode.mode.name, "velocity", &response.velocity);
        add(&mode.mode.name, "acceleration", &response.acceleration);
        add(&mode.mode.name, "joint_force", &response.joint_force);
    }
    for (name, [displacement, velocity, acceleration]) in points {
        add(name, "displacement", displacement);
        add(name, "velocity", velocity);
        add(name, "acceleration", acceleration);
    }
    columns
}
