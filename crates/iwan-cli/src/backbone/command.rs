//! `iwan backbone` from the scenario to its results.

use std::time::Instant;

use iwan_input::InputText;
use iwan_input::scenario::{SteadyScenario, built_in};
use iwan_sim::BackbonePoint;

use super::args::BackboneArgs;
use super::curves::{Traced, harmonics, trace};
use super::report;
use super::summary::BackboneSummary;
use crate::args::Format;
use crate::failure::Failure;
use crate::session::{PAGE, SUMMARY, Session};

/// Table of the curves.
const TABLE: &str = "backbone.csv";

/// Runs the command.
pub(crate) fn run(args: &BackboneArgs) -> Result<(), Failure> {
    let source = match &args.scenario {
        Some(path) => InputText::read(path, "scenario", "paper-modal")?,
        None => built_in()[0].source(),
    };
    let scenario = SteadyScenario::read(&source)?;
    let highest = harmonics(args, &scenario)?;
    let mut session = Session::open(args.place(), &args.common, [TABLE, SUMMARY, PAGE])?;
    let clock = Instant::now();
    let traced = trace(&source.name, &scenario, args, highest, session.threads())?;
    let title = scenario.title.clone().unwrap_or_else(|| source.name.clone());
    let summary = BackboneSummary::new(title, highest, &traced, clock.elapsed().as_secs_f64());
    session.columns(TABLE, &columns(&traced, highest), Format::Csv)?;
    session.summary(SUMMARY, &summary)?;
    session.page(&report::render(&traced, &summary))?;
    session.finish(&summary)
}

/// The columns of the table: modes below each other, told apart by their number.
fn columns(traced: &[Traced], highest: usize) -> Vec<(String, Vec<f64>)> {
    let all = |value: &dyn Fn(&BackbonePoint) -> f64| -> Vec<f64> {
        traced.iter().flat_map(|t| t.curve.points.iter().map(value)).collect()
    };
    let number = |(n, t): (usize, &Traced)| vec![(n + 1) as f64; t.curve.points.len()];
    let mut columns: Vec<(String, Vec<f64>)> = vec![
        ("mode".into(), traced.iter().enumerate().flat_map(number).collect()),
        ("amplitude".into(), all(&|p| p.amplitude)),
        ("frequency".into(), all(&|p| p.frequency)),
        ("damping_ratio".into(), all(&|p| p.damping_ratio)),
    ];
    for (index, n) in (3..=highest).step_by(2).enumerate() {
        let part = all(&|p| p.response.get(index + 1).copied().unwrap_or(0.0));
        columns.push((format!("harmonic_{n}.amplitude"), part));
    }
    columns
}
