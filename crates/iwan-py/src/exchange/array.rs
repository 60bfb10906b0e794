//! NumPy arrays between Python and Rust: any object of real numbers is read as float64 in C order; results are returned without a copy.

use numpy::ndarray::{Array, Array2, Array3, IxDyn};
use numpy::{
    Complex64, IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayDescrMethods, PyArrayDyn, PyArrayMethods,
    PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt};
use rayon::prelude::*;

use crate::exchange::errors::{value, wrong_type};

/// Numbers in logical (C) order, with their shape.
pub(crate) struct Numbers {
    pub(crate) values: Vec<f64>,
    pub(crate) shape: Vec<usize>,
}

/// Refuses a masked array of `numpy.ma`: a value under a mask is no measurement.
fn refuse_masked(name: &str, object: &Bound<'_, PyAny>) -> PyResult<()> {
    let py = object.py();
    if object.hasattr(intern!(py, "_mask"))? && object.hasattr(intern!(py, "mask"))? {
        let masked = object.py().import(intern!(py, "numpy.ma"))?;
        let hidden: usize = masked
            .call_method1(intern!(py, "getmaskarray"), (object,))?
            .call_method0(intern!(py, "sum"))?
            .extract()?;
        if hidden > 0 {
            let what =
                format!("{name} hides {hidden} numbers under a mask: cut them off, or fill them (.filled)");
            return Err(value(what));
        }
    }
    Ok(())
}

impl Numbers {
    /// Reads any object that NumPy takes for real numbers: arrays of any layout, integers, float32, lists, scalars.
    ///
    /// The numbers are copied, because another thread may write to the array while the interpreter's lock is released.
    pub(crate) fn read(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Self> {
        Self::seen(name, object, |values, shape| Self { values: values.to_vec(), shape: shape.to_vec() })
    }

    /// What `look` makes of the numbers, in logical order, and of their shape. It sees those of an array in C order where they are, without a copy.
    fn seen<T>(
        name: &str,
        object: &Bound<'_, PyAny>,
        look: impl FnOnce(&[f64], &[usize]) -> T,
    ) -> PyResult<T> {
        if object.is_instance_of::<PyFloat>()
            || (object.is_instance_of::<PyInt>() && !object.is_instance_of::<PyBool>())
        {
            let wide = |_| value(format!("{name} is out of range: beyond the numbers of 64 bits"));
            return Ok(look(&[object.extract().map_err(wide)?], &[]));
        }
        refuse_masked(name, object)?;
        if let Ok(array) = object.cast::<PyArrayDyn<f64>>()
            && is_aligned(array)
        {
            return Ok(Self::seen_in(array, look));
        }
        let array = object
            .py()
            .import(intern!(object.py(), "numpy"))?
            .call_method1(intern!(object.py(), "asarray"), (object,))
            .map_err(|error| wrong_type(format!("{name} must hold real numbers: {error}")))?;
        let untyped = array.cast::<PyUntypedArray>().map_err(PyErr::from)?;
        let kind = untyped.dtype().kind();
        if untyped.len() > 0 && !matches!(kind, b'f' | b'i' | b'u') {
            let dtype = untyped.dtype();
            return Err(wrong_type(format!("{name} must hold real numbers, not {dtype}")));
        }
        let floats =
            array.call_method1(intern!(object.py(), "astype"), (intern!(object.py(), "float64"),))?;
        Ok(Self::seen_in(floats.cast::<PyArrayDyn<f64>>().map_err(PyErr::from)?, look))
    }

    /// Reads numbers, all of which must be finite.
    pub(crate) fn finite(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Self> {
        let numbers = Self::read(name, object)?;
        if !are_finite(&numbers.values) {
            return Err(not_finite(name, &numbers.values, &numbers.shape));
        }
        Ok(numbers)
    }

    /// Reads finite numbers as rows along the last axis, with the shape of the array. Records of many channels are large: they are copied once, into their rows.
    pub(crate) fn rows(name: &str, object: &Bound<'_, PyAny>) -> PyResult<(Vec<Vec<f64>>, Vec<usize>)> {
        Self::seen(name, object, |values, shape| {
            let length = shape.last().copied().unwrap_or(1).max(1);
            let row = |row: &[f64]| are_finite(row).then(|| row.to_vec());
            match values.par_chunks(length).map(row).collect() {
                Some(rows) => Ok((rows, shape.to_vec())),
                None => Err(not_finite(name, values, shape)),
            }
        })?
    }

    /// Reads finite numbers of one dimension.
    pub(crate) fn vector(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
        let numbers = Self::finite(name, object)?;
        if numbers.shape.len() == 1 {
            return Ok(numbers.values);
        }
        Err(value(format!("{name} has the shape {:?}: it must have one dimension", numbers.shape)))
    }

    fn seen_in<T>(array: &Bound<'_, PyArrayDyn<f64>>, look: impl FnOnce(&[f64], &[usize]) -> T) -> T {
        let view = array.readonly();
        match view.as_slice() {
            Ok(values) if array.is_c_contiguous() => look(values, array.shape()),
            _ => look(&view.as_array().iter().copied().collect::<Vec<f64>>(), array.shape()),
        }
    }

    /// Applies `f` to each number.
    pub(crate) fn map(mut self, f: impl Fn(f64) -> f64) -> Self {
        self.values.iter_mut().for_each(|x| *x = f(*x));
        self
    }

    /// The numbers as a Python object: a float for a scalar, else an array of the same shape.
    pub(crate) fn into_python(self, py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
        if self.shape.is_empty() {
            return Ok(PyFloat::new(py, self.values[0]).into_any());
        }
        Ok(shaped(py, self.shape, self.values)?.into_any())
    }
}

/// Whether all elements are aligned in memory as float64 requires; those of packed structures and received buffers may not be.
fn is_aligned(array: &Bound<'_, PyArrayDyn<f64>>) -> bool {
    const SIZE: usize = size_of::<f64>();
    array.data().is_aligned() && array.strides().iter().all(|stride| stride.unsigned_abs() % SIZE == 0)
}

/// Number of values that are asked together, without a branch for each, whether all are finite.
const TOGETHER: usize = 256;

fn are_finite(values: &[f64]) -> bool {
    values.chunks(TOGETHER).all(|chunk| chunk.iter().fold(true, |all, x| all & x.is_finite()))
}

/// The error that names the first value that is not finite.
fn not_finite(name: &str, values: &[f64], shape: &[usize]) -> PyErr {
    let i = values.iter().position(|x| !x.is_finite()).unwrap_or(0);
    let at = place(i, shape);
    value(format!("{name}{at} = {} must be a finite number: cut it off or repair it", values[i]))
}

/// The place of an element in an array, for messages: `[3]` or `[1, 2]`.
pub(crate) fn place(mut index: usize, shape: &[usize]) -> String {
    let mut indices = Vec::new();
    for n in shape.iter().rev() {
        indices.insert(0, (index % n).to_string());
        index /= n;
    }
    if indices.is_empty() { String::new() } else { format!("[{}]", indices.join(", ")) }
}

/// An array of the given shape, made without a copy.
pub(crate) fn shaped(
    py: Python<'_>,
    shape: Vec<usize>,
    values: Vec<f64>,
) -> PyResult<Bound<'_, PyArrayDyn<f64>>> {
    let array = Array::from_shape_vec(IxDyn(&shape), values);
    Ok(array.map_err(|error| value(error.to_string()))?.into_pyarray(py))
}

/// Rows of complex numbers of one length as an array of rows x columns.
pub(crate) fn complex_rows<'py>(
    py: Python<'py>,
    rows: &[&[Complex64]],
) -> PyResult<Bound<'py, PyArray2<Complex64>>> {
    let columns = rows.first().map_or(0, |row| row.len());
    let array = Array2::from_shape_vec((rows.len(), columns), rows.concat());
    Ok(array.map_err(|error| value(error.to_string()))?.into_pyarray(py))
}

/// An array of one dimension, made without a copy.
pub(crate) fn array(py: Python<'_>, values: Vec<f64>) -> Py<PyArray1<f64>> {
    PyArray1::from_vec(py, values).unbind()
}

/// An array of equally long rows, read-only.
pub(crate) fn frozen_rows(py: Python<'_>, rows: &[Vec<f64>]) -> PyResult<Py<PyArray2<f64>>> {
    let columns = rows.first().map_or(0, Vec::len);
    let array = Array2::from_shape_vec((rows.len(), columns), rows.concat());
    let array = array.map_err(|error| value(error.to_string()))?.into_pyarray(py);
    freeze(array.as_any())?;
    Ok(array.unbind())
}

/// An array of three dimensions, read-only, made without a copy.
pub(crate) fn cube(py: Python<'_>, shape: [usize; 3], values: Vec<f64>) -> PyResult<Py<PyArray3<f64>>> {
    let array = Array3::from_shape_vec(shape, values);
    let array = array.map_err(|error| value(error.to_string()))?.into_pyarray(py);
    freeze(array.as_any())?;
    Ok(array.unbind())
}

/// Makes an array read-only.
pub(crate) fn freeze(array: &Bound<'_, PyAny>) -> PyResult<()> {
    array.call_method1(intern!(array.py(), "setflags"), (false,)).map(drop)
}
