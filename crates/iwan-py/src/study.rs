//! The reproduction of the paper: `iwan.reproduce`.

use pyo3::prelude::*;

use crate::exchange::errors::computation;
use crate::exchange::named;
use crate::exchange::options::thread_count;
use crate::exchange::work;

/// The count that progress reaches at the end.
const PARTS: f64 = 1000.0;

/// Every number of the reproduction as a JSON text; `progress` hears thousandths.
#[pyfunction]
#[pyo3(signature = (*, threads, progress))]
pub(crate) fn _reproduce(
    py: Python<'_>,
    #[pyo3(from_py_with = named::threads)] threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let threads = thread_count(threads)?;
    let found = work::watched(py, progress, move |control| {
        let observer = |share: f64| control.report((share * PARTS) as usize);
        iwan_study::reproduce(threads, &observer).and_then(|found| iwan_study::Summary::new(&found))
    })?;
    let summary = found.map_err(|error| computation(error.to_string()))?;
    serde_json::to_string(&summary).map_err(|error| computation(error.to_string()))
}
