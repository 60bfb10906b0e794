//! Helpers for pickling and hashing the package's values.

use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A function and its arguments that make an equal value; pickling needs them where the constructor alone cannot.
pub(crate) type Remake<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Keyword arguments of the constructor that make an equal value; pickling needs them.
pub(crate) type NewArguments<'py> = ((), Bound<'py, PyDict>);

/// A hash of numbers; it is the same for 0.0 and -0.0, which are equal.
pub(crate) fn hash(values: &[f64]) -> u64 {
    use std::hash::{DefaultHasher, Hash, Hasher};
    let mut hasher = DefaultHasher::new();
    for x in values {
        (x + 0.0).to_bits().hash(&mut hasher);
    }
    hasher.finish()
}
