//! Shaker tests, for `iwan.fit(sweeps=)`: from responses and backbones to parameters with intervals.

use std::path::PathBuf;
use std::sync::Arc;

use iwan_cli::{SweepKind, SweepSource, SweepTest};
use iwan_ident::Parameter;
use iwan_ident::sweeps::SteadyFit;
use iwan_io::ReadError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exchange::arguments::Call;
use crate::exchange::array::{Numbers, array};
use crate::exchange::errors::{computation, identification, reading, record, value};
use crate::exchange::files::{kept, write};
use crate::exchange::named::{self, Argument, ByName};
use crate::exchange::options::unknown;
use crate::exchange::work;
use crate::records::identified::{Identified, six};

/// A path of a file, or a name with columns by their names.
pub(crate) enum Source<'py> {
    Columns(String, Vec<(String, Bound<'py, PyAny>)>),
    File(PathBuf),
}

impl<'py> Argument<'_, 'py> for Source<'py> {
    fn read(name: &str, given: &Bound<'py, PyAny>) -> PyResult<Self> {
        match given.extract() {
            Ok((source, columns)) => Ok(Self::Columns(source, columns)),
            Err(_) => PathBuf::read(name, given).map(Self::File),
        }
    }
}

impl Source<'_> {
    fn read(self) -> PyResult<SweepSource> {
        match self {
            Self::File(path) => match std::fs::metadata(&path) {
                Ok(_) => Ok(SweepSource::File(path)),
                Err(source) => Err(reading(Call::File, &ReadError::Io { file: path, source })),
            },
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
                Ok(SweepSource::Columns { name, columns })
            }
        }
    }
}

/// A fitted test: what `iwan.SweepFit` is made of.
#[pyclass(frozen, module = "iwan._native", name = "_FittedSweeps")]
#[derive(Debug)]
pub(crate) struct FittedSweeps(Arc<(SweepTest, SteadyFit)>);

/// The parameters of a mode from responses and backbones, with identified ring-downs or without. `progress` is called from time to time.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the arguments of a function of Python, and who hears of it")]
pub(crate) fn _fit_sweeps<'py>(
    py: Python<'py>,
    #[pyo3(from_py_with = named::sweeps)] sweeps: Vec<Source<'py>>,
    #[pyo3(from_py_with = named::backbones)] backbones: Vec<Source<'py>>,
    #[pyo3(from_py_with = named::levels)] levels: Vec<f64>,
    #[pyo3(from_py_with = named::mass)] mass: Option<f64>,
    #[pyo3(from_py_with = named::hold)] hold: ByName<f64>,
    ring_downs: Option<&Bound<'py, Identified>>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<FittedSweeps> {
    if let Some(mass) = mass.filter(|mass| !(*mass > 0.0 && mass.is_finite())) {
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
    let hold = hold.0.into_iter().map(held).collect::<PyResult<Vec<_>>>()?;
    let responses = sweeps.into_iter().map(|source| (SweepKind::Response, source));
    let backbones = backbones.into_iter().map(|source| (SweepKind::Backbone, source));
    let sources = responses.chain(backbones).map(|(kind, source)| Ok((kind, source.read()?)));
    let sources = sources.collect::<PyResult<Vec<_>>>()?;
    let ring_downs = ring_downs.map(|found| (found.get().names(), &found.get().0.found));
    let test = SweepTest::read(sources, mass, &levels, ring_downs).map_err(record)?;
    let (test, fit) = work::watched(py, progress, move |_| {
        let fit = test.fit(&hold);
        (test, fit)
    })?;
    Ok(FittedSweeps(Arc::new((test, fit.map_err(identification)?))))
}

#[pymethods]
impl FittedSweeps {
    /// Everything as a dict of plain values and arrays.
    fn told<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (dict, found) = (PyDict::new(py), &self.0.1);
        six(&dict, &found.profiles, found.limit, &found.verdict)?;
        dict.set_item("slips", found.slips)?;
        dict.set_item("drifts", array(py, found.drifts.clone()))?;
        dict.set_item("errors", found.errors.iter().map(|e| (e[0], e[1])).collect::<Vec<_>>())?;
        dict.set_item("other_modes", found.others)?;
        dict.set_item("informed", (found.informed[0], found.informed[1]))?;
        Ok(dict)
    }

    /// `fit.json` of `iwan fit`; in a file, too, where one is named.
    fn json(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = named::path)] path: Option<PathBuf>,
        #[pyo3(from_py_with = named::force)] force: bool,
    ) -> PyResult<String> {
        let made = self.0.clone();
        let text = work::run(py, true, move |_| made.0.json(&made.1))?;
        kept(py, path.as_deref(), text.map_err(computation)?, force)
    }

    /// Writes the page of `iwan fit`, whole or not at all.
    fn report(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = named::path)] path: PathBuf,
        #[pyo3(from_py_with = named::force)] force: bool,
    ) -> PyResult<()> {
        let made = self.0.clone();
        let page = work::run(py, true, move |_| made.0.page(&made.1))?.map_err(computation)?;
        write(py, &path, &page, force)
    }
}
