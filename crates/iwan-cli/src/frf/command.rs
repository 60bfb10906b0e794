//! `iwan frf` from the scenario to its results.

use std::time::Instant;

use iwan_input::InputText;
use iwan_input::scenario::{SteadyScenario, built_in};
use iwan_sim::SteadyPoint;

use super::args::FrfArgs;
use super::coupled;
use super::report;
use super::responses::{Response, ask, respond};
use super::structure;
use super::summary::FrfSummary;
use crate::args::Format;
use crate::failure::Failure;
use crate::session::{PAGE, Session};

/// Table of the curves.
const TABLE: &str = "frf.csv";
/// The summary.
const SUMMARY: &str = "frf.json";

/// Runs the command.
pub(crate) fn run(args: &FrfArgs) -> Result<(), Failure> {
    let source = match &args.scenario {
        Some(path) => InputText::read(path, "scenario", "paper-modal")?,
        None => built_in()[0].source(),
    };
    let scenario = SteadyScenario::read(&source)?;
    let Some(table) = &scenario.sweep else {
        let message = format!("{}: the table [sweep] is missing", source.name);
        return Err(Failure::input(message, "add [sweep] with from, to (Hz) and force = [LEVEL, ...]"));
    };
    ask(&source.name, &table.sweep, scenario.modes.len().max(1))?;
    let mut session = Session::open(args.place(), &args.common, [TABLE, SUMMARY, PAGE])?;
    let clock = Instant::now();
    let (responses, notes) = match &scenario.structure {
        Some(on) => structure::respond(on, table, &session)?,
        None if !scenario.joints.is_empty() => coupled::respond(&source.name, &scenario, table, &session)?,
        None => respond(&source.name, &scenario, table, session.threads())?,
    };
    session.notes(&notes);
    let title = scenario.title.clone().unwrap_or_else(|| source.name.clone());
    let summary = FrfSummary::new(title, table, &responses, clock.elapsed().as_secs_f64());
    session.columns(TABLE, &columns(&responses, table.sweep.harmonics), Format::Csv)?;
    session.summary(SUMMARY, &summary)?;
    session.page(&report::render(&responses, &summary))?;
    session.finish(&summary)
}

/// The columns of the table: modes and levels stand below each other, told apart by the number of the mode and the level.
fn columns(responses: &[Response], harmonics: usize) -> Vec<(String, Vec<f64>)> {
    let curves =
        || responses.iter().enumerate().flat_map(|(n, r)| r.curves.iter().map(move |curve| (n, curve)));
    let all = |value: &dyn Fn(&SteadyPoint) -> f64| -> Vec<f64> {
        curves().flat_map(|(_, curve)| curve.points.iter().map(value)).collect()
    };
    let repeated = |value: &dyn Fn(usize, f64) -> f64| -> Vec<f64> {
        curves().flat_map(|(n, curve)| vec![value(n, curve.level); curve.points.len()]).collect()
    };
    let mut columns: Vec<(String, Vec<f64>)> = vec![
        ("mode".into(), repeated(&|n, _| (n + 1) as f64)),
        ("level".into(), repeated(&|_, level| level)),
        ("frequency".into(), all(&|p| p.frequency)),
        ("amplitude".into(), all(&|p| p.amplitude)),
        ("phase".into(), all(&|p| p.phase)),
        ("excitation".into(), all(&|p| p.excitation)),
    ];
    for (index, n) in (3..=harmonics).step_by(2).enumerate() {
        let part = |which: usize| all(&|p| p.harmonics.get(index).map_or(0.0, |harmonic| harmonic[which]));
        columns.push((format!("harmonic_{n}.amplitude"), part(0)));
        columns.push((format!("harmonic_{n}.phase"), part(1)));
    }
    columns
}
