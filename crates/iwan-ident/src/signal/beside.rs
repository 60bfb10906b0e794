//! Modes beside the one that is looked for, taken out of the record before its band is.
//!
//! A band-pass filter leaves of a mode outside its band what its skirt lets through, and that beats with the mode inside. But such a mode is known as well
//! as any other from a band of its own. So each is followed there, continued to the begin of the decay and to the end of the record, and subtracted;
//! what is left tells the next one better, as in mode isolation (M. S. Allen, J. H. Ginsberg, Mech. Syst. Signal Process. 20:874, 2006).

use super::in_band::{InBand, Options, behind_filter};
use super::isolated::Isolated;
use super::spectrum::Band;
use super::survey::{band_near, spectral_peaks};
use super::transients::Gate;

/// Part of the mode's amplitude that another one leaves behind the filter from which on it is taken out. Of less the fit on windows, whose own skirts are
/// steeper, sees a thousandth.
const LEAK: f64 = 1e-4;
/// Modes that are taken out at most: those that leave most.
const MOST: usize = 4;
/// Rounds in which all modes are followed anew, each without the others, at most, …
const ROUNDS: usize = 8;
/// … and the part of what is left that a round must still take away. Modes an eighth of their frequency apart take four to six rounds, others two.
const WORTH: f64 = 0.1;
/// Distance in resolved lines from the mode's own peak within which a line is a trace of that mode.
const OWN_LINES: f64 = 3.0;

/// What other modes have in a record.
pub(super) struct Others {
    /// Their sum at all samples.
    pub(super) samples: Vec<f64>,
    /// Their frequencies, Hz.
    pub(super) frequencies: Vec<f64>,
}

impl Others {
    pub(super) fn in_words(&self) -> String {
        let list: Vec<String> = self.frequencies.iter().map(|f| format!("{f:.4}")).collect();
        let (modes, them) = if list.len() == 1 { ("mode", "it") } else { ("modes", "them") };
        format!("the {modes} beside it at {} Hz: the record without {them} is looked at", list.join(", "))
    }
}

/// Another mode as it is known.
struct Other {
    band: Band,
    samples: Vec<f64>,
}

/// The modes beside `mode` whose skirts reach into its band; none where there are none, or none can be followed.
pub(super) fn others(x: &[f64], mode: &Isolated, gate: &Gate, options: &Options) -> Option<Others> {
    let dt = mode.dt;
    let mut own = mode.continued(gate)?;
    let mut rest: Vec<f64> = without(x, &own, gate.begin);
    let mut found: Vec<Other> = vec![];
    for band in bands(&rest, mode, &own, gate) {
        let Some(other) = followed(&rest, dt, band, gate, options) else { continue };
        rest = without(&rest, &other.samples, gate.begin);
        found.push(other);
    }
    let mut left = power(&rest);
    for _ in 1..ROUNDS {
        // The mode without the others, then each of these without all others.
        let of_mode: Vec<f64> = rest.iter().zip(&own).map(|(r, o)| r + o).collect();
        let again = behind_filter(&of_mode, dt, mode.band, options, vec![]);
        if let Some(better) = again.ok().and_then(|InBand { mode, .. }| mode.continued(gate)) {
            rest = without(&of_mode, &better, gate.begin);
            own = better;
        }
        for other in &mut found {
            let alone: Vec<f64> = rest.iter().zip(&other.samples).map(|(r, o)| r + o).collect();
            if let Some(better) = followed(&alone, dt, other.band, gate, options) {
                rest = without(&alone, &better.samples, gate.begin);
                *other = better;
            }
        }
        let before = std::mem::replace(&mut left, power(&rest));
        if left > (1.0 - WORTH) * before {
            break;
        }
    }
    let sum = |n: usize| found.iter().map(|other| other.samples[n]).sum::<f64>();
    (!found.is_empty()).then(|| Others {
        samples: (0..x.len()).map(sum).collect(),
        frequencies: found.iter().map(|other| other.band.peak).collect(),
    })
}

/// The record from the begin of the decay on without a mode, and nothing before it.
fn without(x: &[f64], mode: &[f64], begin: usize) -> Vec<f64> {
    x.iter().zip(mode).enumerate().map(|(n, (x, mode))| if n < begin { 0.0 } else { x - mode }).collect()
}

/// Bands of the modes that leave most behind the filter.
fn bands(rest: &[f64], mode: &Isolated, own: &[f64], gate: &Gate) -> Vec<Band> {
    let decay = &rest[gate.begin..];
    let Ok(peaks) = spectral_peaks(&[decay], mode.dt) else { return vec![] };
    let largest = |x: &[f64]| x.iter().map(|x| x.abs()).fold(0.0, f64::max);
    let level = largest(decay) / largest(own).max(f64::MIN_POSITIVE);
    let line = 1.0 / (decay.len() as f64 * mode.dt);
    let left = |frequency: f64, height: f64| level * height * gate.filter.gain(frequency).powi(2);
    let mut reaching: Vec<(f64, f64)> = peaks
        .iter()
        .filter(|p| (p.frequency - mode.band.peak).abs() > OWN_LINES * line)
        .map(|p| (left(p.frequency, p.height), p.frequency))
        .filter(|(left, _)| *left > LEAK)
        .collect();
    reaching.sort_by(|a, b| b.0.total_cmp(&a.0));
    reaching.truncate(MOST);
    reaching.iter().filter_map(|(_, frequency)| band_near(&[decay], mode.dt, *frequency).ok()).collect()
}

/// A mode in a band, where that takes something out of what is left.
fn followed(rest: &[f64], dt: f64, band: Band, gate: &Gate, options: &Options) -> Option<Other> {
    let options =
        Options { band: Some((band.low, band.high)), near: None, order: None, window: None, ..*options };
    let InBand { mode, gate: own } = behind_filter(rest, dt, band, &options, vec![]).ok()?;
    // All modes begin with the same blow.
    let samples = mode.continued(&Gate { begin: gate.begin, ..own? })?;
    (power(&without(rest, &samples, gate.begin)) < power(rest)).then_some(Other { band, samples })
}

fn power(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum()
}
