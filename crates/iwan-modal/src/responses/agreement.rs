//! Whether hits agree channel by channel: cables that were swapped, sensors that were turned round, structures that changed between hits.

use std::borrow::Borrow;
use std::fmt;

use rayon::prelude::*;

use super::estimate::common_times;
use super::shift::{Shift, shift};
use super::transform::{Record, Room, Transform};
use crate::error::Error;
use crate::measure::{Hit, Pulse};
use crate::number::{Complex, complex};

/// Lines are compared up to where the force's spectrum falls below this fraction of its largest value.
const FORCE_LEFT: f64 = 0.03;
/// A channel is looked at where its correlation with the same channel of the other hits is below this: noise of 0 dB on both gives 0.5, a mode that moves
/// by its own width from hit to hit 0.7.
const UNLIKE: f64 = 0.7;
/// A channel is another one where its correlation with that one is above this. A judgement: neighbours on a structure may be that alike, and are told apart
/// because they are then above UNLIKE with themselves as well.
const ALIKE: f64 = 0.9;

/// A channel of a hit, or a mode, that does not agree with the other hits.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Disagreement {
    /// Two channels are swapped.
    Swapped {
        /// Name of the hit.
        hit: String,
        /// The two channels.
        channels: [String; 2],
        /// Name of another hit.
        other: String,
    },
    /// A channel has the opposite sign of the same channel in the other hits.
    Reversed {
        /// Name of the hit.
        hit: String,
        /// The channel.
        channel: String,
        /// Name of another hit.
        other: String,
    },
    /// A mode has different frequencies in two hits.
    Shifted {
        /// Names of the two hits between which it moves most.
        hits: [String; 2],
        /// Its frequencies there, Hz.
        frequencies: [f64; 2],
        /// Its width at half power, Hz.
        width: f64,
    },
}

impl fmt::Display for Disagreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Swapped { hit, channels: [a, b], other } => {
                write!(f, "{hit}: channels {a} and {b} are swapped against {other}")
            }
            Self::Reversed { hit, channel, other } => {
                write!(f, "{hit}: channel {channel} is reversed against {other}")
            }
            Self::Shifted { hits: [a, b], frequencies, width } => write!(
                f,
                "the mode at {:.3} Hz in {a} stands at {:.3} Hz in {b}, and is {width:.2} Hz wide: the structure changed between hits, and their average shows one mode as several; \
                 analyse hits that are alike, without the others (--leave-out)",
                frequencies[0], frequencies[1]
            ),
        }
    }
}

/// Channels of hits at one point that do not agree with those of the other hits there, and modes that move between hits. Of two hits the second is named, as nothing says
/// which of them is wrong; of more hits the one that differs from the rest.
/// is wrong; of more the one that is alone.
///
/// # Errors
/// As [`frequency_responses`](super::frequency_responses).
///
/// ```
/// use iwan_modal::measure::{Channel, Freedom, Hit};
/// use iwan_modal::responses::disagreements;
/// let channel = |name: &str, samples| Channel { name: name.into(), freedom: Freedom::point(name), samples };
/// let force: Vec<f64> = (0..256).map(|n| if n == 10 { 1.0 } else { 0.0 }).collect();
/// let wave = |w: f64| (0..256).map(|n| if n < 10 { 0.0 } else { (w * n as f64).sin() }).collect::<Vec<f64>>();
/// let hit = |name: &str, a, b| Hit {
///     name: name.into(), dt: 1e-3, force: channel("hammer", force.clone()), responses: vec![channel("a", wave(a)), channel("b", wave(b))],
/// };
/// let found = disagreements(&[hit("one", 0.3, 0.5), hit("two", 0.5, 0.3)])?;
/// assert_eq!(found[0].to_string(), "two: channels a and b are swapped against one");
/// # Ok::<(), iwan_modal::Error>(())
/// ```
pub fn disagreements<H: Borrow<Hit>>(hits: &[H]) -> Result<Vec<Disagreement>, Error> {
    let hits: Vec<&Hit> = hits.iter().map(Borrow::borrow).collect();
    let (dt, samples) = common_times(&hits)?;
    let mut points: Vec<_> = hits.iter().map(|h| &h.force.freedom).collect();
    points.sort();
    points.dedup();
    let at = |point: &crate::measure::Freedom| {
        hits.iter().copied().filter(|h| h.force.freedom == *point).collect::<Vec<&Hit>>()
    };
    let groups = points.into_iter().map(at).filter(|group| group.len() > 1);
    Ok(groups.flat_map(|group| of_group(&group, dt, samples)).collect())
}

/// Products of a hit's force and responses, `[channel][line]`, for the channels that all hits of the group have.
struct Products(Vec<Vec<Complex>>);

fn of_group(hits: &[&Hit], dt: f64, samples: usize) -> Vec<Disagreement> {
    let in_all = |c: &&crate::measure::Channel| {
        hits.iter().all(|h| h.responses.iter().any(|other| other.freedom == c.freedom))
    };
    let common: Vec<_> = hits[0].responses.iter().filter(in_all).collect();
    let place = |hit: &Hit, c: usize| {
        hit.responses.iter().position(|own| own.freedom == common[c].freedom).unwrap_or(c)
    };
    let transform = Transform::new(samples, dt);
    let products = |hit: &&Hit| {
        let force = transform.one(&Pulse::of(&hit.force.samples[..samples], dt, false).record(0.0));
        let strongest = force.iter().map(|f| f.norm()).fold(0.0, f64::max);
        let lines = force.iter().position(|f| f.norm() < FORCE_LEFT * strongest).unwrap_or(force.len());
        let some = |room: &mut Room, two: &[usize]| {
            let mut found = Vec::with_capacity(2);
            let record = |c: &usize| Record::of(&hit.responses[place(hit, *c)].samples[..samples]);
            // The first line is the mean, which no sensor measures.
            transform.each(two.iter().map(record), None, room, |_, y| {
                found.push((1..lines).map(|k| force[k].conj() * y[k]).collect::<Vec<Complex>>());
            });
            found
        };
        let channels: Vec<usize> = (0..common.len()).collect();
        Products(channels.par_chunks(2).map_init(|| transform.room(), some).flatten_iter().collect())
    };
    let all: Vec<Products> = hits.par_iter().map(products).collect();
    let sum = |c: usize| -> Vec<Complex> {
        let lines = all.iter().map(|p| p.0[c].len()).min().unwrap_or(0);
        (0..lines).map(|k| all.iter().map(|p| p.0[c][k]).sum()).collect()
    };
    let sums: Vec<Vec<Complex>> = (0..common.len()).into_par_iter().map(sum).collect();
    let name = |h: usize, c: usize| hits[h].responses[place(hits[h], c)].name.clone();
    // Where there are only two hits, both would be named, so only the second is looked at.
    let first = usize::from(hits.len() == 2);
    let of_hit = |h: usize| {
        let mut found = Vec::new();
        let other = hits[usize::from(h == 0)].name.clone();
        let alike = |c: usize, d: usize| correlation(&all[h].0[c], &sums[d], &all[h].0[d]);
        let doubtful: Vec<usize> = (0..common.len()).filter(|c| alike(*c, *c) < UNLIKE).collect();
        for (n, &c) in doubtful.iter().enumerate() {
            let hit = hits[h].name.clone();
            if alike(c, c) < -ALIKE {
                found.push(Disagreement::Reversed { hit, channel: name(h, c), other: other.clone() });
                continue;
            }
            let partner = doubtful[n + 1..].iter().find(|d| alike(c, **d) > ALIKE && alike(**d, c) > ALIKE);
            if let Some(&d) = partner {
                let channels = [name(h, c), name(h, d)];
                found.push(Disagreement::Swapped { hit, channels, other: other.clone() });
            }
        }
        found
    };
    let found: Vec<Vec<Disagreement>> = (first..hits.len()).into_par_iter().map(of_hit).collect();
    let mut found = found.concat();
    found.extend(shifted(hits, &all, 1.0 / (samples as f64 * dt)));
    found
}

/// A mode that moves from hit to hit, found in the sum of all channels; `step` is the distance of lines, Hz.
fn shifted(hits: &[&Hit], products: &[Products], step: f64) -> Option<Disagreement> {
    let whole = |p: &Products| -> Vec<f64> {
        let lines = p.0.first().map_or(0, Vec::len);
        (0..lines).map(|k| p.0.iter().map(|channel| channel[k].norm()).sum()).collect()
    };
    let Shift { hits: moved, lines, width } = shift(&products.iter().map(whole).collect::<Vec<_>>())?;
    Some(Disagreement::Shifted {
        hits: moved.map(|h| hits[h].name.clone()),
        // The first line, the mean, is not among the products.
        frequencies: lines.map(|line| (line + 1.0) * step),
        width: width * step,
    })
}

/// Correlation of a channel's products with those of another channel in all other hits, which are `sum` less `own`.
fn correlation(x: &[Complex], sum: &[Complex], own: &[Complex]) -> f64 {
    let (mut both, mut xx, mut yy) = (complex(0.0, 0.0), 0.0, 0.0);
    for ((x, sum), own) in x.iter().zip(sum).zip(own) {
        let y = sum - own;
        both += x.conj() * y;
        xx += x.norm_sqr();
        yy += y.norm_sqr();
    }
    both.re / (xx * yy).sqrt().max(f64::MIN_POSITIVE)
}
