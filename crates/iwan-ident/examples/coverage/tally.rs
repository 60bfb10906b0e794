//! What intervals did, summed up over trials.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use iwan_ident::curves::Quantity;
use iwan_ident::identify::{Identification, ModeRecord, Settings, identify};
use iwan_ident::{Error, Parameter, Parameters};

/// Records of one mode of known parameters.
pub(crate) struct Trial {
    /// The modes that the records hold: the fit is compared with the one whose frequency it finds.
    pub(crate) truths: Vec<Parameters>,
    pub(crate) records: Vec<Vec<f64>>,
    pub(crate) dt: f64,
    pub(crate) settings: Settings,
}

/// Of each parameter, over all trials.
#[derive(Default, Clone, Copy)]
struct Tally {
    closed: [u32; 6],
    held: [u32; 6],
    /// Closed intervals that miss by more than their width.
    far: [u32; 6],
    /// Half-open intervals, and those that miss.
    half: [u32; 6],
    half_missed: [u32; 6],
    refused: u32,
    /// Trials with at least one interval that misses by more than its width.
    wrong: u32,
}

impl Tally {
    /// Whether an interval misses by more than its width.
    fn add(&mut self, truth: &Parameters, found: &Identification) -> bool {
        let mut wrong = false;
        for (k, parameter) in Parameter::ALL.into_iter().enumerate() {
            let profile = found.profile(parameter);
            let value = truth.get(parameter);
            match (profile.low, profile.high) {
                (Some(low), Some(high)) => {
                    let missed = (low - value).max(value - high);
                    self.closed[k] += 1;
                    self.held[k] += u32::from(missed <= 0.0);
                    self.far[k] += u32::from(missed > high - low);
                    wrong |= missed > high - low;
                }
                (None, None) => {}
                (low, high) => {
                    self.half[k] += 1;
                    let missed = low.is_some_and(|l| l > value) || high.is_some_and(|h| h < value);
                    self.half_missed[k] += u32::from(missed);
                }
            }
        }
        self.wrong += u32::from(wrong);
        wrong
    }
}

/// The mode of the trial that was found.
fn nearest<'a>(truths: &'a [Parameters], found: &Identification) -> Option<&'a Parameters> {
    let off = |p: &Parameters| (p.frequency / found.parameters.frequency).ln().abs();
    truths.iter().min_by(|a, b| off(a).total_cmp(&off(b)))
}

pub(crate) fn outcome(trial: &Trial) -> Result<Identification, Error> {
    let record = |samples| ModeRecord { samples, dt: trial.dt, quantity: Quantity::Acceleration };
    let records: Vec<ModeRecord<'_>> = trial.records.iter().map(|r| record(r.as_slice())).collect();
    identify(&records, &trial.settings)
}

/// What a trial was and what came out of it, for who wants to see each.
#[allow(clippy::print_stdout)] // a program for the terminal
fn tell(seed: u64, truth: &Parameters, found: &Identification, wrong: bool) {
    let mark = if wrong { "WRONG" } else { "" };
    println!("{seed} {mark} {truth:?} grade {}", found.verdict.grade.name());
    for parameter in Parameter::ALL {
        let p = found.profile(parameter);
        let (value, best) = (truth.get(parameter), found.parameters.get(parameter));
        println!("   {:<14} {value:12.6} found {best:12.6} {:?} {:?}", parameter.name(), p.low, p.high);
    }
    for word in found.in_words().iter().chain(&found.notes) {
        println!("   {word}");
    }
}

/// Runs trials on as many threads as `threads` and writes the tally; each trial as well where the environment has `ALL`, those that miss
/// by a width where it has `WRONG`.
#[allow(clippy::print_stdout)] // a program for the terminal
pub(crate) fn run(
    name: &str,
    seeds: std::ops::Range<u64>,
    make: impl Fn(u64) -> Result<Trial, Error> + Sync,
) {
    let (all, some) = (std::env::var_os("ALL").is_some(), std::env::var_os("WRONG").is_some());
    let threads = std::env::var("THREADS").ok().and_then(|t| t.parse().ok()).unwrap_or(2);
    let (next, tally, count) =
        (AtomicU64::new(seeds.start), Mutex::new(Tally::default()), seeds.end - seeds.start);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= seeds.end {
                        break;
                    }
                    let Ok(trial) = make(seed) else { continue };
                    let found = outcome(&trial);
                    let mut tally = tally.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                    match found.as_ref().map(|f| (f, nearest(&trial.truths, f))) {
                        Ok((found, Some(truth))) => {
                            let wrong = tally.add(truth, found);
                            if all || (some && wrong) {
                                tell(seed, truth, found, wrong);
                            }
                        }
                        Ok((_, None)) => {}
                        Err(error) => {
                            tally.refused += 1;
                            if all {
                                println!("{seed} refused: {error}");
                            }
                        }
                    }
                }
            });
        }
    });
    let tally = *tally.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    println!(
        "{name}: {count} records, {} refused, {} with an interval that misses by more than its width",
        tally.refused, tally.wrong
    );
    println!(
        "{:<16}{:>8}{:>10}{:>24}{:>12}{:>10}",
        "parameter", "closed", "hold, %", "miss by a width, count", "half open", "hold, %"
    );
    let part = |of: u32, all: u32| 100.0 * f64::from(of) / f64::from(all.max(1));
    for (k, parameter) in Parameter::ALL.into_iter().enumerate() {
        let Tally { closed, held, far, half, half_missed, .. } = tally;
        println!(
            "{:<16}{:>8}{:>10.1}{:>24}{:>12}{:>10.1}",
            parameter.name(),
            closed[k],
            part(held[k], closed[k]),
            far[k],
            half[k],
            part(half[k] - half_missed[k], half[k])
        );
    }
}
