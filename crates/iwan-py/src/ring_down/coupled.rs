//! Modes that share joints, for `iwan.CoupledModes`.

use iwan_sim::{JointHistory, Settings, SharedJoint, simulate_coupled};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::exchange::array::array;
use crate::exchange::errors::{core, simulation};
use crate::exchange::named;
use crate::exchange::options::{MethodOptions, method, representation_of, thread_count};
use crate::exchange::work;
use crate::ring_down::response::{Response, balance};
use crate::ring_down::simulate::{LASTING, set_initial};
use crate::values::joint_face::Joint;
use crate::values::mode::Mode;
use crate::values::pulse::Force;

/// A joint as Python passes it: name, law, participation in each mode, compliance to each joint, slip at the load.
pub(crate) type GivenJoint<'py> = (String, Bound<'py, Joint>, Vec<f64>, Vec<f64>, f64);

/// Reads the joints that modes share.
pub(crate) fn given_joints<'py>(given: &Bound<'py, PyAny>) -> PyResult<Vec<GivenJoint<'py>>> {
    let one = |given: Bound<'py, PyAny>| {
        let [name, joint, participation, compliance, slip]: [Bound<'py, PyAny>; 5] = given.extract()?;
        Ok((
            named::name(&name)?,
            named::joint(&joint)?,
            named::participation(&participation)?,
            named::compliance(&compliance)?,
            named::slip_at_force(&slip)?,
        ))
    };
    given.try_iter()?.map(|given| one(given?)).collect()
}

/// The joints in the form that the simulation takes.
pub(crate) fn shared(joints: Vec<GivenJoint<'_>>) -> Vec<SharedJoint> {
    let shared = |(name, joint, participation, compliance, slip_at_force): GivenJoint<'_>| {
        let law = joint.get().law.clone();
        SharedJoint { name, law, participation, compliance, slip_at_force }
    };
    joints.into_iter().map(shared).collect()
}

/// Responses of the modes, histories of the joints, and the energy of all.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn _simulate_coupled<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = named::modes)] modes: Vec<Bound<'py, Mode>>,
    #[pyo3(from_py_with = given_joints)] joints: Vec<GivenJoint<'py>>,
    force: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::dt)] dt: f64,
    #[pyo3(from_py_with = named::duration)] duration: f64,
    #[pyo3(from_py_with = named::sliders)] sliders: Option<usize>,
    grid: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::prewarp)] prewarp: bool,
    initial: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::quality)] quality: bool,
    #[pyo3(from_py_with = named::threads)] threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let mut modes: Vec<iwan_sim::Mode> = modes.iter().map(|mode| mode.get().mode.clone()).collect();
    set_initial(&mut modes, initial)?;
    let joints = shared(joints);
    let joint = representation_of(sliders, grid, iwan_core::Grid::graded)?;
    let options = MethodOptions { joint, prewarp, beta: 0.25, gamma: 0.5 };
    let settings = Settings { dt, duration, method: method("newmark", options)?, quality };
    let force = Force::read(force, dt)?;
    let threads = thread_count(threads)?;
    let lasting = settings.samples().map_err(core)?.saturating_mul(modes.len()) > LASTING;
    let response = work::run(py, lasting, move |control| {
        simulate_coupled(&modes, &joints, &force.pulse(), &settings, threads, &|_| control.stop())
    })?
    .map_err(simulation)?;
    let dict = PyDict::new(py);
    let of_modes = PyList::empty(py);
    for mode in response.modes {
        of_modes.append(Py::new(py, Response::new(py, mode))?)?;
    }
    let of_joints = PyList::empty(py);
    for joint in response.joints {
        of_joints.append(told(py, joint)?)?;
    }
    dict.set_item("modes", of_modes)?;
    dict.set_item("joints", of_joints)?;
    dict.set_item("energy", balance(py, &response.energy)?)?;
    dict.set_item("energy_error", response.energy.error())?;
    Ok(dict)
}

fn told(py: Python<'_>, joint: JointHistory) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("slip_ratio", joint.slip_ratio())?;
    dict.set_item("friction", joint.friction)?;
    dict.set_item("forgotten_force", joint.forgotten_force)?;
    dict.set_item("name", joint.name)?;
    dict.set_item("slip", array(py, joint.slip))?;
    dict.set_item("force", array(py, joint.force))?;
    Ok(dict)
}
