//! Statistics of fits that take too long for a test: how often 95 % intervals hold the truth.
//!
//! `softening COUNT`: random joints from 5 % to three times the residual stiffness, released at 0.2 to 4 φ_max, 20 to 500 cycles
//! of 10 to 100 samples, without noise. `noise COUNT DB`: random joints of 1 to 30 % of the stiffness in noise of so many decibels below the
//! record's root mean square. `scripts/validate` runs both; the last figures stand in the book's chapter on validation.

#[path = "../tests/law_records/random.rs"]
mod random;

use std::f64::consts::TAU;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use iwan_core::{Decay, Motion, Reversal, Samples, SplitMix64};
use iwan_ident::curves::Quantity;
use iwan_ident::identify::{Identification, ModeRecord, Settings, identify};
use iwan_ident::{Error, Parameter, Parameters};
use random::{between, normal, scale};

/// One random ring-down.
struct Trial {
    truth: Parameters,
    samples: Vec<f64>,
    dt: f64,
}

/// What a trial's intervals did, summed up over trials.
#[derive(Default, Clone, Copy)]
struct Tally {
    closed: [u32; 6],
    held: [u32; 6],
    /// Closed intervals that miss by more than their width.
    far: [u32; 6],
    refused: u32,
    /// Trials with at least one interval that misses by more than its width.
    wrong: u32,
}

fn ring_down(truth: &Parameters, ratio: f64, dt: f64, count: usize) -> Result<Vec<f64>, Error> {
    let (oscillator, joint) = truth.model()?;
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; count]);
    let stack = vec![Reversal::default(); (3.0 * count as f64 * dt * truth.frequency) as usize + 64];
    let [displacement, velocity, acceleration, joint_force] = &mut out;
    let start = Motion::held_at(ratio * joint.phi_max());
    Decay::new(&oscillator, &joint, 0.0, start, stack)?
        .sample(dt, &mut Samples { displacement, velocity, acceleration, joint_force })?;
    let [_, _, acceleration, _] = out;
    Ok(acceleration)
}

fn softening(seed: u64) -> Result<Trial, Error> {
    let mut random = SplitMix64::new(1000 + seed);
    let frequency = scale(&mut random, 20.0, 1000.0);
    let ratio = scale(&mut random, 0.05, 3.0);
    let truth = Parameters {
        frequency,
        damping_ratio: scale(&mut random, 1e-4, 3e-3),
        k_t: (TAU * frequency).powi(2) * ratio / (1.0 + ratio),
        f_s: scale(&mut random, 10.0, 1000.0),
        chi: between(&mut random, -0.8, 0.0),
        beta: scale(&mut random, 0.02, 3.0),
    };
    let (start, cycles, per_cycle) =
        (scale(&mut random, 0.2, 4.0), scale(&mut random, 20.0, 500.0), scale(&mut random, 10.0, 100.0));
    let dt = 1.0 / (frequency * per_cycle);
    let samples = ring_down(&truth, start, dt, (cycles * per_cycle) as usize)?;
    Ok(Trial { truth, samples, dt })
}

fn noisy(seed: u64, decibels: f64) -> Result<Trial, Error> {
    let mut random = SplitMix64::new(5000 + seed);
    let frequency = scale(&mut random, 20.0, 1000.0);
    let truth = Parameters {
        frequency,
        damping_ratio: scale(&mut random, 1e-4, 3e-3),
        k_t: (TAU * frequency).powi(2) * scale(&mut random, 0.01, 0.3),
        f_s: scale(&mut random, 10.0, 1000.0),
        chi: between(&mut random, -0.9, 0.0),
        beta: scale(&mut random, 0.02, 3.0),
    };
    let (per_cycle, cycles) = (scale(&mut random, 10.0, 60.0), scale(&mut random, 40.0, 400.0));
    let dt = 1.0 / (frequency * per_cycle);
    let start = scale(&mut random, 0.1, 2.0);
    let mut samples = ring_down(&truth, start, dt, (cycles * per_cycle) as usize)?;
    let mean_square = samples.iter().map(|x| x * x).sum::<f64>() / samples.len() as f64;
    let deviation = mean_square.sqrt() * 10.0_f64.powf(-decibels / 20.0);
    for x in &mut samples {
        *x += deviation * normal(&mut random);
    }
    Ok(Trial { truth, samples, dt })
}

impl Tally {
    fn add(&mut self, truth: &Parameters, found: Result<Identification, Error>) {
        let Ok(found) = found else {
            self.refused += 1;
            return;
        };
        let mut wrong = false;
        for (k, parameter) in Parameter::ALL.into_iter().enumerate() {
            let profile = found.profile(parameter);
            if let (Some(low), Some(high)) = (profile.low, profile.high) {
                let value = truth.get(parameter);
                let missed = (low - value).max(value - high);
                self.closed[k] += 1;
                self.held[k] += u32::from(missed <= 0.0);
                self.far[k] += u32::from(missed > high - low);
                wrong |= missed > high - low;
            }
        }
        self.wrong += u32::from(wrong);
    }
}

/// Runs all trials on two threads and writes the tally.
#[allow(clippy::print_stdout)] // a program for the terminal
fn run(name: &str, count: u64, make: impl Fn(u64) -> Result<Trial, Error> + Sync) {
    let (next, tally) = (AtomicU64::new(0), Mutex::new(Tally::default()));
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let seed = next.fetch_add(1, Ordering::Relaxed);
                    if seed >= count {
                        break;
                    }
                    let Ok(Trial { truth, samples, dt }) = make(seed) else { continue };
                    let record = ModeRecord { samples: &samples, dt, quantity: Quantity::Acceleration };
                    let found = identify(&[record], &Settings::default());
                    tally.lock().unwrap_or_else(std::sync::PoisonError::into_inner).add(&truth, found);
                }
            });
        }
    });
    let tally = *tally.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    println!(
        "{name}: {count} records, {} refused, {} with an interval that misses by more than its width",
        tally.refused, tally.wrong
    );
    println!("{:<16}{:>8}{:>14}{:>24}", "parameter", "closed", "hold, %", "miss by a width, count");
    for (k, parameter) in Parameter::ALL.into_iter().enumerate() {
        let part = 100.0 * f64::from(tally.held[k]) / f64::from(tally.closed[k].max(1));
        println!("{:<16}{:>8}{part:>14.1}{:>24}", parameter.name(), tally.closed[k], tally.far[k]);
    }
}

#[allow(clippy::print_stderr)] // a program for the terminal
fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize| arguments.get(i).and_then(|a| a.parse::<f64>().ok());
    match (arguments.first().map(String::as_str), number(1), number(2)) {
        (Some("softening"), Some(count), _) => run("softening", count as u64, softening),
        (Some("noise"), Some(count), Some(db)) => {
            run(&format!("noise of {db} dB"), count as u64, |seed| noisy(seed, db));
        }
        _ => {
            eprintln!("usage: coverage softening COUNT | noise COUNT DB");
            std::process::exit(2);
        }
    }
}
