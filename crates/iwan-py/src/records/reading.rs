//! Records from files and from the bytes of files: `iwan.read_record`, and what `iwan.as_record` stands on.

use std::path::PathBuf;

use iwan_io::{Format, ReadOptions, TimeUnit, UnknownTimeUnit, Warning, unit_of_times};
use iwan_machine::Kind;
use pyo3::prelude::*;

use crate::exchange::arguments::Call;
use crate::exchange::errors::{no_record, of, reading, record, value};
use crate::exchange::named;
use crate::exchange::options::choose;
use crate::exchange::work;
use crate::records::record::{QUANTITIES, Record};

const FORMATS: [(&str, Format); 7] = [
    ("text", Format::Text),
    ("npy", Format::Npy),
    ("npz", Format::Npz),
    ("uff", Format::Uff),
    ("mat", Format::Mat),
    ("lvm", Format::Lvm),
    ("wav", Format::Wav),
];

/// Reads a record from a file: CSV and other text (header and delimiter are found), NPY/NPZ, UFF/UNV dataset 58 and 58b,
/// MATLAB .mat (v5 to v7.3), LabVIEW .lvm, WAV.
///
/// `path`: str or path-like; `format`: "text", "npy", "npz", "uff", "mat", "lvm" or "wav" where content and extension do not tell;
/// `time`: name of the time vector, such as "HIdata.time"; `channels`: names, in the order wanted (all that fit by default);
/// `rate` (Hz) where no time is stored; `quantity`: goes before what the file says; `resample`: interpolate samples that
/// are not uniform; `time_unit`: "s", "ms", "us", "ns", "min" or "h", goes before what the file says; `unit`: convert the samples
/// to "SI" or to a unit such as "m/s^2"; `start`, `stop`: keep only the samples between these times (s, on the record's own clock).
///
/// Returns a `Record`. Raises `iwan.MissingFileError` (a `FileNotFoundError`) or `iwan.FileError` (an `OSError`) when the file
/// cannot be read, `iwan.RecordError` (a `ValueError`) naming the place in the file and what helps when its content is no record.
///
/// >>> with open("tip.csv", "w") as file:
/// ...     _ = file.write("time [s],tip [m/s^2]\n0.0,1.0\n0.5,2.0\n1.0,4.0\n")
/// >>> record = iwan.read_record("tip.csv")
/// >>> record.quantity, record.unit, record.dt, record.channel("tip")
/// ('acceleration', 'm/s^2', 0.5, array([1., 2., 4.]))
#[pyfunction]
#[pyo3(signature = (
    path, *, format = None, time = None, channels = Vec::new(), rate = None, quantity = None, resample = false,
    time_unit = None, unit = None, start = None, stop = None
))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn read_record(
    py: Python<'_>,
    #[pyo3(from_py_with = named::path)] path: PathBuf,
    #[pyo3(from_py_with = named::format)] format: Option<&str>,
    #[pyo3(from_py_with = named::time)] time: Option<String>,
    #[pyo3(from_py_with = named::channels)] channels: Vec<String>,
    #[pyo3(from_py_with = named::rate)] rate: Option<f64>,
    #[pyo3(from_py_with = named::quantity)] quantity: Option<&str>,
    #[pyo3(from_py_with = named::resample)] resample: bool,
    #[pyo3(from_py_with = named::time_unit)] time_unit: Option<&str>,
    #[pyo3(from_py_with = named::unit)] unit: Option<String>,
    #[pyo3(from_py_with = named::start)] start: Option<f64>,
    #[pyo3(from_py_with = named::stop)] stop: Option<f64>,
) -> PyResult<Record> {
    let format = format.map(|name| choose("format", name, &FORMATS)).transpose()?;
    let quantity = quantity.map(|name| choose("quantity", name, &QUANTITIES)).transpose()?;
    let time_unit =
        time_unit.map(str::parse).transpose().map_err(|e: UnknownTimeUnit| value(e.to_string()))?;
    let options = ReadOptions { format, time, channels, rate, quantity, resample, time_unit, unit };
    let record = work::run(py, true, move |_| iwan_io::read(path, &options))?;
    let record = record.map_err(|error| reading(Call::File, &error))?;
    Record::wrap(py, &record.between(start, stop).map_err(|error| no_record(&error))?)?.warned(py)
}

/// Seconds in the unit of times: that which is written beside them, or else the one in their name, or else 1.
#[pyfunction]
pub(crate) fn _seconds_in(name: &str, unit: &str) -> PyResult<f64> {
    let written = if unit.trim().is_empty() { unit_of_times(name) } else { unit.to_owned() };
    if written.trim().is_empty() {
        return Ok(1.0);
    }
    written.parse().map(TimeUnit::seconds).map_err(|error: UnknownTimeUnit| {
        let message =
            format!("the times '{name}' are in '{}': {error}; give dt=, or times in seconds", error.text);
        of(Kind::TimeUnit, record(message))
    })
}

/// Reads a record from the bytes of a file; `left_out` are names beside it that make no channel, with the reasons.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn _read_bytes(
    py: Python<'_>,
    name: PathBuf,
    bytes: &[u8],
    #[pyo3(from_py_with = named::time)] time: Option<String>,
    #[pyo3(from_py_with = named::channels)] channels: Vec<String>,
    #[pyo3(from_py_with = named::rate)] rate: Option<f64>,
    #[pyo3(from_py_with = named::quantity)] quantity: Option<&str>,
    #[pyo3(from_py_with = named::resample)] resample: bool,
    left_out: Vec<(String, String)>,
) -> PyResult<Record> {
    let quantity = quantity.map(|name| choose("quantity", name, &QUANTITIES)).transpose()?;
    let options = ReadOptions { time, channels, rate, quantity, resample, ..ReadOptions::default() };
    let record = iwan_io::read_bytes(&name, bytes, &options);
    let mut record = Record::wrap(py, &record.map_err(|error| reading(Call::Data, &error))?)?;
    let left_out = left_out.into_iter().map(|(name, reason)| Warning::LeftOut { name, reason }.to_string());
    record.warnings.extend(left_out);
    record.warned(py)
}
