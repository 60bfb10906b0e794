//! `iwan reproduce` from the study to its results.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use super::args::ReproduceArgs;
use super::summary::ReproduceSummary;
use super::{curves, figures, plate, report};
use crate::args::Format;
use crate::failure::Failure;
use crate::session::{PAGE, Place, Session};

/// File with every number of the report.
const NUMBERS: &str = "reproduce.json";
/// File with the data of the figures.
const FIGURES: &str = "figures.json";
/// File with the curves of the modes and their models.
const CURVES: &str = "curves.csv";

/// Runs the command.
pub(crate) fn run(args: &ReproduceArgs) -> Result<(), Failure> {
    let place = Place { given: args.out.as_deref(), default: "iwan-reproduce", force: args.force };
    let files = [NUMBERS, FIGURES, CURVES, PAGE].map(String::from).to_vec();
    let mut session = Session::open(place, &args.common, files)?;

    let clock = Instant::now();
    let bar = Arc::new(session.bar("reproducing"));
    let (shown, threads) = (Arc::clone(&bar), session.threads());
    let observer = move |share: f64| -> ControlFlow<()> { shown.report(share) };
    // An identification cannot be stopped between two steps; the main thread therefore watches for Ctrl-C.
    let found = bar.wait(move || iwan_study::reproduce(threads, &observer))?.map_err(failed)?;
    drop(bar);
    let plates = figures::plates(&found);
    let numbers = iwan_study::Summary::new(&found).map_err(failed)?;
    let mut summary = ReproduceSummary::new(numbers, &plates);

    session.summary(NUMBERS, &summary)?;
    session.file(FIGURES, plate::data(&plates).as_bytes())?;
    session.columns(CURVES, &curves::columns(&found), Format::Csv)?;
    session.page(&report::render(&summary.found, &found.laboratory, &plates))?;
    summary.seconds = Some(clock.elapsed().as_secs_f64());
    session.finish(&summary)
}

/// Nothing here is the user's input: an error is a failure of the computation.
fn failed(error: iwan_study::Error) -> Failure {
    match error {
        iwan_study::Error::Interrupted => Failure::Interrupted,
        error => Failure::computation(error.to_string()).of(error.kind()),
    }
}
