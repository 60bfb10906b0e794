//! A mode known by its curves: frequency and damping ratio against amplitude.

use iwan_sim::Curves;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};

use crate::exchange::array::{Numbers, array};
use crate::exchange::errors::core;
use crate::exchange::named::{self, Instance};
use crate::exchange::pickle::{NewArguments, hash};
use crate::exchange::repr;

/// Frequency and damping ratio against amplitude, as measured: a mode without a law, `iwan.Mode(curves=...)`.
///
/// `amplitude` > 0: modal displacement (mass^1/2 length), ascending, two points or more; `frequency` there (Hz), changing by
/// less than a third per factor e of amplitude; `damping_ratio` there (0.01 = 1 %). Between the points monotone cubics in
/// the logarithm of the amplitude (PCHIP). Below the smallest amplitude its values are held, and `iwan.simulate` warns from
/// when on; above the largest it raises `iwan.ComputationError`, unless `extrapolate` allows to hold the last values.
///
/// Raises `iwan.InvalidValueError` with the first entry that is out of order or range. Frozen, hashable, picklable.
///
/// >>> curves = iwan.ModeCurves(amplitude=[1e-4, 1e-2], frequency=[124.0, 122.0], damping_ratio=[0.001, 0.005])
/// >>> mode = iwan.Mode(curves=curves)
/// >>> print(f"{mode.frequency_at(1e-3):.3f} Hz, {mode.damping_ratio_at(1e-3):.4f}")
/// 123.000 Hz, 0.0030
#[pyclass(frozen, module = "iwan")]
#[derive(Debug)]
pub(crate) struct ModeCurves {
    pub(crate) curves: Curves,
}

impl Instance for ModeCurves {}

#[pymethods]
impl ModeCurves {
    #[new]
    #[pyo3(signature = (amplitude, frequency, damping_ratio, *, extrapolate = false))]
    fn new(
        amplitude: &Bound<'_, PyAny>,
        frequency: &Bound<'_, PyAny>,
        damping_ratio: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = named::extrapolate)] extrapolate: bool,
    ) -> PyResult<Self> {
        let amplitude = Numbers::vector("amplitude", amplitude)?;
        let frequency = Numbers::vector("frequency", frequency)?;
        let damping_ratio = Numbers::vector("damping_ratio", damping_ratio)?;
        let curves = Curves::new(amplitude, frequency, damping_ratio).map_err(core)?;
        Ok(Self { curves: curves.extrapolating(extrapolate) })
    }

    /// Amplitudes of the points, float64 array.
    #[getter]
    fn amplitude(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.curves.table()[0].to_vec())
    }

    /// Frequencies at the points, Hz, float64 array.
    #[getter]
    fn frequency(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.curves.table()[1].to_vec())
    }

    /// Damping ratios at the points, float64 array.
    #[getter]
    fn damping_ratio(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        array(py, self.curves.table()[2].to_vec())
    }

    /// Whether amplitudes above the largest are allowed.
    #[getter]
    fn extrapolate(&self) -> bool {
        self.curves.extrapolates()
    }

    fn __repr__(&self) -> String {
        let [amplitude, frequency, damping_ratio] = self.curves.table().map(repr::floats);
        let mut arguments =
            vec![("amplitude", amplitude), ("frequency", frequency), ("damping_ratio", damping_ratio)];
        if self.curves.extrapolates() {
            arguments.push(("extrapolate", "True".into()));
        }
        repr::call("ModeCurves", &arguments)
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().curves == self.curves)
    }

    fn __hash__(&self) -> u64 {
        hash(&self.curves.table().concat())
    }

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<NewArguments<'py>> {
        let [amplitude, frequency, damping_ratio] = self.curves.table().map(<[f64]>::to_vec);
        let arguments: Bound<'py, PyDict> =
            [("amplitude", amplitude), ("frequency", frequency), ("damping_ratio", damping_ratio)]
                .into_py_dict(py)?;
        arguments.set_item("extrapolate", self.curves.extrapolates())?;
        Ok(((), arguments))
    }
}
