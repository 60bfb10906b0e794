//! Steady vibration of modes that share joints, for `CoupledModes.frf` and `CoupledModes.backbone`.

use iwan_sim::{Control, JointedModes, StuckRange, nonlinear_mode};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use super::{backbone, frf};
use crate::exchange::array::Numbers;
use crate::exchange::errors::{simulation, value};
use crate::exchange::named;
use crate::exchange::options::thread_count;
use crate::exchange::work;
use crate::ring_down::coupled::{GivenJoint, given_joints, shared};
use crate::values::mode::Mode;

/// Forced responses of coupled modes: a list of dicts. `at` is a point among the modes' outputs, or a mode.
#[pyfunction]
pub(crate) fn _frf_coupled<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = named::modes)] modes: Vec<Bound<'py, Mode>>,
    #[pyo3(from_py_with = given_joints)] joints: Vec<GivenJoint<'py>>,
    #[pyo3(from_py_with = frf::asked)] asked: frf::Given<'py>,
    #[pyo3(from_py_with = named::at)] at: Option<&str>,
    #[pyo3(from_py_with = named::threads)] threads: Option<usize>,
) -> PyResult<Bound<'py, PyList>> {
    let (modes, joints) = (owned(modes), shared(joints));
    let sweep = frf::sweep(asked)?;
    let at_output = if let Some(at) = at {
        observed(&modes, at)?
    } else {
        let ranges = StuckRange::of_coupled(&modes, &joints).map_err(simulation)?;
        let within = ranges.iter().position(|r| r.slipping <= sweep.to && r.stuck >= sweep.from);
        let missing = || {
            value(format!(
                "band: no mode has its resonance between {} and {} Hz: choose the band around a mode's frequency, or say with \
                 `at` whose response is meant",
                sweep.from, sweep.to
            ))
        };
        unit(&modes, within.ok_or_else(missing)?)
    };
    let mut system = JointedModes::of_coupled(&modes, &joints, &at_output).map_err(simulation)?;
    if sweep.control == Control::BaseAcceleration {
        system = system.on_moving_base();
    }
    let threads = thread_count(threads)?;
    let found = work::run(py, true, move |_| frf::coupled_curves(&system, &sweep, threads))?;
    frf::told(py, &found.map_err(simulation)?)
}

/// The nonlinear mode that grows out of one of the modes, as a dict.
#[pyfunction]
pub(crate) fn _backbone_coupled<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = named::modes)] modes: Vec<Bound<'py, Mode>>,
    #[pyo3(from_py_with = given_joints)] joints: Vec<GivenJoint<'py>>,
    #[pyo3(from_py_with = named::mode)] mode: usize,
    amplitude: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = named::harmonics)] harmonics: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let (modes, joints) = (owned(modes), shared(joints));
    let amplitudes = Numbers::vector("amplitude", amplitude)?;
    let system = JointedModes::of_coupled(&modes, &joints, &unit(&modes, mode)).map_err(simulation)?;
    let names: Vec<String> = system.joints().iter().map(|joint| joint.name.clone()).collect();
    let found = work::run(py, true, move |_| nonlinear_mode(&system, mode, harmonics, &amplitudes))?;
    backbone::told(py, &found.map_err(simulation)?, &names)
}

fn owned(modes: Vec<Bound<'_, Mode>>) -> Vec<iwan_sim::Mode> {
    modes.into_iter().map(|mode| mode.get().mode.clone()).collect()
}

/// Coefficients, one per mode, by which the modal displacements give that of mode `mode`.
fn unit(modes: &[iwan_sim::Mode], mode: usize) -> Vec<f64> {
    (0..modes.len()).map(|i| f64::from(u8::from(i == mode))).collect()
}

/// Coefficients, one per mode, of an observed motion: the shapes at a point, or the modal displacement of the mode with the name `at`.
fn observed(modes: &[iwan_sim::Mode], at: &str) -> PyResult<Vec<f64>> {
    match modes.iter().position(|mode| mode.name == at) {
        Some(mode) => Ok(unit(modes, mode)),
        None => modes.iter().map(|mode| frf::shape(mode, Some(at))).collect(),
    }
}
