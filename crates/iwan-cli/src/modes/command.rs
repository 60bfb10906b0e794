//! `iwan modes` from the structure file to its results.

use std::time::Instant;

use iwan_fem::mesh::vtu::{Field, grid};

use super::args::ModesArgs;
use super::report;
use super::summary::ModesSummary;
use crate::args::Format;
use crate::failure::Failure;
use crate::session::{PAGE, SUMMARY, Session};
use crate::structures::Linear;
use crate::structures::linear::load;

/// Table of the modes.
const TABLE: &str = "modes.csv";
/// The mesh with all shapes, for ParaView.
const SHAPES: &str = "modes.vtu";

/// Runs the command.
pub(crate) fn run(args: &ModesArgs) -> Result<(), Failure> {
    let (source, file) = load(&args.structure)?;
    let place = args.structure.place("iwan-modes");
    let mut session = Session::open(place, &args.common, [TABLE, SHAPES, SUMMARY, PAGE])?;
    session.notes(&file.notes);

    let clock = Instant::now();
    let bar = session.bar("modes");
    let linear = Linear::observed(source, file, args.count.get(), &|share| bar.report(share))?;
    drop(bar);
    let summary = ModesSummary::new(&linear, clock.elapsed().as_secs_f64());

    session.columns(TABLE, &summary.columns(), Format::Csv)?;
    session.file(SHAPES, &shapes(&linear))?;
    session.summary(SUMMARY, &summary)?;
    session.page(&report::render(&linear, &summary))?;
    session.finish(&summary)
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
