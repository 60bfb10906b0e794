//! Methods that all joint laws have.

use iwan_core::Backbone;
use iwan_machine::memory::ask;
use iwan_sim::{JointLaw, force_history};
use pyo3::prelude::*;

use crate::exchange::array::{Numbers, shaped};
use crate::exchange::errors::{core, lacking, simulation, value};
use crate::exchange::named::{self, Instance};
use crate::exchange::options::representation_of;
use crate::exchange::pickle::hash;
use crate::exchange::work;

/// Number of displacements above which a calculation releases the interpreter's lock: it then takes some hundred microseconds, many times
/// what releasing costs.
const MANY: usize = 1 << 12;

/// Number of displacements above which a history gets a thread of its own, so that Ctrl-C can stop it: a million take tens of milliseconds.
const LASTING: usize = 1 << 20;

/// A joint law: the common face of `FourParameter`, `FiveParameter`, `Jenkins`, `Uniform` and `Tabulated`.
///
/// A parallel-series Iwan joint is known by its virgin curve F(u), the density of its sliders being rho = -F''; all loops
/// follow by Masing's rule (but those of a `FiveParameter` joint). Displacements `u` are of either sign, in the user's own length unit, as a float or as an
/// array of any shape; results have the same shape. `force` is odd in u, everything else even. Frozen, hashable, picklable.
///
/// Raises `iwan.InvalidValueError` for a displacement that is not finite.
///
/// Source: D. J. Segalman, J. Appl. Mech. 72(5):752, 2005, doi:10.1115/1.1989354.
#[pyclass(frozen, subclass, module = "iwan")]
#[derive(Debug, Clone)]
pub(crate) struct Joint {
    pub(crate) law: JointLaw,
}

impl Instance for Joint {}

impl Joint {
    /// A property of the law at each displacement.
    fn each<'py>(
        &self,
        u: &Bound<'py, PyAny>,
        property: impl Fn(&JointLaw, f64) -> f64 + Send + Sync,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, numbers) = (u.py(), Numbers::finite("u", u)?);
        let compute = || numbers.map(|u| property(&self.law, u));
        let results = if u.len().is_ok_and(|n| n > MANY) { py.detach(compute) } else { compute() };
        results.into_python(py)
    }
}

#[pymethods]
impl Joint {
    /// Stiffness K_T at small displacement, all sliders stuck.
    #[getter]
    fn k_t(&self) -> f64 {
        self.law.initial_stiffness()
    }

    /// Slip force F_S, all sliders slipping: of static friction.
    #[getter]
    fn f_s(&self) -> f64 {
        self.law.slip_force()
    }

    /// Displacement phi_max at which macro-slip begins: the strength of the strongest slider.
    #[getter]
    fn phi_max(&self) -> f64 {
        self.law.strengths().1
    }

    /// Strength of the weakest slider: nothing slips below this displacement.
    #[getter]
    fn phi_min(&self) -> f64 {
        self.law.strengths().0
    }

    /// Stiffness of the sliders that all have the largest strength: the Dirac in the density.
    #[getter]
    fn dirac(&self) -> f64 {
        self.law.dirac()
    }

    /// Force F(u) on the virgin curve (Eq. 16 of Deaner et al., with its prefix F_S; F_S beyond phi_max).
    ///
    /// >>> joint = iwan.FourParameter(k_t=2.75e5, f_s=300.0, chi=-0.3, beta=0.02)
    /// >>> joint.force([-2 * joint.phi_max, 0.0, 2 * joint.phi_max])
    /// array([-300.,    0.,  300.])
    fn force<'py>(&self, u: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.each(u, Backbone::force)
    }

    /// Tangent stiffness dF/du on the virgin curve: K_T at 0, 0 from phi_max on.
    ///
    /// >>> iwan.Jenkins(k_t=1000.0, f_s=5.0).tangent([0.0, 0.01])
    /// array([1000.,    0.])
    fn tangent<'py>(&self, u: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.each(u, Backbone::tangent)
    }

    /// Secant stiffness F(u)/u on the virgin curve, K_T at 0.
    ///
    /// >>> iwan.Jenkins(k_t=1000.0, f_s=5.0).secant(0.01)
    /// 500.0
    fn secant<'py>(&self, u: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.each(u, Backbone::secant)
    }

    /// First-harmonic (harmonic-balance) stiffness of a closed cycle of amplitude u, K_T at 0.
    ///
    /// K_1(u) = 1/(pi u) times the integral of F cos(theta) over the cycle; omega^2 = K_inf + K_1 gives the frequency.
    ///
    /// >>> joint = iwan.FourParameter(k_t=2.75e5, f_s=300.0, chi=0.0, beta=0.02)
    /// >>> round(joint.harmonic_stiffness(1e-4) / joint.secant(1e-4), 12)  # equal at chi = 0
    /// 1.0
    fn harmonic_stiffness<'py>(&self, u: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.each(u, Backbone::harmonic_stiffness)
    }

    /// Energy dissipated in one closed cycle between -u and u (Eq. 15 of Deaner et al. with its prefix mended to
    /// F_S^2/K_T; exact beyond phi_max, where the printed Eq. 17 is only the asymptote).
    ///
    /// >>> iwan.Jenkins(k_t=1000.0, f_s=5.0).dissipation(0.02)  # 4 F_S (u - phi_max)
    /// 0.3
    fn dissipation<'py>(&self, u: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.each(u, Backbone::dissipation)
    }

    /// Work of the force on the virgin curve, from 0 to u.
    ///
    /// >>> iwan.Jenkins(k_t=1000.0, f_s=5.0).energy(0.001)
    /// 0.0005
    fn energy<'py>(&self, u: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.each(u, Backbone::energy)
    }

    /// Density rho of the sliders at the strength phi >= 0 (stiffness/length), without the Dirac (`dirac`) at phi_max.
    ///
    /// >>> iwan.Uniform(k_t=1000.0, f_s=5.0, width=1.0).density([0.004, 0.011])
    /// array([100000.,      0.])
    fn density<'py>(&self, phi: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let numbers = Numbers::finite("phi", phi)?;
        if let Some(bad) = numbers.values.iter().find(|phi| **phi < 0.0) {
            return Err(value(format!("phi = {bad} is out of range: a strength is >= 0")));
        }
        numbers.map(|phi| self.law.density(phi)).into_python(phi.py())
    }

    /// Hysteretic force at the displacements `u` (one dimension) through which the joint is driven from its virgin
    /// state, monotonically from one to the next.
    ///
    /// `sliders`: number of Jenkins elements into which the density is cut, on the `grid` "graded" (default),
    /// "uniform", or a number > 1, the ratio of neighbouring strengths; None is the exact continuum (Masing's rule with
    /// return-point memory). Returns a float64 array as long as u.
    ///
    /// >>> joint = iwan.Jenkins(k_t=1000.0, f_s=5.0)
    /// >>> joint.force_history([0.004, 0.02, 0.016, 0.0])
    /// array([ 4.,  5.,  1., -5.])
    #[pyo3(signature = (u, sliders = None, grid = None))]
    fn force_history<'py>(
        &self,
        u: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = named::sliders)] sliders: Option<usize>,
        grid: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, displacement) = (u.py(), Numbers::vector("u", u)?);
        let (law, joint) = (self.law.clone(), representation_of(sliders, grid, iwan_core::Grid::graded)?);
        let force = work::run(py, displacement.len() > LASTING, move |control| {
            force_history(&law, &displacement, joint, &|_| control.stop())
        })?
        .map_err(simulation)?;
        Ok(shaped(py, vec![force.len()], force)?.into_any())
    }

    /// Strengths (length) and stiffnesses of the Jenkins elements into which the density is cut; `grid` as in
    /// `force_history`. Their sums are exact: stiffness is K_T, strength times stiffness is F_S.
    ///
    /// >>> joint = iwan.FourParameter(k_t=2.75e5, f_s=300.0, chi=-0.3, beta=0.02)
    /// >>> strength, stiffness = joint.discretise(100)
    /// >>> print(strength.size, f"{stiffness.sum() / joint.k_t:.12f} {strength @ stiffness / joint.f_s:.12f}")
    /// 101 1.000000000000 1.000000000000
    #[pyo3(signature = (sliders = 100, grid = None))]
    fn discretise<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = named::sliders)] sliders: usize,
        grid: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyAny>)> {
        let iwan_core::Representation::Sliders { bins, grid } =
            representation_of(Some(sliders), grid, iwan_core::Grid::graded)?
        else {
            return Err(value("sliders must be a number"));
        };
        // About 100 bytes a slider: the table, and the two arrays made from it while they grow.
        let bytes = (bins as u64).saturating_mul(100);
        ask(format!("a table of {bins} sliders"), bytes, "take fewer sliders").map_err(|e| lacking(&e))?;
        let mut table = vec![iwan_core::Slider::default(); iwan_core::Sliders::table_len(bins)];
        let population = iwan_core::Sliders::discretise(&self.law, grid, bins, &mut table).map_err(core)?;
        let (strength, stiffness): (Vec<_>, Vec<_>) = population.elements().unzip();
        let n = strength.len();
        Ok((shaped(py, vec![n], strength)?.into_any(), shaped(py, vec![n], stiffness)?.into_any()))
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().law == self.law)
    }

    fn __hash__(&self) -> u64 {
        let (low, high) = self.law.strengths();
        hash(&[self.law.initial_stiffness(), self.law.slip_force(), low, high])
    }
}
