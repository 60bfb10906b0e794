//! `iwan simulate`: from a scenario to responses, a summary and a report.

mod structure;

use std::time::Instant;

use iwan_io::Table;
use iwan_sim::{Method, Response, SimulationError, superpose};

use crate::args::{Format, SimulateArgs};
use crate::failure::Failure;
use crate::output;
use crate::progress::{self, Progress};
use crate::report;
use crate::results::Results;
use crate::scenario::{self, Force, InputText, Scenario, built_in};
use crate::summary::{ModeSummary, PointSummary, Summary};

/// Folder for results when none was given.
const DEFAULT_FOLDER: &str = "iwan-simulate";

/// Name under which a force history from a file is handed on.
const FORCE_FILE: &str = "force.csv";

/// Displacement, velocity and acceleration at a named point.
pub(crate) type PointResponse = (String, [Vec<f64>; 3]);

/// Runs the command.
pub(crate) fn run(args: &SimulateArgs) -> Result<(), Failure> {
    let source = match &args.scenario {
        Some(path) => InputText::read(path, "scenario", "paper-modal")?,
        None => built_in()[0].source(),
    };
    let scenario = Scenario::read(&source, &args.changes.overrides())?;
    if let Some(on) = &scenario.structure {
        return structure::run(args, &source.name, &scenario, on);
    }
    let files = file_names(&scenario, args.format);
    progress::catch_interrupts();
    let results = Results::open(args.out.as_deref(), DEFAULT_FOLDER, args.force, &files)?;
    let note = |text: &str| {
        if !args.common.quiet {
            output::message(text);
        }
    };
    scenario.notes().iter().for_each(|n| note(&format!("note: {n}")));

    let clock = Instant::now();
    let responses = compute(&scenario, args).map_err(|error| explain(&source.name, &error))?;
    let seconds = clock.elapsed().as_secs_f64();
    let points = superpose(&scenario.modes(), &responses);
    let mut summary = summarise(&scenario, &source.name, &responses, &points);
    summary.seconds = seconds;
    summary.files = files.iter().map(ToString::to_string).collect();
    let folder = results.path().to_path_buf();
    write(results, &scenario, &responses, &points, &summary, args.format)?;

    summary.warnings.iter().for_each(|w| note(&format!("warning: {w}")));
    note(&format!("results: {}", folder.display()));
    note(&format!("figures: {}", folder.join("report.html").display()));
    summary.folder = Some(folder);
    output::result(&if args.common.json { summary.json() } else { summary.table() })
}

fn response_name(format: Format) -> &'static str {
    match format {
        Format::Csv => "response.csv",
        Format::Npz => "response.npz",
        Format::Parquet => "response.parquet",
    }
}

fn file_names(scenario: &Scenario, format: Format) -> Vec<&'static str> {
    let mut names = vec![response_name(format), "summary.json", "report.html", "scenario.toml"];
    if matches!(scenario.force, Force::File(_)) {
        names.push(FORCE_FILE);
    }
    names
}

fn compute(scenario: &Scenario, args: &SimulateArgs) -> Result<Vec<Response>, SimulationError> {
    let bar = Progress::new("simulating", args.common.quiet);
    let force = scenario.force.pulse();
    let threads = args.common.thread_count();
    iwan_sim::simulate_all(&scenario.modes(), &force, &scenario.settings, threads, &|share| bar.report(share))
}

/// A failed computation in the user's terms: what could not be set up is bad input, the rest failed.
fn explain(name: &str, error: &SimulationError) -> Failure {
    let root = match error {
        SimulationError::Mode { source, .. } => source,
        other => other,
    };
    match root {
        SimulationError::Interrupted => Failure::Interrupted,
        SimulationError::Parameter(_) => Failure::input(
            format!("{name}: {error}"),
            "change this in the scenario, or choose another method",
        ),
        _ => Failure::Computation(format!("{name}: {error}")),
    }
}

fn summarise(scenario: &Scenario, name: &str, responses: &[Response], points: &[PointResponse]) -> Summary {
    let modes: Vec<_> =
        scenario.modes.iter().zip(responses).map(|(m, r)| ModeSummary::new(&m.mode, r)).collect();
    Summary {
        version: env!("CARGO_PKG_VERSION"),
        scenario: scenario.title.clone().unwrap_or_else(|| name.into()),
        method: match scenario.settings.method {
            Method::Newmark { .. } => "newmark",
            Method::HalfCycle => "half-cycle",
            Method::Averaging => "averaging",
            Method::Event { .. } => "event",
        },
        time_step: scenario.settings.dt,
        duration: scenario.settings.duration,
        warnings: modes.iter().flat_map(ModeSummary::warnings).collect(),
        modes,
        structure: None,
        points: points.iter().map(|(name, samples)| PointSummary::new(name, samples)).collect(),
        seconds: 0.0,
        files: Vec::new(),
        folder: None,
    }
}

/// Writes all files; they appear together.
fn write(
    mut results: Results,
    scenario: &Scenario,
    responses: &[Response],
    points: &[PointResponse],
    summary: &Summary,
    format: Format,
) -> Result<(), Failure> {
    let times: Vec<f64> = responses.first().map(|r| r.times().collect()).unwrap_or_default();
    let table = Table::new(columns(&times, scenario, responses, points))
        .map_err(|error| Failure::input(error.to_string(), "rename modes or points in the scenario"))?;
    results.add_table(response_name(format), &table, format)?;
    progress::check_interrupt()?;
    results.add("summary.json", summary.json().as_bytes())?;
    let toml = scenario::to_toml(scenario, FORCE_FILE);
    let page = report::render(&report::Input { scenario, toml: &toml, responses, points, summary });
    results.add("report.html", page.as_bytes())?;
    results.add("scenario.toml", toml.as_bytes())?;
    if let Force::File(file) = &scenario.force {
        results.add(FORCE_FILE, &file.bytes)?;
    }
    progress::check_interrupt()?;
    results.commit()
}

/// The columns of the response: time, modes, points.
pub(crate) fn columns<'a>(
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
