//! How often the 95 % intervals of a coupled fit hold what the records were made with: two modes that share one joint in the continuum, under
//! blows of three levels with noise. `coupled_coverage REPEATS DECIBELS`; estimates that miss are printed, and with `ALL` in the environment all of them.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::too_many_lines,
    reason = "an example with fixed numbers that says what it found"
)]

#[path = "../tests/shared_records/mod.rs"]
mod shared_records;

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use iwan_core::progress::UNWATCHED;
use iwan_core::{Pulse, SplitMix64};
use iwan_ident::Parameters;
use iwan_ident::coupled::{CoupledRecord, CoupledTask, Seen, Sharing, UncoupledMode, Unknown, fit_coupled};
use iwan_ident::curves::Quantity;
use shared_records::Pair;

/// The paper's beam, bending 1 and 3, with the first mode's slip as unit: frequencies, shapes at the load, the law, and what else is unknown.
const FREQUENCIES: [f64; 2] = [132.351, 696.242];
const SHAPES: [f64; 2] = [23.5, 22.0];
const LAW: [f64; 4] = [31_600.0, 143.8, -0.3, 0.02];
const SLIP: f64 = -4.905;
const COMPLIANCE: f64 = 0.2875;
/// Of the structure's statics, in that unit.
const SLIP_AT_FORCE: f64 = 1.58e-6;
const DAMPING: f64 = 2e-4;
const DT: f64 = 1e-5;
const SAMPLES: usize = 20_001;
/// Steps for each sample of the records: their own error is a 256th of that of one step.
const FINER: usize = 16;

fn record(level: f64) -> CoupledRecord {
    let pair = Pair {
        frequencies: FREQUENCIES,
        damping_ratio: DAMPING,
        shapes: SHAPES,
        law: LAW,
        slip: SLIP,
        compliance: COMPLIANCE,
        slip_at_force: SLIP_AT_FORCE,
    };
    // In finer steps: with those of the fit itself the records would have its error, which no measured record has.
    let blow = Pulse::Haversine { amplitude: level, duration: 1.6e-3 };
    let (motions, force) = pair.struck(&blow, DT / FINER as f64, FINER * (SAMPLES - 1) + 1);
    let sampled = |x: &Vec<f64>| x.iter().step_by(FINER).copied().collect::<Vec<_>>();
    CoupledRecord {
        name: format!("{level} lbf"),
        dt: DT,
        motions: motions.iter().map(sampled).collect(),
        force: Some(sampled(&force)),
    }
}

fn main() {
    let number = |n: usize, otherwise: f64| {
        std::env::args().nth(n).map_or(otherwise, |text| text.parse().expect("a number"))
    };
    let (repeats, decibels) = (number(1, 100.0) as u64, number(2, 40.0));
    let clean: Vec<CoupledRecord> = [10.0, 100.0, 1000.0].map(record).to_vec();
    let mode = |name: &str, frequency, k_t, f_s| UncoupledMode {
        name: name.into(),
        parameters: Parameters { frequency, damping_ratio: 3e-4, k_t, f_s, chi: -0.2, beta: 0.2 },
    };
    let modes = [mode("bending 1", 132.3, 4.7e4, 215.0), mode("bending 3", 696.0, 1.08e6, 990.0)];
    let truth = |unknown: Unknown| match unknown {
        Unknown::Frequency(r) => FREQUENCIES[r],
        Unknown::KT(_) => LAW[0],
        Unknown::FS(_) => LAW[1],
        Unknown::Chi(_) => LAW[2],
        Unknown::Beta(_) => LAW[3],
        Unknown::Participation(..) => SLIP,
        Unknown::Compliance(_) => COMPLIANCE,
        Unknown::SlipAtForce(_) => SLIP_AT_FORCE,
        _ => DAMPING,
    };
    let all = std::env::var_os("ALL").is_some();
    let (mut held, mut shared, clock) = (Vec::<(Unknown, u64, u64)>::new(), 0, Instant::now());
    for repeat in 0..repeats {
        let mut random = SplitMix64::new(repeat + 1);
        let mut records = clean.clone();
        for motion in records.iter_mut().flat_map(|record| &mut record.motions) {
            let rms = (motion.iter().map(|x| x * x).sum::<f64>() / motion.len() as f64).sqrt();
            let size = rms * 10.0_f64.powf(-decibels / 20.0);
            // The sum of twelve uniform numbers: normal enough for noise.
            for x in motion {
                *x += size * 0.5 * (0..12).map(|_| random.next_symmetric()).sum::<f64>();
            }
        }
        let fit = fit_coupled(&CoupledTask {
            records: &records,
            held_out: &[],
            modes: &modes,
            quantity: Quantity::Acceleration,
            seen: Seen::Modes,
            shape_at_force: Some(&SHAPES),
            threads: 2,
            stopped: &AtomicBool::new(false),
            progress: UNWATCHED,
        })
        .unwrap();
        if fit.best().sharing != Sharing::Shared(1) {
            continue;
        }
        shared += 1;
        for estimate in &fit.estimates {
            let at = truth(estimate.unknown);
            let inside =
                estimate.low.is_none_or(|low| low <= at) && estimate.high.is_none_or(|high| at <= high);
            if !inside || all {
                println!("repeat {repeat}, truth {at}, inside {inside}: {estimate:?}");
            }
            let known = held.iter().position(|(unknown, ..)| *unknown == estimate.unknown);
            let place = known.unwrap_or_else(|| {
                held.push((estimate.unknown, 0, 0));
                held.len() - 1
            });
            let entry = &mut held[place];
            entry.1 += u64::from(inside);
            entry.2 += u64::from(estimate.identifiable());
        }
    }
    println!(
        "{repeats} repeats at {decibels} dB: one shared joint chosen in {shared}, {:.2} s each",
        clock.elapsed().as_secs_f64() / repeats as f64
    );
    for (unknown, inside, told) in held {
        println!("{unknown:?}: inside {inside}, told {told}");
    }
}
