//! From modes and a force to responses.

use iwan_sim::{Method, Settings};
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exchange::array::{Numbers, array};
use crate::exchange::errors::{core, simulation, value, warn, wrong_type};
use crate::exchange::named;
use crate::exchange::options::{MethodOptions, method as method_named, representation_of, thread_count};
use crate::exchange::work;
use crate::ring_down::response::Response;
use crate::values::mode::Mode;
use crate::values::pulse::Force;

/// Number of steps above which a run gets a thread of its own, so that Ctrl-C can stop it: a million steps take some 4 ms, a few times that
/// with their error estimates. Shorter runs would spend more time on the thread than on the steps.
pub(crate) const LASTING: usize = 1_000_000;

/// Simulates the response of a mode, or of each of several modes, to a force.
///
/// `mode`: a `Mode`, or a sequence of them; `force`: a pulse such as `Haversine`, samples every `dt` seconds (zero behind
/// the last), or None for free decay; `dt`: time between samples (s), also the time step; `duration` (s).
///
/// `method`: "newmark" (time stepping), "half-cycle" (energy map of the free decay, no time steps), "averaging"
/// (approximate) or "event" (reference, slow). `sliders`: number of Jenkins elements, None for the exact continuum;
/// `grid`: as in `Joint.force_history`. `prewarp`: no period error at small amplitude; False is the plain Newmark-beta
/// scheme with `beta` and `gamma`. `initial`: modal displacement and velocity at t = 0 s, one pair for all modes or one for
/// each. `quality`: estimate time-step and discretisation error by companion runs. `threads`: for several modes, all cores by
/// default; the results do not depend on it.
///
/// A mode with parts, or by curves, runs by "newmark" and "averaging". A mode whose amplitude falls below its curves is warned
/// of with the time (`UserWarning`, and `below_curves_from` in `statistics`).
///
/// Returns a `Response`, or a list of them. Raises `iwan.InvalidValueError` for a value out of range,
/// `iwan.ComputationError` when the numbers overflow. The interpreter's lock is released; Ctrl-C is honoured.
///
/// >>> joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
/// >>> mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=2.5e-4)
/// >>> blow = iwan.Haversine(amplitude=1000.0, duration=1.6e-3)
/// >>> response = iwan.simulate(mode, force=blow, dt=1e-5, duration=0.2)
/// >>> response.displacement.shape, f"{response.statistics['slip_ratio']:.4f}", response.energy_error < 1e-10
/// ((20001,), '0.1074', True)
#[pyfunction]
#[pyo3(signature = (
    mode, *, force = None, dt, duration, method = "newmark", sliders = Some(100), grid = None, prewarp = true,
    beta = 0.25, gamma = 0.5, initial = None, quality = true, threads = None
))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn simulate<'py>(
    mode: &Bound<'py, PyAny>,
    force: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::dt)] dt: f64,
    #[pyo3(from_py_with = named::duration)] duration: f64,
    #[pyo3(from_py_with = named::method)] method: &str,
    #[pyo3(from_py_with = named::sliders)] sliders: Option<usize>,
    grid: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::prewarp)] prewarp: bool,
    #[pyo3(from_py_with = named::beta)] beta: f64,
    #[pyo3(from_py_with = named::gamma)] gamma: f64,
    initial: Option<&Bound<'py, PyAny>>,
    #[pyo3(from_py_with = named::quality)] quality: bool,
    #[pyo3(from_py_with = named::threads)] threads: Option<usize>,
) -> PyResult<Bound<'py, PyAny>> {
    let py = mode.py();
    let (mut modes, single) = modes(mode)?;
    set_initial(&mut modes, initial)?;
    let options = MethodOptions {
        joint: representation_of(sliders, grid, iwan_core::Grid::graded)?,
        prewarp,
        beta,
        gamma,
    };
    let settings = Settings { dt, duration, method: method_named(method, options)?, quality };
    let force = Force::read(force, dt)?;
    let steps = settings.samples().map_err(core)?.saturating_mul(modes.len());
    let lasting = steps > LASTING || !matches!(settings.method, Method::Newmark { .. });
    // Finding the number of cores takes longer than a short run, and one mode needs one thread only.
    let threads = if single {
        threads.map_or(Ok(1), |threads| thread_count(Some(threads)))?
    } else {
        thread_count(threads)?
    };
    let mut responses = work::run(py, lasting, move |control| {
        if let [mode] = &modes[..]
            && single
            && !lasting
        {
            return iwan_sim::simulate(mode, &force.pulse(), &settings).map(|response| vec![response]);
        }
        iwan_sim::simulate_all(&modes, &force.pulse(), &settings, threads, &|_| control.stop())
            .map_err(|error| if single { without_name(error) } else { error })
    })?
    .map_err(simulation)?;
    for response in &responses {
        warn_of_curves(py, response)?;
    }
    if single && let Some(response) = responses.pop() {
        return Ok(Bound::new(py, Response::new(py, response))?.into_any());
    }
    let responses: PyResult<Vec<_>> =
        responses.into_iter().map(|response| Py::new(py, Response::new(py, response))).collect();
    responses?.into_bound_py_any(py)
}

/// Warns where the amplitude of a mode leaves the range of its curves.
fn warn_of_curves(py: Python<'_>, response: &iwan_sim::Response) -> PyResult<()> {
    let outside = response.quality.outside_curves;
    let below = outside.below_from.map(|t| {
        format!("from t = {t} s on the amplitude is below the smallest of the curves: frequency and damping are held")
    });
    let above = outside.above_from.map(|t| {
        format!("from t = {t} s on the amplitude exceeds the largest of the curves: frequency and damping are held")
    });
    for message in below.into_iter().chain(above) {
        warn(py, &message)?;
    }
    Ok(())
}

/// The error without the name of its mode, which is not needed where there is only one mode.
fn without_name(error: iwan_sim::SimulationError) -> iwan_sim::SimulationError {
    match error {
        iwan_sim::SimulationError::Mode { source, .. } => *source,
        other => other,
    }
}

/// The modes given, and whether the object was a single mode.
fn modes(object: &Bound<'_, PyAny>) -> PyResult<(Vec<iwan_sim::Mode>, bool)> {
    if let Ok(mode) = object.cast::<Mode>() {
        return Ok((vec![mode.get().mode.clone()], true));
    }
    let wrong = || wrong_type("mode must be an iwan.Mode or a sequence of them");
    let mut modes = Vec::new();
    for item in object.try_iter().map_err(|_| wrong())? {
        modes.push(item?.cast::<Mode>().map_err(|_| wrong())?.get().mode.clone());
    }
    if modes.is_empty() {
        Err(value("mode is an empty sequence: give at least one mode"))
    } else {
        Ok((modes, false))
    }
}

/// Sets displacement and velocity at t = 0: one pair for all, or one for each.
pub(crate) fn set_initial(modes: &mut [iwan_sim::Mode], initial: Option<&Bound<'_, PyAny>>) -> PyResult<()> {
    let Some(initial) = initial else { return Ok(()) };
    let numbers = Numbers::finite("initial", initial)?;
    let each = numbers.shape == [modes.len(), 2];
    if !each && numbers.shape != [2] {
        let n = modes.len();
        return Err(value(format!(
            "initial has the shape {:?}: give (displacement, velocity), or {n} such pairs for {n} modes",
            numbers.shape
        )));
    }
    for (mode, pair) in modes.iter_mut().zip(numbers.values.chunks(2).cycle()) {
        mode.initial = iwan_core::Motion { displacement: pair[0], velocity: pair[1] };
    }
    Ok(())
}

/// Physical responses at the points named in the modes' `outputs`: the sum of shape times modal response.
///
/// `modes` and `responses` are sequences of equal length. Returns a dict from each point's name to a dict of float64
/// arrays `displacement`, `velocity` and `acceleration`. Raises `iwan.InvalidValueError` for sequences or responses of
/// different lengths.
///
/// >>> modes = [iwan.Mode(frequency=f, outputs={"tip": 2.0}) for f in (10.0, 20.0)]
/// >>> responses = iwan.simulate(modes, dt=1e-3, duration=0.1, initial=(0.5, 0.0))
/// >>> float(iwan.superpose(modes, responses)["tip"]["displacement"][0])
/// 2.0
#[pyfunction]
pub(crate) fn superpose<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = named::modes)] modes: Vec<Bound<'py, Mode>>,
    #[pyo3(from_py_with = named::responses)] responses: Vec<Bound<'py, Response>>,
) -> PyResult<Bound<'py, PyDict>> {
    if modes.len() != responses.len() {
        let (m, r) = (modes.len(), responses.len());
        return Err(value(format!("{m} modes and {r} responses: give one response for each mode")));
    }
    let modes: Vec<_> = modes.iter().map(|mode| mode.get().mode.clone()).collect();
    let responses: Vec<_> = responses.iter().map(|response| response.get().motion(py)).collect();
    if let Some(other) = responses.iter().find(|r| r.displacement.len() != responses[0].displacement.len()) {
        let (one, two) = (responses[0].displacement.len(), other.displacement.len());
        return Err(value(format!(
            "responses of {one} and of {two} samples cannot be superposed: simulate them alike"
        )));
    }
    let points = PyDict::new(py);
    for (name, samples) in iwan_sim::superpose(&modes, &responses) {
        let point = PyDict::new(py);
        for (key, values) in ["displacement", "velocity", "acceleration"].into_iter().zip(samples) {
            point.set_item(key, array(py, values))?;
        }
        points.set_item(name, point)?;
    }
    Ok(points)
}
