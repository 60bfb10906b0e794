//! Force histories.

use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};

use crate::exchange::array::{Numbers, array};
use crate::exchange::errors::core;
use crate::exchange::named;
use crate::exchange::pickle::{NewArguments, hash};
use crate::exchange::repr;

/// A force history that owns its samples.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Force {
    /// The force is given by a formula.
    Formula(iwan_core::Pulse<'static>),
    /// The force is given sample by sample.
    Sampled {
        /// Time between samples, s.
        dt: f64,
        /// The samples.
        samples: Vec<f64>,
    },
}

impl Force {
    /// The force in the form that the libraries take.
    pub(crate) fn pulse(&self) -> iwan_core::Pulse<'_> {
        match self {
            Self::Formula(pulse) => *pulse,
            Self::Sampled { dt, samples } => iwan_core::Pulse::Sampled { dt: *dt, samples },
        }
    }

    /// Reads a force: none, a pulse, or an array of samples every `dt` seconds.
    pub(crate) fn read(object: Option<&Bound<'_, PyAny>>, dt: f64) -> PyResult<Self> {
        let Some(object) = object else { return Ok(Self::Formula(iwan_core::Pulse::None)) };
        match object.cast::<Pulse>() {
            Ok(pulse) => Ok(pulse.get().force.clone()),
            Err(_) => Ok(Self::Sampled { dt, samples: Numbers::vector("force", object)? }),
        }
    }
}

/// A force f(t) for t >= 0 s, zero before: the common face of `Haversine`, `HalfSine`, `Step`, `Sine` and `Sampled`.
///
/// Frozen, hashable, picklable. All raise `iwan.InvalidValueError` for a value out of range.
#[pyclass(frozen, subclass, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Pulse {
    pub(crate) force: Force,
    name: &'static str,
    arguments: Vec<(&'static str, f64)>,
}

impl Pulse {
    fn checked(
        name: &'static str,
        arguments: Vec<(&'static str, f64)>,
        force: Force,
    ) -> PyResult<PyClassInitializer<Self>> {
        force.pulse().checked().map_err(core)?;
        Ok(PyClassInitializer::from(Self { force, name, arguments }))
    }
}

#[pymethods]
impl Pulse {
    /// Force at the times `t` (s), float or array.
    ///
    /// >>> iwan.Haversine(amplitude=1000.0, duration=1.6e-3).at([0.0, 0.8e-3, 2e-3])
    /// array([   0., 1000.,    0.])
    fn at<'py>(&self, t: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let pulse = self.force.pulse();
        let force = |t: f64| if t < 0.0 { 0.0 } else { pulse.at(t) };
        Numbers::finite("t", t)?.map(force).into_python(t.py())
    }

    fn __repr__(&self) -> String {
        let mut arguments: Vec<_> = self.arguments.iter().map(|(k, v)| (*k, repr::float(*v))).collect();
        if let Force::Sampled { samples, .. } = &self.force {
            arguments.insert(0, ("samples", repr::floats(samples)));
        }
        repr::call(self.name, &arguments)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().force == self.force)
    }

    fn __hash__(&self) -> u64 {
        let values: Vec<f64> = self.arguments.iter().map(|(_, value)| *value).collect();
        hash(&values)
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        let arguments: Bound<'py, PyDict> = self.arguments.clone().into_py_dict(py)?;
        if let Force::Sampled { samples, .. } = &self.force {
            arguments.set_item("samples", samples.clone())?;
        }
        Ok(((), arguments))
    }
}

/// A/2 (1 - cos(2 pi t/T)) for t < T: the paper's hammer blow. Peak `amplitude` A (force), `duration` T > 0 (s).
///
/// >>> iwan.Haversine(amplitude=10.0, duration=1.6e-3).at(0.8e-3)
/// 10.0
#[pyclass(frozen, extends = Pulse, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Haversine;

#[pymethods]
impl Haversine {
    #[new]
    #[pyo3(signature = (*, amplitude, duration))]
    fn new(
        #[pyo3(from_py_with = named::amplitude)] amplitude: f64,
        #[pyo3(from_py_with = named::duration)] duration: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let force = Force::Formula(iwan_core::Pulse::Haversine { amplitude, duration });
        let arguments = vec![("amplitude", amplitude), ("duration", duration)];
        Ok(Pulse::checked("Haversine", arguments, force)?.add_subclass(Self))
    }
}

/// A sin(pi t/T) for t < T. Peak `amplitude` A (force), `duration` T > 0 (s).
///
/// >>> iwan.HalfSine(amplitude=10.0, duration=1.0).at(0.5)
/// 10.0
#[pyclass(frozen, extends = Pulse, module = "iwan")]
#[derive(Debug)]
pub(crate) struct HalfSine;

#[pymethods]
impl HalfSine {
    #[new]
    #[pyo3(signature = (*, amplitude, duration))]
    fn new(
        #[pyo3(from_py_with = named::amplitude)] amplitude: f64,
        #[pyo3(from_py_with = named::duration)] duration: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let force = Force::Formula(iwan_core::Pulse::HalfSine { amplitude, duration });
        let arguments = vec![("amplitude", amplitude), ("duration", duration)];
        Ok(Pulse::checked("HalfSine", arguments, force)?.add_subclass(Self))
    }
}

/// Force `amplitude` from t = 0 on, up to `duration` (s; infinite by default).
///
/// >>> iwan.Step(amplitude=10.0).at([0.0, 1e9])
/// array([10., 10.])
#[pyclass(frozen, extends = Pulse, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Step;

#[pymethods]
impl Step {
    #[new]
    #[pyo3(signature = (*, amplitude, duration = f64::INFINITY))]
    fn new(
        #[pyo3(from_py_with = named::amplitude)] amplitude: f64,
        #[pyo3(from_py_with = named::duration)] duration: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let force = Force::Formula(iwan_core::Pulse::Step { amplitude, duration });
        let arguments = vec![("amplitude", amplitude), ("duration", duration)];
        Ok(Pulse::checked("Step", arguments, force)?.add_subclass(Self))
    }
}

/// A sin(2 pi f t) for t < T. `amplitude` A (force), `frequency` f > 0 (Hz), `duration` T (s; infinite by default).
///
/// >>> iwan.Sine(amplitude=10.0, frequency=50.0).at(0.005)
/// 10.0
#[pyclass(frozen, extends = Pulse, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Sine;

#[pymethods]
impl Sine {
    #[new]
    #[pyo3(signature = (*, amplitude, frequency, duration = f64::INFINITY))]
    fn new(
        #[pyo3(from_py_with = named::amplitude)] amplitude: f64,
        #[pyo3(from_py_with = named::frequency)] frequency: f64,
        #[pyo3(from_py_with = named::duration)] duration: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let force = Force::Formula(iwan_core::Pulse::Sine { amplitude, frequency, duration });
        let arguments = vec![("amplitude", amplitude), ("frequency", frequency), ("duration", duration)];
        Ok(Pulse::checked("Sine", arguments, force)?.add_subclass(Self))
    }
}

/// A force given by `samples` (one dimension, at least two) every `dt` > 0 seconds from t = 0 on; linear in between, zero
/// behind the last.
///
/// >>> iwan.Sampled(samples=[0.0, 2.0, 0.0], dt=1e-3).at([0.5e-3, 1e-3, 5e-3])
/// array([1., 2., 0.])
#[pyclass(frozen, extends = Pulse, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Sampled;

#[pymethods]
impl Sampled {
    #[new]
    #[pyo3(signature = (*, samples, dt))]
    fn new(
        samples: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = named::dt)] dt: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let force = Force::Sampled { dt, samples: Numbers::vector("samples", samples)? };
        Ok(Pulse::checked("Sampled", vec![("dt", dt)], force)?.add_subclass(Self))
    }

    /// The samples, float64 array.
    #[getter]
    fn samples(slf: PyRef<'_, Self>) -> Py<numpy::PyArray1<f64>> {
        let values = match &slf.as_super().force {
            Force::Sampled { samples, .. } => samples.clone(),
            Force::Formula(_) => Vec::new(),
        };
        array(slf.py(), values)
    }
}
