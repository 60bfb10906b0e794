//! Transients of a structure with its discrete joints: `Structure.simulate`.

use std::ops::ControlFlow;

use iwan_core::{Grid, Representation};
use iwan_fem::{Extras, ModalVelocity, Model, NamedModes, Run, StructureResponse};
use iwan_input::{RunError, StructureTask};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exchange::array::array;
use crate::exchange::errors::{fem, input, value};
use crate::exchange::named::{self, ByName};
use crate::exchange::options::{representation_of, unknown};
use crate::exchange::work::{self, Control};
use crate::ring_down::response::balance;
use crate::structures::structure::{Loaded, Structure};
use crate::values::pulse::Force;

/// The count that progress reaches at the end of a run: thousandths are finer than any progress bar shows.
const PARTS: f64 = 1000.0;

/// The transient to be computed.
struct Request {
    force: Option<Force>,
    velocity: Vec<ModalVelocity>,
    dt: f64,
    duration: f64,
    modes: Vec<String>,
    model: Model,
    representation: Representation,
    quality: bool,
}

/// The response to a force, as a dict.
#[pyfunction]
#[pyo3(signature = (
    structure, *, force, velocity, dt, duration, modes, model, basis, tolerance, sliders, grid, quality, progress
))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn _simulate_structure<'py>(
    structure: &Bound<'py, Structure>,
    force: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::velocity)] velocity: ByName<f64>,
    #[pyo3(from_py_with = named::dt)] dt: f64,
    #[pyo3(from_py_with = named::duration)] duration: f64,
    #[pyo3(from_py_with = named::modes)] modes: Vec<String>,
    #[pyo3(from_py_with = named::model)] model: &str,
    #[pyo3(from_py_with = named::basis)] basis: Option<usize>,
    #[pyo3(from_py_with = named::tolerance)] tolerance: Option<f64>,
    #[pyo3(from_py_with = named::sliders)] sliders: Option<usize>,
    grid: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::quality)] quality: bool,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let request = Request {
        force: force.map(|force| Force::read(Some(force), dt)).transpose()?,
        velocity: velocity.0.into_iter().map(|(mode, velocity)| ModalVelocity { mode, velocity }).collect(),
        dt: positive("dt", dt)?,
        duration: positive("duration", duration)?,
        modes,
        model: model_of(model, basis, tolerance)?,
        representation: representation_of(sliders, grid, |_| Grid::IN_STRUCTURES)?,
        quality,
    };
    if request.force.is_none() && request.velocity.is_empty() {
        return Err(value("nothing moves the structure: give force=, or velocity= of some modes"));
    }
    let (py, this) = (structure.py(), structure.get().0.clone());
    let loaded = this.clone();
    let done = work::watched(py, progress, move |control| run(&loaded, &request, control))?;
    told(
        py,
        done.map_err(|failure| match failure {
            RunError::Analysis(error) => fem(this.name(), &error),
            RunError::Input(error) => input(this.name(), &error),
        })?,
    )
}

fn positive(name: &str, x: f64) -> PyResult<f64> {
    if x > 0.0 && x.is_finite() {
        return Ok(x);
    }
    Err(value(format!("{name} = {x} is out of range: must be a finite number of seconds > 0")))
}

/// The model with this name, and with the basis or tolerance that belongs to it.
fn model_of(name: &str, basis: Option<usize>, tolerance: Option<f64>) -> PyResult<Model> {
    match (name, basis, tolerance) {
        ("full", None, None) => Ok(Model::Full),
        ("full", ..) => Err(value(
            "basis and tolerance do not apply to model = 'full': leave them out, or choose 'reduced'",
        )),
        ("reduced", Some(_), Some(_)) => Err(value(
            "basis and tolerance exclude each other: fix the number of modes, or the error they may cause",
        )),
        ("reduced", Some(0), _) => Err(value("basis = 0 is out of range: at least 1 mode")),
        ("reduced", Some(modes), None) => Ok(Model::Basis(modes)),
        ("reduced", None, tolerance) => Ok(tolerance.map_or(Model::USUAL, Model::Tolerance)),
        _ => Err(unknown("model", name, &["reduced", "full"])),
    }
}

fn run(loaded: &Loaded, request: &Request, control: &Control) -> Result<Run, RunError> {
    let named = loaded.named_modes(NamedModes::LOOKED_UP, control)?;
    let kept = loaded.file.structure.kept.is_some();
    let model = if kept && request.model == Model::USUAL { Model::Kept } else { request.model };
    let task = StructureTask {
        force: request.force.as_ref().map(Force::pulse),
        velocity: &request.velocity,
        dt: request.dt,
        duration: request.duration,
        representation: request.representation,
        model,
        modes: &request.modes,
        extras: Extras { errors: request.quality, frames: 0 },
    };
    let progress = |share: f64| -> ControlFlow<()> { control.report((share * PARTS) as usize) };
    let run = loaded.file.run(&named, &task, &progress)?;
    let _ = control.report(PARTS as usize);
    Ok(run)
}

fn told(py: Python<'_>, run: Run) -> PyResult<Bound<'_, PyDict>> {
    let Run { modes, response, basis, basis_error, errors, joint_forces, .. } = run;
    let dict = PyDict::new(py);
    dict.set_item("dt", response.dt)?;
    dict.set_item("modes", modes.iter().map(|mode| &mode.name).collect::<Vec<_>>())?;
    let names: Vec<&str> = response.outputs.iter().map(|history| history.name.as_str()).collect();
    dict.set_item("outputs", &names[modes.len()..])?;
    dict.set_item("basis", basis)?;
    dict.set_item("basis_error", basis_error.map(|error| error.estimate))?;
    dict.set_item("converged", basis_error.map(|error| error.converged))?;
    let each = |values: &[f64]| -> PyResult<Bound<'_, PyDict>> {
        let dict = PyDict::new(py);
        names.iter().zip(values).try_for_each(|(name, value)| dict.set_item(name, value))?;
        Ok(dict)
    };
    let errors = errors.as_ref();
    dict.set_item("time_step_error", errors.map(|errors| each(&errors.time_step)).transpose()?)?;
    let sliders = errors.and_then(|errors| errors.sliders.as_ref());
    dict.set_item("discretisation_error", sliders.map(|sliders| each(sliders)).transpose()?)?;
    let forces = PyDict::new(py);
    for (mode, force) in modes.iter().zip(joint_forces) {
        forces.set_item(&mode.name, array(py, force))?;
    }
    dict.set_item("joint_force", forces)?;
    histories(&dict, response)?;
    Ok(dict)
}

/// Puts all results of the integration itself into a dict.
fn histories(dict: &Bound<'_, PyDict>, response: StructureResponse) -> PyResult<()> {
    let py = dict.py();
    dict.set_item("energy", balance(py, &response.energy)?)?;
    dict.set_item("energy_error", response.energy.error())?;
    dict.set_item("forgotten_force", response.forgotten_force)?;
    dict.set_item("seconds", response.seconds)?;
    let parts = ["displacement", "velocity", "acceleration"].map(|key| (key, PyDict::new(py)));
    for history in response.outputs {
        let values = [history.displacement, history.velocity, history.acceleration];
        for ((_, part), values) in parts.iter().zip(values) {
            part.set_item(&history.name, array(py, values))?;
        }
    }
    for (key, part) in parts {
        dict.set_item(key, part)?;
    }
    let [slip, force, ratio] = std::array::from_fn(|_| PyDict::new(py));
    for history in response.slips {
        ratio.set_item(&history.name, history.slip_ratio)?;
        slip.set_item(&history.name, array(py, history.slip))?;
        force.set_item(&history.name, array(py, history.force))?;
    }
    dict.set_item("slip", slip)?;
    dict.set_item("slip_force", force)?;
    dict.set_item("slip_ratio", ratio)
}
