//! Records of one mode, made of the objects that a caller gives as records.

use iwan_ident::channels::{NoMode, Recording, Shape, one_mode};
use iwan_ident::curves;
use iwan_ident::signal::{Options, band_near};
use numpy::PyArrayMethods;
use numpy::ndarray::Axis;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;

use crate::exchange::arguments::Call;
use crate::exchange::errors::{identification, identification_of, value};
use crate::exchange::options::unknown;
use crate::records::record::Record;

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
    /// Names of the channels from which the record was taken.
    pub(crate) channels: Vec<String>,
    /// Whether a window is known to lie over the record.
    pub(crate) windowed: bool,
    /// Remarks: how the channels were combined, and what was assumed.
    pub(crate) notes: Vec<String>,
}

/// The records of one mode: the channel named, the only one, or a combination of all, by the mode's `shape` or else by the shape
/// that dominates in the band of the first record. All records must have the same channels and quantity. Errors name the arguments of `call`.
pub(crate) fn modal(
    records: &[Bound<'_, PyAny>],
    dt: Option<f64>,
    channel: Option<&Bound<'_, PyAny>>,
    quantity: Option<curves::Quantity>,
    shape: Option<&[f64]>,
    options: &Options,
    call: Call,
) -> PyResult<Vec<Modal>> {
    let records = records.iter().map(|record| taken(record, dt)).collect::<PyResult<Vec<_>>>()?;
    let Some(first) = records.first() else { return Err(value("there is no record: give at least one")) };
    if let Some(other) = records.iter().find(|r| r.get().names != first.get().names) {
        let (a, b) = (first.get().names.join(", "), other.get().names.join(", "));
        return Err(value(format!("records do not belong together: channels {a} and {b}")));
    }
    let of = |r: &Bound<'_, Record>| (r.get().quantity, r.get().unit.clone());
    if let Some(other) = records.iter().find(|r| of(r) != of(first)) {
        let word = |r: &Bound<'_, Record>| format!("{} in \"{}\"", r.get().quantity, r.get().unit);
        return Err(value(format!(
            "records do not belong together: {} and {}; give records of one quantity in one unit (iwan.read_record converts with unit=)",
            word(first),
            word(other)
        )));
    }
    let (quantity, mut notes) = first.get().motion(quantity, call)?;
    let all = 0..first.get().names.len();
    let chosen = if channel.is_some() { first.get().index(channel).map(|i| i..i + 1)? } else { all };
    let rows = |record: &Bound<'_, Record>| -> Vec<Vec<f64>> {
        let view = record.get().samples.bind(record.py()).readonly();
        chosen.clone().map(|i| view.as_array().index_axis(Axis(0), i).to_vec()).collect()
    };
    let rows: Vec<_> = records.iter().map(rows).collect();
    let names = first.get().names[chosen].to_vec();
    let shapes = shape.map(|shape| [shape.to_vec()]);
    let shape = shapes.as_ref().map_or(Shape::Unknown, |shapes| Shape::Known { shapes, mode: 0 });
    let recordings = records.iter().zip(&rows).map(|(record, rows)| Recording {
        names: &names,
        channels: rows.iter().map(Vec::as_slice).collect(),
        dt: record.get().dt,
    });
    let recordings: Vec<_> = recordings.collect();
    let mode = one_mode(&recordings, shape, options).map_err(|fault| match fault {
        NoMode::Shapes(error) | NoMode::Recording { error, .. } => identification_of(call, "", error),
    })?;
    notes.extend(mode.notes);
    let one = |(record, samples): (&Bound<'_, Record>, Vec<f64>)| Modal {
        samples,
        dt: record.get().dt,
        start: record.get().start,
        quantity,
        unit: record.get().unit.clone(),
        channels: names.clone(),
        windowed: record.get().windowed,
        notes: notes.clone(),
    };
    Ok(records.iter().zip(mode.records).map(one).collect())
}

/// The band around the spectral peak nearest to `near` Hz, in the named channel or in all channels.
pub(crate) fn band_of_mode(
    record: &Bound<'_, PyAny>,
    dt: Option<f64>,
    channel: Option<&Bound<'_, PyAny>>,
    near: f64,
) -> PyResult<(f64, f64)> {
    let record = taken(record, dt)?;
    let all = 0..record.get().names.len();
    let chosen = if channel.is_some() { record.get().index(channel).map(|i| i..i + 1)? } else { all };
    let view = record.get().samples.bind(record.py()).readonly();
    let rows: Vec<Vec<f64>> = chosen.map(|i| view.as_array().index_axis(Axis(0), i).to_vec()).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let band = band_near(&rows, record.get().dt, near).map_err(identification)?;
    Ok((band.low, band.high))
}

/// A record, or an object from which `iwan.as_record` makes one.
fn taken<'py>(record: &Bound<'py, PyAny>, dt: Option<f64>) -> PyResult<Bound<'py, Record>> {
    let py = record.py();
    let options = [("dt", dt)].into_py_dict(py)?;
    let made = py.import(intern!(py, "iwan.records"))?.getattr(intern!(py, "as_record"))?;
    Ok(made.call((record,), Some(&options))?.cast_into()?)
}

/// The kind of motion with this name.
pub(crate) fn motion(name: &str) -> PyResult<curves::Quantity> {
    match name {
        "acceleration" => Ok(curves::Quantity::Acceleration),
        "velocity" => Ok(curves::Quantity::Velocity),
        "displacement" => Ok(curves::Quantity::Displacement),
        _ => Err(unknown("quantity", name, &["acceleration", "velocity", "displacement"])),
    }
}
