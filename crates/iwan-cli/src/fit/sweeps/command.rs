//! `iwan fit --sweep --backbone` from the files of a shaker's test to the results.

use std::path::Path;

use iwan_ident::Parameter;
use iwan_ident::sweeps::SteadyFit;

use super::columns;
use super::measurement::{Measurement, Scaling};
use super::results::Results;
use super::test::{RingDowns, ShakerTest};
use crate::args::Format;
use crate::failure::Failure;
use crate::fit::args::FitArgs;
use crate::session::{PAGE, SUMMARY, Session};
use crate::shown;

/// File with the whole summary.
const WHOLE: &str = "fit.json";
const SCENARIO: &str = "scenario.toml";
/// File with the measured points and the predictions of the fitted mode.
const CURVES: &str = "curves.csv";

/// Fits the sweeps and backbones of `args`, together with ring-downs where there are any. `identify` reads and identifies the ring-downs; it is
/// called once the files of the sweeps have been read.
pub(crate) fn fit(
    args: &FitArgs,
    identify: impl FnOnce(&mut Session) -> Result<Option<RingDowns>, Failure>,
) -> Result<(), Failure> {
    let mass = args.records.mass;
    let scaling = Scaling { mass: mass.unwrap_or(1.0), levels: &args.levels };
    let name = |path: &Path| shown::path(path);
    let responses =
        args.sweeps.iter().map(|path| Measurement::response(name(path), columns::read(path)?, scaling));
    let backbones =
        args.backbones.iter().map(|path| Measurement::backbone(name(path), columns::read(path)?, scaling));
    let measurements = responses.chain(backbones).collect::<Result<Vec<_>, _>>()?;
    let mut session = Session::open(args.place(), &args.common, [WHOLE, SUMMARY, SCENARIO, CURVES, PAGE])?;
    let test = ShakerTest { measurements, ring_downs: identify(&mut session)?, mass };
    let fit = fitted(&test, &args.hold, &session)?;

    let results = Results::new(&test, &fit)?;
    session.columns(CURVES, &results.table, Format::Csv)?;
    session.summary(WHOLE, &results.summary)?;
    session.summary(SUMMARY, &results.summary)?;
    session.file(SCENARIO, results.toml.as_bytes())?;
    session.page(&results.page)?;
    session.finish(&results.summary)
}

/// Runs the fit beside the main thread, which watches for Ctrl-C.
fn fitted(test: &ShakerTest, hold: &[(Parameter, f64)], session: &Session) -> Result<SteadyFit, Failure> {
    let place = test.measurements.iter().map(|m| m.file.as_str()).collect::<Vec<_>>().join(", ");
    let (test, hold) = (test.clone(), hold.to_vec());
    let work = move || test.fit(&hold);
    session.busy("fitting").wait(work)?.map_err(|error| Failure::said(&place, &error))
}
