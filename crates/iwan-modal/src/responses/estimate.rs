//! Frequency responses from hits: H1, H2 and Hv.

use std::borrow::Borrow;
use std::ops::Range;

use rayon::prelude::*;

use super::set::{FiniteRecord, FrequencyResponses, Function};
use super::transform::{Record, Room, Transform, quick_length, quick_length_from};
use crate::error::{Error, check};
use crate::measure::{Channel, Hit, Motion, Pulse};
use crate::number::{Complex, complex};

/// How averages over hits become a frequency response. Gff, Gfy and so on are averaged products of the spectra of force f and response y.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Estimator {
    /// Gfy/Gff: noise on the responses averages out.
    #[default]
    H1,
    /// Gyy/Gyf: noise on the force averages out.
    H2,
    /// The geometric mean of both, between them in phase and magnitude (Rocklin, Crowley, Vold, Proc. 3rd IMAC, 1985).
    Hv,
}

/// Windows in time.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Windows {
    /// Whether the force is taken as measured from end to end, noise after the pulse included; otherwise it is zero outside its pulse.
    pub whole_force: bool,
    /// Decay of an exponential window on force and responses, 1/s; 0: no window. With it the responses are those at s = iω + decay, which the fit
    /// takes into account: no damping has to be subtracted again.
    pub decay: f64,
}

/// Sampling intervals of hits may differ by this fraction: two units of the fifth and last digit that some files have. With more they are refused.
const SAME_INTERVAL: f64 = 2e-5;

/// Frequency responses of all pairs of response and force in `hits`, each averaged over the hits that hold the pair. Records longer than the
/// shortest are cut to its length; all are then cut by up to a thousandth to a length with small prime factors, whose transforms are quick.
///
/// # Errors
/// As [`Hit::check`]; [`Error::Refused`] without hits, where sampling intervals differ, and where a hit has two channels at one freedom.
///
/// ```
/// use iwan_modal::measure::{Channel, Freedom, Hit, Motion};
/// use iwan_modal::responses::{Estimator, Windows, frequency_responses};
/// // A response that is twice the force, two samples later.
/// let force: Vec<f64> = (0..128).map(|n| if n == 10 { 3.0 } else { 0.0 }).collect();
/// let channel = |name: &str, samples| Channel { name: name.into(), freedom: Freedom::point(name), samples };
/// let late: Vec<f64> = (0..128).map(|n| if n == 12 { 6.0 } else { 0.0 }).collect();
/// let hit = Hit { name: "tap".into(), dt: 1e-3, force: channel("hammer", force), responses: vec![channel("tip", late)] };
/// let found = frequency_responses(&[hit], Motion::Acceleration, Estimator::H1, Windows::default())?;
/// assert!((found.functions[0].values[5].norm() - 2.0).abs() < 1e-12);
/// # Ok::<(), iwan_modal::Error>(())
/// ```
pub fn frequency_responses<H: Borrow<Hit> + Sync>(
    hits: &[H],
    motion: Motion,
    estimator: Estimator,
    windows: Windows,
) -> Result<FrequencyResponses, Error> {
    check(
        "window decay",
        windows.decay,
        windows.decay >= 0.0,
        "0 or more, 1/s",
        "0 means no exponential window",
    )?;
    let hits: Vec<&Hit> = hits.iter().map(Borrow::borrow).collect();
    let (dt, samples) = common_times(&hits)?;
    averaged(&hits, dt, 0..samples, (motion, estimator, windows))
}

/// Frequency responses under the exponential window of `windows` from the begin of the hits alone: from the first pulse of the force, because noise before it would be loud under the window, up to
/// `after` seconds after the last one, because what comes later must be next to nothing under the window. The samples of the hits were checked when their responses were averaged.
pub(crate) fn early_responses(
    hits: &[&Hit],
    motion: Motion,
    estimator: Estimator,
    windows: Windows,
    after: f64,
) -> Result<FrequencyResponses, Error> {
    let (dt, samples) = times(hits)?;
    let pulse = |h: &&Hit| {
        let pulse = Pulse::of(&h.force.samples[..samples], dt, windows.whole_force);
        (pulse.start, pulse.start + pulse.force.len())
    };
    let (first, last) = hits.iter().map(pulse).fold((samples, 0), |all, p| (all.0.min(p.0), all.1.max(p.1)));
    let length = quick_length_from(last + (after / dt) as usize - first, samples - first);
    averaged(hits, dt, first..first + length, (motion, estimator, windows))
}

/// The responses of hits that were checked, from the samples in a range, which are taken every `dt` seconds.
fn averaged(
    hits: &[&Hit],
    dt: f64,
    range: Range<usize>,
    (motion, estimator, windows): (Motion, Estimator, Windows),
) -> Result<FrequencyResponses, Error> {
    let samples = range.len();
    let pulses: Vec<Pulse> =
        hits.iter().map(|h| Pulse::of(&h.force.samples[range.clone()], dt, windows.whole_force)).collect();
    let transform = Transform::new(samples, dt);
    let spectra: Vec<Vec<Complex>> = pulses.iter().map(|p| transform.one(&p.record(windows.decay))).collect();
    let pairs = pairs(hits)?;
    let window = exponential(windows.decay, samples, dt);
    // Two pairs are done together, so that their number of records is even for an odd number of hits as well.
    let functions = |room: &mut Room, some: &[Pair]| {
        let places: Vec<(usize, usize, usize)> = some
            .iter()
            .enumerate()
            .flat_map(|(p, pair)| pair.places.iter().map(move |(h, c)| (p, *h, *c)))
            .collect();
        let record = |(_, hit, channel): &(usize, usize, usize)| {
            Record::centred(&hits[*hit].responses[*channel].samples[range.clone()])
        };
        let mut averages: Vec<Average> = some.iter().map(|_| Average::new(transform.lines())).collect();
        transform.each(places.iter().map(record), window.as_deref(), room, |n, spectrum| {
            let (pair, hit, _) = places[n];
            averages[pair].add(&spectra[hit], spectrum);
        });
        let function = |(pair, average): (&Pair, Average)| {
            let force = &hits[pair.places[0].0].force;
            average.function(pair.first(hits), force, pair.places.len(), estimator)
        };
        some.iter().zip(averages).map(function).collect::<Vec<Function>>()
    };
    let functions = pairs.par_chunks(2).map_init(|| transform.room(), functions).flatten_iter().collect();
    let mean = |k: usize| spectra.iter().map(|f| f[k].norm_sqr()).sum::<f64>() / spectra.len() as f64;
    Ok(FrequencyResponses {
        step: 1.0 / (samples as f64 * dt),
        functions,
        motion,
        force: (0..spectra[0].len()).map(|k| mean(k).sqrt()).collect(),
        decay: windows.decay,
        record: Some(FiniteRecord::new(&pulses, &spectra)),
    })
}

/// The sampling interval of all hits, and the number of samples to which all of them are cut.
pub(super) fn common_times(hits: &[&Hit]) -> Result<(f64, usize), Error> {
    // All are looked at, so that it is the first fault that is said, however the work is divided.
    let checked: Vec<Result<(), Error>> = hits.par_iter().map(|hit| hit.check()).collect();
    checked.into_iter().collect::<Result<(), Error>>()?;
    times(hits)
}

/// As [`common_times`], of hits whose samples were checked.
fn times(hits: &[&Hit]) -> Result<(f64, usize), Error> {
    let Some(first) = hits.first() else {
        return Err(Error::refused("frequency responses", "there is no hit", "give at least one"));
    };
    for hit in hits {
        hit.check_times()?;
        if (hit.dt / first.dt - 1.0).abs() > SAME_INTERVAL {
            let finding =
                format!("sampled at {:.6} Hz, {} at {:.6} Hz", 1.0 / hit.dt, first.name, 1.0 / first.dt);
            return Err(Error::refused(
                &hit.name,
                finding,
                "give hits of one sampling rate, or resample them",
            ));
        }
    }
    Ok((first.dt, quick_length(hits.iter().map(|h| h.samples()).min().unwrap_or(0))))
}

/// A pair of response and force, with the (hit, channel) in which it was measured.
struct Pair {
    places: Vec<(usize, usize)>,
}

impl Pair {
    fn first<'a>(&self, hits: &[&'a Hit]) -> &'a Channel {
        let (hit, channel) = self.places[0];
        &hits[hit].responses[channel]
    }
}

fn pairs(hits: &[&Hit]) -> Result<Vec<Pair>, Error> {
    let mut pairs: Vec<Pair> = Vec::new();
    for (h, hit) in hits.iter().enumerate() {
        for (c, channel) in hit.responses.iter().enumerate() {
            if let Some(twin) = hit.responses[..c].iter().find(|other| other.freedom.is_at(&channel.freedom))
            {
                let finding =
                    format!("channels {} and {} both measure {}", twin.name, channel.name, channel.freedom);
                return Err(Error::refused(
                    &hit.name,
                    finding,
                    "give each channel its own point and direction",
                ));
            }
            let same = |pair: &&mut Pair| {
                let (first, _) = pair.places[0];
                pair.first(hits).freedom == channel.freedom && hits[first].force.freedom == hit.force.freedom
            };
            match pairs.iter_mut().find(same) {
                Some(pair) => pair.places.push((h, c)),
                None => pairs.push(Pair { places: vec![(h, c)] }),
            }
        }
    }
    Ok(pairs)
}

/// An exponential window over `samples` samples; none where it does not decay.
fn exponential(decay: f64, samples: usize, dt: f64) -> Option<Vec<f64>> {
    (decay > 0.0).then(|| (0..samples).map(|n| (-decay * n as f64 * dt).exp()).collect())
}

/// Sums over the hits of a pair at each line.
struct Average {
    /// Sums of |f|², of |y|² and of conj(f) y at each line, for force f and response y.
    sums: Vec<(f64, f64, Complex)>,
}

impl Average {
    fn new(lines: usize) -> Self {
        Self { sums: vec![(0.0, 0.0, complex(0.0, 0.0)); lines] }
    }

    fn add(&mut self, force: &[Complex], response: &[Complex]) {
        for ((ff, yy, fy), (f, y)) in self.sums.iter_mut().zip(force.iter().zip(response)) {
            *ff += f.norm_sqr();
            *yy += y.norm_sqr();
            *fy += f.conj() * y;
        }
    }

    fn function(self, response: &Channel, force: &Channel, hits: usize, estimator: Estimator) -> Function {
        let lines = self.sums.len();
        let (mut values, mut coherence, mut variance) = (Vec::with_capacity(lines), Vec::new(), Vec::new());
        for (ff, yy, fy) in self.sums {
            let (h1, cross) = (fy / ff.max(f64::MIN_POSITIVE), fy.norm_sqr());
            let ratio = if cross > 0.0 { (ff * yy / cross).max(1.0) } else { 1.0 };
            values.push(match estimator {
                Estimator::H1 => h1,
                Estimator::H2 => h1 * ratio,
                Estimator::Hv => h1 * ratio.sqrt(),
            });
            if hits > 1 {
                coherence.push(1.0 / ratio);
                variance.push(h1.norm_sqr() * (ratio - 1.0) / (hits - 1) as f64);
            }
        }
        let (name, response, force) =
            (response.name.clone(), response.freedom.clone(), force.freedom.clone());
        Function { name, response, force, hits, values, coherence, variance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Freedom;

    fn channel(name: &str, samples: Vec<f64>) -> Channel {
        Channel { name: name.into(), freedom: Freedom::point(name), samples }
    }

    fn hit(response: impl Fn(usize) -> f64, force: f64) -> Hit {
        let pulse = (0..256).map(|n| if n == 8 { force } else { 0.0 }).collect();
        let y = (0..256).map(|n| force * response(n)).collect();
        Hit {
            name: "tap.csv".into(),
            dt: 1e-3,
            force: channel("hammer", pulse),
            responses: vec![channel("a1", y)],
        }
    }

    #[test]
    fn noise_on_the_response_separates_the_estimators() {
        let (clean, other) =
            (|n: usize| f64::from(u8::from(n == 9)), |n: usize| if n == 9 { 1.2 } else { 0.0 });
        let hits = [hit(clean, 2.0), hit(other, 2.0)];
        let value = |e| {
            let found = frequency_responses(&hits, Motion::Acceleration, e, Windows::default()).unwrap();
            (
                found.functions[0].values[7].norm(),
                found.functions[0].coherence[7],
                found.functions[0].variance[7],
            )
        };
        let ((h1, c, v), (h2, ..), (hv, ..)) =
            (value(Estimator::H1), value(Estimator::H2), value(Estimator::Hv));
        assert!(
            (h1 - 1.1).abs() < 1e-12
                && (h2 - 1.22 / 1.1).abs() < 1e-12
                && (hv - (1.1 * h2).sqrt()).abs() < 1e-12
        );
        assert!((c - h1 / h2).abs() < 1e-12 && (v - 0.01).abs() < 1e-12, "{c} {v}");
    }

    #[test]
    fn what_does_not_belong_together_is_named() {
        let unit = |n: usize| f64::from(u8::from(n == 9));
        let refused = |hits: &[Hit]| {
            frequency_responses(hits, Motion::Acceleration, Estimator::H1, Windows::default())
                .unwrap_err()
                .to_string()
        };
        let mut slow = hit(unit, 1.0);
        (slow.name, slow.dt) = ("slow.csv".into(), 2e-3);
        let text = refused(&[hit(unit, 1.0), slow]);
        assert!(text.contains("slow.csv") && text.contains("500.0") && text.contains("tap.csv"), "{text}");
        let mut twice = hit(unit, 1.0);
        twice.responses.push(Channel { name: "a2".into(), ..twice.responses[0].clone() });
        assert!(refused(&[twice]).contains("a1 and a2"));
        let mut dead = hit(unit, 1.0);
        dead.responses[0].samples = vec![0.5; 256];
        assert!(refused(&[dead]).contains("tap.csv, channel a1"));
        let mut bad = hit(unit, 1.0);
        bad.responses[0].samples[3] = f64::NAN;
        assert!(refused(&[bad]).contains("sample 3"));
        assert!(refused(&[]).contains("no hit"));
    }
}
