//! Weighted least squares on dissipation and frequency against amplitude together, and the verdict on the model.
//!
//! Forward model: averaging with the first harmonic, ω² = K_∞ + K_1(u) and D = D_joint(u) + 2π ζ_v ω0 ω u². It is first
//! order in the damping; [`refine`](mod@crate::refine) goes on from here on the record itself.

use std::f64::consts::TAU;

use iwan_core::Backbone;
use iwan_machine::threads::{at_once, in_parallel};

use super::verdict::{Compared, Verdict};
use crate::curves::Curves;
use crate::error::{Error, check};
use crate::parameters::{COUNT, Parameter, Parameters};
use crate::search::{Chart, Search, TOLERANCE};

/// Least standard deviation of a dissipation, relative: what averaging neglects (second order in the damping), and errors of smooth curves beyond
/// their noise. Without this floor the loudest, cleanest stretch would decide alone. A judgement, as is the ratio of the two floors: with it
/// dissipation weighs 500 times less than frequency, both relative to themselves.
pub(crate) const DISSIPATION_FLOOR: f64 = 5e-3;
/// Least standard deviation of a frequency, relative, for the same reasons.
pub(crate) const FREQUENCY_FLOOR: f64 = 1e-5;
/// Most steps of a search; ten to fifty are usual. A fit that does not settle is taken where it stands and judged by its misfit.
const ITERATIONS: usize = 300;

/// A model fitted to curves, and how well it matches them.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// The parameters.
    pub parameters: Parameters,
    /// Largest displacement amplitude over φ_max: from 1 on macro-slip is seen.
    pub slip_ratio: f64,
    /// How far the model is from the curves.
    pub verdict: Verdict,
}

/// Dissipation and frequency of a model at one displacement amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Predicted {
    /// Energy dissipated per cycle, mass-normalised.
    pub dissipation: f64,
    /// Frequency, Hz.
    pub frequency: f64,
}

/// Dissipation per cycle and frequency of the model at a displacement amplitude (mass-normalised), by averaging.
///
/// # Errors
/// [`Error::Model`] when the parameters are no model.
///
/// ```
/// use iwan_ident::{Parameters, curve_fit::predict};
/// let mode = Parameters { frequency: 124.0, damping_ratio: 0.0, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };
/// let found = predict(&mode, 0.5 * 0.009329393723670242)?;
/// assert!((found.dissipation - 0.2699369136316001).abs() < 1e-12); // golden number of D(φ_max/2)
/// assert!(found.frequency < 124.0);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn predict(parameters: &Parameters, displacement: f64) -> Result<Predicted, Error> {
    Ok(predictor(parameters)?(displacement))
}

/// [`predict`] for many displacements: the model is made once.
fn predictor(parameters: &Parameters) -> Result<impl Fn(f64) -> Predicted + use<>, Error> {
    let (oscillator, joint) = parameters.model()?;
    Ok(move |displacement: f64| {
        let omega = (oscillator.k_inf() + joint.harmonic_stiffness(displacement)).sqrt();
        let viscous = TAU * 0.5 * oscillator.viscous() * omega * displacement * displacement;
        Predicted { dissipation: joint.dissipation(displacement) + viscous, frequency: omega / TAU }
    })
}

/// An entry of a curve with a positive dissipation, and the standard deviations with which it counts.
#[derive(Debug, Clone, Copy)]
struct Entry {
    displacement: f64,
    log_dissipation: f64,
    log_dissipation_sd: f64,
    frequency: f64,
    frequency_sd: f64,
}

impl Entry {
    fn is_finite(&self) -> bool {
        let dissipation = [self.log_dissipation, self.log_dissipation_sd];
        let all = [self.displacement, self.frequency, self.frequency_sd];
        all.iter().chain(&dissipation).all(|v| v.is_finite())
    }
}

/// The usable entries of all curves.
fn entries(curves: &[Curves]) -> Vec<Entry> {
    let one = |c: &Curves, i: usize| {
        let d = c.dissipation[i];
        (d > 0.0).then(|| Entry {
            displacement: c.displacement[i],
            log_dissipation: d.ln(),
            log_dissipation_sd: c.log_dissipation_sd[i].max(DISSIPATION_FLOOR),
            frequency: c.frequency[i],
            frequency_sd: c.frequency_sd[i].max(FREQUENCY_FLOOR * c.frequency[i]),
        })
    };
    curves
        .iter()
        .flat_map(|c| (0..c.t.len()).filter_map(move |i| one(c, i)))
        .filter(Entry::is_finite)
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
    let free = (0..COUNT).filter(|j| held.iter().all(|h| chart.index(*h) != Some(*j))).collect();
    let search = Search::new(2 * entries.len(), free, Chart::bounds().to_vec(), (ITERATIONS, TOLERANCE));
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
    (entries.iter().map(|e| e.displacement.ln()).sum::<f64>() / entries.len() as f64).exp()
}

/// Fits from several start values and keeps the best fit: slopes and knees can be mistaken for one another.
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
    let fits = in_parallel(starts, at_once(), &|first| fit(curves, first, held));
    let best = fits.iter().flatten().min_by(|a, b| quality(a).total_cmp(&quality(b))).cloned();
    best.map_or_else(
        || fits.into_iter().next().unwrap_or(Err(Error::Length { name: "starts", needed: 1, found: 0 })),
        Ok,
    )
}

fn residuals(entries: &[Entry], parameters: &Parameters, out: &mut [f64]) -> bool {
    let Ok(predicted) = predictor(parameters) else { return false };
    for (i, e) in entries.iter().enumerate() {
        let model = predicted(e.displacement);
        out[2 * i] = (e.log_dissipation - model.dissipation.ln()) / e.log_dissipation_sd;
        out[2 * i + 1] = (e.frequency - model.frequency) / e.frequency_sd;
    }
    true
}

/// The fit, with the verdict on it.
fn judged(entries: &[Entry], parameters: Parameters) -> Result<Fit, Error> {
    let (mut dissipation, mut frequency) = (vec![], vec![]);
    for e in entries {
        let model = predict(&parameters, e.displacement)?;
        dissipation.push(Compared {
            measured: e.log_dissipation,
            deviation: e.log_dissipation_sd,
            model: model.dissipation.ln(),
        });
        frequency.push(Compared { measured: e.frequency, deviation: e.frequency_sd, model: model.frequency });
    }
    let largest = entries.iter().map(|e| e.displacement).fold(0.0, f64::max);
    let slip_ratio = largest / parameters.model()?.1.phi_max();
    Ok(Fit { parameters, slip_ratio, verdict: Verdict::new(&dissipation, &frequency) })
}
