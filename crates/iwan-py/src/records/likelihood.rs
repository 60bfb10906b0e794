//! The likelihood of a fit's records as a function of coordinates, for samplers: `iwan.log_likelihood` is its face.

use std::sync::Arc;

use iwan_ident::likelihood::{Buffers, Likelihood as Library};
use iwan_ident::refine::TurningPoint;
use iwan_ident::{Parameter, Parameters};
use numpy::PyArrayDyn;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;

use crate::exchange::array::{Numbers, array, shaped};
use crate::exchange::errors::{computation, value};
use crate::exchange::named;
use crate::exchange::options::thread_count;
use crate::exchange::pickle::Remake;
use crate::exchange::work;

/// Parameters whose logarithms are the coordinates of a likelihood.
const LOGARITHMIC: [Parameter; 3] = [Parameter::KT, Parameter::FS, Parameter::Beta];

/// Makes a pickled likelihood again: from the version of the package, the library's likelihood as JSON and the parameters that are sought.
#[pyfunction]
pub(crate) fn _likelihood(version: &str, json: &str, free: Vec<String>) -> PyResult<Likelihood> {
    const OWN: &str = env!("CARGO_PKG_VERSION");
    let library: Option<Library> = serde_json::from_str(json).ok();
    let library = library.filter(|_| version == OWN).ok_or_else(|| {
        value(format!(
            "this likelihood was pickled by iwan {version} and cannot be read by iwan {OWN}: make it again with iwan.log_likelihood"
        ))
    })?;
    let named = |name: &String| Parameter::ALL.into_iter().find(|parameter| parameter.name() == name);
    Ok(Likelihood::new(library, free.iter().filter_map(named).collect()))
}

/// The likelihood of a fit's records: logarithms for one or many sets of coordinates at once.
#[pyclass(frozen, module = "iwan._native", name = "_Likelihood")]
#[derive(Debug)]
pub(crate) struct Likelihood {
    library: Arc<Library>,
    free: Vec<Parameter>,
}

impl Likelihood {
    /// The library's likelihood with the parameters that are sought.
    pub(super) fn new(library: Library, free: Vec<Parameter>) -> Self {
        Self { library: Arc::new(library), free }
    }

    /// Parameters and starts from coordinates. They may be meaningless where the coordinates are.
    fn read(&self, x: &[f64]) -> (Parameters, Vec<TurningPoint>) {
        let mut parameters = *self.library.parameters();
        for (parameter, x) in self.free.iter().zip(x) {
            *parameters.get_mut(*parameter) = if LOGARITHMIC.contains(parameter) { x.exp() } else { *x };
        }
        let own = x[self.free.len()..].chunks_exact(self.own()).zip(self.library.starts());
        let starts = own.map(|(own, start)| TurningPoint {
            displacement: start.displacement * own[0].exp(),
            time: start.time + own[1] * self.library.radian(),
            day: own.get(2).copied().unwrap_or(start.day),
        });
        (parameters, starts.collect())
    }

    /// Number of coordinates that each record has for itself.
    fn own(&self) -> usize {
        if self.library.has_days() { 3 } else { 2 }
    }

    fn width(&self) -> usize {
        self.free.len() + self.own() * self.library.starts().len()
    }
}

#[pymethods]
impl Likelihood {
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Remake<'py>> {
        let (py, this) = (slf.py(), slf.get());
        let free: Vec<&str> = this.free.iter().map(|parameter| parameter.name()).collect();
        let json = serde_json::to_string(&*this.library).map_err(|error| computation(error.to_string()))?;
        let arguments = (env!("CARGO_PKG_VERSION"), json, free);
        Ok((py.import("iwan._native")?.getattr("_likelihood")?, arguments.into_bound_py_any(py)?))
    }

    /// Names of the coordinates.
    #[getter]
    fn names(&self) -> Vec<String> {
        let name = |p: &Parameter| {
            let prefix = if LOGARITHMIC.contains(p) { "log_" } else { "" };
            format!("{prefix}{}", p.name())
        };
        let own = (0..self.library.starts().len()).flat_map(|i| {
            let names = [format!("log_amplitude_{i}"), format!("phase_{i}"), format!("log_day_{i}")];
            names.into_iter().take(self.own())
        });
        self.free.iter().map(name).chain(own).collect()
    }

    /// Coordinates of the best fit.
    #[getter]
    fn best(&self, py: Python<'_>) -> Py<numpy::PyArray1<f64>> {
        let best = self.library.parameters();
        let coordinate = |p: &Parameter| {
            if LOGARITHMIC.contains(p) { best.get(*p).max(1e-12).ln() } else { best.get(*p) }
        };
        let own = self.library.starts().iter().flat_map(|s| [0.0, 0.0, s.day].into_iter().take(self.own()));
        array(py, self.free.iter().map(coordinate).chain(own).collect())
    }

    /// Logarithms of the likelihood of rows of coordinates; minus infinity where there is no model.
    fn log<'py>(
        &self,
        theta: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = named::threads)] threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (py, width) = (theta.py(), self.width());
        let Numbers { values, shape } = Numbers::read("theta", theta)?;
        if shape.last() != Some(&width) {
            return Err(value(format!(
                "theta has the shape {shape:?}: its last axis must have {width} entries"
            )));
        }
        let threads = if values.len() <= width { 1 } else { thread_count(threads)? };
        let library = self.library.clone();
        let rows: Vec<_> = values.chunks_exact(width).map(|row| self.read(row)).collect();
        let size = rows.len().div_ceil(4 * threads).max(1);
        let mut pieces = Vec::new();
        let mut rest = rows.into_iter().peekable();
        while rest.peek().is_some() {
            pieces.push(rest.by_ref().take(size).collect::<Vec<_>>());
        }
        let lasting = pieces.len() > 4;
        let logs = work::run(py, lasting, move |control| {
            work::each(pieces, threads, control, |piece| {
                let mut buffers = Buffers::default();
                let log = |(p, starts): (Parameters, Vec<TurningPoint>)| {
                    library.log(&p, &starts, &mut buffers).unwrap_or(f64::NEG_INFINITY)
                };
                piece.into_iter().map(log).collect::<Vec<_>>()
            })
        })?;
        shaped(py, shape[..shape.len() - 1].to_vec(), logs.unwrap_or_default().concat())
    }
}
