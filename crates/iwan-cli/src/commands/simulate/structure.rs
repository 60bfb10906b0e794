//! `iwan simulate` on a structure.

use iwan_fem::mesh::vtu::{Field, grid, series};
use iwan_fem::{History, SlipHistory};
use iwan_io::Table;

use super::{DEFAULT_FOLDER, FORCE_FILE, response_name};
use crate::args::SimulateArgs;
use crate::failure::Failure;
use crate::output;
use crate::progress::{self, Progress};
use crate::report;
use crate::results::Results;
use crate::scenario::{self, Force, OnStructure, Scenario};
use crate::summary::{Energy, ModeSummary, PointSummary, SlipSummary, StructureSummary, Summary};
use crate::truth::{self, Truth};

/// Name of the series of frames.
const SERIES: &str = "response.pvd";

/// Runs the scenario and writes its results.
pub(super) fn run(
    args: &SimulateArgs,
    name: &str,
    scenario: &Scenario,
    on: &OnStructure,
) -> Result<(), Failure> {
    let (source, file) = on.load()?;
    let frames = frame_names(on.frames);
    let mut files = vec![response_name(args.format), "summary.json", "report.html", "scenario.toml"];
    if matches!(scenario.force, Force::File(_)) {
        files.push(FORCE_FILE);
    }
    if !frames.is_empty() {
        files.push(SERIES);
        files.extend(frames.iter().map(String::as_str));
    }
    progress::catch_interrupts();
    let results = Results::open(args.out.as_deref(), DEFAULT_FOLDER, args.force, &files)?;
    let note = |text: &str| {
        if !args.common.quiet {
            output::message(text);
        }
    };
    scenario.notes().iter().chain(&file.notes).for_each(|n| note(&format!("note: {n}")));
    let bar = Progress::new("simulating", args.common.quiet);
    let truth = truth::run(scenario, on, (source, file), &bar)?;
    drop(bar);
    progress::check_interrupt()?;
    let mut summary = summarise(scenario, name, &truth);
    summary.files = files.iter().map(ToString::to_string).collect();
    let folder = results.path().to_path_buf();
    write(results, args, scenario, &truth, &summary, &frames)?;

    summary.warnings.iter().for_each(|w| note(&format!("warning: {w}")));
    note(&format!("results: {}", folder.display()));
    note(&format!("figures: {}", folder.join("report.html").display()));
    summary.folder = Some(folder);
    output::result(&if args.common.json { summary.json() } else { summary.table() })
}

fn frame_names(count: usize) -> Vec<String> {
    let digits = count.to_string().len();
    (0..count).map(|n| format!("frame-{n:0digits$}.vtu")).collect()
}

fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, x| most.max(x.abs()))
}

fn summarise(scenario: &Scenario, name: &str, truth: &Truth) -> Summary {
    let modes: Vec<ModeSummary> = (0..truth.modes.len()).map(|n| mode_summary(truth, n)).collect();
    let points = &truth.response.outputs[truth.modes.len()..];
    let of = |p: &History| {
        PointSummary::of_peaks(&p.name, [&p.displacement, &p.velocity, &p.acceleration].map(|v| peak(v)))
    };
    let structure = structure_summary(truth);
    let warnings = modes.iter().flat_map(ModeSummary::warnings).chain(structure.warnings()).collect();
    Summary {
        version: env!("CARGO_PKG_VERSION"),
        scenario: scenario.title.clone().unwrap_or_else(|| name.into()),
        method: "newmark",
        time_step: scenario.settings.dt,
        duration: scenario.settings.duration,
        warnings,
        modes,
        points: points.iter().map(of).collect(),
        structure: Some(structure),
        seconds: truth.seconds,
        files: Vec::new(),
        folder: None,
    }
}

/// The slip ratio is that of the joint that slips most, the energies are those of the whole structure.
fn mode_summary(truth: &Truth, n: usize) -> ModeSummary {
    let (mode, response) = (&truth.modes[n], &truth.response);
    let history = &response.outputs[n];
    let frequency = truth.linear.frequency_stuck(mode);
    ModeSummary {
        name: mode.name.clone(),
        frequency,
        damping_ratio: 0.0,
        phi_max: None,
        peak_displacement: peak(&history.displacement),
        peak_acceleration: peak(&history.acceleration),
        final_displacement: history.displacement.last().copied().unwrap_or(0.0),
        slip_ratio: response.slips.iter().fold(0.0, |most: f64, slip| most.max(slip.slip_ratio)),
        energy_error: response.energy.error(),
        time_step_error: truth.errors.as_ref().map(|errors| errors.time_step[n]),
        discretisation_error: truth.errors.as_ref().and_then(|errors| Some(errors.sliders.as_ref()?[n])),
        forgotten_force: response.forgotten_force,
        samples_per_cycle: 1.0 / (frequency * response.dt),
        steps: history.displacement.len() - 1,
        seconds: response.seconds,
        energy: Energy::from(&response.energy),
    }
}

fn structure_summary(truth: &Truth) -> StructureSummary {
    let slip = |slip: &SlipHistory| SlipSummary {
        name: slip.name.clone(),
        peak_slip: peak(&slip.slip),
        peak_force: peak(&slip.force),
        slip_ratio: slip.slip_ratio,
    };
    StructureSummary {
        title: truth.linear.file.title.clone().unwrap_or_else(|| truth.linear.source.clone()),
        size: crate::commands::modes::Size::of(&truth.linear),
        model: if truth.basis.is_some() { "reduced" } else { "full" },
        basis: truth.basis,
        basis_error: truth.basis_error.map(|error| error.estimate),
        converged: truth.basis_error.map(|error| error.converged),
        slips: truth.response.slips.iter().map(slip).collect(),
    }
}

/// Writes all files; they appear together.
fn write(
    mut results: Results,
    args: &SimulateArgs,
    scenario: &Scenario,
    truth: &Truth,
    summary: &Summary,
    frames: &[String],
) -> Result<(), Failure> {
    let times: Vec<f64> =
        (0..=summary.modes.first().map_or(0, |m| m.steps)).map(|n| n as f64 * truth.response.dt).collect();
    let table = Table::new(columns(&times, truth))
        .map_err(|error| Failure::input(error.to_string(), "rename outputs or joints in the structure"))?;
    results.add_table(response_name(args.format), &table, args.format)?;
    progress::check_interrupt()?;
    results.add("summary.json", summary.json().as_bytes())?;
    let toml = scenario::to_toml(scenario, FORCE_FILE);
    let page = report::truth::render(&report::truth::Input { scenario, toml: &toml, truth, summary });
    results.add("report.html", page.as_bytes())?;
    results.add("scenario.toml", toml.as_bytes())?;
    if let Force::File(file) = &scenario.force {
        results.add(FORCE_FILE, &file.bytes)?;
    }
    if !frames.is_empty() {
        let mesh = &truth.linear.file.structure.mesh;
        for (name, frame) in frames.iter().zip(&truth.frames) {
            results.add(name, &grid(mesh, &[Field { name: "displacement", values: &frame.displacement }]))?;
        }
        let times = truth.frames.iter().map(|frame| frame.time);
        results.add(SERIES, series(times.zip(frames.iter().map(String::as_str))).as_bytes())?;
    }
    progress::check_interrupt()?;
    results.commit()
}

/// The columns of the response: time, modes, outputs, slips.
fn columns<'a>(times: &'a [f64], truth: &'a Truth) -> Vec<(String, &'a [f64])> {
    let mut columns = vec![("t".to_string(), times)];
    for (n, history) in truth.response.outputs.iter().enumerate() {
        let mut add = |quantity: &str, values: &'a [f64]| {
            columns.push((format!("{}.{quantity}", history.name), values));
        };
        add("displacement", &history.displacement);
        add("velocity", &history.velocity);
        add("acceleration", &history.acceleration);
        if let Some(force) = truth.joint_forces.get(n) {
            add("joint_force", force);
        }
    }
    for slip in &truth.response.slips {
        columns.push((format!("{}.slip", slip.name), &slip.slip));
        columns.push((format!("{}.force", slip.name), &slip.force));
    }
    columns
}
