//! Modes that may share joints, from records of several modes at once: `iwan.fit_coupled`.

use std::path::PathBuf;
use std::sync::Arc;

use iwan_cli::{CoupledTest, ModesSought, StruckRecord};
use iwan_core::Backbone;
use iwan_ident::coupled::{CoupledFit, Sharing};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use serde_json::json;

use crate::exchange::arguments::{Call, in_python};
use crate::exchange::array::{Numbers, array, frozen_rows};
use crate::exchange::errors::{identification_of, value_of};
use crate::exchange::files::{kept, write};
use crate::exchange::named::{self, item};
use crate::exchange::options::thread_count;
use crate::exchange::work;
use crate::records::envelope::method_named;
use crate::records::mode_records::motion;
use crate::records::record::Record;

/// The count that progress reaches at the end.
const PARTS: f64 = 1000.0;

/// A record with its name and its force.
type Given<'py> = (String, Bound<'py, Record>, Option<Bound<'py, PyAny>>);

/// Which modes are wanted, by the names of the arguments of `iwan.fit_coupled`.
pub(crate) struct Asked {
    quantity: Option<String>,
    shapes: Option<Vec<Vec<f64>>>,
    frequencies: Option<Vec<f64>>,
    bands: Vec<[f64; 2]>,
    near: Vec<f64>,
    method: String,
    shape_at_force: Option<Vec<f64>>,
    threads: Option<usize>,
}

impl Asked {
    fn read(arguments: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self {
            quantity: item(arguments, "quantity")?,
            shapes: item(arguments, "shapes")?,
            frequencies: item(arguments, "frequencies")?,
            bands: item(arguments, "bands")?,
            near: item(arguments, "near")?,
            method: item(arguments, "method")?,
            shape_at_force: item(arguments, "shape_at_force")?,
            threads: item(arguments, "threads")?,
        })
    }
}

/// Modes with their joints, and the records they were found in: what `iwan.CoupledFit` is made of.
#[pyclass(frozen, module = "iwan._native", name = "_FittedCoupled")]
#[derive(Debug)]
pub(crate) struct FittedCoupled(Arc<(CoupledTest, CoupledFit)>);

/// Fits records with their forces, and predicts others.
#[pyfunction]
pub(crate) fn _fit_coupled(
    py: Python<'_>,
    records: Vec<Given<'_>>,
    held_out: Vec<Given<'_>>,
    #[pyo3(from_py_with = Asked::read)] asked: Asked,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<FittedCoupled> {
    let quantity = asked.quantity.as_deref();
    let read = |given: Vec<Given<'_>>| {
        given.into_iter().map(|one| struck(py, one, quantity)).collect::<PyResult<Vec<_>>>()
    };
    let (records, held_out) = (read(records)?, read(held_out)?);
    let Asked { shapes, frequencies, bands, near, method, shape_at_force, threads, .. } = asked;
    let sought = ModesSought {
        shapes,
        frequencies,
        bands: bands.into_iter().map(Into::into).collect(),
        near,
        method: method_named(&method)?,
    };
    let threads = thread_count(threads)?;
    let found = work::watched(py, progress, move |control| {
        let test = CoupledTest::new(records, held_out, sought).map_err(Fault::Given)?;
        let told = |share: f64| control.report((share * PARTS) as usize);
        let fit = test.fit(shape_at_force.as_deref(), threads, control.flag(), &told);
        fit.map(|fit| (test, fit)).map_err(Fault::Fit)
    })?;
    match found {
        Ok(made) => Ok(FittedCoupled(Arc::new(made))),
        Err(Fault::Given(message)) => Err(value_of(Call::SeveralModes, &message)),
        Err(Fault::Fit(error)) => Err(identification_of(Call::SeveralModes, "", error)),
    }
}

/// Why there is no fit.
enum Fault {
    Given(String),
    Fit(iwan_ident::Error),
}

fn struck(
    py: Python<'_>,
    (name, record, force): Given<'_>,
    quantity: Option<&str>,
) -> PyResult<StruckRecord> {
    let (quantity, warnings) = record.get().motion(quantity.map(motion).transpose()?, Call::SeveralModes)?;
    let force = force.map(|force| Numbers::vector("forces", &force)).transpose()?;
    let (record, windowed) = (record.get().whole(py)?, record.get().windowed);
    Ok(StruckRecord { name, record, quantity, warnings, windowed, force })
}

#[pymethods]
impl FittedCoupled {
    /// `fit.json` of the command with arguments in place of its options, and the numbers of the chosen model.
    fn told(&self) -> (String, String) {
        let (test, fit) = &*self.0;
        let best = fit.best();
        let v = &best.values;
        let laws: Vec<[f64; 4]> = v
            .laws
            .iter()
            .map(|law| [law.initial_stiffness(), law.slip_force(), law.chi(), law.beta()])
            .collect();
        let values = json!({
            "modes": test.modes(),
            "linear": best.sharing == Sharing::Linear,
            "frequency": v.frequency,
            "damping_ratio": v.damping_ratio,
            "shape_at_force": v.shape_at_force,
            "shape_at_sensor": v.shape_at_sensor,
            "laws": laws,
            "participation": v.participation,
            "compliance": v.compliance,
            "slip_at_force": v.slip_at_force,
        });
        (in_python(&test.json(fit), Call::SeveralModes), values.to_string())
    }

    /// `fit.json` of the command; in a file, too, where one is named.
    fn json(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = named::path)] path: Option<PathBuf>,
        #[pyo3(from_py_with = named::force)] force: bool,
    ) -> PyResult<String> {
        kept(py, path.as_deref(), self.0.0.json(&self.0.1), force)
    }

    /// What was measured and what the chosen model shows: series x samples of each record, those fitted and then those kept out.
    fn motions(&self, py: Python<'_>) -> PyResult<Vec<[Py<PyArray2<f64>>; 2]>> {
        let (test, fit) = &*self.0;
        let pairs = test.motions().into_iter().zip(&fit.best().motions);
        pairs.map(|(own, model)| Ok([frozen_rows(py, &own)?, frozen_rows(py, model)?])).collect()
    }

    /// Displacement and velocity of each mode where the records fitted begin: two arrays for each.
    fn initial(&self, py: Python<'_>) -> Vec<[Py<PyArray1<f64>>; 2]> {
        let of = |modes: &Vec<[f64; 2]>| {
            std::array::from_fn(|i| array(py, modes.iter().map(|motion| motion[i]).collect()))
        };
        self.0.1.best().values.initial.iter().map(of).collect()
    }

    /// Writes the page of `iwan fit --coupled`, whole or not at all.
    fn report(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = named::path)] path: PathBuf,
        #[pyo3(from_py_with = named::force)] force: bool,
    ) -> PyResult<()> {
        let made = self.0.clone();
        let page = work::run(py, true, move |_| made.0.page(&made.1))?;
        write(py, &path, &page, force)
    }
}
