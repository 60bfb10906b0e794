//! The joints of the paper's beam from curves of its modes, which another computation made: static loads on the whole structure.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::sync::Arc;

use iwan_core::progress::UNWATCHED;
use iwan_core::{FourParameter, SplitMix64};
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{Correction, Law, Lump, Material, NamedModes, Stiffness, Structure, paper};
use iwan_study::update::{MeasuredCurve, Quantity, Update, UpdateTask, groups_that_move_alike, update};

fn truth() -> NamedModes {
    NamedModes::new(&paper::structure(Configuration::A, 1).unwrap(), 12).unwrap()
}

/// The beam with other start values.
fn start(mut structure: Structure) -> NamedModes {
    let law: Law = Arc::new(first());
    for slip in structure.joints.iter_mut().flat_map(|joint| &mut joint.slips) {
        slip.law = Some(law.clone());
    }
    NamedModes::new(&structure, 12).unwrap()
}

fn first() -> FourParameter {
    FourParameter::new(2.0e5, 450.0, -0.5, 0.2).unwrap()
}

/// Curves of a mode up to a share of macro-slip, from static loads on the structure.
fn curve(truth: &NamedModes, mode: &str, upto: f64, noise: f64, seed: u64) -> MeasuredCurve {
    let named = truth.named(mode).unwrap();
    let onset = truth.onset(named).unwrap();
    let q: Vec<f64> = (0..25).map(|i| onset * upto * 10.0_f64.powf(-2.0 + f64::from(i) / 12.0)).collect();
    let curves = truth.static_curves(named, &q, false).unwrap();
    let mut random = SplitMix64::new(seed);
    // The sum of twelve uniform numbers: normal enough for noise.
    let mut normal = || noise * 0.5 * (0..12).map(|_| random.next_symmetric()).sum::<f64>();
    let shift = curves.frequency[0] - curves.frequency[curves.frequency.len() - 1];
    let damping = MeasuredCurve::damping_of(&curves.displacement, &curves.frequency, &curves.dissipation);
    MeasuredCurve {
        mode: mode.into(),
        source: "static loads".into(),
        frequency: curves.frequency.iter().map(|f| f + shift * normal()).collect(),
        damping_ratio: damping.iter().map(|z| z * normal().exp()).collect(),
        displacement: curves.displacement,
        stiffness: Stiffness::Secant,
    }
}

fn updated(named: &NamedModes, curves: Vec<MeasuredCurve>, held_out: Vec<MeasuredCurve>) -> Update {
    corrected(named, curves, held_out, vec![])
}

/// With parts of the stiffness as further unknowns: name, which, and what is known of the factor before.
fn corrected(
    named: &NamedModes,
    curves: Vec<MeasuredCurve>,
    held_out: Vec<MeasuredCurve>,
    corrections: Vec<(String, Correction, Option<f64>)>,
) -> Update {
    let joints = named.assembled.structure().joints.iter().enumerate();
    let laws: Vec<_> = joints.filter(|(_, j)| !j.slips.is_empty()).map(|(n, _)| (n, first())).collect();
    let groups = groups_that_move_alike(named, &laws, &["bending 1", "bending 3"]).unwrap();
    let task = UpdateTask { named, groups, corrections, viscous: true, curves, held_out, threads: 2 };
    update(&task, UNWATCHED).unwrap()
}

#[test]
fn links_are_found_from_two_modes_and_washers_are_named() {
    let truth = truth();
    let curves =
        |upto| vec![curve(&truth, "bending 1", upto, 0.0, 1), curve(&truth, "bending 3", upto, 0.0, 2)];
    let named = start(paper::structure(Configuration::A, 1).unwrap());
    let held_out = vec![curve(&truth, "bending 2", 1.0, 0.0, 3)];
    let found = updated(&named, curves(2.0), held_out);
    let [links, washers] = &found.groups[..] else { panic!("{:?}", found.groups) };
    for (estimate, expected, within) in [
        (links.k_t, 2.75e5, 0.02),
        (links.f_s, 300.0, 0.02),
        (links.chi, -0.3, 0.02),
        (links.beta, 0.02, 0.1),
    ] {
        assert!((estimate.value / expected - 1.0).abs() < within, "{estimate:?} {expected}");
        assert!(estimate.identifiable, "{estimate:?}");
    }
    assert!(
        ![washers.k_t, washers.f_s, washers.chi, washers.beta].iter().any(|e| e.identifiable),
        "{washers:?}"
    );
    assert!(found.verdict.adequate && found.verdict.systematic.is_empty(), "{:?}", found.verdict);
    let held = found.curves.iter().find(|curve| curve.held_out).unwrap();
    for i in 0..held.displacement.len() {
        let loss = held.damping_ratio_after[i] / held.damping_ratio[i] - 1.0;
        assert!(loss.abs() < 0.03, "{i} {loss}");
        assert!((held.frequency_after[i] / held.frequency[i] - 1.0).abs() < 1e-4);
    }
    // The linear damping of the mode was not measured: no band holds its damping.
    let prediction = held.prediction.as_ref().unwrap();
    assert!(prediction.damping_inside.is_none() && prediction.damping_misfit.abs() < 0.03, "{prediction:?}");
    assert!(
        prediction.not_predicted.iter().any(|why| why.contains("linear (viscous) damping was not measured"))
    );
    assert!(held.log_damping_sd.iter().all(|sd| sd.is_infinite()));
    assert!(prediction.frequency_inside == Some(1.0), "{prediction:?}");
    // Only modes that tell what is open, no faster than those measured were.
    let measured = found.curves.iter().filter(|c| !c.held_out);
    let speeds = measured.flat_map(|c| c.displacement.iter().zip(&c.frequency).map(|(q, f)| q * f));
    let reached = speeds.fold(0.0_f64, f64::max);
    for next in &found.next_modes {
        assert!(next.parameter.contains("washer") && next.remaining < 0.5, "{next:?}");
        assert!(next.displacement * next.frequency <= 1.001 * reached, "{next:?}");
    }
    assert!(found.measure_next.starts_with("measure next: "), "{}", found.measure_next);
}

/// A mode kept out which the washers' joints move: they are not told by the others, and what they may do stands in the band.
#[test]
fn open_joints_widen_predictions() {
    let truth = truth();
    let named = start(paper::structure(Configuration::A, 1).unwrap());
    let curves = vec![curve(&truth, "bending 1", 1.0, 0.0, 1)];
    // Start values of the washers are those of the file, and no curve moves them from there.
    let held_out = vec![curve(&truth, "bending 2", 1.0, 0.0, 3), curve(&truth, "bending 3", 1.0, 0.0, 3)];
    let laws: Vec<_> = (0..4).map(|joint| (joint, first())).collect();
    let groups = groups_that_move_alike(&named, &laws, &["bending 1"]).unwrap();
    let task = UpdateTask {
        named: &named,
        groups,
        corrections: vec![],
        viscous: false,
        curves,
        held_out,
        threads: 2,
    };
    let found = update(&task, UNWATCHED).unwrap();
    for held in found.curves.iter().filter(|curve| curve.held_out) {
        let prediction = held.prediction.as_ref().unwrap();
        assert!(prediction.damping_inside.is_some_and(|share| share > 0.9), "{} {prediction:?}", held.mode);
        assert!(prediction.frequency_inside.is_some_and(|share| share > 0.9), "{} {prediction:?}", held.mode);
    }
}

/// Curves of other modes and in other units are named, with what helps.
#[test]
fn mistakes_in_curves_are_named() {
    let named = truth();
    let clean = [curve(&named, "bending 1", 1.0, 0.0, 1), curve(&named, "bending 3", 1.0, 0.0, 2)];
    let with = |change: &dyn Fn(&mut [MeasuredCurve; 2])| {
        let mut curves = clean.clone();
        change(&mut curves);
        let laws: Vec<_> = (0..4).map(|joint| (joint, first())).collect();
        let groups = groups_that_move_alike(&named, &laws, &["bending 1", "bending 3"]).unwrap();
        let curves = curves.to_vec();
        let task = UpdateTask {
            named: &named,
            groups,
            corrections: vec![],
            viscous: true,
            curves,
            held_out: vec![],
            threads: 2,
        };
        match update(&task, UNWATCHED) {
            Ok(found) => {
                let closed = found.groups.iter().any(|g| g.k_t.identifiable);
                assert!(found.verdict.adequate || !closed, "{found:?}");
                found.verdict.in_words
            }
            Err(error) => error.to_string(),
        }
    };
    let scaled = |values: &mut Vec<f64>, factor: f64| values.iter_mut().for_each(|v| *v *= factor);
    let exchanged = with(&|[a, b]| std::mem::swap(&mut a.mode, &mut b.mode));
    assert!(exchanged.contains("it is that of bending"), "{exchanged}");
    let turns = with(&|all| all.iter_mut().for_each(|c| scaled(&mut c.frequency, std::f64::consts::TAU)));
    assert!(turns.contains("rad/s"), "{turns}");
    let per_cent = with(&|all| all.iter_mut().for_each(|c| scaled(&mut c.damping_ratio, 100.0)));
    assert!(per_cent.contains("per cent"), "{per_cent}");
    for factor in [1e3, 1e-3] {
        let millimetres = with(&|all| all.iter_mut().for_each(|c| scaled(&mut c.displacement, factor)));
        assert!(millimetres.contains("by 1000"), "{millimetres}");
    }
    let reversed = with(&|all| all.iter_mut().for_each(|c| c.displacement.reverse()));
    assert!(reversed.contains("opposite order"), "{reversed}");
}

#[test]
fn wrong_structures_are_told() {
    let truth = truth();
    let curves = || vec![curve(&truth, "bending 1", 1.0, 0.01, 1), curve(&truth, "bending 3", 1.0, 0.01, 2)];
    let mut stiff = paper::structure(Configuration::A, 1).unwrap();
    stiff.material = Material::new(1.03 * 28.0e6, 0.29, 7.48e-4).unwrap();
    let found = updated(&start(stiff), curves(), vec![]);
    assert!(!found.verdict.adequate);
    assert!(found.verdict.in_words.contains("bending"), "{}", found.verdict.in_words);
    // What does not describe the data has no parameters that are told.
    let all = found.groups.iter().flat_map(|g| [g.k_t, g.f_s, g.chi, g.beta]);
    assert!(all.into_iter().all(|e| e.low.is_none() && e.high.is_none() && !e.identifiable));
    assert!(found.verdict.in_words.contains("left open") && found.next_modes.is_empty());
    let [named] = &found.corrections[..] else { panic!("{:?}", found.corrections) };
    assert!((named.factor * 1.03 - 1.0).abs() < 2e-3 && named.adequate, "{named:?}");
    // Patches that stay flexible in place of rigid ones: the mode and the amplitude are named.
    let swapped = paper::structure(Configuration::B, 1).unwrap();
    let found = updated(&start(swapped), curves(), vec![]);
    let worst = &found.verdict.departures[0];
    assert!(worst.mode == "bending 1" && worst.quantity == Quantity::Frequency, "{:?}", found.verdict);
    assert!(worst.misfit.abs() > 3.0 * worst.limit && worst.range.0 <= worst.displacement, "{worst:?}");
}

/// One end of the link tied: one joint of half the stiffness tells what two did to 0.5 % of damping, which passes, and is not noise.
#[test]
fn a_tied_end_is_told_where_the_curves_are_good_enough() {
    let truth = truth();
    let curves =
        |noise| vec![curve(&truth, "bending 1", 1.0, noise, 1), curve(&truth, "bending 3", 1.0, noise, 2)];
    let mut tied = paper::structure(Configuration::A, 1).unwrap();
    let right = tied.joints.iter_mut().find(|joint| joint.name == "right link").unwrap();
    right.slips.clear();
    let tied = start(tied);
    let found = updated(&tied, curves(0.0), vec![]).verdict;
    assert!(found.adequate && found.in_words.contains("tied at one end"), "{found:?}");
    assert_eq!(found.systematic[0].mode, "bending 3");
    // With noise of 1 % nothing of it is left.
    let found = updated(&tied, curves(0.01), vec![]).verdict;
    assert!(found.adequate && found.systematic.is_empty(), "{found:?}");
}

/// Springs to the ground and a modulus that are off: both come back, the modulus held near by what is known of it before.
#[test]
fn springs_and_material_are_corrected() {
    let with = |springs: f64, modulus: f64| {
        let mut structure = paper::structure(Configuration::A, 1).unwrap();
        structure.material = Material::new(modulus * 28.0e6, 0.29, 7.48e-4).unwrap();
        let stiffness = [0.0, 0.0, springs * 2e3];
        structure.lumps.push(Lump { name: "stand".into(), nodes: "tip".into(), mass: 0.0, stiffness });
        structure
    };
    let truth = NamedModes::new(&with(1.0, 1.0), 12).unwrap();
    // Every third point tells these parameters as well.
    let few = |mode| {
        let all = curve(&truth, mode, 1.0, 0.0, 1);
        let third = |x: &[f64]| x.iter().copied().step_by(3).collect();
        let (displacement, frequency) = (third(&all.displacement), third(&all.frequency));
        MeasuredCurve { displacement, frequency, damping_ratio: third(&all.damping_ratio), ..all }
    };
    let corrections = |known| {
        vec![
            ("material".into(), Correction::GeneralMaterial, known),
            ("stand".into(), Correction::Springs(0), None),
        ]
    };
    let found = corrected(
        &start(with(1.2, 1.01)),
        ["bending 1", "bending 3"].map(few).to_vec(),
        vec![],
        corrections(Some(0.02)),
    );
    let [(_, modulus), (_, springs)] = &found.factors[..] else { panic!("{:?}", found.factors) };
    assert!((modulus.value * 1.01 - 1.0).abs() < 1e-3, "{modulus:?}");
    assert!((springs.value * 1.2 - 1.0).abs() < 0.02 && springs.identifiable, "{springs:?}");
    assert!(found.verdict.adequate, "{:?}", found.verdict);
    // What is known of a modulus better than the curves tell it holds it where it is.
    let held = corrected(&start(with(1.2, 1.01)), vec![few("bending 1")], vec![], corrections(Some(1e-9)));
    assert!((held.factors[0].1.value - 1.0).abs() < 1e-3, "{:?}", held.factors);
}
