//! The joint laws: construction, parameters, `repr` and pickling of each.

use iwan_core::Backbone;
use iwan_sim::JointLaw;
use numpy::PyArray1;
use pyo3::IntoPyObjectExt;
use pyo3::prelude::*;
use pyo3::types::IntoPyDict;

use crate::exchange::array::{Numbers, array};
use crate::exchange::errors::{core, value};
use crate::exchange::named;
use crate::exchange::pickle::{NewArguments, Remake};
use crate::exchange::repr;
use crate::values::joint_face::Joint;

/// Segalman's four-parameter Iwan joint {K_T, F_S, chi, beta}.
///
/// Density rho(phi) = R phi^chi up to phi_max and a Dirac S there (Deaner et al., Eq. 3). `k_t` > 0: stiffness
/// (force/length, or 1/s^2 for a mass-normalised mode); `f_s` > 0: slip force; -1 < `chi` <= 1: power, dissipation grows
/// with u^(chi+3) in micro-slip; `beta` >= 0: stiffness of the Dirac over that of the power-law part.
///
/// Raises `iwan.InvalidValueError` for a parameter out of range.
///
/// >>> joint = iwan.FourParameter(k_t=2.75e5, f_s=300.0, chi=-0.3, beta=0.02)  # Table 1 of Deaner et al.
/// >>> print(f"{joint.phi_max:.9f} {joint.dissipation(joint.phi_max):.9f}")
/// 0.002577161 1.092348096
/// >>> joint == eval(repr(joint))
/// True
#[pyclass(frozen, extends = Joint, module = "iwan")]
#[derive(Debug)]
pub(crate) struct FourParameter {
    law: iwan_core::FourParameter,
    /// The density's parameters, when it was made from them: they give the same bits again.
    density: Option<[f64; 4]>,
}

impl FourParameter {
    fn initializer(law: iwan_core::FourParameter, density: Option<[f64; 4]>) -> PyClassInitializer<Self> {
        let base = Joint { law: JointLaw::FourParameter(law) };
        PyClassInitializer::from(base).add_subclass(Self { law, density })
    }

    fn arguments(&self) -> [(&'static str, f64); 4] {
        match self.density {
            Some([r, chi, phi_max, s]) => [("r", r), ("chi", chi), ("phi_max", phi_max), ("s", s)],
            None => [
                ("k_t", self.law.k_t()),
                ("f_s", self.law.f_s()),
                ("chi", self.law.chi()),
                ("beta", self.law.beta()),
            ],
        }
    }
}

#[pymethods]
impl FourParameter {
    #[new]
    #[pyo3(signature = (*, k_t, f_s, chi, beta))]
    fn new(
        #[pyo3(from_py_with = named::k_t)] k_t: f64,
        #[pyo3(from_py_with = named::f_s)] f_s: f64,
        #[pyo3(from_py_with = named::chi)] chi: f64,
        #[pyo3(from_py_with = named::beta)] beta: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let law = iwan_core::FourParameter::new(k_t, f_s, chi, beta).map_err(core)?;
        Ok(Self::initializer(law, None))
    }

    /// From the density: coefficient `r` > 0 and power `chi` of R phi^chi, its end `phi_max` > 0 and the strength
    /// `s` >= 0 of the Dirac there.
    ///
    /// Raises `iwan.InvalidValueError` for a parameter out of range.
    ///
    /// >>> joint = iwan.FourParameter.from_density(r=2e5, chi=0.0, phi_max=0.01, s=500.0)
    /// >>> joint.k_t, joint.f_s, joint.beta
    /// (2500.0, 15.0, 0.25)
    #[staticmethod]
    #[pyo3(signature = (*, r, chi, phi_max, s))]
    fn from_density(
        py: Python<'_>,
        #[pyo3(from_py_with = named::r)] r: f64,
        #[pyo3(from_py_with = named::chi)] chi: f64,
        #[pyo3(from_py_with = named::phi_max)] phi_max: f64,
        #[pyo3(from_py_with = named::s)] s: f64,
    ) -> PyResult<Py<Self>> {
        let law = iwan_core::FourParameter::from_density(r, chi, phi_max, s).map_err(core)?;
        Py::new(py, Self::initializer(law, Some([r, chi, phi_max, s])))
    }

    /// Power chi of the density.
    #[getter]
    fn chi(&self) -> f64 {
        self.law.chi()
    }

    /// Ratio beta = S (chi+1) / (R phi_max^(chi+1)).
    #[getter]
    fn beta(&self) -> f64 {
        self.law.beta()
    }

    /// Coefficient R of the density, in stiffness / length^(chi+1).
    #[getter]
    fn r(&self) -> f64 {
        self.law.r()
    }

    /// Strength S = K_T beta/(1+beta) of the Dirac at phi_max, a stiffness.
    #[getter]
    fn s(&self) -> f64 {
        self.law.s()
    }

    /// Dissipation per cycle in macro-slip as printed in Eq. 17 of Deaner et al., 4 u F_S: only the asymptote for
    /// u >> phi_max, 2.8 to 5.3 times too high at phi_max. For drawing the paper's dashed lines.
    ///
    /// >>> iwan.FourParameter(k_t=2.75e5, f_s=300.0, chi=-0.3, beta=0.02).dissipation_printed_eq17(0.01)
    /// 12.0
    fn dissipation_printed_eq17<'py>(&self, u: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        Numbers::finite("u", u)?.map(|u| self.law.dissipation_printed_eq17(u)).into_python(u.py())
    }

    fn __repr__(&self) -> String {
        let name = if self.density.is_some() { "FourParameter.from_density" } else { "FourParameter" };
        repr::call(name, &self.arguments().map(|(key, value)| (key, repr::float(value))))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Remake<'py>> {
        let made = slf.py().import("iwan._native")?.getattr("_four_parameter")?;
        let arguments = (slf.get().density.is_some(), slf.get().arguments().map(|(_, value)| value));
        Ok((made, arguments.into_bound_py_any(slf.py())?))
    }
}

/// Makes a pickled `FourParameter` again.
#[pyfunction]
pub(crate) fn _four_parameter(
    py: Python<'_>,
    density: bool,
    values: [f64; 4],
) -> PyResult<Py<FourParameter>> {
    let [a, b, c, d] = values;
    if density {
        return FourParameter::from_density(py, a, b, c, d);
    }
    Py::new(py, FourParameter::new(a, b, c, d)?)
}

/// The Iwan joint of five parameters {K_T, F_S, chi, beta, theta}: Segalman's, with dynamic below static friction.
///
/// A slider sticks up to its static limit, slides at `theta` of that (0 < `theta` <= 1) until the motion turns round, and sticks again;
/// the other parameters are those of `FourParameter`, `f_s` that of static friction. Masing's rule does not hold, and a cycle depends on
/// what was before: `dissipation` and `harmonic_stiffness` are those of a cycle reached from rest, `dissipation_in_decay` and
/// `harmonic_stiffness_in_decay` of one in a decay, in which more sliders slide. Methods "newmark" on sliders and "averaging" run it.
///
/// Raises `iwan.InvalidValueError` for a parameter out of range.
///
/// Source: M. P. Mignolet, P. Song, X. Q. Wang, J. Sound Vib. 349:289, 2015, doi:10.1016/j.jsv.2015.03.032.
///
/// >>> joint = iwan.FiveParameter(k_t=2.75e5, f_s=300.0, chi=-0.3, beta=0.02, theta=0.8)
/// >>> print(f"{joint.force(2 * joint.phi_max):.9g}")  # all sliders slide
/// 240
#[pyclass(frozen, extends = Joint, module = "iwan")]
#[derive(Debug)]
pub(crate) struct FiveParameter {
    law: iwan_core::FiveParameter,
}

impl FiveParameter {
    fn arguments(&self) -> [(&'static str, f64); 5] {
        let law = self.law.sticking();
        let own = ("theta", self.law.theta());
        [("k_t", law.k_t()), ("f_s", law.f_s()), ("chi", law.chi()), ("beta", law.beta()), own]
    }

    /// A property of cycles at each displacement, after motions with amplitudes up to `largest`; none: after motions of any amplitude.
    fn in_decay<'py>(
        &self,
        u: &Bound<'py, PyAny>,
        largest: Option<f64>,
        property: impl Fn(&iwan_core::FiveParameter, f64) -> f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let largest = largest.unwrap_or(f64::INFINITY);
        if largest.is_nan() || largest < 0.0 {
            return Err(value(format!("largest = {largest} is out of range: an amplitude is >= 0")));
        }
        let law = self.law.after(largest);
        Numbers::finite("u", u)?.map(|u| property(&law, u)).into_python(u.py())
    }
}

#[pymethods]
impl FiveParameter {
    #[new]
    #[pyo3(signature = (*, k_t, f_s, chi, beta, theta))]
    fn new(
        #[pyo3(from_py_with = named::k_t)] k_t: f64,
        #[pyo3(from_py_with = named::f_s)] f_s: f64,
        #[pyo3(from_py_with = named::chi)] chi: f64,
        #[pyo3(from_py_with = named::beta)] beta: f64,
        #[pyo3(from_py_with = named::theta)] theta: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let law = iwan_core::FiveParameter::new(k_t, f_s, chi, beta, theta).map_err(core)?;
        let base = Joint { law: JointLaw::FiveParameter(law) };
        Ok(PyClassInitializer::from(base).add_subclass(Self { law }))
    }

    /// Power chi of the density.
    #[getter]
    fn chi(&self) -> f64 {
        self.law.sticking().chi()
    }

    /// Ratio beta of the stiffness of the Dirac to that of the power-law part.
    #[getter]
    fn beta(&self) -> f64 {
        self.law.sticking().beta()
    }

    /// Ratio theta of dynamic to static friction.
    #[getter]
    fn theta(&self) -> f64 {
        self.law.theta()
    }

    /// Energy dissipated in one cycle between -u and u of a decay from the amplitude `largest` (length; None: from any): a slider
    /// that slid goes on sliding down to the amplitude (1+theta)/2 of its strength.
    ///
    /// >>> joint = iwan.FiveParameter(k_t=2.75e5, f_s=300.0, chi=0.0, beta=0.0, theta=0.5)
    /// >>> print(f"{joint.dissipation_in_decay(1e-4) / joint.dissipation(1e-4):.4f}")
    /// 1.5802
    #[pyo3(signature = (u, largest = None))]
    fn dissipation_in_decay<'py>(
        &self,
        u: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = named::largest)] largest: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.in_decay(u, largest, Backbone::dissipation)
    }

    /// First-harmonic stiffness of a cycle of amplitude u of a decay from the amplitude `largest` (length; None: from any).
    ///
    /// >>> joint = iwan.FiveParameter(k_t=2.75e5, f_s=300.0, chi=0.0, beta=0.0, theta=0.5)
    /// >>> joint.harmonic_stiffness_in_decay(1e-4) < joint.harmonic_stiffness(1e-4)
    /// True
    #[pyo3(signature = (u, largest = None))]
    fn harmonic_stiffness_in_decay<'py>(
        &self,
        u: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = named::largest)] largest: Option<f64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.in_decay(u, largest, Backbone::harmonic_stiffness)
    }

    fn __repr__(&self) -> String {
        repr::call("FiveParameter", &self.arguments().map(|(key, value)| (key, repr::float(value))))
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        Ok(((), self.arguments().into_py_dict(py)?))
    }
}

/// One Jenkins element: a spring `k_t` > 0 in series with a friction slider of slip force `f_s` > 0.
///
/// Raises `iwan.InvalidValueError` for a parameter out of range.
///
/// >>> joint = iwan.Jenkins(k_t=1000.0, f_s=5.0)
/// >>> joint.phi_max, joint.force(0.002), joint.force(-0.02)
/// (0.005, 2.0, -5.0)
#[pyclass(frozen, extends = Joint, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Jenkins {
    k_t: f64,
    f_s: f64,
}

#[pymethods]
impl Jenkins {
    #[new]
    #[pyo3(signature = (*, k_t, f_s))]
    fn new(
        #[pyo3(from_py_with = named::k_t)] k_t: f64,
        #[pyo3(from_py_with = named::f_s)] f_s: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let law = JointLaw::Jenkins(iwan_core::Jenkins::new(k_t, f_s).map_err(core)?);
        Ok(PyClassInitializer::from(Joint { law }).add_subclass(Self { k_t, f_s }))
    }

    fn __repr__(&self) -> String {
        repr::call("Jenkins", &[("k_t", repr::float(self.k_t)), ("f_s", repr::float(self.f_s))])
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        Ok(((), [("k_t", self.k_t), ("f_s", self.f_s)].into_py_dict(py)?))
    }
}

/// Iwan's 1966 model: strengths spread evenly over the band phi_mean (1 +- `width`), 0 < width <= 1.
///
/// `width` = 1 is the four-parameter joint with chi = 0 and beta = 0, `width` -> 0 a Jenkins element.
/// Raises `iwan.InvalidValueError` for a parameter out of range.
///
/// Source: W. D. Iwan, J. Appl. Mech. 33(4):893, 1966, doi:10.1115/1.3625199.
///
/// >>> joint = iwan.Uniform(k_t=1000.0, f_s=5.0, width=1.0)  # strengths from 0 to 0.01
/// >>> joint.force(0.005), joint.force(0.02)
/// (3.75, 5.0)
#[pyclass(frozen, extends = Joint, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Uniform {
    k_t: f64,
    f_s: f64,
    #[pyo3(get)]
    /// Relative half width of the band.
    width: f64,
}

#[pymethods]
impl Uniform {
    #[new]
    #[pyo3(signature = (*, k_t, f_s, width))]
    fn new(
        #[pyo3(from_py_with = named::k_t)] k_t: f64,
        #[pyo3(from_py_with = named::f_s)] f_s: f64,
        #[pyo3(from_py_with = named::width)] width: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let law = JointLaw::Uniform(iwan_core::Uniform::new(k_t, f_s, width).map_err(core)?);
        Ok(PyClassInitializer::from(Joint { law }).add_subclass(Self { k_t, f_s, width }))
    }

    fn __repr__(&self) -> String {
        let [k_t, f_s, width] = [self.k_t, self.f_s, self.width].map(repr::float);
        repr::call("Uniform", &[("k_t", k_t), ("f_s", f_s), ("width", width)])
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        let arguments = [("k_t", self.k_t), ("f_s", self.f_s), ("width", self.width)];
        Ok(((), arguments.into_py_dict(py)?))
    }
}

/// A density given point by point: `density` (stiffness/length, >= 0) at the strengths `strength` (length, >= 0,
/// ascending), linear in between, 0 outside; `dirac` >= 0 is the stiffness of a slider at the last strength.
///
/// Raises `iwan.InvalidValueError` with the first entry that is out of order or range.
///
/// >>> joint = iwan.Tabulated(strength=[0.0, 0.5], density=[8.0, 8.0])
/// >>> joint.k_t, joint.f_s
/// (4.0, 1.0)
#[pyclass(frozen, extends = Joint, module = "iwan")]
#[derive(Debug)]
pub(crate) struct Tabulated {
    strength: Vec<f64>,
    table: Vec<f64>,
    dirac: f64,
}

#[pymethods]
impl Tabulated {
    #[new]
    #[pyo3(signature = (*, strength, density, dirac = 0.0))]
    fn new(
        strength: &Bound<'_, PyAny>,
        density: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = named::dirac)] dirac: f64,
    ) -> PyResult<PyClassInitializer<Self>> {
        let strength = Numbers::vector("strength", strength)?;
        let table = Numbers::vector("density", density)?;
        let law = JointLaw::tabulated(&strength, &table, dirac).map_err(core)?;
        Ok(PyClassInitializer::from(Joint { law }).add_subclass(Self { strength, table, dirac }))
    }

    /// Strengths of the points (length), float64 array.
    #[getter]
    fn strength(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.strength.clone())
    }

    /// Densities at the points (stiffness/length), float64 array.
    #[getter]
    fn table(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.table.clone())
    }

    fn __repr__(&self) -> String {
        let arguments = [
            ("strength", repr::floats(&self.strength)),
            ("density", repr::floats(&self.table)),
            ("dirac", repr::float(self.dirac)),
        ];
        repr::call("Tabulated", &arguments)
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        let arguments =
            [("strength", self.strength.clone()), ("density", self.table.clone())].into_py_dict(py)?;
        arguments.set_item("dirac", self.dirac)?;
        Ok(((), arguments))
    }
}
