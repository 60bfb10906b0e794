//! Modes from hammer hits, for `iwan.modal_fit`.

use iwan_machine::{Kind, listed};
use iwan_modal::measure::{Channel, Fault, Freedom, Hit, Motion, faults};
use iwan_modal::responses::{Estimator, FrequencyResponses, Windows, free_responses, frequency_responses};
use iwan_modal::{Analysis, Error, ModalFit, each_of, modal_fit, modal_fit_by_subspaces};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::exchange::array::{Numbers, array, complex_rows};
use crate::exchange::errors::{identification_failed, of, value};
use crate::exchange::named::item;
use crate::exchange::options::choose;
use crate::exchange::work;

/// What the hits were, and how they are looked at.
pub(crate) struct Request {
    dt: f64,
    /// None: the channels are counted from 0.
    names: Option<Vec<String>>,
    force_at: Option<String>,
    quantity: String,
    estimator: String,
    decay: f64,
    whole_force: bool,
    band: Option<[f64; 2]>,
    method: String,
    order: usize,
    poles: Option<Vec<f64>>,
    add_poles: Vec<f64>,
    drop_poles: Vec<f64>,
}

impl Request {
    fn read(arguments: &Bound<'_, PyAny>) -> PyResult<Self> {
        Ok(Self {
            dt: item(arguments, "dt")?,
            names: item(arguments, "names")?,
            force_at: item(arguments, "force_at")?,
            quantity: item(arguments, "quantity")?,
            estimator: item(arguments, "estimator")?,
            decay: item(arguments, "decay")?,
            whole_force: item(arguments, "whole_force")?,
            band: item(arguments, "band")?,
            method: item(arguments, "method")?,
            order: item(arguments, "order")?,
            poles: item(arguments, "poles")?,
            add_poles: item(arguments, "add_poles")?,
            drop_poles: item(arguments, "drop_poles")?,
        })
    }
}

/// The measurement: hits with a force, or free decays.
enum Measured {
    Hits(Vec<Hit>),
    /// The channels of each decay.
    Decays(Vec<Vec<Channel>>),
}

impl Measured {
    /// The hits; empty for free decays.
    fn hits(&self) -> &[Hit] {
        match self {
            Self::Hits(hits) => hits,
            Self::Decays(_) => &[],
        }
    }
}

/// Modes of hits (or of free decays, without forces): a dict.
#[pyfunction]
pub(crate) fn _modal_fit<'py>(
    py: Python<'py>,
    forces: Option<&Bound<'py, PyAny>>,
    responses: &Bound<'py, PyAny>,
    #[pyo3(from_py_with = Request::read)] request: Request,
) -> PyResult<Bound<'py, PyDict>> {
    let motions = [
        ("acceleration", Motion::Acceleration),
        ("velocity", Motion::Velocity),
        ("displacement", Motion::Displacement),
    ];
    let motion = choose("quantity", &request.quantity, &motions)?;
    let estimators = [("h1", Estimator::H1), ("h2", Estimator::H2), ("hv", Estimator::Hv)];
    let estimator = choose("estimator", &request.estimator, &estimators)?;
    let ways = [
        ("chart", Analysis::Chart),
        ("isolation", Analysis::Isolation),
        // The poles of this method come from the samples, not from the frequency responses.
        ("subspace", Analysis::Chart),
    ];
    let given = request.poles.clone().unwrap_or_default();
    let subspaces = request.poles.is_none() && request.method == "subspace";
    if subspaces && forces.is_some() {
        return Err(value("method = \"subspace\" is for free decays: give force = None"));
    }
    let way = match request.poles.clone() {
        Some(poles) => Analysis::Given(poles),
        None => {
            ways.iter().find(|(name, _)| *name == request.method).map(|(_, way)| way.clone()).ok_or_else(
                || {
                    value(format!(
                        "method = \"{}\" must be \"chart\", \"isolation\" or \"subspace\"",
                        request.method
                    ))
                },
            )?
        }
    };
    let channels = channels(responses, request.names.as_deref())?;
    let measured = match forces {
        Some(forces) => Measured::Hits(hits(forces, channels, &request)?),
        None => Measured::Decays(channels),
    };
    let whole_force = request.whole_force;
    let words = each_of(measured.hits(), |hit| judged(hit, whole_force));
    let words = words.into_iter().collect::<Result<Vec<_>, String>>();
    let words = words.map_err(|message| of(Kind::Refused, identification_failed(message)))?.concat();
    let (dt, decay, order) = (request.dt, request.decay, request.order);
    let band = request.band.map(Into::into);
    let (added, dropped) = (request.add_poles, request.drop_poles);
    let found = work::run(py, true, move |_| -> Result<(FrequencyResponses, ModalFit), Error> {
        let responses = match &measured {
            Measured::Hits(hits) => {
                frequency_responses(hits, motion, estimator, Windows { decay, whole_force })?
            }
            Measured::Decays(decays) => free_responses(decays, dt, motion)?,
        };
        let fit = match &measured {
            Measured::Decays(decays) if subspaces => {
                modal_fit_by_subspaces(&responses, decays, dt, band, order)?
            }
            _ => modal_fit(&responses, band, &way, order)?,
        };
        let fit = if added.is_empty() && dropped.is_empty() {
            fit
        } else {
            fit.overruled(&responses, &added, &dropped)?
        };
        let fit = match &measured {
            Measured::Hits(hits) if decay == 0.0 => {
                fit.scaled_at_begin(hits, motion, estimator, whole_force)?
            }
            _ => fit,
        };
        Ok((responses, fit))
    })?;
    let (responses, fit) = found.map_err(|e| told_error(&e))?;
    told(py, &responses, &fit, &given, words)
}

/// Faults of a hit in words. Responses over a force without a pulse are no frequency responses: such a hit is refused, unless the whole
/// force record is used. The error is a text, because threads that work for the caller cannot make Python's exceptions: these wait for the
/// lock that the caller holds.
fn judged(hit: &Hit, whole_force: bool) -> Result<Vec<String>, String> {
    let mut words = Vec::new();
    for fault in faults(hit) {
        match fault {
            Fault::NoPulse { .. } if whole_force => {}
            Fault::NoPulse { .. } => {
                return Err(format!(
                    "{}: {fault}; leave the hit out, give the hammer's channel as force, or take the force from end to end with whole_force=True",
                    hit.name
                ));
            }
            _ => words.push(format!("{}: {fault}", hit.name)),
        }
    }
    Ok(words)
}

/// The exception for an error: an identification error where the records do not give the result, else a bad value.
fn told_error(error: &Error) -> PyErr {
    let exception = match error {
        Error::Refused { .. } | Error::Record { .. } => identification_failed(error.to_string()),
        _ => value(error.to_string()),
    };
    of(error.kind(), exception)
}

/// Channels of each hit from an array of hits x channels x samples, or of one hit from channels x samples.
fn channels(responses: &Bound<'_, PyAny>, names: Option<&[String]>) -> PyResult<Vec<Vec<Channel>>> {
    let (rows, shape) = Numbers::rows("responses", responses)?;
    let (hits, channels) = match shape[..] {
        [channels, _] => (1, channels),
        [hits, channels, _] => (hits, channels),
        _ => {
            let dimensions = shape.len();
            return Err(value(format!(
                "responses has {dimensions} dimensions: give (hits, channels, samples)"
            )));
        }
    };
    let counted: Vec<String>;
    let names = if let Some(names) = names {
        names
    } else {
        counted = (0..channels).map(|n| n.to_string()).collect();
        &counted
    };
    if names.len() != channels {
        return Err(value(format!(
            "names has {} entries for {channels} channels: give one for each",
            names.len()
        )));
    }
    let freedom = |name: &String| {
        Freedom::parse(name)
            .ok_or_else(|| value(format!("names: \"{name}\" is no POINT or POINT:DIRECTION such as 12:+z")))
    };
    let freedoms: Vec<Freedom> = names.iter().map(freedom).collect::<PyResult<_>>()?;
    let mut rows = rows.into_iter();
    let mut one = |c: usize| {
        let samples = rows.next().unwrap_or_default();
        Channel { name: names[c].clone(), freedom: freedoms[c].clone(), samples }
    };
    Ok((0..hits).map(|_| (0..channels).map(&mut one).collect()).collect())
}

fn hits(forces: &Bound<'_, PyAny>, channels: Vec<Vec<Channel>>, request: &Request) -> PyResult<Vec<Hit>> {
    let (rows, shape) = Numbers::rows("force", forces)?;
    let (count, samples) = match shape[..] {
        [] => (1, 1),
        [samples] => (1, samples),
        [count, samples] => (count, samples),
        _ => return Err(value(format!("force has the shape {shape:?}: it must be (hits, samples)"))),
    };
    let own = channels.first().and_then(|c| c.first()).map_or(0, |c| c.samples.len());
    if count != channels.len() || samples != own {
        let found = channels.len();
        return Err(value(format!(
            "force is {count} x {samples}, responses hold {found} hits of {own} samples: give one force for each hit"
        )));
    }
    let at = request.force_at.clone().unwrap_or_else(|| "force".into());
    let freedom = Freedom::parse(&at)
        .ok_or_else(|| value(format!("force_at = \"{at}\" is no POINT or POINT:DIRECTION")))?;
    let sensors = channels.first().map_or(&[][..], |c| c);
    if request.force_at.is_some() && !sensors.iter().any(|c| c.freedom.is_at(&freedom)) {
        let names = listed(sensors.iter().map(|c| &c.name));
        return Err(value(format!(
            "force_at = \"{at}\" is no channel: the names are {names}; leave it out where nothing was measured there"
        )));
    }
    let hit = |((h, responses), samples): ((usize, Vec<Channel>), Vec<f64>)| Hit {
        name: format!("hit {h} (counted from 0)"),
        dt: request.dt,
        force: Channel { name: "force".into(), freedom: freedom.clone(), samples },
        responses,
    };
    Ok(channels.into_iter().enumerate().zip(rows).map(hit).collect())
}

fn told<'py>(
    py: Python<'py>,
    responses: &FrequencyResponses,
    fit: &ModalFit,
    given: &[f64],
    words: Vec<String>,
) -> PyResult<Bound<'py, PyDict>> {
    let modes = PyList::empty(py);
    for m in &fit.modes {
        let mode = PyDict::new(py);
        mode.set_item("frequency", m.frequency)?;
        mode.set_item("damping_ratio", m.damping_ratio)?;
        mode.set_item("frequency_sd", m.frequency_sd)?;
        mode.set_item("damping_ratio_sd", m.damping_ratio_sd)?;
        mode.set_item("shape", array(py, m.real_shape.clone()))?;
        mode.set_item("shape_sd", array(py, m.shape_sd.clone()))?;
        mode.set_item("complex_shape", PyArray1::from_slice(py, &m.shape))?;
        mode.set_item("phase_collinearity", m.phase_collinearity)?;
        modes.append(mode)?;
    }
    let first = fit.fitted.first;
    let lines = fit.fitted.curves.first().map_or(0, Vec::len);
    let measured: Vec<_> = responses.functions.iter().map(|f| &f.values[first..first + lines]).collect();
    let fitted: Vec<_> = fit.fitted.curves.iter().map(Vec::as_slice).collect();
    let dict = PyDict::new(py);
    dict.set_item("modes", modes)?;
    dict.set_item("names", fit.names.clone())?;
    dict.set_item("mass_normalised", fit.scale == iwan_modal::modes::Scale::DrivePoint)?;
    dict.set_item("band", fit.band)?;
    dict.set_item("misfit", fit.fitted.misfit)?;
    dict.set_item("frequency", array(py, (first..first + lines).map(|k| responses.frequency(k)).collect()))?;
    dict.set_item("responses", complex_rows(py, &measured)?)?;
    dict.set_item("fitted", complex_rows(py, &fitted)?)?;
    let doubts = [fit.drive_point_doubt(), fit.sideband_doubt(), fit.parts_doubt(), fit.moved_doubt(given)]
        .into_iter()
        .flatten();
    dict.set_item("remarks", words.into_iter().chain(doubts).collect::<Vec<String>>())?;
    Ok(dict)
}
