//! `iwan simulate` from the scenario to its results.

use std::time::Instant;

use iwan_input::InputText;
use iwan_input::scenario::{Scenario, built_in, to_toml};
use iwan_sim::{CoupledResponse, SimulationError, superpose};

use super::args::SimulateArgs;
use super::explain::explain;
use super::files::{FORCE, names, response_columns, write_input, write_response};
use super::report::{self, Reported};
use super::streamed;
use super::structure;
use super::summary::SimulationSummary;
use crate::failure::Failure;
use crate::session::{SUMMARY, Session};

/// Runs the command.
pub(crate) fn run(args: &SimulateArgs) -> Result<(), Failure> {
    let source = match &args.scenario {
        Some(path) => InputText::read(path, "scenario", "paper-modal")?,
        None => built_in()[0].source(),
    };
    let scenario = args.read(&source)?;
    if args.keeping.checkpoint.is_some() && scenario.structure.is_none() {
        let message = "--checkpoint is for scenarios on a structure: modes are stepped in seconds";
        return Err(Failure::input(
            message,
            "leave it out; a response of any length is written with --stream",
        ));
    }
    match &scenario.structure {
        _ if args.stream => streamed::run(args, &source.name, &scenario),
        Some(on) => structure::run(args, &source.name, &scenario, on),
        None => run_modes(args, &source.name, &scenario),
    }
}

/// Runs a scenario of modes.
fn run_modes(args: &SimulateArgs, name: &str, scenario: &Scenario) -> Result<(), Failure> {
    let mut session = Session::open(args.place(), &args.common, names(scenario, args.format))?;
    session.notes(scenario.notes());

    let clock = Instant::now();
    let response = compute(scenario, &session).map_err(|error| explain(name, &error))?;
    let seconds = clock.elapsed().as_secs_f64();
    let points = superpose(&scenario.modes(), &response.modes);
    let summary = SimulationSummary::new(scenario, name, &response, &points, seconds);

    let times: Vec<f64> = response.modes.first().map(|r| r.times().collect()).unwrap_or_default();
    let mut columns = response_columns(&times, scenario, &response.modes, &points);
    for joint in &response.joints {
        columns.push((format!("{}.slip", joint.name), &joint.slip));
        columns.push((format!("{}.force", joint.name), &joint.force));
    }
    write_response(&mut session, args, columns, "rename modes or points in the scenario")?;
    session.summary(SUMMARY, &summary)?;
    let toml = to_toml(scenario, FORCE);
    let reported =
        Reported { scenario, toml: &toml, response: &response, points: &points, summary: &summary };
    session.page(&report::render(&reported))?;
    write_input(&mut session, scenario, &toml)?;
    session.finish(&summary)
}

/// Computes the response; `joints` of the result are those that modes share.
fn compute(scenario: &Scenario, session: &Session) -> Result<CoupledResponse, SimulationError> {
    let bar = session.bar("simulating");
    let (modes, joints, force) = (scenario.modes(), scenario.joints(), scenario.force.pulse());
    let (settings, threads) = (&scenario.settings, session.threads());
    if joints.is_empty() {
        let modes = iwan_sim::simulate_all(&modes, &force, settings, threads, &|share| bar.report(share))?;
        return Ok(CoupledResponse { modes, ..CoupledResponse::default() });
    }
    iwan_sim::simulate_coupled(&modes, &joints, &force, settings, threads, &|share| bar.report(share))
}
