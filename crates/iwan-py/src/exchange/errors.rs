//! The libraries' errors as Python exceptions, with Python's arguments in place of the command line's options.

use std::path::{Path, PathBuf};

use iwan_input::InputError;
use iwan_io::atomic::WriteError;
use iwan_io::{ReadError, RecordError};
use iwan_machine::{Kind, brief, harmless};
use iwan_sim::SimulationError;
use pyo3::prelude::*;

use crate::exchange::arguments::{Call, in_python};

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

/// A message in the words of Python: of long numbers and lines only the ends are left, and what a terminal would obey is written as its code.
fn said(message: &str, call: Call) -> String {
    harmless(&brief(&in_python(message, call))).into()
}

/// The exception for a bad value: `iwan.InvalidValueError`.
pub(crate) fn value(message: impl Into<String>) -> PyErr {
    python::InvalidValueError::new_err(said(&message.into(), Call::Other))
}

/// A bad value that a call of its own kind was given.
pub(crate) fn value_of(call: Call, message: &str) -> PyErr {
    value(in_python(message, call))
}

/// A warning of Python's: `UserWarning`.
pub(crate) fn warn(py: Python<'_>, message: &str) -> PyResult<()> {
    let message = std::ffi::CString::new(said(message, Call::Other))?;
    PyErr::warn(py, &py.get_type::<pyo3::exceptions::PyUserWarning>(), &message, 1)
}

/// The exception for a computation that failed: `iwan.ComputationError`.
pub(crate) fn computation(message: String) -> PyErr {
    python::ComputationError::new_err(said(&message, Call::Other))
}

/// The exception for too little memory: `iwan.ComputationError`.
pub(crate) fn lacking(short: &iwan_machine::memory::Short) -> PyErr {
    of(Kind::Memory, computation(short.to_string()))
}

/// The exception for an invalid record: `iwan.RecordError`.
pub(crate) fn record(message: String) -> PyErr {
    python::RecordError::new_err(said(&message, Call::Other))
}

/// Values that do not make a record: `iwan.InvalidValueError`.
pub(crate) fn no_record(error: &RecordError) -> PyErr {
    of(error.kind(), value(error.to_string()))
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
        other => of(other.kind(), computation(other.to_string())),
    }
}

/// An error of iwan-sim at a `place`, such as `mode "bending 1"`.
pub(crate) fn simulation_at(place: &str, error: SimulationError) -> PyErr {
    match error {
        SimulationError::Parameter(error) => value(format!("{place}: {error}")),
        other => of(other.kind(), computation(format!("{place}: {other}"))),
    }
}

/// The exception for records from which the wanted result cannot be found: `iwan.IdentificationError`.
pub(crate) fn identification_failed(message: String) -> PyErr {
    python::IdentificationError::new_err(said(&message, Call::Other))
}

/// An error of iwan-ident.
pub(crate) fn identification(error: iwan_ident::Error) -> PyErr {
    identification_of(Call::Other, "", error)
}

/// An error of iwan-ident in one of several records.
pub(crate) fn identification_at(call: Call, record: usize, error: iwan_ident::Error) -> PyErr {
    identification_of(call, &format!("record {record} (counted from 0): "), error)
}

/// An error of iwan-ident at a `place`, in the words of a call.
pub(crate) fn identification_of(call: Call, place: &str, error: iwan_ident::Error) -> PyErr {
    use iwan_ident::Error::{Refused, TooShort};
    let (message, kind) = (in_python(&format!("{place}{error}"), call), error.kind());
    let error = match error {
        Refused { .. } | TooShort { .. } => identification_failed(message),
        _ => value(message),
    };
    of(kind, error)
}

/// An error of the reader of records.
pub(crate) fn reading(call: Call, error: &ReadError) -> PyErr {
    let message = said(&error.to_string(), call);
    let ReadError::Io { file, source } = error else {
        return of(error.kind(), python::RecordError::new_err(message));
    };
    of(error.kind(), file_error(source, message, file.clone()))
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
    let message = said(&error.to_string(), Call::Other);
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

/// A structure that cannot be computed with: `iwan.StructureError`.
fn structure(message: &str) -> PyErr {
    python::StructureError::new_err(said(message, Call::Other))
}

/// What is wrong in a structure file; `place` where the message does not name it.
pub(crate) fn input(place: &str, error: &InputError) -> PyErr {
    let prefix = if place.is_empty() { String::new() } else { format!("{place}: ") };
    of(error.kind, structure(&format!("{prefix}{error}")))
}

/// The exception for an error of iwan-fem: a bad value where the model could not be set up, else a failed computation.
pub(crate) fn fem(name: &str, error: &iwan_fem::Error) -> PyErr {
    use iwan_fem::Error::{Analysis, Element, Interrupted, Model, Modes, Node, OutOfRange};
    let exception = match error {
        OutOfRange { name: "time step", value: dt, allowed } => {
            value(format!("dt = {dt} is out of range: {allowed}"))
        }
        OutOfRange { .. } | Modes { .. } => value(error.to_string()),
        Model(error) => core(*error),
        Analysis { .. } | Interrupted => computation(format!("{name}: {error}")),
        Element { .. } | Node { .. } => structure(&format!("{name}: {error}")),
        _ => value(format!("{name}: {error}")),
    };
    of(error.kind(), exception)
}
