//! `iwan modal` from files to results.

use super::analysis::analyse;
use super::args::ModalArgs;
use super::files::{frf_columns, geometry, shape_columns, universal};
use super::hits::Test;
use super::linearity::hardest;
use super::report::render;
use super::summary::ModalSummary;
use crate::args::Format;
use crate::failure::Failure;
use crate::session::{PAGE, Session};

/// File with the summary, which `iwan fit --modal` reads.
pub(crate) const MODAL: &str = "modal.json";
/// File with the shapes, which `--shapes` reads.
pub(crate) const SHAPES: &str = "shapes.csv";
const RESPONSES: &str = "frf.csv";
const UNIVERSAL: &str = "shapes.uff";
/// File with points and elements; written only where positions are known.
const GEOMETRY: &str = "geometry.unv";

/// Runs the command.
pub(crate) fn run(args: &ModalArgs) -> Result<(), Failure> {
    let test = Test::read(args)?;
    let placed = !test.geometry.points.is_empty();
    let files =
        [MODAL, RESPONSES, SHAPES, UNIVERSAL].into_iter().chain(placed.then_some(GEOMETRY)).chain([PAGE]);
    let mut session = Session::open(args.place(), &args.common, files)?;
    let levels = analyse(&test, args)?;
    let chosen = args.level.get() - 1;
    // Whether there is this level has been asked before the analysis.
    let level = &levels[chosen];
    let decay = hardest(&test, level.fit.band);
    let summary = ModalSummary::new(&test, &levels, chosen, decay.as_ref(), args);
    session.columns(RESPONSES, &frf_columns(level), Format::Csv)?;
    session.columns(SHAPES, &shape_columns(&level.fit), Format::Csv)?;
    session.file(UNIVERSAL, universal(&test, level, args.common.thread_count()).as_bytes())?;
    if placed {
        session.file(GEOMETRY, geometry(&test, level).as_bytes())?;
    }
    session.summary(MODAL, &summary)?;
    session.page(&render(&test, &levels, level, decay.as_ref(), &summary))?;
    session.finish(&summary)
}
