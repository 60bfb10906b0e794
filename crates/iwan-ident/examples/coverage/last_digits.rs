//! Whether fits depend on the last digits of the samples, which no instrument and no compiler keeps.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use iwan_core::SplitMix64;
use iwan_ident::identify::Identification;
use iwan_ident::{Error, Parameter};

use crate::random::uniform;
use crate::tally::{Trial, outcome};

/// Relative size of the changes: some units in the last place.
const CHANGE: f64 = 1e-15;
/// Change of a value, in widths of its interval, from which on it is another value: searches end within a thousandth of the width.
const OTHER: f64 = 0.1;

/// The trial with other last digits.
fn changed(trial: &Trial, seed: u64) -> Vec<Vec<f64>> {
    let mut random = SplitMix64::new(seed);
    let mut other = |s: &f64| s * (1.0 + CHANGE * (2.0 * uniform(&mut random) - 1.0));
    trial.records.iter().map(|r| r.iter().map(&mut other).collect()).collect()
}

/// How two fits differ, in words; none where they agree.
fn difference(one: &Identification, two: &Identification) -> Option<String> {
    let of = |parameter: Parameter| {
        let (p, q) = (one.profile(parameter), two.profile(parameter));
        let ends = |p: &iwan_ident::profile::Profile| (p.low, p.high);
        if (p.low.is_some(), p.high.is_some()) != (q.low.is_some(), q.high.is_some()) {
            return Some(format!("{} {:?} or {:?}", parameter.name(), ends(p), ends(q)));
        }
        let width = p.high.zip(p.low).map(|(high, low)| high - low)?;
        let (x, y) = (one.parameters.get(parameter), two.parameters.get(parameter));
        ((x - y).abs() > OTHER * width).then(|| format!("{} {x} or {y}, width {width}", parameter.name()))
    };
    let grades = (one.verdict.grade != two.verdict.grade)
        .then(|| format!("{} or {}", one.verdict.grade.name(), two.verdict.grade.name()));
    let all: Vec<String> = grades.into_iter().chain(Parameter::ALL.into_iter().filter_map(of)).collect();
    let left =
        || format!("; left {:.2e} or {:.2e}", one.refined.relative_residual, two.refined.relative_residual);
    (!all.is_empty()).then(|| all.join("; ") + &left())
}

/// Fits each record as it is and `copies` times with other last digits; writes those that differ and how many they are.
#[allow(clippy::print_stdout)] // a program for the terminal
pub(crate) fn run(
    seeds: std::ops::Range<u64>,
    copies: u64,
    make: impl Fn(u64) -> Result<Trial, Error> + Sync,
) {
    let (next, counts) = (AtomicU64::new(seeds.start), Mutex::new([0_u32; 2]));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= seeds.end {
                        break;
                    }
                    let Ok(mut trial) = make(seed) else { continue };
                    let Ok(plain) = outcome(&trial) else { continue };
                    let original = trial.records.clone();
                    for copy in 0..copies {
                        trial.records.clone_from(&original);
                        trial.records = changed(&trial, 1000 * seed + copy);
                        let said = match outcome(&trial) {
                            Ok(other) => difference(&plain, &other),
                            Err(error) => Some(error.to_string()),
                        };
                        let mut counts = counts.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
                        counts[0] += 1;
                        if let Some(said) = said {
                            counts[1] += 1;
                            println!("{seed}: {said}");
                        }
                    }
                }
            });
        }
    });
    let [fits, others] = *counts.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    println!("last digits: {others} of {fits} fits differ from those of the records as they are");
}
