//! Joint weighted least squares on dissipation and frequency against amplitude, and the verdict on the model.
//!
//! Forward model: averaging with the first harmonic, ω² = K_∞ + K_1(u) and D = D_joint(u) + 2π ζ_v ω0 ω u². It is first
//! order in the damping; [`refine`](mod@crate::refine) goes on from here on the record itself.

use std::f64::consts::TAU;

use iwan_core::Backbone;

use crate::chart::Chart;
use crate::curves::Curves;
use crate::error::{Error, check};
use crate::least_squares::{Search, TOLERANCE};
use crate::parameters::{COUNT, Parameter, Parameters};
use crate::verdict::{Compared, Verdict};

/// Least relative standard deviation of a dissipation: what averaging neglects.
const DISSIPATION_FLOOR: f64 = 5e-3;
/// Least standard deviation of a frequency, relative to it: the same.
const FREQUENCY_FLOOR: f64 = 1e-5;
const ITERATIONS: usize = 300;

/// What a set of curves and a model have in common, and what not.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The parameters.
    pub parameters: Parameters,
    /// Largest displacement amplitude over φ_max: macro-slip is seen from 1 on.
    pub slip_ratio: f64,
    /// How far off the model is.
    pub verdict: Verdict,
}

/// Dissipation per cycle and frequency (Hz) of the model at a displacement amplitude.
///
/// # Errors
/// [`Error::Model`].
///
/// ```
/// use iwan_ident::{Parameters, fit::predict};
/// let mode = Parameters { frequency: 124.0, damping_ratio: 0.0, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };
/// let (dissipation, frequency) = predict(&mode, 0.5 * 0.009329393723670242)?;
/// assert!((dissipation - 0.2699369136316001).abs() < 1e-12); // golden number of D(φ_max/2)
/// assert!(frequency < 124.0);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn predict(parameters: &Parameters, displacement: f64) -> Result<(f64, f64), Error> {
    Ok(predictor(parameters)?(displacement))
}

/// [`predict`] for many displacements.
fn predictor(parameters: &Parameters) -> Result<impl Fn(f64) -> (f64, f64) + use<>, Error> {
    let (oscillator, joint) = parameters.model()?;
    Ok(move |displacement: f64| {
        let omega = (oscillator.k_inf() + joint.harmonic_stiffness(displacement)).sqrt();
        let viscous = TAU * 0.5 * oscillator.viscous() * omega * displacement * displacement;
        (joint.dissipation(displacement) + viscous, omega / TAU)
    })
}

/// Entries of curves with a positive dissipation, as (displacement, ln D, its deviation, frequency, its deviation).
type Entry = [f64; 5];

fn entries(curves: &[Curves]) -> Vec<Entry> {
    let one = |c: &Curves, i: usize| {
        let d = c.dissipation[i];
        let deviation = c.log_dissipation_sd[i].max(DISSIPATION_FLOOR);
        let frequency = c.frequency_sd[i].max(FREQUENCY_FLOOR * c.frequency[i]);
        (d > 0.0).then(|| [c.displacement[i], d.ln(), deviation, c.frequency[i], frequency])
    };
    curves
        .iter()
        .flat_map(|c| (0..c.t.len()).filter_map(move |i| one(c, i)))
        .filter(|e| e.iter().all(|v| v.is_finite()))
        .collect()
}

/// Fits the model to the curves of one or several force levels, from `first`; parameters in `held` keep their values.
///
/// # Errors
/// [`Error::TooShort`] with fewer than eight usable entries; [`Error::Model`]; [`Error::Refused`] when no search succeeds.
pub fn fit(curves: &[Curves], first: &Parameters, held: &[Parameter]) -> Result<Fit, Error> {
    first.model()?;
    let entries = entries(curves);
    if entries.len() < 8 {
        let remedy = "record longer or louder";
        return Err(Error::TooShort {
            what: "entries with a positive dissipation",
            found: entries.len(),
            needed: 8,
            remedy,
        });
    }
    let chart = Chart::holding(held, middle(&entries));
    let free = (0..COUNT).filter(|j| held.iter().all(|h| chart.index(*h) != *j)).collect();
    let search = Search {
        count: 2 * entries.len(),
        free,
        bounds: chart.bounds().to_vec(),
        iterations: ITERATIONS,
        tolerance: TOLERANCE,
    };
    let mut residuals = |x: &[f64], out: &mut [f64]| residuals(&entries, &chart.parameters(x), out);
    let found = search.run(&mut residuals, &chart.coordinates(first)?).ok_or_else(|| Error::Refused {
        finding: "the start values have no curves".into(),
        remedy: "start nearer to the solution",
    })?;
    let parameters = chart.parameters(&found.x);
    judged(&entries, parameters)
}

/// Geometric mean of the displacements.
fn middle(entries: &[Entry]) -> f64 {
    (entries.iter().map(|e| e[0].ln()).sum::<f64>() / entries.len() as f64).exp()
}

/// Fits from several starts and keeps the best: slopes and knees can be mistaken for one another.
///
/// # Errors
/// As [`fit`]; the first error when no start succeeds.
pub fn fit_from(curves: &[Curves], starts: &[Parameters], held: &[Parameter]) -> Result<Fit, Error> {
    check("starts", starts.len() as f64, !starts.is_empty(), "at least one", "give start values")?;
    let entries = entries(curves);
    let quality = |f: &Fit| {
        let mut out = vec![0.0; 2 * entries.len()];
        let known = residuals(&entries, &f.parameters, &mut out);
        if known { out.iter().map(|r| r * r).sum::<f64>() } else { f64::INFINITY }
    };
    let fits: Vec<_> = starts.iter().map(|first| fit(curves, first, held)).collect();
    let best = fits.iter().flatten().min_by(|a, b| quality(a).total_cmp(&quality(b))).cloned();
    best.map_or_else(
        || fits.into_iter().next().unwrap_or(Err(Error::Length { name: "starts", needed: 1, found: 0 })),
        Ok,
    )
}

fn residuals(entries: &[Entry], parameters: &Parameters, out: &mut [f64]) -> bool {
    let Ok(predicted) = predictor(parameters) else { return false };
    for (i, [u, log, log_sd, frequency, frequency_sd]) in entries.iter().enumerate() {
        let (d, f) = predicted(*u);
        (out[2 * i], out[2 * i + 1]) = ((log - d.ln()) / log_sd, (frequency - f) / frequency_sd);
    }
    true
}

/// The fit with its verdict.
fn judged(entries: &[Entry], parameters: Parameters) -> Result<Fit, Error> {
    let (mut dissipation, mut frequency) = (vec![], vec![]);
    for [u, log, log_sd, measured, deviation] in entries {
        let (d, f) = predict(&parameters, *u)?;
        dissipation.push(Compared { measured: *log, deviation: *log_sd, model: d.ln() });
        frequency.push(Compared { measured: *measured, deviation: *deviation, model: f });
    }
    let largest = entries.iter().map(|e| e[0]).fold(0.0, f64::max);
    let slip_ratio = largest / parameters.model()?.1.phi_max();
    Ok(Fit { parameters, slip_ratio, verdict: Verdict::new(&dissipation, &frequency, false) })
}
