//! The joints of the paper's beam from blows on it, which a finer computation made: the reduced structure with its four joints in the continuum.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::sync::Arc;

use iwan_core::progress::UNWATCHED;
use iwan_core::{FourParameter, Pulse, SplitMix64};
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{Basis, Kinematic, Law, NamedModes, Output, Representation, Transient, paper};
use iwan_study::update::{BlowTask, MeasuredBlow, UpdateTask, groups_that_move_alike, update_from_blows};

/// Sampling interval of the records, s, and steps of the computation in it.
const DT: f64 = 2e-5;
const FINER: usize = 8;
const SAMPLES: usize = 6_001;

fn beam(law: FourParameter) -> NamedModes {
    let mut structure = paper::structure(Configuration::A, 1).unwrap();
    let law: Law = Arc::new(law);
    for slip in structure.joints.iter_mut().flat_map(|joint| &mut joint.slips) {
        slip.law = Some(law.clone());
    }
    NamedModes::new(&structure, 12).unwrap()
}

/// Points of the beam: where it is struck, and the faces of link and washer.
fn points(named: &NamedModes) -> Vec<Output> {
    let up = [0.0, 0.0, 1.0];
    ["tip", "left washer face"].map(|set| named.assembled.output(set, set, up).unwrap()).to_vec()
}

/// Blows of these strengths in lbf with noise as a share of the root mean square of each channel.
fn blows(levels: &[f64], noise: f64) -> Vec<MeasuredBlow> {
    let named = beam(paper::joint().unwrap());
    let reduced = named.assembled.reduce(50, Basis::default()).unwrap();
    let load = named.assembled.load("tip", [0.0, 0.0, 1.0]).unwrap();
    let mut random = SplitMix64::new(7);
    let mut blow = |level: &f64| {
        let pulse = Pulse::Haversine { amplitude: *level, duration: 1.6e-3 };
        let force = (0..SAMPLES).map(|n| pulse.at(n as f64 * DT)).collect();
        let response = reduced
            .transient(&Transient {
                dt: DT / FINER as f64,
                steps: FINER * (SAMPLES - 1),
                pulse,
                load: load.clone(),
                initial_velocity: None,
                representation: Representation::Continuum,
                outputs: points(&named),
            })
            .unwrap();
        let mut noisy = |history: &iwan_fem::History| -> Vec<f64> {
            let clean: Vec<f64> = history.acceleration.iter().step_by(FINER).copied().collect();
            let size = noise * (clean.iter().map(|a| a * a).sum::<f64>() / clean.len() as f64).sqrt();
            // The sum of twelve uniform numbers: normal enough for noise.
            let mut normal = || 0.5 * (0..12).map(|_| random.next_symmetric()).sum::<f64>();
            clean.iter().map(|a| a + size * normal()).collect()
        };
        let motions: Vec<Vec<f64>> = response.outputs.iter().map(&mut noisy).collect();
        MeasuredBlow {
            source: format!("{level} lbf"),
            dt: DT,
            force,
            points: points(&named).into_iter().zip(motions).collect(),
            kinematic: Kinematic::Acceleration,
        }
    };
    levels.iter().map(&mut blow).collect()
}

#[test]
fn links_are_found_from_blows_and_a_harder_one_is_predicted() {
    let first = FourParameter::new(2.0e5, 450.0, -0.5, 0.2).unwrap();
    let named = beam(first);
    let laws: Vec<_> = (0..4).map(|joint| (joint, first)).collect();
    let modes = ["bending 1", "bending 3"];
    let task = UpdateTask {
        named: &named,
        groups: groups_that_move_alike(&named, &laws, &modes).unwrap(),
        corrections: vec![],
        viscous: true,
        curves: vec![],
        held_out: vec![],
        threads: 2,
    };
    let given = BlowTask {
        load: named.assembled.load("tip", [0.0, 0.0, 1.0]).unwrap(),
        blows: blows(&[10.0, 100.0, 1000.0], 0.01),
        held_out: blows(&[300.0, 2000.0], 0.0),
        modes: modes.map(str::to_owned).to_vec(),
    };
    let found = update_from_blows(&task, &given, UNWATCHED).unwrap();
    let [links, washers] = &found.groups[..] else { panic!("{:?}", found.groups) };
    for (estimate, expected) in [(links.k_t, 2.75e5), (links.f_s, 300.0), (links.chi, -0.3)] {
        assert!((estimate.value / expected - 1.0).abs() < 0.02, "{estimate:?} {expected}");
        let (low, high) = (estimate.low.unwrap(), estimate.high.unwrap());
        assert!(low < expected && expected < high, "{estimate:?} {expected}");
    }
    // β stands at the onset of macro-slip alone: not told in noise.
    assert!(!links.beta.identifiable && links.slip_ratio > 2.0, "{links:?}");
    // Washers that hardly slip show nothing of their law's shape: the search ends at χ next to -0.99, or anywhere, where nothing but the stiffness has an end.
    assert!(!washers.k_t.identifiable && washers.k_t.low.is_none_or(|low| low < 2.75e5), "{washers:?}");
    let open = |e: &iwan_study::update::Estimated| e.low.is_none() && e.high.is_none();
    assert!([washers.f_s, washers.chi, washers.beta].iter().all(open), "{washers:?}");
    assert!(found.verdict.adequate, "{:?}", found.verdict);
    for blow in found.blows.iter().filter(|blow| blow.held_out) {
        assert!(blow.after < 0.02, "{blow:?}");
        assert!(blow.before.is_none_or(|before| before > 10.0 * blow.after), "{blow:?}");
    }
}

#[test]
fn records_that_do_not_fit_are_refused_by_name() {
    let named = beam(paper::joint().unwrap());
    let laws: Vec<_> = (0..4).map(|joint| (joint, paper::joint().unwrap())).collect();
    let modes = ["bending 1"];
    let task = UpdateTask {
        named: &named,
        groups: groups_that_move_alike(&named, &laws, &modes).unwrap(),
        corrections: vec![],
        viscous: true,
        curves: vec![],
        held_out: vec![],
        threads: 1,
    };
    let samples = 300;
    let wave = |n: usize| (n as f64 * 0.1).sin();
    let good = MeasuredBlow {
        source: "hit.csv".into(),
        dt: 1e-3,
        force: (0..samples).map(wave).collect(),
        points: vec![(points(&named).remove(0), (0..samples).map(wave).collect())],
        kinematic: Kinematic::Acceleration,
    };
    let short = MeasuredBlow { force: good.force[..20].to_vec(), ..good.clone() };
    let still = MeasuredBlow { force: vec![0.0; samples], ..good.clone() };
    let mut broken = good.clone();
    broken.points[0].1[7] = f64::NAN;
    let mut uneven = good.clone();
    uneven.points[0].1.pop();
    let nowhere = MeasuredBlow { points: vec![], ..good };
    for (blow, said) in [
        (short, "20 samples"),
        (still, "the force is zero throughout"),
        (broken, "a sample is not finite"),
        (uneven, "tip has 299 samples, the force 300"),
        (nowhere, "no point was measured"),
    ] {
        let given = BlowTask {
            load: named.assembled.load("tip", [0.0, 0.0, 1.0]).unwrap(),
            blows: vec![blow],
            held_out: vec![],
            modes: modes.map(str::to_owned).to_vec(),
        };
        let error = update_from_blows(&task, &given, UNWATCHED).unwrap_err().to_string();
        assert!(error.contains(said) && error.contains("hit.csv"), "{error}");
    }
}
