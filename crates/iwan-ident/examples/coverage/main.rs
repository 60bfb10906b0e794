//! Statistics of fits that take too long for a test: how often 95 % intervals hold the truth.
//!
//! `softening COUNT`: random joints from 5 % to three times the residual stiffness, released at 0.2 to 4 φ_max, 20 to 500 cycles
//! of 10 to 100 samples, without noise. `noise COUNT DB`: random joints of 1 to 30 % of the stiffness in noise of so many decibels below the
//! record's root mean square. `neighbours COUNT DB [band]`: the same beside one or two other modes at 1.05 to 3 times the frequency, as
//! loud or up to thirty times less, all automatic or with a band about the mode. `repeats COUNT`: four hits of a specimen whose frequency strays by 0.3 % from
//! hit to hit and whose damping by 3 %: how often the intervals hold the specimen's mean. `sliders`: README's mode cut into 20, 100 and 1000 sliders, under three blows, in records of three
//! lengths. `digits COUNT [COPIES]`: the records of `softening` as they are and with other last digits. `FIRST` in the environment is the first seed.
//! `scripts/validate` runs all of them; the last figures stand in the book's chapter on validation.

#[path = "../../tests/law_records/in_noise.rs"]
mod in_noise;
mod last_digits;
#[path = "../../tests/law_records/random.rs"]
mod random;
#[path = "../../tests/law_records/sliders.rs"]
mod sliders;
#[path = "../../tests/law_records/softening.rs"]
mod softening;
mod tally;

use in_noise::{MadeRecord, add_noise, in_noise, moderate, phi_max, ring_down};
use iwan_core::SplitMix64;
use iwan_ident::identify::Settings;
use iwan_ident::signal::Options;
use iwan_ident::{Error, Parameters};
use random::{normal, scale, uniform};
use tally::{Trial, run};

/// Hits of a specimen in `repeats`.
const HITS: usize = 4;
/// Relative standard deviations of frequency and of damping from hit to hit there.
const SCATTER: [f64; 2] = [0.003, 0.03];

fn noisy(seed: u64, decibels: f64) -> Result<Trial, Error> {
    let MadeRecord { truth, dt, samples } = in_noise(seed, decibels)?;
    Ok(Trial { truths: vec![truth], records: vec![samples], dt, settings: Settings::default() })
}

fn softening(seed: u64) -> Result<Trial, Error> {
    let MadeRecord { truth, dt, samples } = softening::softening(seed)?;
    Ok(Trial { truths: vec![truth], records: vec![samples], dt, settings: Settings::default() })
}

/// Sliders, amplitudes of the blow and lengths (s) of the records of README's mode.
const CUT_INTO: [usize; 3] = [20, 100, 1000];
const BLOWS: [f64; 3] = [100.0, 1000.0, 3000.0];
const LENGTHS: [f64; 3] = [0.2, 0.5, 2.0];

/// README's mode simulated with few and with many sliders.
fn cut_into_sliders(case: u64) -> Result<Trial, Error> {
    let case = case as usize;
    let (cut, amplitude, seconds) = (CUT_INTO[case / 9 % 3], BLOWS[case / 3 % 3], LENGTHS[case % 3]);
    let samples = sliders::blow(cut, amplitude, seconds)?;
    let settings = Settings::default();
    Ok(Trial { truths: vec![sliders::README], records: vec![samples], dt: sliders::STEP, settings })
}

/// A point of a structure: the mode, and one or two others at 1.05 to 3 times its frequency (or as far below it), as loud or up to thirty times less.
fn neighbours(seed: u64, decibels: f64, banded: bool) -> Result<Trial, Error> {
    let mut random = SplitMix64::new(9000 + seed);
    let frequency = scale(&mut random, 20.0, 500.0);
    let mut truths = vec![moderate(&mut random, frequency)];
    let count = if uniform(&mut random) < 0.5 { 1 } else { 2 };
    for _ in 0..count {
        let ratio = scale(&mut random, 1.05, 3.0);
        let other = if uniform(&mut random) < 0.5 { frequency * ratio } else { frequency / ratio };
        truths.push(moderate(&mut random, other));
    }
    let highest = truths.iter().map(|p| p.frequency).fold(0.0, f64::max);
    let lowest = truths.iter().map(|p| p.frequency).fold(f64::INFINITY, f64::min);
    let (per_cycle, cycles) = (scale(&mut random, 10.0, 40.0), scale(&mut random, 60.0, 400.0));
    let dt = 1.0 / (highest * per_cycle);
    let length = (cycles / (lowest * dt)) as usize;
    let mut samples = vec![0.0; length];
    let mut loudest = None;
    for truth in &mut truths {
        let start = scale(&mut random, 0.1, 2.0) * phi_max(truth)?;
        let of_mode = ring_down(truth, start, dt, length)?;
        let own = of_mode[0].abs();
        // What the point sees of another mode is its motion times a factor of either sign; to that motion its joint slips so many times later.
        let factor = match loudest {
            None => 1.0,
            Some(loudest) => loudest / own / scale(&mut random, 1.0, 30.0),
        };
        let sign = if loudest.is_some() && uniform(&mut random) < 0.5 { -1.0 } else { 1.0 };
        loudest = loudest.or(Some(own));
        truth.f_s *= factor;
        samples.iter_mut().zip(&of_mode).for_each(|(s, x)| *s += sign * factor * x);
    }
    add_noise(&mut samples, decibels, &mut random);
    let distance =
        truths[1..].iter().map(|p| (p.frequency / frequency).ln().abs()).fold(f64::INFINITY, f64::min);
    let half = (0.5 * distance).min(0.25);
    let band = banded.then(|| (frequency * (-half).exp(), frequency * half.exp()));
    let options = Options { band, ..Options::default() };
    Ok(Trial { truths, records: vec![samples], dt, settings: Settings { options, ..Settings::default() } })
}

/// Hits of a specimen that does not repeat itself.
fn repeats(seed: u64) -> Result<Trial, Error> {
    let mut random = SplitMix64::new(13000 + seed);
    let frequency = scale(&mut random, 20.0, 1000.0);
    let truth = moderate(&mut random, frequency);
    let (per_cycle, cycles) = (scale(&mut random, 10.0, 40.0), scale(&mut random, 60.0, 300.0));
    let dt = 1.0 / (frequency * per_cycle);
    let loudest = scale(&mut random, 0.1, 0.6) * phi_max(&truth)?;
    let hit = |_| {
        let [frequency, damping] = SCATTER.map(|s| 1.0 + s * normal(&mut random));
        // Dissipation in micro-slip goes with R, which is K_T over phi_max to the power 1 + chi: so the slip force carries it.
        let own = Parameters {
            frequency: truth.frequency * frequency,
            damping_ratio: truth.damping_ratio * damping,
            f_s: truth.f_s * damping.powf(-1.0 / (1.0 + truth.chi)),
            ..truth
        };
        let displacement = loudest * scale(&mut random, 0.4, 1.0);
        let mut samples = ring_down(&own, displacement, dt, (cycles * per_cycle) as usize)?;
        add_noise(&mut samples, 50.0, &mut random);
        Ok(samples)
    };
    let records = (0..HITS).map(hit).collect::<Result<Vec<_>, Error>>()?;
    Ok(Trial { truths: vec![truth], records, dt, settings: Settings::default() })
}

#[allow(clippy::print_stderr)] // a program for the terminal
fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |i: usize| arguments.get(i).and_then(|a| a.parse::<f64>().ok());
    let first = std::env::var("FIRST").ok().and_then(|f| f.parse::<u64>().ok()).unwrap_or(0);
    let seeds = |count: f64| first..first + count as u64;
    let banded = arguments.get(3).is_some_and(|a| a == "band");
    match (arguments.first().map(String::as_str), number(1), number(2)) {
        (Some("softening"), Some(count), _) => run("softening", seeds(count), softening),
        (Some("noise"), Some(count), Some(db)) => {
            run(&format!("noise of {db} dB"), seeds(count), |seed| noisy(seed, db));
        }
        (Some("neighbours"), Some(count), Some(db)) => {
            let name = format!("neighbours{}, {db} dB", if banded { ", with a band" } else { "" });
            run(&name, seeds(count), |seed| neighbours(seed, db, banded));
        }
        (Some("repeats"), Some(count), _) => run("repeats", seeds(count), repeats),
        (Some("digits"), Some(count), copies) => {
            last_digits::run(seeds(count), copies.unwrap_or(1.0) as u64, softening);
        }
        (Some("sliders"), ..) => run("sliders", 0..27, cut_into_sliders),
        _ => {
            eprintln!(
                "usage: coverage softening COUNT | noise COUNT DB | neighbours COUNT DB [band] | repeats COUNT | sliders | digits COUNT [COPIES]"
            );
            std::process::exit(2);
        }
    }
}
