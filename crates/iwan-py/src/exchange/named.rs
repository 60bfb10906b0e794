//! Arguments by their names: what an argument cannot be is refused by an error of `iwan.errors` that says which argument it was, what was
//! given and what is wanted.

use std::path::PathBuf;

use pyo3::PyClass;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyBytes, PyFloat, PyInt, PyMapping, PyString};

use crate::exchange::array::{Numbers, shaped};
use crate::exchange::errors::{value, wrong_type};

/// What an argument may be converted to.
pub(crate) trait Argument<'a, 'py>: Sized {
    /// The argument `name`, or why it cannot be taken.
    fn read(name: &str, given: &'a Bound<'py, PyAny>) -> PyResult<Self>;
}

/// The number given for an argument of a function that is written in Python.
#[pyfunction]
pub(crate) fn _number(name: &str, given: &Bound<'_, PyAny>) -> PyResult<f64> {
    f64::read(name, given)
}

/// The whole number >= 0 given for an argument.
#[pyfunction]
pub(crate) fn _whole(name: &str, given: &Bound<'_, PyAny>) -> PyResult<usize> {
    usize::read(name, given)
}

/// The real numbers given for an argument, a float64 array of the same shape.
#[pyfunction]
pub(crate) fn _numbers<'py>(name: &str, given: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let Numbers { values, shape } = Numbers::read(name, given)?;
    Ok(shaped(given.py(), shape, values)?.into_any())
}

/// Functions that read the argument of their own name, for `from_py_with`.
macro_rules! arguments {
    ($($name:ident)*) => {
        $(pub(crate) fn $name<'a, 'py, T: Argument<'a, 'py>>(given: &'a Bound<'py, PyAny>) -> PyResult<T> {
            T::read(stringify!($name), given)
        })*
    };
}

/// An item of a dict that holds the arguments of a function by their names.
pub(crate) fn item<'py, T: for<'a> Argument<'a, 'py>>(
    arguments: &Bound<'py, PyAny>,
    name: &str,
) -> PyResult<T> {
    T::read(name, &arguments.get_item(name)?)
}

/// The name of an object's type.
fn kind(given: &Bound<'_, PyAny>) -> String {
    given.get_type().name().map_or_else(|_| "an object".into(), |name| name.to_string())
}

/// The number as Python writes it; the length of those with thousands of digits is enough.
fn shown(given: &Bound<'_, PyAny>) -> String {
    const MOST: usize = 40;
    match given.str().map(|text| text.to_string()) {
        Ok(text) if text.len() <= MOST => text,
        _ => "a number with more than 40 characters".into(),
    }
}

impl<'a, 'py> Argument<'a, 'py> for f64 {
    fn read(name: &str, given: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        if let Ok(number) = given.cast::<PyFloat>() {
            return Ok(number.value());
        }
        let wrong = || wrong_type(format!("{name} must be a real number, not {}", kind(given)));
        if given.is_instance_of::<PyBool>() || given.is_instance_of::<PyString>() {
            return Err(wrong());
        }
        if given.is_instance_of::<PyInt>() {
            let wide = |_| {
                value(format!("{name} = {} is out of range: beyond the numbers of 64 bits", shown(given)))
            };
            return given.extract().map_err(wide);
        }
        if given.hasattr("dtype")? {
            let numbers = Numbers::read(name, given)?;
            return match numbers.values[..] {
                [number] if numbers.shape.is_empty() => Ok(number),
                _ => Err(wrong_type(format!(
                    "{name} must be one number, not an array of the shape {:?}",
                    numbers.shape
                ))),
            };
        }
        given.extract().map_err(|_| wrong())
    }
}

impl<'a, 'py> Argument<'a, 'py> for usize {
    fn read(name: &str, given: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        let wrong = || wrong_type(format!("{name} must be a whole number, not {}", kind(given)));
        if given.is_instance_of::<PyBool>() {
            return Err(wrong());
        }
        // Whatever counts as an integer for Python, such as those of NumPy.
        let number = given.call_method0("__index__").map_err(|_| wrong())?;
        number.extract().map_err(|_| {
            value(format!(
                "{name} = {} is out of range: a whole number from 0 to {}",
                shown(&number),
                isize::MAX
            ))
        })
    }
}

impl<'a, 'py> Argument<'a, 'py> for bool {
    fn read(name: &str, given: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        given.extract().map_err(|_| wrong_type(format!("{name} must be True or False, not {}", kind(given))))
    }
}

impl<'a, 'py> Argument<'a, 'py> for &'a str {
    fn read(name: &str, given: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        let text = given.cast::<PyString>();
        let text = text.map_err(|_| wrong_type(format!("{name} must be a str, not {}", kind(given))))?;
        text.to_str().map_err(|_| {
            value(format!("{name} holds half of a character: text of whole characters is wanted"))
        })
    }
}

impl<'a, 'py> Argument<'a, 'py> for String {
    fn read(name: &str, given: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        <&str>::read(name, given).map(str::to_owned)
    }
}

impl<'a, 'py> Argument<'a, 'py> for PathBuf {
    fn read(name: &str, given: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        given.extract().map_err(|_| {
            wrong_type(format!("{name} must be a path, a str or os.PathLike, not {}", kind(given)))
        })
    }
}

impl<'a, 'py, T: Argument<'a, 'py>> Argument<'a, 'py> for Option<T> {
    fn read(name: &str, given: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        if given.is_none() { Ok(None) } else { T::read(name, given).map(Some) }
    }
}

impl<'py> Argument<'_, 'py> for Bound<'py, PyAny> {
    fn read(_: &str, given: &Bound<'py, PyAny>) -> PyResult<Self> {
        Ok(given.clone())
    }
}

/// Classes of the package that arguments may be instances of.
pub(crate) trait Instance: PyClass {}

impl<'py, T: Instance> Argument<'_, 'py> for Bound<'py, T> {
    fn read(name: &str, given: &Bound<'py, PyAny>) -> PyResult<Self> {
        let wrong = || wrong_type(format!("{name} must be an iwan.{}, not {}", T::NAME, kind(given)));
        given.cast::<T>().cloned().map_err(|_| wrong())
    }
}

impl<'py, T: for<'b> Argument<'b, 'py>> Argument<'_, 'py> for Vec<T> {
    fn read(name: &str, given: &Bound<'py, PyAny>) -> PyResult<Self> {
        let wrong = || wrong_type(format!("{name} must be a sequence, such as a list, not {}", kind(given)));
        // Texts and bytes are no lists of their letters, mappings none of their names.
        if given.is_instance_of::<PyString>()
            || given.is_instance_of::<PyBytes>()
            || given.is_instance_of::<PyMapping>()
        {
            return Err(wrong());
        }
        let items = given.try_iter().map_err(|_| wrong())?;
        items.enumerate().map(|(i, one)| T::read(&format!("{name}[{i}]"), &one?)).collect()
    }
}

impl<'py, const N: usize> Argument<'_, 'py> for [f64; N] {
    fn read(name: &str, given: &Bound<'py, PyAny>) -> PyResult<Self> {
        let numbers = Vec::<f64>::read(name, given)?;
        let n = numbers.len();
        numbers.try_into().map_err(|_| value(format!("{name} has {n} numbers: give {N}")))
    }
}

/// What stands together in a tuple, one after the other.
macro_rules! tuple {
    ($count:literal: $($part:ident $place:tt),*) => {
        impl<'py, $($part: for<'b> Argument<'b, 'py>),*> Argument<'_, 'py> for ($($part,)*) {
            fn read(name: &str, given: &Bound<'py, PyAny>) -> PyResult<Self> {
                let parts = Vec::<Bound<'py, PyAny>>::read(name, given)?;
                if parts.len() != $count {
                    return Err(value(format!("{name} has {} parts: give {}", parts.len(), $count)));
                }
                Ok(($($part::read(&format!("{name}[{}]", $place), &parts[$place])?,)*))
            }
        }
    };
}

tuple!(2: A 0, B 1);
tuple!(3: A 0, B 1, C 2);
tuple!(5: A 0, B 1, C 2, D 3, E 4);
tuple!(7: A 0, B 1, C 2, D 3, E 4, F 5, G 6);

/// Values by their names, of any mapping.
pub(crate) struct ByName<T>(pub(crate) Vec<(String, T)>);

impl<'py, T: for<'b> Argument<'b, 'py>> Argument<'_, 'py> for ByName<T> {
    fn read(name: &str, given: &Bound<'py, PyAny>) -> PyResult<Self> {
        let wrong = || {
            wrong_type(format!("{name} must be a mapping from names, such as a dict, not {}", kind(given)))
        };
        let pairs = given.cast::<PyMapping>().map_err(|_| wrong())?.items()?;
        let one = |pair: Bound<'py, PyAny>| {
            let (key, one) = (pair.get_item(0)?, pair.get_item(1)?);
            let key = String::read(&format!("a name in {name}"), &key)?;
            let one = T::read(&format!("{name}['{key}']"), &one)?;
            Ok((key, one))
        };
        pairs.iter().map(one).collect::<PyResult<_>>().map(Self)
    }
}

arguments! {
    allow_negative_residual amplitude at backbones band basis beta built_in c channels chi compliance control correct
    count curves damping_ratio dirac direction dt duration exponent extrapolate f_s filter_order first
    folder force force_axis format frequency gamma gap groups harmonics hold joint k k_t keep largest law levels
    mass method mode model modes n name names near order outputs participation parts path phi_max points
    prewarp quality quantity r rate reduced resample responses s shape shape_at_force sliders slip_at_force
    start stop sweeps text theta threads time time_unit tolerance undamped unit velocity width window
}
