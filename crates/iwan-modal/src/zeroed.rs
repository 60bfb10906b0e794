//! The time from which on a decay is linear: M. S. Allen, R. L. Mayes, *Estimating the degree of nonlinearity in transient responses with zeroed
//! early-time fast Fourier transforms*, Mechanical Systems and Signal Processing 24:2049, 2010.

use std::f64::consts::TAU;

use rayon::prelude::*;

use crate::analysis::{Analysis, modal_fit};
use crate::error::{Error, check};
use crate::fit::{Band, Fitted, Linear};
use crate::measure::{Channel, Motion};
use crate::number::Complex;
use crate::responses::{FrequencyResponses, PoleInRecord, free_responses, laplace};

/// Number of zeroed times at which spectra are taken: so many are read at a glance, and the time is found to a thirtieth of the first half of the record.
const TIMES: usize = 30;
/// The model is fitted to the record from this fraction of it on, where the decay is most linear.
const LATE: f64 = 0.5;
/// Range on either side of a mode in which its spectrum is compared, in half-power half widths.
const WIDTHS: f64 = 4.0;
/// Least range on either side, in lines of the spectrum.
const LINES: f64 = 3.0;
/// A line this fraction of a line beyond the range counts too, so that rounding does not decide about one at its very end: a mode that lies on a line has two of these.
const AT_THE_END: f64 = 1e-6;
/// A decay is linear from the time on from which the model, carried backwards, stays within this fraction of the mode's spectrum. A judgement: noise
/// of 30 dB and a neighbour in the band disturb it by that much.
const WITHIN: f64 = 0.05;

/// Two poles at least this many sums of their decays apart are two modes, nearer ones are two halves of one peak. Two modes of equal damping that are 1.5 half-power
/// bandwidths apart have 1.5. A judgement.
const APART: f64 = 1.25;

/// The spectrum of a record whose samples before a time are zero.
#[derive(Debug, Clone, PartialEq)]
pub struct ZeroedSpectrum {
    /// Time before which samples are zero, s from the first sample.
    pub time: f64,
    /// Magnitude at the lines from 0 on, unit of the record times s.
    pub magnitude: Vec<f64>,
    /// Distance of lines, Hz.
    pub step: f64,
}

/// The time from which on one mode is linear.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearFrom {
    /// Pole of the late decay, 1/s.
    pub pole: nalgebra::Complex<f64>,
    /// Distance of the model, carried backwards, from the mode's spectrum over that spectrum, at each zeroed time.
    pub misfit: Vec<f64>,
    /// First zeroed time (s) from which on the misfit stays within 5 %; none where it never does before the late part.
    pub time: Option<f64>,
    /// Amplitude of the mode at that time, in the unit of the record.
    pub amplitude: Option<f64>,
}

/// The zeroed spectra of a record and what they say of each mode.
#[derive(Debug, Clone, PartialEq)]
pub struct Zeroed {
    /// The spectra, by ascending zeroed time.
    pub spectra: Vec<ZeroedSpectrum>,
    /// Modes of the late decay, by ascending frequency.
    pub modes: Vec<LinearFrom>,
}

/// Zeroed early-time spectra of a free decay `x`, sampled every `dt` seconds, and the time from which on each mode in `band` (Hz) is linear.
///
/// # Errors
/// As [`modal_fit`] and [`free_responses`] on the late half of the record; [`Error::OutOfRange`] for `dt`.
///
/// ```
/// // 40 Hz, linear from the first sample on.
/// let x: Vec<f64> = (0..4096).map(|n| (-1e-3 * n as f64).exp() * (0.25 * n as f64).sin()).collect();
/// let zeroed = iwan_modal::zeroed(&x, 1e-3, (20.0, 80.0))?;
/// assert_eq!(zeroed.modes[0].time, Some(0.0));
/// # Ok::<(), iwan_modal::Error>(())
/// ```
pub fn zeroed(x: &[f64], dt: f64, band: (f64, f64)) -> Result<Zeroed, Error> {
    check("dt", dt, dt > 0.0, "a sampling interval > 0 s", "give the sampling interval in seconds")?;
    let start = (LATE * x.len() as f64) as usize;
    let late = responses(&x[start..], dt)?;
    let order = 30.min(late.lines() / 4);
    let fit = modal_fit(&late, Some(band), &Analysis::Chart, order)?;
    let mut poles: Vec<Complex> = fit.modes.iter().map(|m| m.pole).collect();
    let band = Band::new(&late, band)?;
    let mut linear = Linear::new(&band, &poles, false)?;
    // A single channel has no shapes that would tell two halves of a peak that is not linear yet from two modes.
    loop {
        let apart = one_for_each_peak(&poles, &linear);
        if apart.len() == poles.len() {
            break;
        }
        poles = Fitted::new(&band, &apart)?.poles;
        linear = Linear::new(&band, &poles, false)?;
    }
    let amplitudes: Vec<Complex> = (0..poles.len()).map(|p| linear.residue(p, 0)).collect();
    let mut modes: Vec<LinearFrom> = poles
        .iter()
        .map(|p| LinearFrom { pole: *p, misfit: Vec::new(), time: None, amplitude: None })
        .collect();
    let zeroed_until = |k: usize| -> Result<(ZeroedSpectrum, Vec<f64>), Error> {
        let from = k * start / TIMES;
        let own = responses(&x[from..], dt)?;
        let back = (start - from) as f64 * dt;
        let misfits = (0..poles.len()).map(|p| misfit(&own, &poles, &amplitudes, p, back)).collect();
        let magnitude = own.functions[0].values.iter().map(|v| v.norm()).collect();
        Ok((ZeroedSpectrum { time: from as f64 * dt, magnitude, step: own.step }, misfits))
    };
    let all: Vec<_> = (0..TIMES).into_par_iter().map(zeroed_until).collect::<Result<_, Error>>()?;
    let mut spectra = Vec::new();
    for (spectrum, misfits) in all {
        modes.iter_mut().zip(misfits).for_each(|(mode, misfit)| mode.misfit.push(misfit));
        spectra.push(spectrum);
    }
    for (mode, c) in modes.iter_mut().zip(&amplitudes) {
        let within = mode.misfit.iter().rev().take_while(|m| **m < WITHIN).count();
        if within > 0 {
            let spectrum = &spectra[TIMES - within];
            let back = start as f64 * dt - spectrum.time;
            mode.time = Some(spectrum.time);
            mode.amplitude = Some(2.0 * c.norm() * (-mode.pole.re * back).exp());
        }
    }
    Ok(Zeroed { spectra, modes })
}

/// The poles without those that are too near to one with a higher peak.
fn one_for_each_peak(poles: &[Complex], linear: &Linear) -> Vec<Complex> {
    let height = |p: usize| linear.residue(p, 0).norm() / poles[p].re.abs();
    let near = |p: usize, q: usize| (poles[p] - poles[q]).norm() < APART * (poles[p].re + poles[q].re).abs();
    let higher = |p: usize, q: usize| height(q) > height(p) || height(q) == height(p) && q < p;
    let stays = |p: &usize| (0..poles.len()).all(|q| q == *p || !near(*p, q) || !higher(*p, q));
    (0..poles.len()).filter(stays).map(|p| poles[p]).collect()
}

fn responses(x: &[f64], dt: f64) -> Result<FrequencyResponses, Error> {
    let freedom = crate::measure::Freedom::point("record");
    let channel = Channel { name: "record".into(), freedom, samples: x.to_vec() };
    free_responses(&[vec![channel]], dt, Motion::Acceleration)
}

/// Relative distance between the spectrum around mode `p` and that of all modes carried backwards by `back` seconds.
fn misfit(own: &FrequencyResponses, poles: &[Complex], amplitudes: &[Complex], p: usize, back: f64) -> f64 {
    let record = own.record.as_ref();
    let centre = poles[p].im / TAU;
    let half = (WIDTHS * poles[p].re.abs() / TAU).max(LINES * own.step);
    let first = ((centre - half) / own.step - AT_THE_END).ceil().max(1.0) as usize;
    let last = (((centre + half) / own.step + AT_THE_END) as usize).min(own.lines() - 1);
    let parts: Vec<(PoleInRecord<'_>, Complex)> = poles
        .iter()
        .zip(amplitudes)
        .filter_map(|(pole, c)| Some((record?.at(*pole), c * (-pole * back).exp())))
        .collect();
    let (mut off, mut all) = (0.0, 0.0);
    for k in first..=last {
        let s = laplace(own.frequency(k), 0.0);
        let value = |(at, now): &(PoleInRecord<'_>, Complex)| {
            let [(own, _), (conjugate, _)] = at.pair(k, s, at.record.turns(-s));
            own * now + conjugate * now.conj()
        };
        let model: Complex = parts.iter().map(value).sum();
        let measured = own.functions[0].values[k];
        off += (measured - model).norm_sqr();
        all += measured.norm_sqr();
    }
    (off / all.max(f64::MIN_POSITIVE)).sqrt()
}
