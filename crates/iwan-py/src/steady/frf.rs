//! Forced responses of modes, for `iwan.frf`.

use iwan_sim::{Control, SimulationError, SteadyCurve, SteadyPoint, Sweep, forced_response, in_parallel};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::exchange::array::{Numbers, array};
use crate::exchange::errors::{simulation, value};
use crate::exchange::options::{choose, thread_count};
use crate::exchange::work;
use crate::values::mode::Mode;

/// Forced responses of several modes at several levels: a list of dicts per mode.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "arguments of Python's own function, which names them")]
pub(crate) fn _frf<'py>(
    py: Python<'py>,
    modes: Vec<Bound<'py, Mode>>,
    control: &str,
    levels: &Bound<'py, PyAny>,
    band: (f64, f64),
    at: Option<&str>,
    harmonics: usize,
    points: usize,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyList>> {
    let controls = [
        Control::Force,
        Control::BaseAcceleration,
        Control::Displacement,
        Control::Velocity,
        Control::Acceleration,
    ];
    let control = choose("control", control, &controls.map(|control| (control.name(), control)))?;
    let levels = Numbers::vector(control.name(), levels)?;
    let sweep = Sweep { from: band.0, to: band.1, control, levels, harmonics, points };
    let mut tasks = Vec::new();
    for mode in modes {
        let mode = mode.get().mode.clone();
        let shape = shape(&mode, at)?;
        tasks.push((mode, shape));
    }
    let threads = thread_count(threads)?;
    let found = work::run(py, true, move |_| {
        in_parallel(&tasks, threads, &|(mode, shape)| forced_response(mode, &sweep, *shape))
    })?;
    let found: Result<Vec<Vec<SteadyCurve>>, SimulationError> = found.into_iter().collect();
    let list = PyList::empty(py);
    for curves in found.map_err(simulation)? {
        let of_mode = PyList::empty(py);
        for curve in curves {
            of_mode.append(told(py, &curve)?)?;
        }
        list.append(of_mode)?;
    }
    Ok(list)
}

/// Shape at the point whose response is held or returned.
fn shape(mode: &iwan_sim::Mode, at: Option<&str>) -> PyResult<f64> {
    let Some(at) = at else { return Ok(1.0) };
    let found = mode.outputs.iter().find(|point| point.name == at).map(|point| point.shape);
    found.ok_or_else(|| {
        value(format!(
            "at: mode \"{}\" has no point \"{at}\"; give it in outputs of the mode, or leave `at` out",
            mode.name
        ))
    })
}

fn told<'py>(py: Python<'py>, curve: &SteadyCurve) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let all = |of: &dyn Fn(&SteadyPoint) -> f64| array(py, curve.points.iter().map(of).collect());
    dict.set_item("control", curve.control.name())?;
    dict.set_item("level", curve.level)?;
    dict.set_item("frequency", all(&|p| p.frequency))?;
    dict.set_item("amplitude", all(&|p| p.amplitude))?;
    dict.set_item("phase", all(&|p| p.phase))?;
    dict.set_item("excitation", all(&|p| p.excitation))?;
    let higher = PyDict::new(py);
    let count = curve.points.first().map_or(0, |point| point.harmonics.len());
    for index in 0..count {
        let part = |which: usize| all(&|p: &SteadyPoint| p.harmonics[index][which]);
        higher.set_item(2 * index + 3, (part(0), part(1)))?;
    }
    dict.set_item("harmonics", higher)?;
    let jumps: Vec<(f64, f64)> = curve.jumps().iter().map(|jump| (jump.frequency, jump.amplitude)).collect();
    dict.set_item("jumps", jumps)?;
    let peak = curve.peak().map(|peak| (peak.frequency, peak.amplitude));
    dict.set_item("peak", peak)?;
    dict.set_item("remarks", curve.remarks.clone())?;
    Ok(dict)
}
