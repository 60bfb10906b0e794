//! How often the 95 % intervals of `iwan update` hold the joints that the curves were made with: bending 1 and 3 of the paper's beam with noise.
//! `update_coverage REPEATS DECIBELS`; estimates that miss are printed, and with `ALL` in the environment all of them.
#![allow(
    clippy::print_stdout,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::too_many_lines,
    reason = "an example with fixed numbers that says what it found"
)]

use std::time::Instant;

use iwan_core::progress::UNWATCHED;
use iwan_core::{FourParameter, SplitMix64};
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{NamedModes, Stiffness, paper};
use iwan_study::update::{Estimated, MeasuredCurve, UpdateTask, groups_that_move_alike, update};

fn main() {
    let number = |n: usize, otherwise: f64| {
        std::env::args().nth(n).map_or(otherwise, |text| text.parse().expect("a number"))
    };
    let (repeats, noise) = (number(1, 200.0) as u64, 10.0_f64.powf(-number(2, 40.0) / 20.0));
    let named = NamedModes::new(&paper::structure(Configuration::A, 1).unwrap(), 12).unwrap();
    let clean = ["bending 1", "bending 3"].map(|name| {
        let mode = named.named(name).unwrap();
        let onset = named.onset(mode).unwrap();
        let q: Vec<f64> = (0..49).map(|i| onset * 10.0_f64.powf(-2.0 + f64::from(i) / 24.0)).collect();
        let curves = named.static_curves(mode, &q, false).unwrap();
        let damping = MeasuredCurve::damping_of(&curves.displacement, &curves.frequency, &curves.dissipation);
        MeasuredCurve {
            mode: name.into(),
            source: "static loads".into(),
            displacement: curves.displacement,
            frequency: curves.frequency,
            damping_ratio: damping,
            stiffness: Stiffness::Secant,
        }
    });
    let first = FourParameter::new(2.0e5, 450.0, -0.5, 0.2).unwrap();
    let laws: Vec<_> = (0..4).map(|joint| (joint, first)).collect();
    let groups = groups_that_move_alike(&named, &laws, &["bending 1", "bending 3"]).unwrap();
    let truth = [2.75e5, 300.0, -0.3, 0.02];
    let every = std::env::var_os("ALL").is_some();
    let (mut inside, mut told, clock) = ([0_u64; 4], [0_u64; 4], Instant::now());
    for repeat in 0..repeats {
        let mut random = SplitMix64::new(repeat + 1);
        let mut normal = || noise * 0.5 * (0..12).map(|_| random.next_symmetric()).sum::<f64>();
        let mut curves = clean.to_vec();
        for curve in &mut curves {
            let shift = curve.frequency[0] - curve.frequency[curve.frequency.len() - 1];
            curve.frequency.iter_mut().for_each(|f| *f += shift * normal());
            curve.damping_ratio.iter_mut().for_each(|z| *z *= normal().exp());
        }
        let task = UpdateTask {
            named: &named,
            groups: groups.clone(),
            corrections: vec![],
            viscous: true,
            curves,
            held_out: vec![],
            threads: 2,
        };
        let found = update(&task, UNWATCHED).unwrap();
        let joints = &found.groups[0];
        let all: [Estimated; 4] = [joints.k_t, joints.f_s, joints.chi, joints.beta];
        for (k, (estimate, truth)) in all.iter().zip(truth).enumerate() {
            let held =
                estimate.low.is_none_or(|low| low <= truth) && estimate.high.is_none_or(|high| truth <= high);
            if !held || every {
                println!("repeat {repeat}, parameter {k}, truth {truth}, inside {held}: {estimate:?}");
            }
            inside[k] += u64::from(held);
            told[k] += u64::from(estimate.identifiable);
        }
    }
    let seconds = clock.elapsed().as_secs_f64() / repeats as f64;
    println!("{repeats} repeats, {seconds:.2} s each; k_t, f_s, chi, beta of the links");
    println!("inside {inside:?}, told {told:?}");
}
