//! `iwan fit --coupled` from files to fitted modes that share joints.

use std::sync::atomic::AtomicBool;

use iwan_ident::coupled::CoupledFit;

use super::records::Measured;
use super::results::CoupledResults;
use crate::failure::Failure;
use crate::fit::args::FitArgs;
use crate::session::{PAGE, SUMMARY, Session};

/// File with the whole summary.
const WHOLE: &str = "fit.json";
const SCENARIO: &str = "scenario.toml";

/// Runs `iwan fit --coupled`.
pub(crate) fn fit(args: &FitArgs) -> Result<(), Failure> {
    let measured = Measured::read(args)?;
    let mut session = Session::open(args.place(), &args.common, [WHOLE, SUMMARY, SCENARIO, PAGE])?;
    let shape = &args.shape_at_force;
    if !shape.is_empty() && shape.len() != measured.modes.len() {
        let message =
            format!("--shape-at-force has {} numbers for {} modes", shape.len(), measured.modes.len());
        return Err(Failure::input(message, "give one for each mode, in their order"));
    }
    let found = run(&measured, shape, &session)?;
    let results = CoupledResults::new(&measured, &found);
    session.summary(WHOLE, &results.summary)?;
    session.summary(SUMMARY, &results.summary.short())?;
    session.file(SCENARIO, results.toml.as_bytes())?;
    session.page(&results.page)?;
    session.finish(&results.summary)
}

/// Runs the fit beside the main thread, which watches for Ctrl-C.
fn run(measured: &Measured, shape: &[f64], session: &Session) -> Result<CoupledFit, Failure> {
    let place = measured.records.iter().map(|r| r.name.as_str()).collect::<Vec<_>>().join(", ");
    let (measured, threads, shape) = (measured.clone(), session.threads(), shape.to_vec());
    let bar = session.bar("fitting");
    let teller = bar.teller();
    let work = move || {
        let shape = (!shape.is_empty()).then_some(shape.as_slice());
        let progress = |share| teller.report(share);
        measured.fit(shape, threads, &AtomicBool::new(false), &progress)
    };
    bar.wait(work)?.map_err(|error| Failure::said(&place, &error))
}
