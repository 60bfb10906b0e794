//! Steady vibration of a structure: `Structure.frf` and `Structure.backbone`.

use iwan_fem::{Model, NamedModes};
use iwan_input::{Drive, RunError, SteadyStructure, SteadyTask};
use iwan_sim::{Control, NonlinearMode, SimulationError, nonlinear_mode};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::exchange::array::Numbers;
use crate::exchange::errors::{fem, input, simulation, value};
use crate::exchange::named;
use crate::exchange::options::thread_count;
use crate::exchange::work::{self, Control as Watch};
use crate::steady::{backbone, frf};
use crate::structures::structure::{Loaded, Structure};

/// Default range of amplitudes, relative to the amplitude of first macro-slip: from amplitudes at which joints hardly slip to those at
/// which they slip entirely.
const RANGE: [f64; 2] = [1e-3, 10.0];

/// Why there is no result.
enum Refused {
    Run(RunError),
    Simulation(SimulationError),
    Value(String),
}

impl Refused {
    fn told(self, name: &str) -> PyErr {
        match self {
            Self::Run(RunError::Analysis(error)) => fem(name, &error),
            Self::Run(RunError::Input(error)) => input(name, &error),
            Self::Simulation(error) => simulation(error),
            Self::Value(message) => value(message),
        }
    }
}

impl From<RunError> for Refused {
    fn from(error: RunError) -> Self {
        Self::Run(error)
    }
}

impl From<iwan_fem::Error> for Refused {
    fn from(error: iwan_fem::Error) -> Self {
        Self::Run(error.into())
    }
}

impl From<SimulationError> for Refused {
    fn from(error: SimulationError) -> Self {
        Self::Simulation(error)
    }
}

/// What Python passes about the model: the observed output, the viscous damping ratio of all modes, the number of modes.
type Given = (Option<String>, f64, Option<usize>);

/// Reads it.
fn model(given: &Bound<'_, PyAny>) -> PyResult<Given> {
    let [at, damping_ratio, basis]: [Bound<'_, PyAny>; 3] = given.extract()?;
    Ok((named::at(&at)?, named::damping_ratio(&damping_ratio)?, named::basis(&basis)?))
}

fn prepared(
    loaded: &Loaded,
    modes: &NamedModes,
    drive: Drive,
    (at, damping_ratio, basis): &Given,
    control: &Watch,
) -> Result<SteadyStructure, Refused> {
    let model = basis.map_or(Model::USUAL, Model::Basis);
    let task = SteadyTask { drive, at: at.as_deref(), damping_ratio: *damping_ratio, model };
    Ok(loaded.file.steady(modes, &task, &|_: f64| control.stop())?)
}

/// Forced responses of a structure: a list of dicts, and what the response is, in words.
#[pyfunction]
pub(crate) fn _frf_structure<'py>(
    structure: &Bound<'py, Structure>,
    #[pyo3(from_py_with = frf::asked)] asked: frf::Given<'py>,
    #[pyo3(from_py_with = named::direction)] direction: Option<[f64; 3]>,
    #[pyo3(from_py_with = model)] given: Given,
    #[pyo3(from_py_with = named::threads)] threads: Option<usize>,
) -> PyResult<(Bound<'py, PyList>, String)> {
    let (py, this) = (structure.py(), structure.get().0.clone());
    let sweep = frf::sweep(asked)?;
    let drive = drive(sweep.control, direction)?;
    checked(&given)?;
    let threads = thread_count(threads)?;
    let loaded = this.clone();
    let found = work::run(py, true, move |control| -> Result<_, Refused> {
        let modes = loaded.named_modes(NamedModes::LOOKED_UP, control)?;
        let steady = prepared(&loaded, &modes, drive, &given, control)?;
        Ok((frf::coupled_curves(&steady.modes, &sweep, threads)?, steady.output))
    })?;
    let (curves, output) = found.map_err(|refused| refused.told(this.name()))?;
    Ok((frf::told(py, &curves)?, output))
}

/// The nonlinear mode that grows out of a mode of the structure, as a dict.
#[pyfunction]
pub(crate) fn _backbone_structure<'py>(
    structure: &Bound<'py, Structure>,
    #[pyo3(from_py_with = named::mode)] mode: String,
    amplitude: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::points)] points: usize,
    #[pyo3(from_py_with = named::harmonics)] harmonics: usize,
    #[pyo3(from_py_with = model)] given: Given,
) -> PyResult<Bound<'py, PyDict>> {
    let (py, this) = (structure.py(), structure.get().0.clone());
    let amplitudes = amplitude.map(|given| Numbers::vector("amplitude", given)).transpose()?;
    if points < 2 {
        return Err(value(format!("points = {points} is out of range: at least 2")));
    }
    checked(&given)?;
    let loaded = this.clone();
    let found = work::run(py, true, move |control| -> Result<(NonlinearMode, Vec<String>), Refused> {
        let modes = loaded.named_modes(NamedModes::LOOKED_UP, control)?;
        let number = modes.named(&mode)?.pair.stuck;
        let steady = prepared(&loaded, &modes, Drive::Nothing, &given, control)?;
        let amplitudes = if let Some(given) = amplitudes {
            given
        } else {
            let onset = steady.modes.macro_slip(number).ok_or_else(|| {
                Refused::Value(format!(
                    "mode: no joint slips in \"{mode}\": its frequency does not change; give amplitude"
                ))
            })?;
            let [from, to] = RANGE.map(|factor| factor * onset);
            (0..points).map(|i| from * (to / from).powf(i as f64 / (points - 1) as f64)).collect()
        };
        let names = steady.modes.joints().iter().map(|joint| joint.name.clone()).collect();
        Ok((nonlinear_mode(&steady.modes, number, harmonics, &amplitudes)?, names))
    })?;
    let (curve, names) = found.map_err(|refused| refused.told(this.name()))?;
    backbone::told(py, &curve, &names)
}

fn drive(control: Control, direction: Option<[f64; 3]>) -> PyResult<Drive> {
    let length = direction.map(|d| d.iter().map(|x| x * x).sum::<f64>().sqrt());
    match (control, direction, length) {
        (Control::BaseAcceleration, Some(d), Some(length)) if length > 0.0 && length.is_finite() => {
            Ok(Drive::Base(d.map(|x| x / length)))
        }
        (Control::BaseAcceleration, ..) => Err(value(
            "direction: base_acceleration of a structure needs the direction (x, y, z) of its base's motion",
        )),
        (_, None, _) => Ok(Drive::Loads),
        _ => Err(value("direction is that of base_acceleration: leave it out")),
    }
}

fn checked((_, damping_ratio, basis): &Given) -> PyResult<()> {
    if !(0.0..1.0).contains(damping_ratio) {
        return Err(value(format!(
            "damping_ratio = {damping_ratio} is out of range: must satisfy 0 <= damping_ratio < 1"
        )));
    }
    if *basis == Some(0) {
        return Err(value("basis = 0 is out of range: at least 1 mode"));
    }
    Ok(())
}
