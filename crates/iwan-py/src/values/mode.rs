//! A mode with its joint.

use iwan_core::ResidualStiffness;
use iwan_sim::Point;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict, PyTuple};

use crate::exchange::array::Numbers;
use crate::exchange::errors::{core, value};
use crate::exchange::named::{self, ByName, Instance};
use crate::exchange::pickle::{NewArguments, hash};
use crate::exchange::repr;
use crate::values::joint_face::Joint;
use crate::values::mode_curves::ModeCurves;
use crate::values::parts::Part;

/// A mass-normalised mode with an Iwan joint: q'' + 2 zeta_v omega0 q' + K_inf q + F_J(q) = phi f(t), K_inf = omega0^2 - K_T
/// (Deaner et al., Eq. 5).
///
/// `frequency` > 0: at small amplitude, all sliders stuck (Hz); `joint`: in modal coordinates, None for a linear mode;
/// 0 <= `damping_ratio` < 1: viscous, in parallel (0.01 = 1 %); `name`; `shape_at_force`: mass-normalised mode shape phi at
/// the load (mass^-1/2), modal force = phi times force; `outputs`: shapes at named points for `superpose`; `parts`: dampers
/// and springs beside the joint (`PowerDamping`, `Coulomb`, `Spring`, `Pinning`); `curves`: a `ModeCurves` in place of
/// frequency, joint, damping_ratio and parts.
///
/// Raises `iwan.InvalidValueError` for a value out of range; also when K_T >= omega0^2, unless
/// `allow_negative_residual`. Frozen, hashable, picklable.
///
/// >>> joint = iwan.FourParameter(k_t=4.45e4, f_s=239.4, chi=-0.183, beta=0.3)
/// >>> mode = iwan.Mode(frequency=124.0, joint=joint, damping_ratio=2.5e-4)
/// >>> print(f"{mode.frequency_at(joint.phi_max):.1f} Hz, {mode.damping_ratio_at(joint.phi_max):.4f}")
/// 122.0 Hz, 0.0062
#[pyclass(frozen, module = "iwan")]
#[derive(Debug)]
#[expect(clippy::struct_field_names, reason = "the mode of the library inside that of Python")]
pub(crate) struct Mode {
    pub(crate) mode: iwan_sim::Mode,
    joint: Option<Py<PyAny>>,
    parts: Vec<Py<PyAny>>,
    curves: Option<Py<ModeCurves>>,
}

impl Instance for Mode {}

#[pymethods]
impl Mode {
    #[new]
    #[pyo3(signature = (
        *, frequency = None, joint = None, damping_ratio = 0.0, name = "mode", shape_at_force = 1.0, outputs = None,
        allow_negative_residual = false, parts = None, curves = None
    ))]
    #[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        #[pyo3(from_py_with = named::frequency)] frequency: Option<f64>,
        #[pyo3(from_py_with = named::joint)] joint: Option<Bound<'_, Joint>>,
        #[pyo3(from_py_with = named::damping_ratio)] damping_ratio: f64,
        #[pyo3(from_py_with = named::name)] name: &str,
        #[pyo3(from_py_with = named::shape_at_force)] shape_at_force: f64,
        #[pyo3(from_py_with = named::outputs)] outputs: Option<ByName<f64>>,
        #[pyo3(from_py_with = named::allow_negative_residual)] allow_negative_residual: bool,
        #[pyo3(from_py_with = named::parts)] parts: Option<Vec<Bound<'_, Part>>>,
        #[pyo3(from_py_with = named::curves)] curves: Option<Bound<'_, ModeCurves>>,
    ) -> PyResult<Self> {
        let residual =
            if allow_negative_residual { ResidualStiffness::Any } else { ResidualStiffness::Positive };
        let plain = match (frequency, &curves) {
            (Some(frequency), None) => iwan_sim::Mode::new(name, frequency, None),
            (None, Some(curves)) => iwan_sim::Mode::by_curves(name, curves.get().curves.clone()),
            (Some(_), Some(_)) => {
                return Err(value("frequency and curves exclude each other: the curves are the whole mode"));
            }
            (None, None) => return Err(value("frequency is missing: give frequency= in Hz, or curves=")),
        };
        let parts = parts.unwrap_or_default();
        let law = joint.as_ref().map(|joint| joint.get().law.clone());
        let mode = iwan_sim::Mode {
            joint: law,
            parts: parts.iter().map(|part| part.get().part).collect(),
            damping_ratio,
            residual,
            shape_at_force,
            outputs: outputs.map_or(Ok(Vec::new()), points)?,
            ..plain
        };
        mode.oscillator().map_err(core)?;
        Ok(Self {
            mode,
            joint: joint.map(|joint| joint.into_any().unbind()),
            parts: parts.into_iter().map(|part| part.into_any().unbind()).collect(),
            curves: curves.map(Bound::unbind),
        })
    }

    /// Frequency at small amplitude, Hz.
    #[getter]
    fn frequency(&self) -> f64 {
        self.mode.frequency
    }

    /// Viscous damping ratio zeta_v.
    #[getter]
    fn damping_ratio(&self) -> f64 {
        self.mode.damping_ratio
    }

    /// The joint, or None.
    #[getter]
    fn joint(&self, py: Python<'_>) -> Option<Py<PyAny>> {
        self.joint.as_ref().map(|joint| joint.clone_ref(py))
    }

    /// The parts beside the joint (a tuple).
    #[getter]
    fn parts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.parts.iter().map(|part| part.clone_ref(py)))
    }

    /// The curves in place of a law, or None.
    #[getter]
    fn curves(&self, py: Python<'_>) -> Option<Py<ModeCurves>> {
        self.curves.as_ref().map(|curves| curves.clone_ref(py))
    }

    /// Name of the mode.
    #[getter]
    fn name(&self) -> &str {
        &self.mode.name
    }

    /// Mass-normalised mode shape at the load.
    #[getter]
    fn shape_at_force(&self) -> f64 {
        self.mode.shape_at_force
    }

    /// Mass-normalised mode shapes at named points (a new dict).
    #[getter]
    fn outputs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.mode.outputs.iter().map(|p| (p.name.as_str(), p.shape)).into_py_dict(py)
    }

    /// Whether K_inf <= 0 is allowed.
    #[getter]
    fn allow_negative_residual(&self) -> bool {
        self.mode.residual == ResidualStiffness::Any
    }

    /// Residual stiffness K_inf = omega0^2 - K_T when all sliders slip, 1/s^2.
    #[getter]
    fn k_inf(&self) -> PyResult<f64> {
        Ok(self.mode.oscillator().map_err(core)?.k_inf())
    }

    /// Frequency (Hz) at the modal displacement amplitudes `a` (mass^1/2 length; float or array), by first-harmonic
    /// balance: omega^2 = K_inf + K_1(a).
    ///
    /// >>> iwan.Mode(frequency=50.0).frequency_at([0.1, 1.0])
    /// array([50., 50.])
    fn frequency_at<'py>(&self, a: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let frequency = |a| self.mode.frequency_at(a).unwrap_or(f64::NAN);
        Numbers::finite("a", a)?.map(frequency).into_python(a.py())
    }

    /// Damping ratio at the modal displacement amplitudes `a` > 0 (float or array): zeta = zeta_v omega0/omega +
    /// D(a) / (2 pi omega^2 a^2).
    ///
    /// >>> iwan.Mode(frequency=50.0, damping_ratio=0.01).damping_ratio_at(1.0)
    /// 0.01
    fn damping_ratio_at<'py>(&self, a: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let numbers = Numbers::finite("a", a)?;
        if let Some(bad) = numbers.values.iter().find(|a| **a <= 0.0) {
            return Err(value(format!("a = {bad} is out of range: an amplitude is > 0")));
        }
        numbers.map(|a| self.mode.damping_ratio_at(a).unwrap_or(f64::NAN)).into_python(a.py())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let mode = &self.mode;
        let joint = match &self.joint {
            Some(joint) => joint.bind(py).repr()?.to_string(),
            None => "None".into(),
        };
        let outputs: Vec<_> = mode
            .outputs
            .iter()
            .map(|p| format!("{}: {}", repr::text(&p.name), repr::float(p.shape)))
            .collect();
        let mut arguments = match &self.curves {
            Some(curves) => vec![("curves", curves.bind(py).repr()?.to_string())],
            None => vec![
                ("frequency", repr::float(mode.frequency)),
                ("joint", joint),
                ("damping_ratio", repr::float(mode.damping_ratio)),
            ],
        };
        arguments.extend([
            ("name", repr::text(&mode.name)),
            ("shape_at_force", repr::float(mode.shape_at_force)),
            ("outputs", format!("{{{}}}", outputs.join(", "))),
        ]);
        if !self.parts.is_empty() {
            let parts: PyResult<Vec<_>> =
                self.parts.iter().map(|part| Ok(part.bind(py).repr()?.to_string())).collect();
            arguments.push(("parts", format!("[{}]", parts?.join(", "))));
        }
        if self.allow_negative_residual() {
            arguments.push(("allow_negative_residual", "True".into()));
        }
        Ok(repr::call("Mode", &arguments))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().mode == self.mode)
    }

    fn __hash__(&self) -> u64 {
        hash(&[self.mode.frequency, self.mode.damping_ratio, self.mode.shape_at_force])
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        let arguments = PyDict::new(py);
        if let Some(curves) = self.curves(py) {
            arguments.set_item("curves", curves)?;
        } else {
            arguments.set_item("frequency", self.mode.frequency)?;
            arguments.set_item("joint", self.joint(py))?;
            arguments.set_item("damping_ratio", self.mode.damping_ratio)?;
            arguments.set_item("parts", self.parts(py)?.to_list())?;
        }
        arguments.set_item("name", self.name())?;
        arguments.set_item("shape_at_force", self.mode.shape_at_force)?;
        arguments.set_item("outputs", self.outputs(py)?)?;
        arguments.set_item("allow_negative_residual", self.allow_negative_residual())?;
        Ok(((), arguments))
    }
}

/// Observed points with names; their shapes must be finite.
fn points(ByName(outputs): ByName<f64>) -> PyResult<Vec<Point>> {
    let point = |(name, shape): (String, f64)| {
        if !shape.is_finite() {
            return Err(value(format!("outputs['{name}'] = {shape} must be a finite number")));
        }
        Ok(Point { name, shape })
    };
    outputs.into_iter().map(point).collect()
}
