//! `iwan envelope`: amplitude, frequency and damping of a ring-down against time.

mod summary;

use iwan_io::Table;
use iwan_sim::in_parallel;

use crate::args::{EnvelopeArgs, Format};
use crate::extraction::Extraction;
use crate::failure::Failure;
use crate::output;
use crate::progress;
use crate::records::{self, Recording, Units, Wanted};
use crate::report;
use crate::results::Results;
pub(crate) use summary::{EnvelopeSummary, RecordSummary, agreement};

/// Folder for results when none was given.
const DEFAULT_FOLDER: &str = "iwan-envelope";

/// Runs the command.
pub(crate) fn run(args: &EnvelopeArgs) -> Result<(), Failure> {
    let recording = records::read(&args.record, &args.records)?;
    let files = [table_name(args.format), "summary.json", "report.html"];
    progress::catch_interrupts();
    let results = Results::open(args.out.as_deref(), DEFAULT_FOLDER, args.force, &files)?;
    let note = |text: &str| {
        if !args.common.quiet {
            output::message(text);
        }
    };
    recording.warnings.iter().for_each(|w| note(&format!("warning: {w}")));

    let extractions = extract(&recording, args)?;
    progress::check_interrupt()?;
    let units = units(&recording, args);
    let mut summary = EnvelopeSummary::new(&recording, &extractions, &units);
    summary.files = files.iter().map(ToString::to_string).collect();
    let folder = results.path().to_path_buf();
    write(results, &extractions, &summary, &units, args.format)?;

    note(&format!("results: {}", folder.display()));
    note(&format!("figures: {}", folder.join("report.html").display()));
    summary.folder = Some(folder);
    output::result(&if args.common.json { summary.json() } else { summary.text() })
}

fn extract(recording: &Recording, args: &EnvelopeArgs) -> Result<Vec<Extraction>, Failure> {
    let recordings = std::slice::from_ref(recording);
    let wanted = records::modes(recordings, &args.records)?;
    let (method, axis) = (args.method.method(), args.records.force_axis);
    let one = |mode: &Wanted| Extraction::new(recordings, mode, 0, method, axis);
    in_parallel(&wanted, args.common.thread_count(), &one).into_iter().collect()
}

fn units(recording: &Recording, args: &EnvelopeArgs) -> Units {
    let root = args.records.mass.is_some() || args.records.shapes.is_some();
    Units::new(recording.record.unit(), recording.quantity, root)
}

const fn table_name(format: Format) -> &'static str {
    match format {
        Format::Csv => "envelope.csv",
        Format::Npz => "envelope.npz",
        Format::Parquet => "envelope.parquet",
    }
}

/// Writes all files; they appear together.
fn write(
    mut results: Results,
    extractions: &[Extraction],
    summary: &EnvelopeSummary,
    units: &Units,
    format: Format,
) -> Result<(), Failure> {
    let columns = columns(extractions);
    let table = columns.iter().map(|(name, values)| ((*name).to_string(), values.as_slice())).collect();
    let table = Table::new(table).map_err(|e| Failure::Computation(e.to_string()))?;
    results.add_table(table_name(format), &table, format)?;
    results.add("summary.json", summary.json().as_bytes())?;
    let page = report::envelope::render(&report::envelope::Input { extractions, summary, units });
    results.add("report.html", page.as_bytes())?;
    progress::check_interrupt()?;
    results.commit()
}

/// The columns of the table: all modes below each other, told apart by their number.
fn columns(extractions: &[Extraction]) -> Vec<(&'static str, Vec<f64>)> {
    const NAMES: [&str; 11] = [
        "mode",
        "t",
        "amplitude",
        "frequency",
        "damping_ratio",
        "log_amplitude_sd",
        "frequency_sd",
        "damping_ratio_sd",
        "displacement",
        "dissipation",
        "force",
    ];
    let mut columns = NAMES.map(|name| (name, Vec::new()));
    for (mode, x) in extractions.iter().enumerate() {
        let Some(e) = x.envelope() else { continue };
        let times: Vec<f64> = e.t.iter().map(|t| x.start + t).collect();
        let numbers = vec![(mode + 1) as f64; times.len()];
        let c = &x.curves;
        let parts = [
            &numbers,
            &times,
            &e.amplitude,
            &e.frequency,
            &e.damping_ratio,
            &e.log_amplitude_sd,
            &e.frequency_sd,
            &e.damping_ratio_sd,
            &c.displacement,
            &c.dissipation,
            &c.force,
        ];
        columns.iter_mut().zip(parts).for_each(|((_, all), part)| all.extend_from_slice(part));
    }
    columns.into()
}
