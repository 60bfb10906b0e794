//! The output of a fitted test: the summary, measured and predicted curves, the scenario and the page.

use iwan_ident::sweeps::{SteadyData, SteadyFit};
use iwan_input::scenario::to_toml;

use super::figures::{self, Shown};
use super::predicted::{self, Curve};
use super::report::render;
use super::scenario::scenario;
use super::summary::SweepSummary;
use super::test::ShakerTest;
use crate::failure::Failure;

/// The results of one test.
pub(crate) struct Results {
    pub(crate) summary: SweepSummary,
    /// Columns of `curves.csv`.
    pub(super) table: Vec<(&'static str, Vec<f64>)>,
    /// The scenario.
    pub(super) toml: String,
    /// The page.
    pub(crate) page: String,
}

impl Results {
    pub(crate) fn new(test: &ShakerTest, fit: &SteadyFit) -> Result<Self, Failure> {
        let measurements = &test.measurements;
        let summary = SweepSummary::new(test.mode(), test.records(), measurements, fit);
        let mode = predicted::mode(test.mode(), fit)?;
        let curves = measurements
            .iter()
            .zip(&fit.drifts)
            .map(|(measurement, drift)| predicted::curves(&mode, fit, measurement, *drift))
            .collect::<Result<Vec<_>, _>>()?;
        let toml = to_toml(&scenario(&summary.title, &mode, fit, measurements, test.mass), "");
        let shown: Vec<_> = measurements
            .iter()
            .zip(&curves)
            .map(|(measurement, curves)| Shown { measurement, curves, informed: fit.informed })
            .map(|shown| figures::responses(&shown))
            .collect();
        let page = render(&summary, &figures::backbones(&mode, fit, measurements), &shown, &toml);
        Ok(Self { summary, table: table(test, &curves), toml, page })
    }
}

/// Measured and predicted points below each other; the column `measured` is 1 for measured points and 0 for predicted ones.
fn table(test: &ShakerTest, curves: &[Vec<Curve>]) -> Vec<(&'static str, Vec<f64>)> {
    let names = ["measurement", "level", "measured", "frequency", "amplitude", "phase", "damping_ratio"];
    let mut columns = names.map(|name| (name, Vec::new()));
    let mut add =
        |row: [f64; 7]| columns.iter_mut().zip(row).for_each(|(column, value)| column.1.push(value));
    for (n, (measurement, curves)) in test.measurements.iter().zip(curves).enumerate() {
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
