//! Modes beside the one that is looked for: they are subtracted from the record before its band is filtered.
//!
//! A band-pass filter lets a part of a mode outside its band through its skirt, and that part beats with the mode inside. But such a mode can be
//! followed in a band of its own as well as any other. So each one is followed there, continued to the start of the decay and to the end of the record, and subtracted;
//! the remaining record shows the next one better, as in mode isolation (M. S. Allen, J. H. Ginsberg, Mech. Syst. Signal Process. 20:874, 2006).

use super::in_band::{InBand, Options, behind_filter};
use super::isolated::Isolated;
use super::spectrum::Band;
use super::survey::{SpectralPeak, band_among, spectral_peaks};
use super::transients::Gate;

/// A mode outside the band is subtracted where its amplitude behind the filter exceeds this fraction of the followed mode's amplitude. The windows of the fit have
/// steeper skirts of their own. A judgement, not varied; a mode below this limit stays in the record.
const LEAK: f64 = 1e-4;
/// The same limit for another mode inside the band. It is higher because a smooth curve through the followed mode leaves peaks of a thousandth of that mode there;
/// a smaller second mode is only noted, and stays. A judgement: with the limit of modes outside, such a trace was taken for a mode.
const INSIDE: f64 = 0.01;
/// Another mode of at least this fraction of the followed mode's amplitude is followed in a band that is narrowed beside a near neighbour; a smaller one can be a trace
/// of the followed mode itself. The same value as for neighbours of the automatic band.
const NEIGHBOUR: f64 = 0.03;
/// Largest number of modes that are subtracted: those that leave most behind the filter; further ones stay in the record. Not varied.
const MOST: usize = 4;
/// Largest number of rounds; in each round every mode is followed anew in the record without the others.
const ROUNDS: usize = 8;
/// Least fraction of the remaining sum of squares that a round must take away, else it is the last. Modes 8 % apart in frequency take all eight rounds, modes 30 % apart two.
const WORTH: f64 = 0.1;
/// Distance from the mode's own peak within which a line is a trace of that mode, in resolved lines (1/length of the decay). A judgement, not varied.
const OWN_LINES: f64 = 3.0;

/// What other modes contribute to a record.
pub(super) struct Others {
    /// Sum of the other modes at all samples, in the unit of the record.
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

/// Another mode: the band in which it is followed, and its samples over the whole record.
struct Other {
    band: Band,
    samples: Vec<f64>,
}

/// The modes beside `mode` whose skirts reach into its band; none where there are no such modes, or none of them can be followed.
pub(super) fn others(x: &[f64], mode: &Isolated, gate: &Gate, options: &Options) -> Option<Others> {
    let own = alone(x, mode, gate, options)?;
    let rest = without(x, &own, gate.begin);
    let peaks = peaks(&rest, mode, &own, gate);
    let of = |nearest| -> Vec<Band> {
        let all: Vec<SpectralPeak> = peaks.all.iter().copied().chain(nearest).collect();
        let yields = |p: &SpectralPeak| peaks.level * p.height >= NEIGHBOUR;
        peaks.reaching.iter().map(|p| band_among(&all, p, yields(p), 0.5 / mode.dt)).collect()
    };
    // Filters of wide bands have a short memory, which the start of the decay needs. But a wide band also holds what is not yet known of a near mode, and then some modes
    // do not settle. So both kinds of bands are tried, and the one that leaves less is kept.
    let own_peak =
        SpectralPeak { frequency: mode.band.peak, height: f64::INFINITY, ..*peaks.reaching.first()? };
    let (wide, narrow) = (of(None), of(Some(own_peak)));
    let first = separated(x, (mode, &own), gate, options, &wide);
    let second = (wide != narrow).then(|| separated(x, (mode, &own), gate, options, &narrow));
    let found = second.into_iter().chain([first]).min_by(|a, b| a.left.total_cmp(&b.left))?;
    let sum = |n: usize| found.others.iter().map(|other| other.samples[n]).sum::<f64>();
    (!found.others.is_empty()).then(|| Others {
        samples: (0..x.len()).map(sum).collect(),
        frequencies: found.others.iter().map(|other| other.band.peak).collect(),
    })
}

/// Modes that were followed one by one, and what remains of the record without all of them.
struct Separated {
    others: Vec<Other>,
    /// Sum of squares of the remaining record.
    left: f64,
}

/// The followed mode as it is known before the others are: its samples, continued to both ends of its decay. Where the band holds two modes next to each other, smooth
/// curves through their sum would follow the beat, so the smaller one is first subtracted as a linear mode.
fn alone(x: &[f64], mode: &Isolated, gate: &Gate, options: &Options) -> Option<Vec<f64>> {
    let smaller = mode.smaller_of_two(gate);
    let rest = smaller.map(|other| without(x, &other, gate.begin));
    let again = rest.and_then(|rest| behind_filter(&rest, mode.dt, mode.band, options, None).ok());
    again.and_then(|found| found.mode.continued(gate)).or_else(|| mode.continued(gate))
}

/// Follows the mode and each of the others in its own band in turn, each in the record without the rest, and repeats that until a round takes too little away.
fn separated(
    x: &[f64],
    (mode, own): (&Isolated, &[f64]),
    gate: &Gate,
    options: &Options,
    bands: &[Band],
) -> Separated {
    let dt = mode.dt;
    let mut own = own.to_vec();
    let mut rest = without(x, &own, gate.begin);
    let mut others: Vec<Other> = vec![];
    for band in bands {
        let Some(other) = followed(&rest, dt, *band, gate, options) else { continue };
        rest = without(&rest, &other.samples, gate.begin);
        others.push(other);
    }
    let mut left = power(&rest);
    for _ in 1..ROUNDS {
        let of_mode = with(&rest, &own);
        let again = behind_filter(&of_mode, dt, mode.band, options, None);
        if let Some(better) = again.ok().and_then(|InBand { mode, .. }| mode.continued(gate)) {
            rest = without(&of_mode, &better, gate.begin);
            own = better;
        }
        for other in &mut others {
            let alone = with(&rest, &other.samples);
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
    Separated { others, left }
}

fn with(rest: &[f64], mode: &[f64]) -> Vec<f64> {
    rest.iter().zip(mode).map(|(r, m)| r + m).collect()
}

/// The record without a mode from the start of the decay on, and zeros before.
fn without(x: &[f64], mode: &[f64], begin: usize) -> Vec<f64> {
    x.iter().zip(mode).enumerate().map(|(n, (x, mode))| if n < begin { 0.0 } else { x - mode }).collect()
}

/// Peaks in the spectrum of a record from which the followed mode was subtracted.
struct Peaks {
    /// Largest sample of that record over the largest sample of the mode.
    level: f64,
    all: Vec<SpectralPeak>,
    /// The peaks that leave most behind the filter, the largest first.
    reaching: Vec<SpectralPeak>,
}

fn peaks(rest: &[f64], mode: &Isolated, own: &[f64], gate: &Gate) -> Peaks {
    let decay = &rest[gate.begin..];
    let mut all = spectral_peaks(&[decay], mode.dt).unwrap_or_default();
    let largest = |x: &[f64]| x.iter().map(|x| x.abs()).fold(0.0, f64::max);
    let level = largest(decay) / largest(own).max(f64::MIN_POSITIVE);
    let line = 1.0 / (decay.len() as f64 * mode.dt);
    all.retain(|p| (p.frequency - mode.band.peak).abs() > OWN_LINES * line);
    let left = |p: &SpectralPeak| level * p.height * gate.filter.gain(p.frequency).powi(2);
    let inside = |p: &SpectralPeak| (mode.band.low..=mode.band.high).contains(&p.frequency);
    let least = |p: &SpectralPeak| if inside(p) { INSIDE } else { LEAK };
    let mut reaching: Vec<SpectralPeak> = all.iter().filter(|p| left(p) > least(p)).copied().collect();
    reaching.sort_by(|a, b| left(b).total_cmp(&left(a)));
    reaching.truncate(MOST);
    Peaks { level, all, reaching }
}

/// Another mode as followed in its band; none where subtracting it does not make the remaining record smaller.
fn followed(rest: &[f64], dt: f64, band: Band, gate: &Gate, options: &Options) -> Option<Other> {
    let options =
        Options { band: Some((band.low, band.high)), near: None, order: None, window: None, ..*options };
    let InBand { mode, gate: own, .. } = behind_filter(rest, dt, band, &options, None).ok()?;
    // All modes begin with the same blow.
    let samples = mode.continued(&Gate { begin: gate.begin, ..own? })?;
    (power(&without(rest, &samples, gate.begin)) < power(rest)).then_some(Other { band, samples })
}

fn power(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum()
}
