//! The modal Iwan counterpart of each bending mode: fitted, simulated, compared with the truth (Table 2 and Fig. 8).

use iwan_core::FourParameter;
use iwan_ident::curve_fit::fit_from;
use iwan_ident::curves::{Curves, Quantity};
use iwan_ident::identify::{Held, ModeRecord, Settings, identify};
use iwan_ident::signal::{Method, Options};
use iwan_ident::{Parameter, Parameters};
use iwan_sim::{JointKind, JointLaw, Mode, simulate};
use serde::Serialize;

use super::modal::Study;
use super::printed::TABLE_2;
use super::truth::{DT, LEVELS, STEPS, Side, blow};
use crate::failure::Failure;

/// Levels up to this force, lbf, make up the fit: above it, modes of higher frequency keep the joints slipping and a mode's
/// curves have more than one value at an amplitude.
pub(crate) const FITTED: f64 = 1000.0;
/// Levels, by index, whose records are compared with the model for the intervals: micro-slip and the way into macro-slip.
const RECORDS: [usize; 2] = [2, 3];
/// Degree of the polynomials in the envelopes behind the intervals.
const ORDER: usize = 4;
/// Levels, by index, of Figs. 8a and 8b.
pub(crate) const SHOWN: [usize; 2] = [1, 3];
/// Ends of the two stretches in which Fig. 8 is judged, s.
const STRETCHES: [f64; 2] = [0.05, 0.2];
/// Parameters known from the structure's modes.
const KNOWN: [Parameter; 3] = [Parameter::Frequency, Parameter::DampingRatio, Parameter::KT];

/// The modal Iwan model of a mode.
#[derive(Debug)]
pub(crate) struct Counterpart {
    /// Fitted on the curves, with ω0 and K_T of the structure's modes.
    pub(crate) parameters: Parameters,
    pub(crate) adequate: bool,
    pub(crate) misfit: String,
    /// 95 % intervals of F_S, χ and β from the records themselves.
    pub(crate) intervals: Vec<Interval>,
    /// By level.
    pub(crate) errors: Vec<Distance>,
    /// The same with the parameters the paper prints.
    pub(crate) errors_printed: Vec<Distance>,
    /// Modal accelerations at the levels [`SHOWN`].
    pub(crate) shown: Vec<Vec<f64>>,
}

/// What the records tell about a parameter.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Interval {
    pub(crate) parameter: &'static str,
    /// Best value on the records.
    pub(crate) value: f64,
    pub(crate) low: Option<f64>,
    pub(crate) high: Option<f64>,
    pub(crate) identifiable: bool,
}

/// Root mean square of the difference of accelerations over that of the truth's.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Distance {
    pub(crate) level: f64,
    /// Over 0 to 50 ms.
    pub(crate) early: f64,
    /// Over 0 to 200 ms.
    pub(crate) whole: f64,
}

impl Counterpart {
    /// Of a mode with a joint.
    pub(crate) fn new(side: &Side, study: &Study) -> Result<Self, Failure> {
        let place = format!("{}, {}", side.linear.source, study.name);
        let said = |error: iwan_ident::Error| Failure::Computation(format!("{place}: {error}"));
        let failed = |error: String| Failure::Computation(format!("{place}: {error}"));
        let quiet = study.curves.iter().zip(LEVELS).filter(|(_, level)| *level <= FITTED);
        let curves: Vec<Curves> = quiet.map(|(curves, _)| curves.clone()).collect();
        let fit = fit_from(&curves, &starts(study), &KNOWN).map_err(said)?;
        let fitted = responses(study, &fit.parameters).map_err(failed)?;
        let printed = TABLE_2[study.index];
        let printed = Parameters { f_s: printed.f_s, chi: printed.chi, beta: printed.beta, ..fit.parameters };
        let printed = responses(study, &printed).map_err(failed)?;
        Ok(Self {
            parameters: fit.parameters,
            adequate: fit.verdict.adequate,
            misfit: fit.verdict.misfit,
            intervals: intervals(side, study).map_err(said)?,
            errors: distances(side, study.index, &fitted),
            errors_printed: distances(side, study.index, &printed),
            shown: SHOWN.map(|n| fitted[n].clone()).to_vec(),
        })
    }

    /// The joint's law.
    pub(crate) fn law(&self) -> Result<FourParameter, iwan_core::Error> {
        let p = &self.parameters;
        FourParameter::new(p.k_t, p.f_s, p.chi, p.beta)
    }
}

fn starts(study: &Study) -> Vec<Parameters> {
    let plateau = study.static_curves.joint_force.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let mut starts = Vec::new();
    for chi in [-0.3, -0.15] {
        for beta in [0.05, 0.5, 2.0] {
            let (frequency, k_t) = (study.stuck, study.k_t);
            starts.push(Parameters { frequency, damping_ratio: 0.0, k_t, f_s: 0.8 * plateau, chi, beta });
        }
    }
    starts
}

/// Simulation in the loop on the records themselves, with what the modes tell given.
fn intervals(side: &Side, study: &Study) -> Result<Vec<Interval>, iwan_ident::Error> {
    let sources = RECORDS.map(|n| ModeRecord {
        samples: &side.responses[n].outputs[study.index].acceleration,
        dt: DT,
        quantity: Quantity::Acceleration,
    });
    let window = Some((super::modal::TRIM, STEPS as f64 * DT - super::modal::TRIM));
    let options = Options {
        near: Some(study.stuck),
        filter_order: 0,
        window,
        order: Some(ORDER),
        ..Options::default()
    };
    let known = [study.stuck, 0.0, study.k_t];
    let held = KNOWN.into_iter().zip(known).map(|(parameter, value)| Held { parameter, value }).collect();
    let found = identify(&sources, &Settings { options, method: Method::Hilbert, held })?;
    let sought = found.profiles.parameters.iter().filter(|profile| !profile.held);
    let interval = |profile: &iwan_ident::profile::Profile| Interval {
        parameter: profile.parameter.name(),
        value: profile.value,
        low: profile.low,
        high: profile.high,
        identifiable: profile.identifiable(),
    };
    Ok(sought.map(interval).collect())
}

/// Accelerations of the modal model under all blows, by the paper's scheme: average acceleration without prewarping.
fn responses(study: &Study, parameters: &Parameters) -> Result<Vec<Vec<f64>>, String> {
    let joint = FourParameter::new(parameters.k_t, parameters.f_s, parameters.chi, parameters.beta);
    let joint = JointLaw::FourParameter(joint.map_err(|error| error.to_string())?);
    let mode = Mode {
        shape_at_force: study.tip,
        ..Mode::new(study.name.clone(), parameters.frequency, Some(joint))
    };
    let joint = JointKind::default_sliders();
    let method = iwan_sim::Method::Newmark { beta: 0.25, gamma: 0.5, prewarp: false, joint };
    let settings = iwan_sim::Settings { dt: DT, duration: STEPS as f64 * DT, method, quality: false };
    let run = |level: &f64| simulate(&mode, &blow(*level), &settings).map(|response| response.acceleration);
    LEVELS.iter().map(run).collect::<Result<_, _>>().map_err(|error| error.to_string())
}

fn distances(side: &Side, index: usize, responses: &[Vec<f64>]) -> Vec<Distance> {
    let one = |(n, response): (usize, &Vec<f64>)| {
        let truth = &side.responses[n].outputs[index].acceleration;
        let [early, whole] = STRETCHES.map(|end| {
            let samples = ((end / DT).round() as usize + 1).min(truth.len());
            distance(&response[..samples], &truth[..samples])
        });
        Distance { level: LEVELS[n], early, whole }
    };
    responses.iter().enumerate().map(one).collect()
}

/// Root mean square of the difference over that of the reference.
pub(crate) fn distance(x: &[f64], reference: &[f64]) -> f64 {
    let square = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>();
    let difference = square(&mut x.iter().zip(reference).map(|(a, b)| a - b));
    (difference / square(&mut reference.iter().copied())).sqrt()
}
