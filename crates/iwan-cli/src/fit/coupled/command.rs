//! From files to modes that share joints.

use std::sync::atomic::AtomicBool;

use iwan_ident::coupled::{CoupledFit, CoupledRecord, CoupledTask, fit_coupled};
use iwan_input::scenario::to_toml;

use super::figures::figures;
use super::records::Measured;
use super::report::render;
use super::scenario::scenario;
use super::summary::CoupledSummary;
use crate::failure::Failure;
use crate::fit::args::FitArgs;
use crate::session::{PAGE, SUMMARY, Session};

/// The results.
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
    let names: Vec<String> = measured.modes.iter().map(|m| m.name.clone()).collect();
    let files = |records: &[CoupledRecord]| records.iter().map(|r| r.name.clone()).collect::<Vec<_>>();
    let (fitted, held_out) = (files(&measured.records), files(&measured.held_out));
    let found = run(&measured, shape, &session)?;
    let summary = CoupledSummary::new(&found, &names, [fitted, held_out], measured.warnings.clone());
    let toml = to_toml(&scenario(&summary.title, &found, &names, &measured.records, measured.seen), "");
    let all: Vec<CoupledRecord> = measured.records.iter().chain(&measured.held_out).cloned().collect();
    let drawn = figures(&found, &all, &names, measured.quantity);
    let motions: usize = measured.records.iter().map(|r| r.motions.len()).sum();
    session.summary(WHOLE, &summary)?;
    session.summary(SUMMARY, &summary.short())?;
    session.file(SCENARIO, toml.as_bytes())?;
    session.page(&render(&summary, [&drawn[..motions], &drawn[motions..]], &toml))?;
    session.finish(&summary)
}

/// The fit, beside the main thread, which watches for Ctrl-C.
fn run(measured: &Measured, shape: &[f64], session: &Session) -> Result<CoupledFit, Failure> {
    let place = measured.records.iter().map(|r| r.name.as_str()).collect::<Vec<_>>().join(", ");
    let (records, held_out, modes) =
        (measured.records.clone(), measured.held_out.clone(), measured.modes.clone());
    let (quantity, seen, threads) = (measured.quantity, measured.seen, session.threads());
    let shape = (!shape.is_empty()).then(|| shape.to_vec());
    let work = move || {
        fit_coupled(&CoupledTask {
            records: &records,
            held_out: &held_out,
            modes: &modes,
            quantity,
            seen,
            shape_at_force: shape.as_deref(),
            threads,
            stopped: &AtomicBool::new(false),
        })
    };
    session.busy("fitting").wait(work)?.map_err(|error| Failure::said(&place, &error))
}
