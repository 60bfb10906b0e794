//! `iwan backbone` from the scenario to its results.

use std::time::Instant;

use iwan_input::scenario::{SteadyScenario, built_in};
use iwan_input::{InputText, StructureFile, is_structure};
use iwan_sim::BackbonePoint;

use super::args::BackboneArgs;
use super::curves::{Traced, ask, harmonics, trace};
use super::report;
use super::structure::{self, OnStructure};
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
    let task = Task::read(&source)?;
    let highest = harmonics(args, &task.scenario)?;
    ask(&source.name, args.points, task.scenario.modes.len().max(1), highest)?;
    let mut session = Session::open(args.place(), &args.common, [TABLE, SUMMARY, PAGE])?;
    let clock = Instant::now();
    let title = task.scenario.title.clone().unwrap_or_else(|| source.name.clone());
    let traced = match task.structure {
        Some(on) => {
            session.notes(&on.file.notes);
            structure::trace(on, args, highest, &session)?
        }
        None => trace(&source.name, &task.scenario, args, highest, session.threads())?,
    };
    let summary = BackboneSummary::new(title, highest, &traced, clock.elapsed().as_secs_f64());
    session.columns(TABLE, &columns(&traced, highest), Format::Csv)?;
    session.summary(SUMMARY, &summary)?;
    session.page(&report::render(&traced, &summary))?;
    session.finish(&summary)
}

/// What the file describes: modes of a scenario, or a structure.
struct Task {
    scenario: SteadyScenario,
    structure: Option<OnStructure>,
}

impl Task {
    fn read(source: &InputText) -> Result<Self, Failure> {
        if is_structure(source)? {
            let file = StructureFile::read(source)?;
            let scenario = SteadyScenario {
                title: file.title.clone(),
                modes: Vec::new(),
                joints: Vec::new(),
                structure: None,
                sweep: None,
            };
            let (source, model) = (source.name.clone(), iwan_fem::Model::USUAL);
            let on = OnStructure { source, file, model, at: None, damping_ratio: 0.0 };
            return Ok(Self { scenario, structure: Some(on) });
        }
        let scenario = SteadyScenario::read(source)?;
        let Some(on) = &scenario.structure else { return Ok(Self { scenario, structure: None }) };
        let (source, file) = on.load()?;
        let table = scenario.sweep.as_ref();
        let damping_ratio = table.and_then(|table| table.damping_ratio).unwrap_or(0.0);
        let at = table.and_then(|table| table.at.clone());
        let structure = OnStructure { source, file, model: on.model, at, damping_ratio };
        Ok(Self { structure: Some(structure), scenario })
    }
}

/// The columns of the table: the modes stand below each other, told apart by their number.
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
