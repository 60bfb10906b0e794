//! `iwan modes` from the structure file to its results.

use std::time::Instant;

use iwan_fem::mesh::vtu::{Field, grid};
use iwan_input::{InputText, MatrixFormat, ReducedFolder, matrix_file_names, matrix_files};

use super::args::{ModesArgs, Written};
use super::report;
use super::summary::ModesSummary;
use crate::args::Format;
use crate::failure::Failure;
use crate::session::{PAGE, SUMMARY, Session};
use crate::structures::Linear;
use crate::structures::linear::{NAMED_MODES, load};

/// Table of the modes.
const TABLE: &str = "modes.csv";
/// The mesh with all shapes, for ParaView.
const SHAPES: &str = "modes.vtu";

/// Runs the command.
pub(crate) fn run(args: &ModesArgs) -> Result<(), Failure> {
    let (source, file) = load(&args.structure)?;
    let place = args.structure.place(args.out.as_deref(), "iwan-modes");
    let mut files: Vec<String> = [TABLE, SHAPES, SUMMARY, PAGE].map(String::from).to_vec();
    let format = args.write_matrices.map(format_of);
    files.extend(format.into_iter().flat_map(matrix_file_names));
    if args.write_reduced.is_some() {
        files.extend(ReducedFolder::FILES.map(String::from));
    }
    let mut session = Session::open(place, &args.common, files)?;
    session.notes(&file.notes);

    let clock = Instant::now();
    let bar = session.bar("modes");
    let least = if args.write_reduced.is_some() { NAMED_MODES } else { 1 };
    let count = args.count.get().max(least);
    let linear = Linear::computed(source.name.clone(), file, count, &bar)?;
    drop(bar);
    let summary = ModesSummary::new(&linear, clock.elapsed().as_secs_f64());

    session.columns(TABLE, &summary.columns(), Format::Csv)?;
    session.file(SHAPES, &shapes(&linear))?;
    session.summary(SUMMARY, &summary)?;
    session.page(&report::render(&linear, &summary))?;
    if let Some(format) = format {
        let written = matrix_files(&linear.assembled, format);
        for (name, content) in written.map_err(|error| Failure::computation(error.to_string()))? {
            session.file(&name, &content)?;
        }
    }
    if let Some(modes) = args.write_reduced {
        write_reduced(&mut session, &source, &linear, modes.get())?;
    }
    session.finish(&summary)
}

fn format_of(written: Written) -> MatrixFormat {
    match written {
        Written::MatrixMarket => MatrixFormat::MatrixMarket,
        Written::Npz => MatrixFormat::Npz,
        Written::Mat => MatrixFormat::Matlab,
    }
}

/// Writes the reduced model as a folder that can be opened in place of a structure file.
fn write_reduced(
    session: &mut Session,
    source: &InputText,
    linear: &Linear,
    modes: usize,
) -> Result<(), Failure> {
    let bar = session.bar("reducing");
    let (own, teller) = (linear.clone(), bar.teller());
    let kept = bar.wait(move || own.keep(modes, &|share| teller.report(share)))?;
    let kept = kept.map_err(|error| linear.failed(&error))?;
    drop(bar);
    let folder = ReducedFolder { source, kept: &kept };
    let [table, text, arrays] = ReducedFolder::FILES;
    let at = session.folder().to_path_buf();
    session.file(table, folder.table(&at).as_bytes())?;
    session.file(text, folder.structure().as_bytes())?;
    session.written(arrays, |sink| folder.arrays(sink))
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
