//! Records of one mode, out of whatever stands for records.

use iwan_ident::channels::{Combination, strangers};
use iwan_ident::curves;
use iwan_ident::signal::Options;
use numpy::PyArrayMethods;
use numpy::ndarray::Axis;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;

use crate::errors::{identification, value};
use crate::record::Record;

/// The record of one mode.
#[derive(Debug, Clone)]
pub(crate) struct Modal {
    pub(crate) samples: Vec<f64>,
    pub(crate) dt: f64,
    /// Time of the first sample, s.
    pub(crate) start: f64,
    pub(crate) quantity: curves::Quantity,
    /// Unit of the samples as text.
    pub(crate) unit: String,
    /// Names of the channels it was taken from.
    pub(crate) channels: Vec<String>,
    /// How the channels were combined, and what was assumed.
    pub(crate) notes: Vec<String>,
}

/// The records of one mode: the channel named, the only one, or a combination of all, by the mode's `shape` or else by the shape
/// that dominates in the band of the first record. All records must have the same channels and quantity.
pub(crate) fn modal(
    records: &[Bound<'_, PyAny>],
    dt: Option<f64>,
    channel: Option<&Bound<'_, PyAny>>,
    quantity: Option<curves::Quantity>,
    shape: Option<&[f64]>,
    options: &Options,
) -> PyResult<Vec<Modal>> {
    let records = records.iter().map(|record| taken(record, dt)).collect::<PyResult<Vec<_>>>()?;
    let Some(first) = records.first() else { return Err(value("there is no record: give at least one")) };
    if let Some(other) = records.iter().find(|r| r.get().names != first.get().names) {
        let (a, b) = (first.get().names.join(", "), other.get().names.join(", "));
        return Err(value(format!("records do not belong together: channels {a} and {b}")));
    }
    let (quantity, mut notes) = first.get().motion(quantity)?;
    let all = 0..first.get().names.len();
    let chosen = if channel.is_some() { first.get().index(channel).map(|i| i..i + 1)? } else { all };
    let rows = |record: &Bound<'_, Record>| -> Vec<Vec<f64>> {
        let view = record.get().samples.bind(record.py()).readonly();
        chosen.clone().map(|i| view.as_array().index_axis(Axis(0), i).to_vec()).collect()
    };
    let combination = combination(&rows(first), first.get(), shape, options).map_err(identification)?;
    notes.extend(combination.notes.iter().cloned());
    let one = |record: &Bound<'_, Record>| {
        let rows = rows(record);
        let samples = combination.apply(&rows.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let (samples, this) = (samples.map_err(identification)?, record.get());
        Ok(Modal {
            samples,
            dt: this.dt,
            start: this.start,
            quantity,
            unit: this.unit.clone(),
            channels: this.names[chosen.clone()].to_vec(),
            notes: notes.clone(),
        })
    };
    records.iter().map(one).collect()
}

fn combination(
    rows: &[Vec<f64>],
    record: &Record,
    shape: Option<&[f64]>,
    options: &Options,
) -> Result<Combination, iwan_ident::Error> {
    let channels: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    match shape {
        Some(shape) => {
            let mut one = Combination::of_shapes(&[shape.to_vec()])?;
            let mut one = one.pop().unwrap_or_else(Combination::single);
            if shape.len() == record.names.len() && channels.len() > 1 {
                one.notes.extend(strangers(&channels, &record.names, shape, record.dt, options)?);
            }
            Ok(one)
        }
        None if channels.len() == 1 => Ok(Combination::single()),
        None => Combination::dominant(&channels, &record.names, record.dt, options),
    }
}

/// A record, or whatever `iwan.as_record` makes one of.
fn taken<'py>(record: &Bound<'py, PyAny>, dt: Option<f64>) -> PyResult<Bound<'py, Record>> {
    let py = record.py();
    let options = [("dt", dt)].into_py_dict(py)?;
    let made = py.import(intern!(py, "iwan.records"))?.getattr(intern!(py, "as_record"))?;
    Ok(made.call((record,), Some(&options))?.cast_into()?)
}
