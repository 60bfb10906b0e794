//! What pickling and hashing of the package's values need.

use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A function and its arguments that make an equal value: what pickling needs where the constructor does not do.
pub(crate) type Remake<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Keyword arguments that make an equal value: what pickling needs.
pub(crate) type NewArguments<'py> = ((), Bound<'py, PyDict>);

/// Of numbers: the same for 0.0 and -0.0, which are equal.
pub(crate) fn hash(values: &[f64]) -> u64 {
    use std::hash::{DefaultHasher, Hash, Hasher};
    let mut hasher = DefaultHasher::new();
    for x in values {
        (x + 0.0).to_bits().hash(&mut hasher);
    }
    hasher.finish()
}
