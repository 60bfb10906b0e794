//! From the files of a shaker's test to the results.

use std::path::Path;

use iwan_ident::Parameter;
use iwan_ident::likelihood::Likelihood;
use iwan_ident::sweeps::{SteadyData, SteadyFit, fit_steady};
use iwan_input::scenario::to_toml;

use super::columns;
use super::figures::{self, Shown};
use super::measurement::{Measurement, Scaling};
use super::predicted::{self, Curve};
use super::report::render;
use super::scenario::scenario;
use super::summary::SweepSummary;
use crate::args::Format;
use crate::failure::Failure;
use crate::fit::args::FitArgs;
use crate::session::{PAGE, SUMMARY, Session};

/// The results.
const WHOLE: &str = "fit.json";
const SCENARIO: &str = "scenario.toml";
/// Measured points beside what the mode predicts.
const CURVES: &str = "curves.csv";
/// The only mode.
const NAME: &str = "mode 1";

/// Ring-downs that are fitted together with the sweeps.
#[derive(Debug)]
pub(crate) struct RingDowns {
    /// Names of their files.
    pub(crate) files: Vec<String>,
    /// The mode's name.
    pub(crate) mode: String,
    pub(crate) likelihood: Likelihood,
    /// Amplitudes of the modal displacement that they hold.
    pub(crate) informed: [f64; 2],
}

/// Fits the sweeps and backbones of `args`, with ring-downs where there are any; `identify` finds these once the files of the sweeps
/// are read.
pub(crate) fn fit(
    args: &FitArgs,
    identify: impl FnOnce(&Session) -> Result<Option<RingDowns>, Failure>,
) -> Result<(), Failure> {
    let mass = args.records.mass;
    let scaling = Scaling { mass: mass.unwrap_or(1.0), levels: &args.levels };
    let name = |path: &Path| path.display().to_string();
    let responses =
        args.sweeps.iter().map(|path| Measurement::response(name(path), columns::read(path)?, scaling));
    let backbones =
        args.backbones.iter().map(|path| Measurement::backbone(name(path), columns::read(path)?, scaling));
    let measurements = responses.chain(backbones).collect::<Result<Vec<_>, _>>()?;
    let mut session = Session::open(args.place(), &args.common, [WHOLE, SUMMARY, SCENARIO, CURVES, PAGE])?;
    let ring_downs = identify(&session)?;
    let fit = fitted(&measurements, ring_downs.as_ref(), &args.hold, &session)?;

    let name = ring_downs.as_ref().map_or(NAME, |r| &r.mode);
    let files = ring_downs.as_ref().map_or_else(Vec::new, |r| r.files.clone());
    let summary = SweepSummary::new(name, files, &measurements, &fit);
    let mode = predicted::mode(name, &fit)?;
    let curves = measurements
        .iter()
        .zip(&fit.drifts)
        .map(|(measurement, drift)| predicted::curves(&mode, &fit, measurement, *drift))
        .collect::<Result<Vec<_>, _>>()?;
    let toml = to_toml(&scenario(&summary.title, &mode, &fit, &measurements, mass), "");
    let shown: Vec<_> = measurements
        .iter()
        .zip(&curves)
        .map(|(measurement, curves)| Shown { measurement, curves, informed: fit.informed })
        .map(|shown| figures::responses(&shown))
        .collect();
    session.columns(CURVES, &table(&measurements, &curves), Format::Csv)?;
    session.summary(WHOLE, &summary)?;
    session.summary(SUMMARY, &summary)?;
    session.file(SCENARIO, toml.as_bytes())?;
    session.page(&render(&summary, &figures::backbones(&mode, &fit, &measurements), &shown, &toml))?;
    session.finish(&summary)
}

/// The fit, beside the main thread, which watches for Ctrl-C.
fn fitted(
    measurements: &[Measurement],
    ring_downs: Option<&RingDowns>,
    hold: &[(Parameter, f64)],
    session: &Session,
) -> Result<SteadyFit, Failure> {
    let data: Vec<SteadyData> = measurements.iter().map(|m| m.data.clone()).collect();
    let (likelihood, hold) = (ring_downs.map(|r| r.likelihood.clone()), hold.to_vec());
    let place = measurements.iter().map(|m| m.file.as_str()).collect::<Vec<_>>().join(", ");
    let work = move || fit_steady(&data, likelihood.as_ref(), &hold);
    let mut fit = session.busy("fitting").wait(work)?.map_err(|error| Failure::said(&place, &error))?;
    if let Some(ring_downs) = ring_downs {
        fit.informed[0] = fit.informed[0].min(ring_downs.informed[0]);
        fit.informed[1] = fit.informed[1].max(ring_downs.informed[1]);
    }
    Ok(fit)
}

/// Measured and predicted points below each other: `measured` is 1 or 0.
fn table(measurements: &[Measurement], curves: &[Vec<Curve>]) -> Vec<(&'static str, Vec<f64>)> {
    let names = ["measurement", "level", "measured", "frequency", "amplitude", "phase", "damping_ratio"];
    let mut columns = names.map(|name| (name, Vec::new()));
    let mut add =
        |row: [f64; 7]| columns.iter_mut().zip(row).for_each(|(column, value)| column.1.push(value));
    for (n, (measurement, curves)) in measurements.iter().zip(curves).enumerate() {
        let number = (n + 1) as f64;
        let level = |l: usize| measurement.levels[l].held.map_or(f64::NAN, |held| held.1);
        match &measurement.data {
            SteadyData::Response(points) => {
                for (l, own) in measurement.levels.iter().enumerate() {
                    for p in own.points.iter().map(|&i| points[i]) {
                        add([number, level(l), 1.0, p.frequency, p.amplitude, p.phase, f64::NAN]);
                    }
                }
            }
            SteadyData::Backbone(points) => {
                for p in points {
                    add([number, f64::NAN, 1.0, p.frequency, p.amplitude, f64::NAN, p.damping_ratio]);
                }
            }
        }
        for curve in curves {
            for [frequency, amplitude, phase] in &curve.points {
                add([number, level(curve.level), 0.0, *frequency, *amplitude, *phase, f64::NAN]);
            }
        }
    }
    columns.into()
}
