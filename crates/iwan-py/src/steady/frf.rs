//! Forced responses of modes, for `iwan.frf`.

use iwan_sim::{
    Control, JointedModes, SimulationError, SteadyCurve, SteadyPoint, Sweep, forced_response,
    forced_response_of, in_parallel,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::exchange::array::{Numbers, array};
use crate::exchange::errors::{simulation, value};
use crate::exchange::named;
use crate::exchange::options::{choose, thread_count};
use crate::exchange::work;
use crate::values::mode::Mode;

/// A sweep as Python passes it: name of the quantity that is held, its amplitudes, the band, the highest harmonic, the number of points.
pub(crate) type Given<'py> = (String, Bound<'py, PyAny>, [f64; 2], usize, usize);

/// Reads what Python passes.
pub(crate) fn asked<'py>(given: &Bound<'py, PyAny>) -> PyResult<Given<'py>> {
    let [control, levels, band, harmonics, points]: [Bound<'py, PyAny>; 5] = given.extract()?;
    Ok((
        named::control(&control)?,
        levels,
        named::band(&band)?,
        named::harmonics(&harmonics)?,
        named::points(&points)?,
    ))
}

/// The sweep in the form that the library takes.
pub(crate) fn sweep((control, levels, band, harmonics, points): Given<'_>) -> PyResult<Sweep> {
    let controls = [
        Control::Force,
        Control::BaseAcceleration,
        Control::Displacement,
        Control::Velocity,
        Control::Acceleration,
    ];
    let control = choose("control", &control, &controls.map(|control| (control.name(), control)))?;
    let levels = Numbers::vector(control.name(), &levels)?;
    let sweep = Sweep { from: band[0], to: band[1], control, levels, harmonics, points };
    sweep.checked().map_err(simulation)?;
    Ok(sweep)
}

/// One sweep for each level.
pub(crate) fn by_level(sweep: &Sweep) -> Vec<Sweep> {
    sweep.levels.iter().map(|&level| Sweep { levels: vec![level], ..sweep.clone() }).collect()
}

/// The response curves of modes that joints couple; each level is a piece of work of its own.
pub(crate) fn coupled_curves(
    system: &JointedModes,
    sweep: &Sweep,
    threads: usize,
) -> Result<Vec<SteadyCurve>, SimulationError> {
    let found: Result<Vec<Vec<SteadyCurve>>, SimulationError> =
        in_parallel(&by_level(sweep), threads, &|level| forced_response_of(system, level))
            .into_iter()
            .collect();
    Ok(found?.concat())
}

/// Forced responses of several modes at several levels: a list of dicts per mode. One level of one mode is a piece of work.
#[pyfunction]
pub(crate) fn _frf<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = named::modes)] modes: Vec<Bound<'py, Mode>>,
    #[pyo3(from_py_with = asked)] asked: Given<'py>,
    #[pyo3(from_py_with = named::at)] at: Option<&str>,
    #[pyo3(from_py_with = named::threads)] threads: Option<usize>,
) -> PyResult<Bound<'py, PyList>> {
    let sweep = sweep(asked)?;
    let levels = sweep.levels.len();
    let mut tasks = Vec::new();
    for mode in modes {
        let mode = mode.get().mode.clone();
        let shape = shape(&mode, at)?;
        tasks.extend(by_level(&sweep).into_iter().map(|level| (mode.clone(), level, shape)));
    }
    let threads = thread_count(threads)?;
    let found = work::run(py, true, move |_| {
        in_parallel(&tasks, threads, &|(mode, level, shape)| forced_response(mode, level, *shape))
    })?;
    let found: Result<Vec<Vec<SteadyCurve>>, SimulationError> = found.into_iter().collect();
    let found = found.map_err(simulation)?.concat();
    let list = PyList::empty(py);
    for curves in found.chunks(levels) {
        list.append(told(py, curves)?)?;
    }
    Ok(list)
}

/// The mode's shape at the point whose response is held or returned.
pub(crate) fn shape(mode: &iwan_sim::Mode, at: Option<&str>) -> PyResult<f64> {
    let Some(at) = at else { return Ok(1.0) };
    let found = mode.outputs.iter().find(|point| point.name == at).map(|point| point.shape);
    found.ok_or_else(|| {
        value(format!(
            "at: mode \"{}\" has no point \"{at}\"; give it in outputs of the mode, or leave `at` out",
            mode.name
        ))
    })
}

/// The curves as a list of dicts, one per curve.
pub(crate) fn told<'py>(py: Python<'py>, curves: &[SteadyCurve]) -> PyResult<Bound<'py, PyList>> {
    let list = PyList::empty(py);
    for curve in curves {
        list.append(told_curve(py, curve)?)?;
    }
    Ok(list)
}

fn told_curve<'py>(py: Python<'py>, curve: &SteadyCurve) -> PyResult<Bound<'py, PyDict>> {
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
    let found = curve.superharmonics();
    let found: Vec<(usize, f64, f64)> =
        found.iter().map(|s| (s.harmonic, s.frequency, s.amplitude)).collect();
    dict.set_item("superharmonics", found)?;
    let peak = curve.peak().map(|peak| (peak.frequency, peak.amplitude));
    dict.set_item("peak", peak)?;
    dict.set_item("remarks", curve.remarks.clone())?;
    Ok(dict)
}
