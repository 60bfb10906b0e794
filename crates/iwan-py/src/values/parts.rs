//! Parts of a mode's law that act beside its joint.

use iwan_core::Part as CorePart;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};

use crate::exchange::array::Numbers;
use crate::exchange::errors::{core, value};
use crate::exchange::named::{self, Instance};
use crate::exchange::pickle::{NewArguments, hash};
use crate::exchange::repr;

/// A part of a mode's law beside its joint: the common face of `PowerDamping`, `Coulomb`, `Spring` and `Pinning`.
///
/// Forces act on the mass-normalised mode, against a positive displacement and velocity. Frozen, hashable, picklable.
/// Example: that of `Spring`.
#[pyclass(frozen, subclass, module = "iwan")]
#[derive(Debug, Clone)]
pub(crate) struct Part {
    pub(crate) part: CorePart,
}

impl Instance for Part {}

impl Part {
    /// Name of the Python class, and the arguments from which it makes this part.
    fn call(&self) -> (&'static str, Vec<(&'static str, f64)>) {
        match &self.part {
            CorePart::PowerDamping(part) => ("PowerDamping", vec![("c", part.c()), ("n", part.n())]),
            CorePart::Coulomb(part) => ("Coulomb", vec![("force", part.size())]),
            CorePart::Spring(part) => ("Spring", vec![("k", part.k()), ("exponent", part.exponent())]),
            CorePart::Pinning(part) => ("Pinning", vec![("k", part.k()), ("gap", part.gap())]),
        }
    }

    /// A property of the part at each amplitude, at a frequency in Hz.
    fn each<'py>(
        &self,
        a: &Bound<'py, PyAny>,
        frequency: f64,
        property: impl Fn(&CorePart, f64, f64) -> f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        if !(frequency > 0.0 && frequency.is_finite()) {
            let message =
                format!("frequency = {frequency} is out of range: must be a finite number of hertz > 0");
            return Err(value(message));
        }
        let omega = 2.0 * std::f64::consts::PI * frequency;
        Numbers::finite("a", a)?.map(|a| property(&self.part, a, omega)).into_python(a.py())
    }
}

#[pymethods]
impl Part {
    /// First-harmonic stiffness (1/s^2) in a motion of amplitude `a` (mass^1/2 length; float or array) at `frequency` (Hz):
    /// the force in phase with the displacement, over the amplitude. 0 for a damper.
    ///
    /// >>> round(iwan.Spring(k=200.0, exponent=3).harmonic_stiffness(0.1, frequency=1.0), 12)  # 3/4 k a^2
    /// 1.5
    #[pyo3(signature = (a, *, frequency))]
    fn harmonic_stiffness<'py>(
        &self,
        a: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = named::frequency)] frequency: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.each(a, frequency, CorePart::harmonic_stiffness)
    }

    /// Energy lost in one cycle of amplitude `a` (float or array) at `frequency` (Hz). 0 for a spring.
    ///
    /// >>> iwan.Coulomb(force=2.0).dissipation([0.1, 0.2], frequency=1.0)  # 4 F a
    /// array([0.8, 1.6])
    #[pyo3(signature = (a, *, frequency))]
    fn dissipation<'py>(
        &self,
        a: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = named::frequency)] frequency: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.each(a, frequency, CorePart::dissipation)
    }

    fn __repr__(&self) -> String {
        let (name, arguments) = self.call();
        repr::call(name, &arguments.iter().map(|(key, x)| (*key, repr::float(*x))).collect::<Vec<_>>())
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().part == self.part)
    }

    fn __hash__(&self) -> u64 {
        hash(&self.call().1.iter().map(|(_, x)| *x).collect::<Vec<_>>())
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        let arguments: Bound<'py, PyDict> = self.call().1.into_py_dict(py)?;
        Ok(((), arguments))
    }
}

/// Velocity damping f = c |v|^n sign v: `n` = 1 viscous, 2 quadratic; `c` >= 0 in (mass^1/2 length/s^2) per (mass^1/2
/// length/s)^n, 0 < `n` <= 100.
///
/// Raises `iwan.InvalidValueError` for a parameter out of range.
///
/// >>> quadratic = iwan.PowerDamping(c=3.0, n=2)
/// >>> round(quadratic.dissipation(0.1, frequency=1.5915494309189535), 12)  # 8/3 c w^2 a^3 at w = 10 rad/s
/// 0.8
#[pyclass(frozen, extends = Part, module = "iwan")]
#[derive(Debug)]
pub(crate) struct PowerDamping {
    /// Coefficient.
    #[pyo3(get)]
    c: f64,
    /// Exponent of the velocity.
    #[pyo3(get)]
    n: f64,
}

#[pymethods]
impl PowerDamping {
    #[new]
    #[pyo3(signature = (*, c, n))]
    fn new(
        #[pyo3(from_py_with = named::c)] c: f64,
        #[pyo3(from_py_with = named::n)] n: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let part = iwan_core::PowerDamping::new(c, n).map_err(core)?.into();
        Ok(PyClassInitializer::from(Part { part }).add_subclass(Self { c, n }))
    }
}

/// Dry friction of constant size `force` >= 0 (mass^1/2 length/s^2), which sticks: at rest it holds up to that size.
///
/// Raises `iwan.InvalidValueError` for a parameter out of range.
///
/// >>> mode = iwan.Mode(frequency=1.0, parts=[iwan.Coulomb(force=0.3947841760435743)])  # F/k = 0.01
/// >>> released = iwan.simulate(mode, dt=0.01, duration=1.0, initial=(1.0, 0.0))
/// >>> print(f"{released.displacement[50]:.6f} {released.displacement[100]:.6f}")  # 2 F/k less in half a cycle
/// -0.980000 0.960000
#[pyclass(frozen, extends = Part, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Coulomb {
    /// Size of the friction.
    #[pyo3(get)]
    force: f64,
}

#[pymethods]
impl Coulomb {
    #[new]
    #[pyo3(signature = (*, force))]
    fn new(#[pyo3(from_py_with = named::force)] force: f64) -> PyResult<PyClassInitializer<Self>> {
        let part = iwan_core::Coulomb::new(force).map_err(core)?.into();
        Ok(PyClassInitializer::from(Part { part }).add_subclass(Self { force }))
    }
}

/// Elastic spring f = k |u|^(exponent-1) u without dissipation: `exponent` = 3 is Duffing's spring, `k` < 0 softens, as a
/// contact does that opens; 1 < `exponent` <= 100, so that the frequency at small amplitude stays that of the mode.
///
/// Raises `iwan.InvalidValueError` for a parameter out of range.
///
/// >>> mode = iwan.Mode(frequency=1.0, parts=[iwan.Spring(k=-10.0, exponent=3)])
/// >>> print(f"{mode.frequency_at(0.5):.4f}")
/// 0.9760
#[pyclass(frozen, extends = Part, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Spring {
    /// Coefficient.
    #[pyo3(get)]
    k: f64,
    /// Exponent of the displacement.
    #[pyo3(get)]
    exponent: f64,
}

#[pymethods]
impl Spring {
    #[new]
    #[pyo3(signature = (*, k, exponent))]
    fn new(
        #[pyo3(from_py_with = named::k)] k: f64,
        #[pyo3(from_py_with = named::exponent)] exponent: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let part = iwan_core::PowerSpring::new(k, exponent).map_err(core)?.into();
        Ok(PyClassInitializer::from(Part { part }).add_subclass(Self { k, exponent }))
    }
}

/// A spring `k` >= 0 (1/s^2) beyond a `gap` > 0 (mass^1/2 length) on either side, without dissipation: a stop, a bolt's shank in
/// its hole.
///
/// Raises `iwan.InvalidValueError` for a parameter out of range.
///
/// >>> iwan.Pinning(k=1000.0, gap=0.01).harmonic_stiffness([0.005, 1e6], frequency=1.0).round(3)
/// array([   0., 1000.])
#[pyclass(frozen, extends = Part, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Pinning {
    /// Stiffness beyond the gap.
    #[pyo3(get)]
    k: f64,
    /// Gap.
    #[pyo3(get)]
    gap: f64,
}

#[pymethods]
impl Pinning {
    #[new]
    #[pyo3(signature = (*, k, gap))]
    fn new(
        #[pyo3(from_py_with = named::k)] k: f64,
        #[pyo3(from_py_with = named::gap)] gap: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let part = iwan_core::Pinning::new(k, gap).map_err(core)?.into();
        Ok(PyClassInitializer::from(Part { part }).add_subclass(Self { k, gap }))
    }
}
