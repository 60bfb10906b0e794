//! Backbones of modes, for `iwan.backbone`.

use iwan_sim::{BackbonePoint, NonlinearMode, SimulationError, backbone, in_parallel};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::exchange::array::{Numbers, array};
use crate::exchange::errors::simulation;
use crate::exchange::named;
use crate::exchange::options::thread_count;
use crate::exchange::work;
use crate::values::mode::Mode;

/// Backbones of several modes at the same amplitudes: a dict per mode.
#[pyfunction]
pub(crate) fn _backbone<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = named::modes)] modes: Vec<Bound<'py, Mode>>,
    amplitude: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = named::harmonics)] harmonics: usize,
    #[pyo3(from_py_with = named::threads)] threads: Option<usize>,
) -> PyResult<Bound<'py, PyList>> {
    let amplitudes = Numbers::vector("amplitude", amplitude)?;
    let modes: Vec<iwan_sim::Mode> = modes.into_iter().map(|mode| mode.get().mode.clone()).collect();
    let threads = thread_count(threads)?;
    let found = work::run(py, true, move |_| {
        in_parallel(&modes, threads, &|mode| backbone(mode, harmonics, &amplitudes))
    })?;
    let found: Result<Vec<NonlinearMode>, SimulationError> = found.into_iter().collect();
    let list = PyList::empty(py);
    for curve in found.map_err(simulation)? {
        list.append(told(py, &curve, &[])?)?;
    }
    Ok(list)
}

/// A nonlinear mode as a dict; `slips` are the names of the joints, in their order.
pub(crate) fn told<'py>(
    py: Python<'py>,
    curve: &NonlinearMode,
    slips: &[String],
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let all = |of: &dyn Fn(&BackbonePoint) -> f64| array(py, curve.points.iter().map(of).collect());
    dict.set_item("amplitude", all(&|p| p.amplitude))?;
    dict.set_item("frequency", all(&|p| p.frequency))?;
    dict.set_item("damping_ratio", all(&|p| p.damping_ratio))?;
    dict.set_item("response", all(&|p| p.response[0]))?;
    let higher = PyDict::new(py);
    let count = curve.points.first().map_or(1, |point| point.response.len());
    for index in 1..count {
        higher.set_item(2 * index + 1, all(&|p: &BackbonePoint| p.response[index]))?;
    }
    dict.set_item("harmonics", higher)?;
    let of_joints = PyDict::new(py);
    for (j, name) in slips.iter().enumerate() {
        of_joints.set_item(name, all(&|p: &BackbonePoint| p.slips[j][0]))?;
    }
    dict.set_item("slips", of_joints)?;
    dict.set_item("remarks", curve.remarks.clone())?;
    Ok(dict)
}
