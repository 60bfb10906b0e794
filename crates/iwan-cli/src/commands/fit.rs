//! `iwan fit`: from records to the parameters of an Iwan joint, with intervals and a verdict.

mod summary;

use iwan_core::Pulse;
use iwan_io::Table;
use iwan_sim::{Method, Settings, in_parallel};
use iwan_study::identified::time_step;

use crate::args::{FitArgs, Format};
use crate::commands::simulate::columns;
use crate::extraction::Extraction;
use crate::failure::Failure;
use crate::identified::{Identified, extract};
use crate::output;
use crate::progress::{self, Progress};
use crate::records::{self, Recording, Units, Wanted};
use crate::report;
use crate::results::Results;
use crate::scenario::{self, Force, Scenario, ScenarioMode, WrittenLaw};
pub(crate) use summary::{Estimate, FitSummary, ModeFit, ROWS, interval, value};

/// Folder for results when none was given.
const DEFAULT_FOLDER: &str = "iwan-fit";

/// Runs the command.
pub(crate) fn run(args: &FitArgs) -> Result<(), Failure> {
    let recordings =
        args.fit.iter().map(|path| records::read(path, &args.records)).collect::<Result<Vec<_>, _>>()?;
    let files = file_names(args.format);
    progress::catch_interrupts();
    let results = Results::open(args.out.as_deref(), DEFAULT_FOLDER, args.force, &files)?;
    let note = |text: &str| {
        if !args.common.quiet {
            output::message(text);
        }
    };
    recordings.iter().flat_map(|r| &r.warnings).for_each(|w| note(&format!("warning: {w}")));

    let wanted = records::modes(&recordings, &args.records)?;
    let identified = identify_all(&recordings, wanted, args)?;
    let units = Units::new(
        recordings[0].record.unit(),
        recordings[0].quantity,
        args.records.mass.is_some() || args.records.shapes.is_some(),
    );
    let mut summary = FitSummary::new(&recordings, &identified, args.records.force_axis, &units);
    summary.files = files.iter().map(ToString::to_string).collect();
    let folder = results.path().to_path_buf();
    write(results, &identified, &summary, &units, args.format)?;

    note(&format!("results: {}", folder.display()));
    note(&format!("figures: {}", folder.join("report.html").display()));
    summary.folder = Some(folder);
    output::result(&if args.common.json { summary.json() } else { summary.text() })
}

/// A hundred thousand ring-downs may take a while: Ctrl-C ends them at once.
fn identify_all(
    recordings: &[Recording],
    wanted: Vec<Wanted>,
    args: &FitArgs,
) -> Result<Vec<Identified>, Failure> {
    let (method, axis, threads) = (args.method.method(), args.records.force_axis, args.common.thread_count());
    let (recordings, hold) = (recordings.to_vec(), args.hold.clone());
    let work = move || {
        let first = |mode: &Wanted| extract(&recordings, mode, method);
        let extracted: Result<Vec<_>, Failure> = in_parallel(&wanted, threads, &first).into_iter().collect();
        let pairs: Vec<_> = wanted.into_iter().zip(extracted?).collect();
        let then = |(mode, extractions): &(Wanted, Vec<Extraction>)| {
            Identified::new(&recordings, mode, extractions.clone(), axis, &hold)
        };
        in_parallel(&pairs, threads, &then).into_iter().collect()
    };
    Progress::busy("identifying", args.common.quiet).wait(work)?
}

const fn table_names(format: Format) -> [&'static str; 2] {
    match format {
        Format::Csv => ["curves.csv", "response.csv"],
        Format::Npz => ["curves.npz", "response.npz"],
        Format::Parquet => ["curves.parquet", "response.parquet"],
    }
}

fn file_names(format: Format) -> [&'static str; 6] {
    let [curves, response] = table_names(format);
    ["fit.json", "summary.json", "scenario.toml", "report.html", curves, response]
}

/// Writes all files; they appear together.
fn write(
    mut results: Results,
    identified: &[Identified],
    summary: &FitSummary,
    units: &Units,
    format: Format,
) -> Result<(), Failure> {
    let [curves_name, response_name] = table_names(format);
    let failed = |e: &dyn std::fmt::Display| Failure::Computation(e.to_string());
    let scenario = as_scenario(identified, &summary.title()).map_err(|e| failed(&e))?;
    let toml = scenario::to_toml(&scenario, "");
    let curves = curve_columns(identified);
    let borrowed = curves.iter().map(|(name, values)| ((*name).to_string(), values.as_slice())).collect();
    let table = Table::new(borrowed).map_err(|e| failed(&e))?;
    results.add_table(curves_name, &table, format)?;
    let responses = iwan_sim::simulate_all(
        &scenario.modes(),
        &Pulse::None,
        &scenario.settings,
        1,
        iwan_core::progress::UNWATCHED,
    );
    let responses = responses.map_err(|e| failed(&e))?;
    let times: Vec<f64> = responses.first().map(|r| r.times().collect()).unwrap_or_default();
    let table = Table::new(columns(&times, &scenario, &responses, &[])).map_err(|e| failed(&e))?;
    results.add_table(response_name, &table, format)?;
    results.add("fit.json", summary.json().as_bytes())?;
    results.add("summary.json", summary.without_curves().json().as_bytes())?;
    results.add("scenario.toml", toml.as_bytes())?;
    let page = report::fit::render(&report::fit::Input { identified, summary, units, toml: &toml });
    results.add("report.html", page.as_bytes())?;
    progress::check_interrupt()?;
    results.commit()
}

/// The fit as a scenario: each mode is released where the loudest record begins.
pub(crate) fn as_scenario(identified: &[Identified], title: &str) -> Result<Scenario, iwan_core::Error> {
    let mut modes = Vec::new();
    let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
    for i in identified {
        let (p, record) = (i.found.parameters, i.loudest());
        let joint = WrittenLaw::FourParameter { k_t: p.k_t, f_s: p.f_s, chi: p.chi, beta: p.beta };
        modes.push(ScenarioMode { mode: i.mode(record)?, joint: Some(joint) });
        let c = &i.comparisons[record];
        shortest = shortest.min(time_step(c.dt, p.frequency));
        longest = longest.max(c.record.len() as f64 * c.dt);
    }
    let settings = Settings { method: Method::HalfCycle, ..Settings::new(shortest, longest) };
    Ok(Scenario {
        title: Some(title.into()),
        modes,
        structure: None,
        force: Force::Formula("none", Pulse::None),
        settings,
    })
}

/// The columns of the curves: all modes and records below each other, told apart by their numbers.
fn curve_columns(identified: &[Identified]) -> Vec<(&'static str, Vec<f64>)> {
    const NAMES: [&str; 12] = [
        "mode",
        "record",
        "t",
        "amplitude",
        "displacement",
        "frequency",
        "damping_ratio",
        "dissipation",
        "force",
        "frequency_sd",
        "log_dissipation_sd",
        "noise",
    ];
    let mut columns = NAMES.map(|name| (name, Vec::new()));
    for (mode, i) in identified.iter().enumerate() {
        for (record, c) in i.curves.iter().enumerate() {
            let n = c.t.len();
            let number = |k: f64| vec![k; n];
            let start = i.extractions[record].start;
            let envelope = &i.found.envelopes[record];
            let parts = [
                number((mode + 1) as f64),
                number((record + 1) as f64),
                c.t.iter().map(|t| start + t).collect(),
                envelope.amplitude.clone(),
                c.displacement.clone(),
                c.frequency.clone(),
                c.damping_ratio.clone(),
                c.dissipation.clone(),
                c.force.clone(),
                c.frequency_sd.clone(),
                c.log_dissipation_sd.clone(),
                number(envelope.noise),
            ];
            columns.iter_mut().zip(parts).for_each(|((_, all), part)| all.extend(part));
        }
    }
    columns.into()
}
