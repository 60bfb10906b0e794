//! Modal Iwan parameters from the quasi-static curves of a computed structure, before any test.
//!
//! The curves are secant frequency and dissipation over modal displacement, ω² = K_∞ + F(q)/q and D = D_joint(q), without noise and
//! with ω0 and K_T known; F_S, χ and β are sought.

use std::f64::consts::TAU;

use iwan_core::Backbone;

use crate::curve_fit::Predicted;
use crate::error::{Error, check_length};
use crate::parameters::{Parameter, Parameters};
use crate::search::{Chart, Minimum, Search, TOLERANCE};

/// Unit of the residuals: one per cent of a dissipation weighs as much as one per cent of the whole loss of frequency.
const ONE_PER_CENT: f64 = 0.01;
/// Largest number of steps of a search; ten to fifty are usual. A fit that does not settle within them is taken where it stands, and its misfit says
/// so.
const ITERATIONS: usize = 300;
/// Least joint stiffness over ω0²: below it, slipping changes the frequency by less than 5e-7, which no
/// measurement sees. Such a mode is refused as linear.
const LEAST_STIFFNESS: f64 = 1e-6;

/// Curves of one mode; one entry per modal displacement.
#[derive(Debug, Clone, Copy)]
pub struct StaticCurves<'a> {
    /// Modal displacement q > 0, mass^½·length.
    pub displacement: &'a [f64],
    /// Secant frequency, Hz.
    pub frequency: &'a [f64],
    /// Dissipation per cycle of amplitude q.
    pub dissipation: &'a [f64],
}

/// Parameters that fit quasi-static curves best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StaticFit {
    /// The parameters; the damping ratio is 0.
    pub parameters: Parameters,
    /// Largest |D_model/D - 1|.
    pub dissipation_misfit: f64,
    /// Largest difference of frequency over the loss of frequency from all stuck to all slipping.
    pub frequency_misfit: f64,
}

/// Fits F_S, χ and β, with the stuck `frequency` in Hz and the joint stiffness `k_t` in 1/s² given.
///
/// # Errors
/// [`Error::Length`] for curves of different length; [`Error::TooShort`] with fewer than eight entries; [`Error::Model`]
/// for a frequency and K_T that are no mode; [`Error::Refused`] for K_T <= 0, a mode that slipping does not soften, and
/// when no search succeeds.
///
/// ```
/// use iwan_core::{Backbone, FourParameter};
/// use iwan_ident::static_fit::{StaticCurves, fit_static};
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let k_inf = (std::f64::consts::TAU * 124.0).powi(2) - 4.45e4;
/// let q: Vec<f64> = (0..40).map(|i| 1e-5 * 1.25_f64.powi(i)).collect();
/// let frequency: Vec<f64> = q.iter().map(|q| (k_inf + joint.force(*q) / q).sqrt() / std::f64::consts::TAU).collect();
/// let dissipation: Vec<f64> = q.iter().map(|q| joint.dissipation(*q)).collect();
/// let curves = StaticCurves { displacement: &q, frequency: &frequency, dissipation: &dissipation };
/// let found = fit_static(&curves, 124.0, 4.45e4)?.parameters;
/// assert!((found.f_s / 239.4 - 1.0).abs() < 1e-6 && (found.chi + 0.183).abs() < 1e-6 && (found.beta - 0.3).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_static(curves: &StaticCurves<'_>, frequency: f64, k_t: f64) -> Result<StaticFit, Error> {
    let count = curves.displacement.len();
    check_length("frequency", curves.frequency.len(), count)?;
    check_length("dissipation", curves.dissipation.len(), count)?;
    if k_t <= LEAST_STIFFNESS * (TAU * frequency).powi(2) {
        let finding = format!(
            "K_T = {k_t:.3e} is not positive: slipping does not soften this mode, it is linear in practice"
        );
        return Err(Error::Refused { finding, remedy: "nothing is fitted" });
    }
    if count < 8 {
        let remedy = "compute the curves at more displacements";
        return Err(Error::TooShort { what: "entries of the curves", found: count, needed: 8, remedy });
    }
    let held = [Parameter::Frequency, Parameter::DampingRatio, Parameter::KT];
    let middle = curves.displacement.iter().map(|q| q.ln()).sum::<f64>() / count as f64;
    let chart = Chart::holding(&held, middle.exp());
    let free = (0..6).filter(|j| held.iter().all(|h| chart.index(*h) != Some(*j))).collect();
    let search = Search::new(2 * count, free, Chart::bounds().to_vec(), (ITERATIONS, TOLERANCE));
    let mut residuals = |x: &[f64], out: &mut [f64]| residuals(curves, &chart.parameters(x), out).is_some();
    let mut best: Option<Minimum> = None;
    for first in starts(curves, frequency, k_t)? {
        let Some(found) = search.run(&mut residuals, &chart.coordinates(&first)?) else { continue };
        if best.as_ref().is_none_or(|best| found.cost < best.cost) {
            best = Some(found);
        }
    }
    let best = best.ok_or_else(|| Error::Refused {
        finding: "no start values have curves".into(),
        remedy: "compute the curves over more amplitudes",
    })?;
    judged(curves, chart.parameters(&best.x))
}

/// Start values: F_S at the largest joint force, with several χ and β.
fn starts(curves: &StaticCurves<'_>, frequency: f64, k_t: f64) -> Result<Vec<Parameters>, Error> {
    let k_inf = (TAU * frequency).powi(2) - k_t;
    let forces =
        curves.frequency.iter().zip(curves.displacement).map(|(f, q)| ((TAU * f).powi(2) - k_inf) * q);
    let f_s = forces.fold(f64::MIN_POSITIVE, f64::max);
    let mut starts = Vec::new();
    for chi in [-0.6, -0.2, 0.3] {
        for beta in [0.05, 0.5, 3.0] {
            let start = Parameters { frequency, damping_ratio: 0.0, k_t, f_s, chi, beta };
            start.model()?;
            starts.push(start);
        }
    }
    Ok(starts)
}

/// Dissipation and secant frequency (Hz) of the model at the displacement `q`.
fn predict(parameters: &Parameters, q: f64) -> Option<Predicted> {
    let (oscillator, joint) = parameters.model().ok()?;
    let frequency = (oscillator.k_inf() + joint.force(q) / q).sqrt() / TAU;
    Some(Predicted { dissipation: joint.dissipation(q), frequency })
}

/// Frequency (Hz) that a mode loses from stuck to slipping.
fn loss(parameters: &Parameters) -> f64 {
    let slipping = ((TAU * parameters.frequency).powi(2) - parameters.k_t).max(0.0).sqrt() / TAU;
    parameters.frequency - slipping
}

fn residuals(curves: &StaticCurves<'_>, parameters: &Parameters, out: &mut [f64]) -> Option<()> {
    let loss = loss(parameters);
    for (i, q) in curves.displacement.iter().enumerate() {
        let model = predict(parameters, *q)?;
        out[2 * i] = (curves.dissipation[i] / model.dissipation).ln() / ONE_PER_CENT;
        out[2 * i + 1] = (curves.frequency[i] - model.frequency) / (ONE_PER_CENT * loss);
    }
    out.iter().all(|r| r.is_finite()).then_some(())
}

fn judged(curves: &StaticCurves<'_>, parameters: Parameters) -> Result<StaticFit, Error> {
    let mut out = vec![0.0; 2 * curves.displacement.len()];
    residuals(curves, &parameters, &mut out).ok_or_else(|| Error::Refused {
        finding: "the best parameters have no curves".into(),
        remedy: "compute the curves over other amplitudes",
    })?;
    let largest = |from: usize| out.iter().skip(from).step_by(2).fold(0.0, |most: f64, r| most.max(r.abs()));
    Ok(StaticFit {
        parameters,
        dissipation_misfit: (ONE_PER_CENT * largest(0)).exp_m1(),
        frequency_misfit: ONE_PER_CENT * largest(1),
    })
}
