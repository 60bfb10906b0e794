//! How often 95 % intervals of frequency, damping and shape hold the truth, how often a mode is missed or invented: random noise on hits of ten
//! known modes. `scripts/validate` runs it.
#![allow(clippy::print_stdout, clippy::expect_used, reason = "a program that prints its result")]

#[path = "../tests/support/mod.rs"]
mod support;

use iwan_modal::measure::Motion;
use iwan_modal::responses::{Estimator, Windows, frequency_responses};
use iwan_modal::{Analysis, modal_fit};
use support::{Bench, ten_modes};

fn main() {
    let count: u64 = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(200);
    // Twelve sensors instead of 54: the same statistics in a quarter of the time. At 16 samples a pulse what folds back in the sampled force is below
    // the standard deviations; at four samples it is not, and no recorder without a filter before it would do better.
    let bench =
        Bench { stations: 6, calibration: 0.0, rate: 16_384.0, samples: 32_768, ..Bench::new(ten_modes()) };
    let (mut inside, mut all, mut wrong) = ([0_u32; 3], 0_u32, 0_u32);
    for repeat in 0..count {
        let hits = bench.hits(100.0, 5, 1000 + repeat);
        let responses = frequency_responses(&hits, Motion::Acceleration, Estimator::H1, Windows::default())
            .expect("hits");
        let fit = modal_fit(&responses, Some((60.0, 1100.0)), &Analysis::Chart, 60).expect("modes");
        if fit.modes.len() != bench.modes.len() {
            wrong += 1;
            continue;
        }
        for (mode, truth) in fit.modes.iter().zip(&bench.modes) {
            all += 1;
            let off = [
                (mode.frequency - truth.frequency) / mode.frequency_sd,
                (mode.damping_ratio - truth.damping_ratio) / mode.damping_ratio_sd,
                (mode.real_shape[1].abs() - bench.shape(truth)[1].abs()) / mode.shape_sd[1],
            ];
            for (count, off) in inside.iter_mut().zip(off) {
                *count += u32::from(off.abs() < 1.96);
            }
        }
    }
    let share = inside.map(|n| 100.0 * f64::from(n) / f64::from(all.max(1)));
    println!(
        "modes of hits, {count} repeats: a mode missed or invented in {wrong}; 95 % intervals hold the frequency in {:.1} %, the damping in {:.1} %, the shape in {:.1} %",
        share[0], share[1], share[2]
    );
}
