//! The responses that simulations return.

use std::sync::OnceLock;

use iwan_core::EnergyBalance;
use iwan_sim::{OutsideCurves, Quality};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exchange::array::array;
use crate::exchange::named::Instance;
use crate::exchange::pickle::Remake;

/// Response of a mode: one entry per `dt`, the initial state first. Made by `simulate`.
///
/// Arrays are float64 of one dimension; modal units (displacement in mass^1/2 length). Picklable.
#[pyclass(frozen, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Response {
    /// Without its arrays, which have moved to NumPy.
    summary: iwan_sim::Response,
    peak: f64,
    last: f64,
    steps: usize,
    times: OnceLock<Py<PyArray1<f64>>>,
    /// Modal displacement q, float64 array (mass^1/2 length).
    #[pyo3(get)]
    displacement: Py<PyArray1<f64>>,
    /// Modal velocity q', float64 array.
    #[pyo3(get)]
    velocity: Py<PyArray1<f64>>,
    /// Modal acceleration q'', float64 array.
    #[pyo3(get)]
    acceleration: Py<PyArray1<f64>>,
    /// Modal joint force F_J, float64 array.
    #[pyo3(get)]
    joint_force: Py<PyArray1<f64>>,
}

impl Instance for Response {}

impl Response {
    /// Takes the samples over.
    pub(crate) fn new(py: Python<'_>, mut response: iwan_sim::Response) -> Self {
        let (peak, steps) = (response.peak_displacement(), response.steps());
        let last = response.displacement.last().copied().unwrap_or(0.0);
        let taken = |samples: &mut Vec<f64>| array(py, std::mem::take(samples));
        Self {
            displacement: taken(&mut response.displacement),
            velocity: taken(&mut response.velocity),
            acceleration: taken(&mut response.acceleration),
            joint_force: taken(&mut response.joint_force),
            times: OnceLock::new(),
            summary: response,
            peak,
            last,
            steps,
        }
    }

    /// The response of the library, with displacement, velocity and acceleration copied back: superposition needs these.
    pub(crate) fn motion(&self, py: Python<'_>) -> iwan_sim::Response {
        let copy = |array: &Py<PyArray1<f64>>| array.bind(py).readonly().as_array().to_vec();
        let [displacement, velocity, acceleration] =
            [&self.displacement, &self.velocity, &self.acceleration].map(copy);
        iwan_sim::Response { displacement, velocity, acceleration, ..iwan_sim::Response::default() }
    }
}

/// An energy balance as a dict.
pub(crate) fn balance<'py>(py: Python<'py>, e: &EnergyBalance) -> PyResult<Bound<'py, PyDict>> {
    let parts = [
        ("initial", e.initial),
        ("input", e.input),
        ("kinetic", e.kinetic),
        ("elastic", e.elastic),
        ("stored", e.stored),
        ("viscous", e.viscous),
        ("friction", e.friction),
        ("residual", e.residual),
    ];
    let dict = PyDict::new(py);
    parts.iter().try_for_each(|(key, part)| dict.set_item(*key, *part))?;
    Ok(dict)
}

/// Everything but the histories in a pickle: dt, largest strength, seconds, the energy balance, the quality figures.
type Figures = (f64, f64, f64, [f64; 9], (Option<f64>, Option<f64>, f64, Option<f64>, Option<f64>, f64));

/// Makes a pickled `Response` again.
#[pyfunction]
pub(crate) fn _response(py: Python<'_>, histories: [Vec<f64>; 4], figures: Figures) -> Response {
    let (dt, strongest, seconds, energy, quality) = figures;
    let [displacement, velocity, acceleration, joint_force] = histories;
    let [initial, input, kinetic, elastic, stored, viscous, friction, residual, scale] = energy;
    let (time_step_error, discretisation_error, forgotten_force, below_from, above_from, largest_amplitude) =
        quality;
    let outside_curves = OutsideCurves { below_from, above_from, largest_amplitude };
    let response = iwan_sim::Response {
        dt,
        displacement,
        velocity,
        acceleration,
        joint_force,
        energy: EnergyBalance {
            initial,
            input,
            kinetic,
            elastic,
            stored,
            viscous,
            friction,
            residual,
            scale,
        },
        quality: Quality { time_step_error, discretisation_error, forgotten_force, outside_curves },
        strongest,
        seconds,
    };
    Response::new(py, response)
}

#[pymethods]
impl Response {
    /// Times, s: 0, dt, 2 dt, …, float64 array.
    #[getter]
    fn t(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        let times = || array(py, (0..=self.steps).map(|n| n as f64 * self.summary.dt).collect());
        self.times.get_or_init(times).clone_ref(py)
    }

    /// Time between samples, s.
    #[getter]
    fn dt(&self) -> f64 {
        self.summary.dt
    }

    /// |residual| of the energy balance over the largest energy in play.
    #[getter]
    fn energy_error(&self) -> f64 {
        self.summary.energy.error()
    }

    /// The energy balance (a new dict): initial + input = kinetic + elastic + stored + viscous + friction + residual,
    /// mass-normalised.
    #[getter]
    fn energy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        balance(py, &self.summary.energy)
    }

    /// Figures of the run (a new dict), named as in the command line's `summary.json`: `peak_displacement`,
    /// `final_displacement`, `slip_ratio` (peak |q| over phi_max; macro-slip above 1), `energy_error`, `time_step_error`
    /// and `discretisation_error` (relative to the peak; None where not estimated), `forgotten_force` (bound on the
    /// force error from lack of room, 0 = exact), `below_curves_from` and `above_curves_from` (of a mode by curves: times, s,
    /// from which on its amplitude stays below and at which it first exceeds them; only there where it does), `steps`, `seconds` (of the integration itself).
    #[getter]
    fn statistics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (quality, dict) = (&self.summary.quality, PyDict::new(py));
        dict.set_item("peak_displacement", self.peak)?;
        dict.set_item("final_displacement", self.last)?;
        dict.set_item("slip_ratio", self.peak / self.summary.strongest)?;
        dict.set_item("energy_error", self.energy_error())?;
        dict.set_item("time_step_error", quality.time_step_error)?;
        dict.set_item("discretisation_error", quality.discretisation_error)?;
        dict.set_item("forgotten_force", quality.forgotten_force)?;
        let outside = quality.outside_curves;
        for (name, time) in
            [("below_curves_from", outside.below_from), ("above_curves_from", outside.above_from)]
        {
            time.map_or(Ok(()), |time| dict.set_item(name, time))?;
        }
        dict.set_item("steps", self.steps)?;
        dict.set_item("seconds", self.summary.seconds)?;
        Ok(dict)
    }

    /// An `xarray.Dataset` of the histories over `t` (s); the figures are its attributes. Needs xarray.
    ///
    /// >>> response = iwan.simulate(iwan.Mode(frequency=10.0), dt=1e-2, duration=1.0, initial=(1.0, 0.0))
    /// >>> dict(response.to_xarray().sizes), sorted(response.to_xarray().data_vars)
    /// ({'t': 101}, ['acceleration', 'displacement', 'joint_force', 'velocity'])
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("iwan._xarray")?.call_method1("dataset", (slf,))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Remake<'py>> {
        let (py, this) = (slf.py(), slf.get());
        let iwan_sim::Response { dt, energy: e, quality: q, strongest, seconds, .. } = &this.summary;
        let energy =
            [e.initial, e.input, e.kinetic, e.elastic, e.stored, e.viscous, e.friction, e.residual, e.scale];
        let OutsideCurves { below_from, above_from, largest_amplitude } = q.outside_curves;
        let quality = (
            q.time_step_error,
            q.discretisation_error,
            q.forgotten_force,
            below_from,
            above_from,
            largest_amplitude,
        );
        let histories = [&this.displacement, &this.velocity, &this.acceleration, &this.joint_force];
        let arguments = (histories.map(|h| h.clone_ref(py)), (*dt, *strongest, *seconds, energy, quality));
        let made = py.import("iwan._native")?.getattr("_response")?;
        Ok((made, arguments.into_bound_py_any(py)?))
    }

    fn __len__(&self) -> usize {
        self.steps + 1
    }

    fn __repr__(&self) -> String {
        let (dt, ratio) = (self.summary.dt, self.peak / self.summary.strongest);
        format!(
            "<iwan.Response: {} steps of {dt:?} s, peak {:.6e}, slip ratio {ratio:.4}>",
            self.steps, self.peak
        )
    }
}
