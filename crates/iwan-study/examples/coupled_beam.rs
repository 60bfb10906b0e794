//! A coupled fit of bending 1 and 3 of the paper's beam to blows of 10, 100 and 1000 lbf, held against blows of 300 and 5000 lbf that it has not
//! seen. `coupled_beam NOISE`, the noise as a share of each record's root mean square.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::too_many_lines,
    reason = "an example with fixed numbers that says what it found"
)]

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use iwan_core::SplitMix64;
use iwan_core::progress::UNWATCHED;
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{Basis, Representation, Transient};
use iwan_ident::Parameters;
use iwan_ident::coupled::{CoupledRecord, CoupledTask, Seen, UncoupledMode, fit_coupled};
use iwan_ident::curves::Quantity;
use iwan_study::beam::PaperBeam;
use iwan_study::blows::{DT, STEPS, blow};

/// Fitted are the first three.
const LEVELS: [f64; 5] = [10.0, 100.0, 1000.0, 300.0, 5000.0];

/// The records, and the shapes at the load.
fn truth() -> (Vec<CoupledRecord>, Vec<f64>) {
    let beam = PaperBeam::new(Configuration::A).unwrap();
    let (assembled, stuck) = (&beam.modes.assembled, &beam.modes.stuck);
    let bending = [&beam.bending[0], &beam.bending[2]];
    let outputs = bending.map(|m| assembled.modal_output(&m.name, stuck, m.pair.stuck)).to_vec();
    let load = assembled.load("tip", [0.0, 0.0, 1.0]).unwrap();
    let reduced = assembled.reduce(50, Basis::default()).unwrap();
    let at_tip = |shape: &[f64]| shape.iter().zip(&load).map(|(a, b)| a * b).sum();
    let tip = bending.iter().map(|m| at_tip(stuck.shape(m.pair.stuck))).collect();
    let record = |level: f64| {
        let response = reduced.transient(&Transient {
            dt: DT,
            steps: STEPS,
            pulse: blow(level),
            load: load.clone(),
            initial_velocity: None,
            representation: Representation::DEFAULT_IN_A_STRUCTURE,
            outputs: outputs.clone(),
        });
        CoupledRecord {
            name: format!("{level} lbf"),
            dt: DT,
            motions: response.unwrap().outputs.into_iter().map(|o| o.acceleration).collect(),
            force: Some((0..=STEPS).map(|n| blow(level).at(DT * n as f64)).collect()),
        }
    };
    (LEVELS.map(record).to_vec(), tip)
}

fn main() {
    let noise: f64 = std::env::args().nth(1).map_or(0.0, |text| text.parse().expect("a number"));
    let (truth, tip) = truth();
    let mode = |name: &str, frequency, k_t, f_s| UncoupledMode {
        name: name.into(),
        parameters: Parameters { frequency, damping_ratio: 2.5e-4, k_t, f_s, chi: -0.2, beta: 0.3 },
    };
    let modes = [mode("bending 1", 132.35, 4.7e4, 215.0), mode("bending 3", 696.0, 1.08e6, 990.0)];
    let (mut random, mut records) = (SplitMix64::new(1), truth.clone());
    for motion in records[..3].iter_mut().flat_map(|record| &mut record.motions) {
        let rms = (motion.iter().map(|x| x * x).sum::<f64>() / motion.len() as f64).sqrt();
        for x in motion {
            // The sum of twelve uniform numbers: normal enough for noise.
            *x += noise * rms * 0.5 * (0..12).map(|_| random.next_symmetric()).sum::<f64>();
        }
    }
    let clock = Instant::now();
    let fit = fit_coupled(&CoupledTask {
        records: &records[..3],
        held_out: &truth[3..],
        modes: &modes,
        quantity: Quantity::Acceleration,
        seen: Seen::Modes,
        shape_at_force: Some(&tip),
        threads: 2,
        stopped: &AtomicBool::new(false),
        progress: UNWATCHED,
    })
    .unwrap();
    println!("{:.1} s", clock.elapsed().as_secs_f64());
    for model in &fit.models {
        println!("{}: criterion {:.0}", model.sharing.name(), model.criterion);
        for misfit in model.misfits.iter().chain(&model.held_out) {
            println!("  {} {} {:.5}", misfit.record, modes[misfit.mode].name, misfit.relative);
        }
    }
    for estimate in &fit.estimates {
        println!("{:?} = {} ({:?} to {:?})", estimate.unknown, estimate.value, estimate.low, estimate.high);
    }
    println!("{:#?} {:?}", fit.in_words(), fit.warnings);
}
