//! Identification, for `iwan.fit`: from records to parameters with intervals, curves and a verdict.

use std::path::PathBuf;
use std::sync::Arc;

use iwan_cli::{FittedMode, FittedRecord};
use iwan_ident::curves::{Curves, ForceAxis};
use iwan_ident::identify::{Held, Identification, ModeRecord, Settings, identify_until};
use iwan_ident::laws::{Backbone, CANDIDATES, FittedLaw};
use iwan_ident::profile::Profile;
use iwan_ident::signal::Options;
use iwan_ident::{Parameter, Verdict};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::exchange::arguments::{Call, in_python};
use crate::exchange::array::array;
use crate::exchange::errors::{computation, identification, value};
use crate::exchange::files::{kept, write};
use crate::exchange::named::{self, ByName, item};
use crate::exchange::options::{thread_count, unknown};
use crate::exchange::work::{self, Control};
use crate::records::envelope::{Envelope, method_named};
use crate::records::likelihood::Likelihood;
use crate::records::mode_records::{Modal, band_of_mode, modal, motion};

/// What was asked for, by the names of the arguments of `iwan.fit`.
pub(crate) struct Request<'py> {
    channel: Option<Bound<'py, PyAny>>,
    quantity: Option<String>,
    shape: Option<Vec<f64>>,
    mass: Option<f64>,
    band: Option<[f64; 2]>,
    near: Option<f64>,
    mode: Option<f64>,
    method: String,
    filter_order: usize,
    window: Option<[f64; 2]>,
    order: Option<usize>,
    hold: ByName<f64>,
}

impl<'py> Request<'py> {
    fn read(arguments: &Bound<'py, PyAny>) -> PyResult<Self> {
        Ok(Self {
            channel: item(arguments, "channel")?,
            quantity: item(arguments, "quantity")?,
            shape: item(arguments, "shape")?,
            mass: item(arguments, "mass")?,
            band: item(arguments, "band")?,
            near: item(arguments, "near")?,
            mode: item(arguments, "mode")?,
            method: item(arguments, "method")?,
            filter_order: item(arguments, "filter_order")?,
            window: item(arguments, "window")?,
            order: item(arguments, "order")?,
            hold: item(arguments, "hold")?,
        })
    }
}

impl Request<'_> {
    fn settings(&self) -> PyResult<Settings> {
        let parameter = |(name, held): &(String, f64)| {
            let found = Parameter::ALL.into_iter().find(|p| p.name() == name);
            let names = || Parameter::ALL.map(Parameter::name);
            found
                .map(|parameter| Held { parameter, value: *held })
                .ok_or_else(|| unknown("hold", name, &names()))
        };
        let held = self.hold.0.iter().map(parameter).collect::<PyResult<Vec<_>>>()?;
        let Self { near, filter_order, order, .. } = *self;
        let (band, window) = (self.band.map(Into::into), self.window.map(Into::into));
        let options = Options { band, near, filter_order, window, order, ..Options::default() };
        Ok(Settings { options, method: method_named(&self.method)?, held })
    }

    /// The records of one mode with these settings.
    fn task(&self, records: &[Bound<'_, PyAny>], settings: &Settings) -> PyResult<Task> {
        let mut settings = settings.clone();
        if let (Some(mode), Some(first)) = (self.mode, records.first()) {
            if self.band.is_some() || self.near.is_some() {
                return Err(value("mode goes without band and near: give one of them"));
            }
            settings.options.band = Some(band_of_mode(first, None, self.channel.as_ref(), mode)?);
        }
        let quantity = self.quantity.as_deref().map(motion).transpose()?;
        let shape = self.shape.as_deref();
        let mut records =
            modal(records, None, self.channel.as_ref(), quantity, shape, &settings.options, Call::Other)?;
        scale(&mut records, self.mass)?;
        settings.options.windowed = records.iter().any(|record| record.windowed);
        let mass_normalised = self.mass.is_some() || shape.is_some();
        Ok(Task { records, mass_normalised, settings })
    }
}

/// Records of one mode with the settings of their identification.
struct Task {
    records: Vec<Modal>,
    mass_normalised: bool,
    settings: Settings,
}

impl Task {
    fn run(self, control: &Control) -> Result<Identified, iwan_ident::Error> {
        let found = identify_until(&sources(&self.records), &self.settings, control.flag())?;
        let Self { records, mass_normalised, settings } = self;
        Ok(Identified(Arc::new(Made { records, mass_normalised, settings, found })))
    }
}

fn sources(records: &[Modal]) -> Vec<ModeRecord<'_>> {
    records.iter().map(|r| ModeRecord { samples: &r.samples, dt: r.dt, quantity: r.quantity }).collect()
}

/// An identification with its records and settings.
#[derive(Debug)]
pub(super) struct Made {
    records: Vec<Modal>,
    /// Whether the samples are multiplied by the square root of a modal mass.
    mass_normalised: bool,
    settings: Settings,
    pub(super) found: Identification,
}

/// What `iwan.Fit` is made of.
#[pyclass(frozen, module = "iwan._native", name = "_Identified")]
#[derive(Debug)]
pub(crate) struct Identified(pub(super) Arc<Made>);

/// Refuses the name of a law that is not in the list.
#[pyfunction]
pub(crate) fn _check_law(#[pyo3(from_py_with = named::law)] law: &str) -> PyResult<()> {
    let names: Vec<&str> = CANDIDATES.iter().map(|candidate| candidate.name).collect();
    if names.contains(&law) { Ok(()) } else { Err(unknown("law", law, &names)) }
}

/// Identifies a mode from its records at several force levels. `progress` is called from time to time, as a sign of life.
#[pyfunction]
#[pyo3(signature = (records, request, progress = None))]
pub(crate) fn _identify<'py>(
    py: Python<'py>,
    records: Vec<Bound<'py, PyAny>>,
    #[pyo3(from_py_with = Request::read)] request: Request<'py>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Identified> {
    let task = request.task(&records, &request.settings()?)?;
    work::watched(py, progress, move |control| task.run(control))?.map_err(identification)
}

/// Identifies many modes, each from its records, on threads: for each what was found, or the exception that says why not.
#[pyfunction]
#[pyo3(signature = (groups, request, *, threads, progress))]
pub(crate) fn _identify_many<'py>(
    py: Python<'py>,
    groups: Vec<Vec<Bound<'py, PyAny>>>,
    #[pyo3(from_py_with = Request::read)] request: Request<'py>,
    #[pyo3(from_py_with = named::threads)] threads: Option<usize>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let (settings, threads) = (request.settings()?, thread_count(threads)?);
    let tasks: Vec<_> = groups.iter().map(|records| request.task(records, &settings)).collect();
    let made = work::watched(py, progress, move |control| {
        work::each(tasks, threads, control, |task| task.map(|task| task.run(control)))
    })?;
    let entry = |made: PyResult<Result<Identified, iwan_ident::Error>>| -> PyResult<Bound<'py, PyAny>> {
        match made.and_then(|found| found.map_err(identification)) {
            Ok(identified) => Ok(Bound::new(py, identified)?.into_any()),
            Err(error) => Ok(error.into_value(py).into_bound(py).into_any()),
        }
    };
    made.unwrap_or_default().into_iter().map(entry).collect()
}

/// Mass-normalises the records of a point that moves with the modal mass `mass`.
fn scale(records: &mut [Modal], mass: Option<f64>) -> PyResult<()> {
    let Some(mass) = mass else { return Ok(()) };
    if !(mass > 0.0 && mass.is_finite()) {
        return Err(value(format!("mass = {mass} is out of range: a modal mass is a finite number > 0")));
    }
    for record in records {
        record.samples.iter_mut().for_each(|x| *x *= mass.sqrt());
    }
    Ok(())
}

#[pymethods]
impl Identified {
    /// Everything as a dict of plain values and arrays.
    fn told<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = named::force_axis)] force_axis: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (found, dict) = (&self.0.found, PyDict::new(py));
        six(&dict, &found.profiles.parameters, found.profiles.limit, &found.verdict)?;
        dict.set_item("dissipation_misfit", found.verdict.dissipation_misfit)?;
        dict.set_item("frequency_misfit", found.verdict.frequency_misfit)?;
        dict.set_item("relative_residual", found.refined.relative_residual)?;
        dict.set_item("joint_needed", !found.needs_no_joint())?;
        let said = |words: &String| in_python(words, Call::Other);
        let own = self.0.records.iter().flat_map(|record| &record.notes);
        dict.set_item("notes", own.chain(&found.notes).map(said).collect::<Vec<_>>())?;
        dict.set_item("words", found.in_words().iter().map(said).collect::<Vec<_>>())?;
        self.laws(&dict)?;
        dict.set_item("curves", self.curves(py, &found.curves, force_axis)?)?;
        dict.set_item("model_curves", self.curves(py, &found.model_curves, force_axis)?)?;
        let envelopes = found.envelopes.iter().zip(&self.0.records);
        let envelopes = envelopes
            .map(|(e, r)| Py::new(py, Envelope { curves: e.clone(), start: r.start, quantity: r.quantity }));
        dict.set_item("envelopes", envelopes.collect::<PyResult<Vec<_>>>()?)?;
        Ok(dict)
    }

    /// Writes the page of `iwan fit`.
    fn report(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = named::path)] path: PathBuf,
        #[pyo3(from_py_with = named::names)] names: Option<Vec<String>>,
        #[pyo3(from_py_with = named::force_axis)] force_axis: &str,
        #[pyo3(from_py_with = named::force)] force: bool,
    ) -> PyResult<()> {
        let (made, joint_force) = (self.0.clone(), force_axis == "joint");
        let names = self.called(names)?;
        let page = work::run(py, true, move |_| made.with(names, joint_force, iwan_cli::fit_page))?;
        let page = page.map_err(computation)?;
        write(py, &path, &page, force)
    }

    /// `fit.json` of `iwan fit`, for the law of that name; in a file, too, where one is named.
    fn json(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = named::path)] path: Option<PathBuf>,
        #[pyo3(from_py_with = named::names)] names: Option<Vec<String>>,
        #[pyo3(from_py_with = named::force_axis)] force_axis: &str,
        #[pyo3(from_py_with = named::law)] law: Option<String>,
        #[pyo3(from_py_with = named::force)] force: bool,
    ) -> PyResult<String> {
        let (made, joint_force) = (self.0.clone(), force_axis == "joint");
        let names = self.called(names)?;
        let json = move |mode: &FittedMode<'_>| iwan_cli::fit_json(mode, law.as_deref());
        let text = work::run(py, true, move |_| made.with(names, joint_force, json))?;
        kept(py, path.as_deref(), text.map_err(computation)?, force)
    }

    /// The likelihood of the records.
    fn likelihood(&self) -> Likelihood {
        let held: Vec<Parameter> = self.0.settings.held.iter().map(|h| h.parameter).collect();
        let free = Parameter::ALL.into_iter().filter(|p| !held.contains(p)).collect();
        Likelihood::new(self.0.found.likelihood.clone(), free)
    }
}

/// A fitted law as a dict, with the parameters that make a mode of it.
fn law<'py>(py: Python<'py>, l: &FittedLaw) -> PyResult<Bound<'py, PyDict>> {
    let (dict, parameters, intervals) = (PyDict::new(py), PyDict::new(py), PyDict::new(py));
    for p in &l.parameters {
        parameters.set_item(p.name, p.value)?;
        intervals.set_item(p.name, (p.low, p.high))?;
    }
    dict.set_item("name", l.law.name)?;
    dict.set_item("words", l.law.words)?;
    dict.set_item("criterion", l.criterion)?;
    dict.set_item("dissipation_misfit", l.dissipation_misfit)?;
    dict.set_item("frequency_misfit", l.frequency_misfit)?;
    dict.set_item("held_out_dissipation", l.held_out.map(|h| h.dissipation))?;
    dict.set_item("held_out_frequency", l.held_out.map(|h| h.frequency))?;
    dict.set_item("dissipation_discrepancy", l.discrepancy.0)?;
    dict.set_item("frequency_discrepancy", l.discrepancy.1)?;
    dict.set_item("grade", l.grade.name())?;
    dict.set_item("parameters", parameters)?;
    dict.set_item("intervals", intervals)?;
    Ok(dict)
}

/// Puts the six parameters with their intervals and profiles, and the verdict, into a dict.
pub(crate) fn six(dict: &Bound<'_, PyDict>, all: &[Profile], limit: f64, verdict: &Verdict) -> PyResult<()> {
    let py = dict.py();
    let (parameters, intervals, profiles) = (PyDict::new(py), PyDict::new(py), PyDict::new(py));
    for profile in all {
        let name = profile.parameter.name();
        parameters.set_item(name, profile.value)?;
        intervals.set_item(name, (profile.low, profile.high))?;
        let (values, deviances): (Vec<_>, Vec<_>) =
            profile.points.iter().map(|p| (p.value, p.deviance)).unzip();
        profiles.set_item(name, (array(py, values), array(py, deviances)))?;
    }
    dict.set_item("parameters", parameters)?;
    dict.set_item("intervals", intervals)?;
    dict.set_item("profiles", profiles)?;
    dict.set_item("limit", limit)?;
    dict.set_item("adequate", verdict.adequate)?;
    dict.set_item("grade", verdict.grade.name())?;
    dict.set_item("misfit", &verdict.misfit)
}

/// Smooth curves with bands as a dict.
fn backbone<'py>(py: Python<'py>, b: &Backbone) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    let columns = [
        ("amplitude", &b.amplitude),
        ("frequency", &b.frequency),
        ("damping_ratio", &b.damping_ratio),
        ("frequency_low", &b.frequency_low),
        ("frequency_high", &b.frequency_high),
        ("damping_ratio_low", &b.damping_ratio_low),
        ("damping_ratio_high", &b.damping_ratio_high),
    ];
    for (name, values) in columns {
        dict.set_item(name, array(py, values.clone()))?;
    }
    Ok(dict)
}

impl Made {
    /// What the command line makes of the fit, whose records have these names.
    fn with<T>(&self, names: Vec<String>, joint_force: bool, made: impl FnOnce(&FittedMode<'_>) -> T) -> T {
        let record = |(name, record): (String, &Modal)| FittedRecord {
            name,
            channels: record.channels.clone(),
            unit: record.unit.clone(),
            quantity: record.quantity,
            dt: record.dt,
            start: record.start,
            samples: record.samples.clone(),
        };
        let records: Vec<_> = names.into_iter().zip(&self.records).map(record).collect();
        made(&FittedMode {
            records: &records,
            settings: &self.settings,
            found: &self.found,
            notes: self.records.first().map_or(&[], |record| record.notes.as_slice()),
            mass_normalised: self.mass_normalised,
            joint_force,
        })
    }
}

impl Identified {
    /// Default names of the records, where the caller gave none.
    pub(super) fn names(&self) -> Vec<String> {
        match self.0.records.len() {
            1 => vec!["record".into()],
            count => (1..=count).map(|i| format!("record {i}")).collect(),
        }
    }

    /// The names that were given for the records, one for each, or what they are called without.
    fn called(&self, names: Option<Vec<String>>) -> PyResult<Vec<String>> {
        let Some(names) = names else { return Ok(self.names()) };
        let (given, records) = (names.len(), self.0.records.len());
        if given == records {
            return Ok(names);
        }
        Err(value(format!("names has {given} entries for {records} records: give one for each")))
    }

    /// What the comparison of laws found, or why there is none.
    fn laws(&self, dict: &Bound<'_, PyDict>) -> PyResult<()> {
        let py = dict.py();
        match &self.0.found.laws {
            Ok(laws) => {
                dict.set_item("law", laws.chosen().law.name)?;
                dict.set_item("law_words", laws.in_words())?;
                dict.set_item("backbone", backbone(py, &laws.backbone)?)?;
                let all = laws.laws.iter().map(|l| law(py, l)).collect::<PyResult<Vec<_>>>()?;
                dict.set_item("laws", all)
            }
            Err(error) => {
                dict.set_item("law", py.None())?;
                dict.set_item(
                    "law_words",
                    in_python(&format!("laws were not compared: {error}"), Call::Other),
                )?;
                dict.set_item("backbone", PyDict::new(py))?;
                dict.set_item("laws", Vec::<Bound<'_, PyDict>>::new())
            }
        }
    }

    /// Curves of all records, joined one after the other, with the force axis that was asked for.
    fn curves<'py>(&self, py: Python<'py>, all: &[Curves], force_axis: &str) -> PyResult<Bound<'py, PyDict>> {
        let p = &self.0.found.parameters;
        let axis = match force_axis {
            "modal" => ForceAxis::Modal,
            "joint" => ForceAxis::Joint { frequency: p.frequency, k_t: p.k_t },
            other => return Err(unknown("force_axis", other, &["modal", "joint"])),
        };
        let all = all.iter().map(|c| c.clone().on_axis(axis));
        let all = all.collect::<Result<Vec<_>, _>>().map_err(identification)?;
        let joined =
            |f: &dyn Fn(&Curves) -> &[f64]| array(py, all.iter().flat_map(|c| f(c).to_vec()).collect());
        let each = |f: &dyn Fn(usize, &Curves) -> Vec<f64>| {
            array(py, all.iter().enumerate().flat_map(|(i, c)| f(i, c)).collect())
        };
        let start = |i: usize| self.0.records[i].start;
        let dict = PyDict::new(py);
        dict.set_item("record", each(&|i, c| vec![i as f64; c.t.len()]))?;
        dict.set_item("t", each(&|i, c| c.t.iter().map(|t| start(i) + t).collect()))?;
        dict.set_item("displacement", joined(&|c| &c.displacement))?;
        dict.set_item("frequency", joined(&|c| &c.frequency))?;
        dict.set_item("damping_ratio", joined(&|c| &c.damping_ratio))?;
        dict.set_item("dissipation", joined(&|c| &c.dissipation))?;
        dict.set_item("force", joined(&|c| &c.force))?;
        dict.set_item("frequency_sd", joined(&|c| &c.frequency_sd))?;
        dict.set_item("log_dissipation_sd", joined(&|c| &c.log_dissipation_sd))?;
        Ok(dict)
    }
}
