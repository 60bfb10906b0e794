//! The libraries' errors as Python exceptions, with Python's arguments in place of the command line's options.

use std::path::{Path, PathBuf};

use iwan_input::InputError;
use iwan_io::ReadError;
use iwan_io::atomic::WriteError;
use iwan_machine::Kind;
use iwan_sim::SimulationError;
use pyo3::prelude::*;

mod python {
    #![allow(missing_docs, unreachable_pub, reason = "the macro writes these")]
    pyo3::import_exception!(iwan.errors, ComputationError);
    pyo3::import_exception!(iwan.errors, ExistingFileError);
    pyo3::import_exception!(iwan.errors, FileError);
    pyo3::import_exception!(iwan.errors, IdentificationError);
    pyo3::import_exception!(iwan.errors, InvalidTypeError);
    pyo3::import_exception!(iwan.errors, InvalidValueError);
    pyo3::import_exception!(iwan.errors, MissingFileError);
    pyo3::import_exception!(iwan.errors, RecordError);
    pyo3::import_exception!(iwan.errors, StructureError);
}

/// The exception with a kind of the catalogue of errors, where this kind differs from that of the exception's class.
pub(crate) fn of(kind: Kind, error: PyErr) -> PyErr {
    // If the attribute cannot be set, the kind of the class remains, which is less specific but not wrong.
    Python::attach(|py| error.value(py).setattr("kind", kind.name()).ok());
    error
}

/// The exception for a bad value: `iwan.InvalidValueError`.
pub(crate) fn value(message: impl Into<String>) -> PyErr {
    python::InvalidValueError::new_err(message.into())
}

/// The exception for a computation that failed: `iwan.ComputationError`.
pub(crate) fn computation(message: String) -> PyErr {
    python::ComputationError::new_err(message)
}

/// The exception for too little memory: `iwan.ComputationError`.
pub(crate) fn lacking(short: &iwan_machine::memory::Short) -> PyErr {
    of(Kind::Memory, computation(short.to_string()))
}

/// The exception for an invalid record: `iwan.RecordError`.
pub(crate) fn record(message: String) -> PyErr {
    python::RecordError::new_err(in_python(&message))
}

/// The exception for a wrong type: `iwan.InvalidTypeError`.
pub(crate) fn wrong_type(message: impl Into<String>) -> PyErr {
    python::InvalidTypeError::new_err(message.into())
}

/// Names in errors of the libraries, and the corresponding arguments in Python.
const ARGUMENTS: [(&str, &str); 6] = [
    ("time step", "dt"),
    ("force time step", "dt"),
    ("force amplitude", "amplitude"),
    ("force duration", "duration"),
    ("force frequency", "frequency"),
    ("force samples", "force"),
];

/// An error of iwan-core.
pub(crate) fn core(mut error: iwan_core::Error) -> PyErr {
    use iwan_core::Error::{Entry, Length, OutOfRange};
    if let OutOfRange { name, .. } | Length { name, .. } | Entry { name, .. } = &mut error
        && let Some((_, argument)) = ARGUMENTS.iter().find(|(library, _)| library == name)
    {
        *name = argument;
    }
    value(error.to_string())
}

/// The exception for an error of iwan-sim; a failed computation is not reported as a bad value.
pub(crate) fn simulation(error: SimulationError) -> PyErr {
    match error {
        SimulationError::Parameter(error) => core(error),
        SimulationError::Mode { mode, source } => simulation_at(&format!("mode \"{mode}\""), *source),
        SimulationError::Joint { joint, source } => simulation_at(&format!("joint \"{joint}\""), *source),
        other => of(other.kind(), python::ComputationError::new_err(other.to_string())),
    }
}

/// An error of iwan-sim at a `place`, such as `mode "bending 1"`.
pub(crate) fn simulation_at(place: &str, error: SimulationError) -> PyErr {
    match error {
        SimulationError::Parameter(error) => value(format!("{place}: {error}")),
        other => of(other.kind(), python::ComputationError::new_err(format!("{place}: {other}"))),
    }
}

/// The exception for records from which the wanted result cannot be found: `iwan.IdentificationError`.
pub(crate) fn identification_failed(message: String) -> PyErr {
    python::IdentificationError::new_err(message)
}

/// An error of iwan-ident.
pub(crate) fn identification(error: iwan_ident::Error) -> PyErr {
    told_at("", error)
}

/// An error of iwan-ident in one of several records.
pub(crate) fn identification_at(record: usize, error: iwan_ident::Error) -> PyErr {
    told_at(&format!("record {record} (counted from 0): "), error)
}

fn told_at(place: &str, error: iwan_ident::Error) -> PyErr {
    use iwan_ident::Error::{Refused, TooShort};
    let (message, kind) = (format!("{place}{error}"), error.kind());
    let error = match error {
        Refused { .. } | TooShort { .. } => python::IdentificationError::new_err(message),
        _ => value(message),
    };
    of(kind, error)
}

/// An error of the reader of records, with Python's arguments in place of the command line's options.
pub(crate) fn reading(error: &ReadError) -> PyErr {
    let message = in_python(&error.to_string());
    let ReadError::Io { file, source } = error else {
        return of(error.kind(), python::RecordError::new_err(message));
    };
    of(error.kind(), file_error(source, message, file.clone()))
}

/// A message of the reader of records, with Python's arguments in place of the command line's options.
pub(crate) fn in_python(text: &str) -> String {
    const WORDS: [(&str, &str); 16] = [
        ("--time-unit s|ms|us|ns|min|h", "time_unit="),
        ("--time-unit ", "time_unit="),
        ("leave --unit out", "leave unit= out"),
        ("--rate HZ", "rate="),
        ("--time NAME", "time="),
        ("--channel NAME", "channels=[...]"),
        ("--quantity", "quantity="),
        ("--resample", "resample=True"),
        ("--force", "force=True"),
        ("--band LOW:HIGH", "bands="),
        ("one --band", "one band"),
        ("--mode HZ", "near="),
        ("--shapes FILE", "shapes="),
        ("choose one channel with --channel", "give one channel"),
        ("--shapes", "shapes="),
        ("a column `frequency` (Hz) in the file", "frequencies="),
    ];
    WORDS.iter().fold(text.to_owned(), |text, (from, to)| text.replace(from, to))
}

/// An error of the operating system.
fn file_error(source: &std::io::Error, message: String, file: PathBuf) -> PyErr {
    let arguments = (source.raw_os_error(), message, file);
    if source.kind() == std::io::ErrorKind::NotFound {
        python::MissingFileError::new_err(arguments)
    } else {
        python::FileError::new_err(arguments)
    }
}

/// The error number EEXIST (a file exists), which has this value on all systems.
const EEXIST: i32 = 17;

/// An error of the writer of files.
pub(crate) fn writing(error: &WriteError) -> PyErr {
    let message = error.to_string().replace("--force", "force=True");
    let exception = match error {
        WriteError::Exists { path } => python::ExistingFileError::new_err((EEXIST, message, path.clone())),
        WriteError::Io { path, source, .. } => file_error(source, message, path.clone()),
        WriteError::Name { path } | WriteError::Folder { path } => {
            python::FileError::new_err((None::<i32>, message, path.clone()))
        }
        _ => python::FileError::new_err(message),
    };
    of(error.kind(), exception)
}

/// The exception for a structure file that cannot be read at all.
pub(crate) fn missing_file(path: &Path, error: &std::io::Error) -> PyErr {
    let message = format!("cannot be read: {error}; check the path; `iwan scenario paper-a` prints a start");
    file_error(error, message, path.to_path_buf())
}

/// The exception for an error in a structure file; `place` is given where the message does not name the place.
pub(crate) fn input(place: &str, error: &InputError) -> PyErr {
    let prefix = if place.is_empty() { String::new() } else { format!("{place}: ") };
    of(error.kind, python::StructureError::new_err(format!("{prefix}{error}")))
}

/// The exception for an error of iwan-fem: a bad value where the model could not be set up, else a failed computation.
pub(crate) fn fem(name: &str, error: &iwan_fem::Error) -> PyErr {
    use iwan_fem::Error::{Analysis, Element, Interrupted, Model, Node, OutOfRange};
    let exception = match error {
        OutOfRange { name: "time step", value: dt, allowed } => {
            value(format!("dt = {dt} is out of range: {allowed}"))
        }
        OutOfRange { .. } => value(error.to_string()),
        Model(error) => core(*error),
        Analysis { .. } | Interrupted => python::ComputationError::new_err(format!("{name}: {error}")),
        Element { .. } | Node { .. } => python::StructureError::new_err(format!("{name}: {error}")),
        _ => value(format!("{name}: {error}")),
    };
    of(error.kind(), exception)
}
