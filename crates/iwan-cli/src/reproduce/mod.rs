//! `iwan reproduce`: the paper's tables and figures beside ours.

mod arguments;
mod units;
mod plate;
mod schematics;
mod blow_figures;
mod laboratory_figures;
mod figures;
mod curves;
mod summary;
mod tables;
mod report;

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use iwan_io::Table;
use iwan_study::Reproduction;

use crate::args::Format;
use crate::failure::Failure;
use crate::output;
use crate::progress::{self, Progress};
use crate::results::Results;
pub(crate) use arguments::ReproduceArgs;
use plate::Plate;
use summary::ReproduceSummary;

/// Folder for results when none was given.
const DEFAULT_FOLDER: &str = "iwan-reproduce";
const FILES: [&str; 4] = ["reproduce.json", "figures.json", "curves.csv", "report.html"];

/// Runs the command.
pub(crate) fn run(args: &ReproduceArgs) -> Result<(), Failure> {
    progress::catch_interrupts();
    let results = Results::open(args.out.as_deref(), DEFAULT_FOLDER, args.force, &FILES)?;
    let clock = Instant::now();
    let bar = Arc::new(Progress::new("reproducing", args.common.quiet));
    let (shown, threads) = (Arc::clone(&bar), args.common.thread_count());
    let observer = move |share: f64| -> ControlFlow<()> { shown.report(share) };
    // Identification cannot be asked to stop between two steps: the main thread watches for Ctrl-C.
    let found = bar.wait(move || iwan_study::reproduce(threads, &observer))?.map_err(failed)?;
    drop(bar);
    let plates = figures::plates(&found);
    let numbers = iwan_study::Summary::new(&found).map_err(failed)?;
    let mut summary = ReproduceSummary::new(numbers, &plates, &FILES);
    let folder = results.path().to_path_buf();
    write(results, &found, &summary, &plates)?;

    if !args.common.quiet {
        output::message(&format!("results: {}", folder.display()));
        output::message(&format!("figures: {}", folder.join("report.html").display()));
    }
    summary.folder = Some(folder);
    summary.seconds = Some(clock.elapsed().as_secs_f64());
    output::result(&if args.common.json { summary.json() } else { summary.text() })
}

/// Nothing of it is the user's input: what fails is a fault of the computation.
fn failed(error: iwan_study::Error) -> Failure {
    match error {
        iwan_study::Error::Interrupted => Failure::Interrupted,
        error => Failure::Computation(error.to_string()),
    }
}

/// Writes all files; they appear together.
fn write(
    mut results: Results,
    found: &Reproduction,
    summary: &ReproduceSummary,
    plates: &[Plate],
) -> Result<(), Failure> {
    results.add("reproduce.json", summary.json().as_bytes())?;
    results.add("figures.json", plate::data(plates).as_bytes())?;
    let columns = curves::columns(found);
    let table = columns.iter().map(|(name, values)| ((*name).to_string(), values.as_slice())).collect();
    let table = Table::new(table).map_err(|error| Failure::Computation(error.to_string()))?;
    results.add_table("curves.csv", &table, Format::Csv)?;
    let page = report::render(&summary.found, &found.laboratory, plates);
    results.add("report.html", page.as_bytes())?;
    progress::check_interrupt()?;
    results.commit()
}
