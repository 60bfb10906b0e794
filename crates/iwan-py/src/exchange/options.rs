//! Arguments of Python that choose among options of the libraries.

use iwan_core::{Grid, Representation};
use iwan_input::scenario::MOST_SLIDERS;
use iwan_machine::memory::ask;
use iwan_machine::threads::at_once;
use iwan_sim::Method;
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::exchange::errors::{lacking, value};
use crate::exchange::named::Argument;

/// The representation of a joint: number of sliders (none: the continuum), and grid ("graded", "uniform" or the ratio of neighbouring
/// strengths). The caller supplies the grid for "graded" and for no grid at all, because a mode and a structure have different smallest
/// strengths.
pub(crate) fn representation_of(
    sliders: Option<usize>,
    grid: Option<&Bound<'_, PyAny>>,
    graded: fn(usize) -> Grid,
) -> PyResult<Representation> {
    let grid = grid.map(grid_of).transpose()?;
    let Some(bins) = sliders else { return Ok(Representation::Continuum) };
    if bins == 0 {
        return Err(value("sliders = 0 is out of range: at least 1, or None for the exact continuum"));
    }
    if bins > MOST_SLIDERS {
        return Err(value(format!(
            "sliders = {bins} is out of range: at most {MOST_SLIDERS}, or None for the exact continuum, which has no error of cutting"
        )));
    }
    Ok(Representation::Sliders { bins, grid: grid.flatten().unwrap_or_else(|| graded(bins)) })
}

/// The grid that was asked for; none for "graded".
fn grid_of(grid: &Bound<'_, PyAny>) -> PyResult<Option<Grid>> {
    if let Ok(name) = grid.cast::<PyString>() {
        let choices = [("graded", None), ("uniform", Some(Grid::Uniform))];
        return choose("grid", &name.to_string_lossy(), &choices);
    }
    let ratio = f64::read("grid", grid)?;
    if ratio > 1.0 && ratio.is_finite() {
        return Ok(Some(Grid::Geometric { ratio }));
    }
    Err(value(format!(
        "grid = {ratio} is out of range: 'graded', 'uniform', or the ratio of strengths, a finite number > 1"
    )))
}

/// The numerical parameters of a method.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MethodOptions {
    pub(crate) joint: Representation,
    pub(crate) prewarp: bool,
    pub(crate) beta: f64,
    pub(crate) gamma: f64,
}

/// The method with this name.
pub(crate) fn method(name: &str, options: MethodOptions) -> PyResult<Method> {
    let MethodOptions { joint, prewarp, beta, gamma } = options;
    match (name, joint) {
        ("newmark", joint) => Ok(Method::Newmark { beta, gamma, prewarp, joint }),
        ("half-cycle", _) => Ok(Method::HalfCycle),
        ("averaging", _) => Ok(Method::Averaging),
        ("event", Representation::Sliders { bins, grid }) => Ok(Method::Event { bins, grid }),
        ("event", Representation::Continuum) => {
            Err(value("method 'event' works on sliders: give a number of sliders"))
        }
        _ => Err(unknown("method", name, &["newmark", "half-cycle", "averaging", "event"])),
    }
}

/// The exception for a choice that does not exist.
pub(crate) fn unknown(argument: &str, given: &str, known: &[&str]) -> PyErr {
    value(format!("{argument} = '{given}' is not known: choose one of '{}'", known.join("', '")))
}

/// The choice with the given name.
pub(crate) fn choose<T: Copy>(argument: &str, given: &str, choices: &[(&str, T)]) -> PyResult<T> {
    let found = choices.iter().find(|(name, _)| *name == given);
    let names = || choices.iter().map(|(name, _)| *name).collect::<Vec<_>>();
    found.map(|(_, choice)| *choice).ok_or_else(|| unknown(argument, given, &names()))
}

/// Refuses what needs more memory than there is.
#[pyfunction]
pub(crate) fn _ask(what: &str, bytes: f64, remedy: &str) -> PyResult<()> {
    ask(what.to_owned(), bytes as u64, remedy).map_err(|short| lacking(&short))
}

/// Number of threads; all cores unless given.
pub(crate) fn thread_count(threads: Option<usize>) -> PyResult<usize> {
    match threads {
        Some(0) => Err(value("threads = 0 is out of range: at least 1, or None for all cores")),
        Some(threads) => Ok(threads),
        None => Ok(at_once()),
    }
}
