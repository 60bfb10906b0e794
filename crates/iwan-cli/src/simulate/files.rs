//! The files of a simulation: their names and the columns of the response.

use iwan_input::scenario::{Force, Scenario};
use iwan_io::Table;
use iwan_sim::Response;

use super::args::SimulateArgs;
use crate::args::Format;
use crate::failure::Failure;
use crate::session::{PAGE, SUMMARY, Session};

/// File with the scenario as run, from which the run can be repeated.
pub(super) const SCENARIO: &str = "scenario.toml";

/// File with a copy of the force history, where the scenario reads the force from a file.
pub(super) const FORCE: &str = "force.csv";

/// Quantities in the columns of a mode; a named point has the first three.
const QUANTITIES: [&str; 4] = ["displacement", "velocity", "acceleration", "joint_force"];

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

/// Writes the input from which the run can be repeated: the scenario as run, and the file of the force.
pub(super) fn write_input(session: &mut Session, scenario: &Scenario, toml: &str) -> Result<(), Failure> {
    session.file(SCENARIO, toml.as_bytes())?;
    match &scenario.force {
        Force::File(file) => session.file(FORCE, &file.bytes),
        Force::Formula(..) => Ok(()),
    }
}

/// Writes the response as the options ask for; `remedy` tells the user what to do where the names of the columns are not valid.
pub(super) fn write_response(
    session: &mut Session,
    args: &SimulateArgs,
    columns: Vec<(String, &[f64])>,
    remedy: &str,
) -> Result<(), Failure> {
    let (name, every) = (args.format.file("response"), args.every.get());
    if every > 1 {
        return session.columns(&name, &thinned(&columns, every), args.format);
    }
    let table = Table::new(columns).map_err(|error| Failure::input(error.to_string(), remedy))?;
    session.table(&name, &table, args.format)
}

/// Every `every`-th row of the columns.
fn thinned(columns: &[(String, &[f64])], every: usize) -> Vec<(String, Vec<f64>)> {
    let thin = |values: &[f64]| values.iter().copied().step_by(every).collect();
    columns.iter().map(|(name, values)| (name.clone(), thin(values))).collect()
}

/// The names of the columns of the response: time, modes, points.
pub(super) fn column_names(scenario: &Scenario, points: &[String]) -> Vec<String> {
    let modes = scenario.modes.iter().map(|mode| (&mode.mode.name, 4));
    let all = modes.chain(points.iter().map(|name| (name, 3)));
    let named = all.flat_map(|(name, count)| QUANTITIES[..count].iter().map(move |q| format!("{name}.{q}")));
    std::iter::once("t".to_string()).chain(named).collect()
}

/// The columns of the response: time, modes, points.
pub(crate) fn response_columns<'a>(
    times: &'a [f64],
    scenario: &Scenario,
    responses: &'a [Response],
    points: &'a [PointResponse],
) -> Vec<(String, &'a [f64])> {
    let of_modes = responses.iter().flat_map(|response| {
        let Response { displacement, velocity, acceleration, joint_force, .. } = response;
        [displacement, velocity, acceleration, joint_force].map(Vec::as_slice)
    });
    let of_points = points.iter().flat_map(|(_, motion)| motion.iter().map(Vec::as_slice));
    let names: Vec<String> = points.iter().map(|(name, _)| name.clone()).collect();
    let values = std::iter::once(times).chain(of_modes).chain(of_points);
    column_names(scenario, &names).into_iter().zip(values).collect()
}
