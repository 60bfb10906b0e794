//! Many simulations in one call, for `iwan.ensemble`: from arrays of parameters to arrays of results.

use iwan_core::Error;
use iwan_sim::{Ensemble, History, JointLaw, Mode, Settings};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::exchange::array::{Numbers, array, place};
use crate::exchange::errors::{simulation_at, value};
use crate::exchange::named;
use crate::exchange::options::{MethodOptions, choose, method, representation_of, thread_count};
use crate::exchange::work;
use crate::values::pulse::Force;

/// Histories by their names.
const HISTORIES: [(&str, History); 4] = [
    ("displacement", History::Displacement),
    ("velocity", History::Velocity),
    ("acceleration", History::Acceleration),
    ("joint_force", History::JointForce),
];

/// Names of a member's parameters, in the order of the columns.
const PARAMETERS: [&str; 9] =
    ["frequency", "damping_ratio", "k_t", "f_s", "chi", "beta", "shape_at_force", "displacement", "velocity"];

/// One list of numbers per parameter.
struct Columns(Vec<Vec<f64>>);

impl Columns {
    fn read(columns: &[Bound<'_, PyAny>]) -> PyResult<Self> {
        if columns.len() != PARAMETERS.len() {
            return Err(value(format!("{} columns: there are {}", columns.len(), PARAMETERS.len())));
        }
        let read = |(column, name): (&Bound<'_, PyAny>, &&str)| Numbers::vector(name, column);
        let columns = columns.iter().zip(&PARAMETERS).map(read).collect::<PyResult<Vec<_>>>()?;
        if columns.iter().any(|column| column.len() != columns[0].len()) {
            return Err(value("columns differ in length"));
        }
        Ok(Self(columns))
    }

    fn mode(&self, i: usize) -> Result<Mode, Error> {
        let [frequency, damping_ratio, k_t, f_s, chi, beta, shape_at_force, q, v] =
            std::array::from_fn(|parameter| self.0[parameter][i]);
        let joint = iwan_core::FourParameter::new(k_t, f_s, chi, beta)?;
        let mode = Mode::new("", frequency, Some(JointLaw::FourParameter(joint)));
        let initial = iwan_core::Motion { displacement: q, velocity: v };
        Ok(Mode { damping_ratio, shape_at_force, initial, ..mode })
    }
}

/// Figures of each member (peak and final displacement, slip ratio, energy error), then the kept histories, member after member.
type Arrays = (Vec<Py<PyArray1<f64>>>, Vec<Py<PyArray1<f64>>>, usize);

/// Simulates one member per entry of the columns `frequency`, `damping_ratio`, `k_t`, `f_s`, `chi`, `beta`,
/// `shape_at_force`, `displacement`, `velocity`. They are the entries from `first` on of arrays of the given `shape`, for
/// messages.
#[pyfunction]
#[pyo3(signature = (columns, *, force, dt, duration, method, sliders, grid, prewarp, keep, shape, first, threads, progress))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn _ensemble(
    py: Python<'_>,
    columns: Vec<Bound<'_, PyAny>>,
    force: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = named::dt)] dt: f64,
    #[pyo3(from_py_with = named::duration)] duration: f64,
    #[pyo3(from_py_with = named::method)] method: &str,
    #[pyo3(from_py_with = named::sliders)] sliders: Option<usize>,
    grid: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = named::prewarp)] prewarp: bool,
    #[pyo3(from_py_with = named::keep)] keep: Vec<String>,
    #[pyo3(from_py_with = named::shape)] shape: Vec<usize>,
    #[pyo3(from_py_with = named::first)] first: usize,
    #[pyo3(from_py_with = named::threads)] threads: Option<usize>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Arrays> {
    let columns = Columns::read(&columns)?;
    let options = MethodOptions {
        joint: representation_of(sliders, grid, iwan_core::Grid::graded)?,
        prewarp,
        beta: 0.25,
        gamma: 0.5,
    };
    let settings = Settings { dt, duration, method: self::method(method, options)?, quality: false };
    let force = Force::read(force, dt)?;
    let kept = keep.iter().map(|name| choose("keep", name, &HISTORIES)).collect::<PyResult<Vec<_>>>()?;
    let threads = thread_count(threads)?;
    let outcome = work::watched(py, progress, move |control| {
        let mode = |i: usize| columns.mode(i);
        let members = columns.0[0].len();
        let ensemble = Ensemble { members, mode: &mode, force: force.pulse(), settings, kept: &kept };
        ensemble.run(threads, &|share| control.report((share * members as f64).round() as usize))
    })?
    .map_err(|error| {
        simulation_at(&format!("parameter set {}", place(first + error.member, &shape)), error.source)
    })?;
    let figure = |f: fn(&iwan_sim::Figures) -> f64| array(py, outcome.figures.iter().map(f).collect());
    let figures = vec![
        figure(|f| f.peak_displacement),
        figure(|f| f.final_displacement),
        figure(|f| f.slip_ratio),
        figure(|f| f.energy_error),
    ];
    Ok((figures, outcome.histories.into_iter().map(|h| array(py, h)).collect(), outcome.samples))
}
