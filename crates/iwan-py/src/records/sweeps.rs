//! Shaker's tests: responses and backbones in, parameters with intervals out. `iwan.fit(sweeps=)` is its face.

use std::path::PathBuf;

use iwan_cli::{SweepKind, SweepSource, sweep_data};
use iwan_ident::Parameter;
use iwan_ident::sweeps::{SteadyData, SteadyFit, fit_steady};
use iwan_io::ReadError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exchange::array::{Numbers, array};
use crate::exchange::errors::{identification, reading, record, value};
use crate::exchange::options::unknown;
use crate::exchange::work;
use crate::records::identified::{Identified, six};

/// A path, or a name with columns by name.
#[derive(FromPyObject)]
pub(crate) enum Source<'py> {
    Columns(String, Vec<(String, Bound<'py, PyAny>)>),
    File(PathBuf),
}

impl Source<'_> {
    fn data(self, kind: SweepKind, mass: f64, levels: &[f64]) -> PyResult<SteadyData> {
        let source = match self {
            Self::File(path) => {
                if let Err(source) = std::fs::metadata(&path) {
                    return Err(reading(&ReadError::Io { file: path, source }));
                }
                SweepSource::File(path)
            }
            Self::Columns(name, columns) => {
                let columns = columns
                    .into_iter()
                    .map(|(column, values)| Ok((Numbers::vector(&column, &values)?, column)))
                    .map(|found: PyResult<_>| found.map(|(values, column)| (column, values)))
                    .collect::<PyResult<Vec<_>>>()?;
                let rows = columns.first().map_or(0, |column| column.1.len());
                if let Some((column, values)) = columns.iter().find(|column| column.1.len() != rows) {
                    return Err(value(format!(
                        "{name}: {column} has {} entries, {} has {rows}: they must agree",
                        values.len(),
                        columns[0].0
                    )));
                }
                SweepSource::Columns { name, columns }
            }
        };
        sweep_data(source, kind, mass, levels).map_err(record)
    }
}

/// The parameters of a mode from responses and backbones, with identified ring-downs or without, as a dict.
#[pyfunction]
pub(crate) fn _fit_sweeps<'py>(
    py: Python<'py>,
    sweeps: Vec<Source<'py>>,
    backbones: Vec<Source<'py>>,
    levels: Vec<f64>,
    mass: Option<f64>,
    hold: Vec<(String, f64)>,
    ring_downs: Option<&Bound<'py, Identified>>,
) -> PyResult<Bound<'py, PyDict>> {
    let mass = mass.unwrap_or(1.0);
    if !(mass > 0.0 && mass.is_finite()) {
        return Err(value(format!("mass = {mass} is out of range: must be a finite number > 0")));
    }
    if let Some(level) = levels.iter().find(|level| !(**level > 0.0 && level.is_finite())) {
        return Err(value(format!("levels: {level} is out of range: a force must be a finite number > 0")));
    }
    let held = |(name, held): (String, f64)| {
        let names = || Parameter::ALL.map(Parameter::name);
        let found = Parameter::ALL.into_iter().find(|p| p.name() == name);
        found.map(|parameter| (parameter, held)).ok_or_else(|| unknown("hold", &name, &names()))
    };
    let hold = hold.into_iter().map(held).collect::<PyResult<Vec<_>>>()?;
    let responses = sweeps.into_iter().map(|source| source.data(SweepKind::Response, mass, &levels));
    let backbones = backbones.into_iter().map(|source| source.data(SweepKind::Backbone, mass, &[]));
    let data = responses.chain(backbones).collect::<PyResult<Vec<_>>>()?;
    let likelihood = ring_downs.map(|found| found.get().0.found.likelihood.clone());
    let found = work::run(py, true, move |_| fit_steady(&data, likelihood.as_ref(), &hold))?;
    told(py, &found.map_err(identification)?)
}

fn told<'py>(py: Python<'py>, found: &SteadyFit) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    six(&dict, &found.profiles, found.limit, &found.verdict)?;
    dict.set_item("slips", found.slips)?;
    dict.set_item("drifts", array(py, found.drifts.clone()))?;
    dict.set_item("errors", found.errors.iter().map(|e| (e[0], e[1])).collect::<Vec<_>>())?;
    dict.set_item("other_modes", found.others)?;
    dict.set_item("informed", (found.informed[0], found.informed[1]))?;
    Ok(dict)
}
