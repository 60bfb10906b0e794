//! `iwan modes`: frequencies and shapes of a structure with its joints stuck and slipping.

mod summary;

use std::time::Instant;

use iwan_fem::mesh::vtu::{Field, grid};
use iwan_io::Table;

use crate::args::{Format, ModesArgs};
use crate::failure::Failure;
use crate::linear::{self, Linear};
use crate::output;
use crate::progress::{self, Progress};
use crate::report;
use crate::results::Results;
pub(crate) use summary::{ModesSummary, Pair, Size};

/// Folder for results when none was given.
const DEFAULT_FOLDER: &str = "iwan-modes";
const FILES: [&str; 4] = ["modes.csv", "modes.vtu", "summary.json", "report.html"];

/// Runs the command.
pub(crate) fn run(args: &ModesArgs) -> Result<(), Failure> {
    let (source, file) = linear::load(&args.structure)?;
    progress::catch_interrupts();
    let results = Results::open(args.structure.out.as_deref(), DEFAULT_FOLDER, args.structure.force, &FILES)?;
    let note = |text: &str| {
        if !args.common.quiet {
            output::message(text);
        }
    };
    file.notes.iter().for_each(|n| note(&format!("note: {n}")));

    let clock = Instant::now();
    let bar = Progress::new("modes", args.common.quiet);
    let linear = Linear::observed(source, file, args.count.get(), &mut |share| bar.report(share))?;
    drop(bar);
    let seconds = clock.elapsed().as_secs_f64();
    progress::check_interrupt()?;
    let mut summary = ModesSummary::new(&linear, seconds);
    summary.files = FILES.iter().map(ToString::to_string).collect();
    let folder = results.path().to_path_buf();
    write(results, &linear, &summary)?;

    summary.warnings.iter().for_each(|w| note(&format!("warning: {w}")));
    note(&format!("results: {}", folder.display()));
    note(&format!("pictures: {}", folder.join("report.html").display()));
    summary.folder = Some(folder);
    output::result(&if args.common.json { summary.json() } else { summary.table() })
}

/// Writes all files; they appear together.
fn write(mut results: Results, linear: &Linear, summary: &ModesSummary) -> Result<(), Failure> {
    let columns = summary.columns();
    let table = columns.iter().map(|(name, values)| ((*name).to_string(), values.as_slice())).collect();
    let table = Table::new(table).map_err(|e| Failure::Computation(e.to_string()))?;
    results.add_table("modes.csv", &table, Format::Csv)?;
    results.add("modes.vtu", &shapes(linear))?;
    results.add("summary.json", summary.json().as_bytes())?;
    let page = report::modes::render(&report::modes::Input { linear, summary });
    results.add("report.html", page.as_bytes())?;
    progress::check_interrupt()?;
    results.commit()
}

/// The mesh with all shapes.
fn shapes(linear: &Linear) -> Vec<u8> {
    let stuck = linear.elastic.iter().map(|mode| {
        let name = format!("{}, stuck, {:.3} Hz", mode.name, linear.frequency_stuck(mode));
        (name, linear.assembled.displacements(linear.stuck.shape(mode.pair.stuck)))
    });
    let slipping = linear.elastic.iter().map(|mode| {
        let name = format!("{}, slipping, {:.3} Hz", mode.name, linear.frequency_slipping(mode));
        (name, linear.assembled.displacements(linear.slipping.shape(mode.pair.slipping)))
    });
    let shapes: Vec<(String, Vec<f64>)> = stuck.chain(slipping).collect();
    let fields: Vec<Field> = shapes.iter().map(|(name, values)| Field { name, values }).collect();
    grid(&linear.file.structure.mesh, &fields)
}
