//! Hands the results of `iwan modal` to the fit (records, channels, shapes and what the sensors measure) and from there to the scenario (the shapes
//! at the hammer and at all measured points).

use std::path::{Path, PathBuf};

use iwan_input::scenario::Scenario;
use iwan_sim::Point;
use serde_json::Value;

use super::args::FitArgs;
use crate::failure::Failure;
use crate::modal::{MODAL, SHAPES};
use crate::records::Motion;
use crate::shown;

/// Mass-normalised shapes, one for each mode that `iwan modal` found.
pub(super) struct MeasuredShapes(Vec<MeasuredShape>);

struct MeasuredShape {
    at_force: Option<f64>,
    points: Vec<Point>,
}

impl MeasuredShapes {
    fn of(summary: &Value) -> Option<Self> {
        let mode = |mode: &Value| {
            let point =
                |(name, value): (&String, &Value)| Some(Point { name: name.clone(), shape: value.as_f64()? });
            let points = mode["shape"].as_object()?.iter().map(point).collect::<Option<Vec<Point>>>()?;
            Some(MeasuredShape { at_force: mode["shape_at_force"].as_f64(), points })
        };
        summary["modes"].as_array()?.iter().map(mode).collect::<Option<_>>().map(Self)
    }

    /// Puts the measured shapes into a scenario's modes; `numbers[i]` is the number, from 0, of the measured mode that the scenario's mode `i` is.
    pub(super) fn place(&self, scenario: &mut Scenario, numbers: &[usize]) {
        let names: Vec<String> = scenario.modes.iter().map(|m| m.mode.name.clone()).collect();
        for (mode, number) in scenario.modes.iter_mut().zip(numbers) {
            let Some(measured) = self.0.get(*number) else { continue };
            if let Some(shape) = measured.at_force {
                mode.mode.shape_at_force = shape;
            }
            // A point must not have the name of a mode.
            let own = |p: &Point| {
                let name = if names.contains(&p.name) { format!("point {}", p.name) } else { p.name.clone() };
                Point { name, shape: p.shape }
            };
            mode.mode.outputs = measured.points.iter().map(own).collect();
        }
    }
}

/// Fills in the options that the user left open from the folder of `iwan modal`; returns the shapes.
pub(super) fn over_from_modal(args: &mut FitArgs, folder: &Path) -> Result<MeasuredShapes, Failure> {
    let path = folder.join(MODAL);
    let name = shown::path(&path);
    let wrong =
        |what: &str| Failure::input(format!("{name}: {what}"), "give the folder that `iwan modal` wrote");
    let bytes = iwan_machine::read_file(&path).map_err(|e| wrong(&format!("cannot be read: {e}")))?;
    let summary: Value = serde_json::from_slice(&bytes).map_err(|e| wrong(&format!("is no summary: {e}")))?;
    let texts = |key: &str| -> Result<Vec<String>, Failure> {
        let list = summary[key].as_array().ok_or_else(|| wrong(&format!("has no list `{key}`")))?;
        let text = |v: &Value| {
            v.as_str().map(str::to_owned).ok_or_else(|| wrong(&format!("`{key}` holds no texts")))
        };
        list.iter().map(text).collect()
    };
    if summary["mass_normalised"] != Value::Bool(true) {
        let message = format!("{name}: its shapes are not mass-normalised");
        let remedy = "say where the hammer hits with `iwan modal --at POINT`, a point with a sensor";
        return Err(Failure::input(message, remedy));
    }
    if args.fit.is_empty() {
        args.fit = texts("sources")?.into_iter().map(PathBuf::from).collect();
    }
    if args.records.channels.is_empty() {
        args.records.channels = texts("channels")?;
    }
    args.records.shapes = Some(folder.join(SHAPES));
    if args.records.quantity.is_none() {
        args.records.quantity = match summary["quantity"].as_str() {
            Some("displacement") => Some(Motion::Displacement),
            Some("velocity") => Some(Motion::Velocity),
            _ => Some(Motion::Acceleration),
        };
    }
    MeasuredShapes::of(&summary).ok_or_else(|| wrong("has no shapes under `modes`"))
}
