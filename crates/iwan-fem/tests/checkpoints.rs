//! Transients that are stopped anywhere continue from their checkpoint, and end with the same bits as a run that was never interrupted.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};

use iwan_core::{Pulse, SplitMix64};
use iwan_fem::mesh::beam::Configuration;
use iwan_fem::{Basis, Error, Model, NamedModes, Representation, StructureResponse, Transient, Watch, paper};
use iwan_machine::checkpoint::{Checkpoint, Digest};

fn open(folder: &std::path::Path) -> Checkpoint {
    Checkpoint::open(folder, "transients", "1", Digest::default()).unwrap()
}

/// Whether all of two responses but the computing time agrees.
fn same(a: &StructureResponse, b: &StructureResponse) -> bool {
    StructureResponse { seconds: 0.0, ..a.clone() } == StructureResponse { seconds: 0.0, ..b.clone() }
}

/// Runs a transient that is stopped again and again until it is done; returns how often it was stopped.
fn in_pieces(
    seed: u64,
    run: &dyn Fn(Watch<'_>) -> Result<StructureResponse, Error>,
) -> (StructureResponse, usize) {
    let place = tempfile::tempdir().unwrap();
    let mut random = SplitMix64::new(seed);
    for broken in 0.. {
        let kept = open(place.path());
        let calls = AtomicUsize::new((3.0 * random.next_symmetric().abs()) as usize);
        let progress = |_: f64| {
            let left = calls.fetch_sub(1, Ordering::Relaxed);
            if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        match run(Watch { progress: &progress, kept: Some(&kept) }) {
            Ok(response) => return (response, broken),
            Err(error) => assert_eq!(error, Error::Interrupted),
        }
        assert!(broken < 100, "no run gets any further");
    }
    unreachable!("the loop ends by what it returns")
}

/// Cases: sliders and continuum, micro-slip and far in macro-slip, a structure that flies away, damping, all unknowns and a few modes.
#[test]
fn a_transient_in_pieces_has_the_bits_of_one() {
    let named = NamedModes::new(&paper::structure(Configuration::A, 1).unwrap(), 4).unwrap();
    let assembled = &named.assembled;
    let modes = named.chosen(&["bending 1".to_owned()]).unwrap();
    let bending = assembled.modal_output("bending 1", &named.stuck, modes[0].pair.stuck);
    let task = |amplitude: f64, steps: usize, representation: Representation| Transient {
        dt: 1e-5,
        steps,
        pulse: Pulse::Haversine { amplitude, duration: 1.6e-3 },
        load: assembled.load("tip", [0.0, 0.0, 1.0]).unwrap(),
        initial_velocity: None,
        representation,
        outputs: vec![bending.clone(), assembled.output("tip", "tip", [0.0, 0.0, 1.0]).unwrap()],
    };
    let plain = assembled.reduce(20, Basis::default()).unwrap();
    let damped = assembled.reduce(20, Basis::default()).and_then(|r| r.with_damping(|_| 1e-3)).unwrap();
    let sliders = Representation::DEFAULT_IN_A_STRUCTURE;
    for (k, (reduced, amplitude, representation)) in [
        (&plain, 1e3, sliders),
        (&plain, 1e6, sliders),
        (&damped, 1e4, sliders),
        (&damped, 1e4, Representation::Continuum),
    ]
    .into_iter()
    .enumerate()
    {
        let task = task(amplitude, 2000, representation);
        let whole = reduced.transient(&task).unwrap();
        let (pieces, broken) = in_pieces(k as u64, &|watch| reduced.transient_observed(&task, watch));
        assert!(broken > 1 && same(&pieces, &whole), "case {k}, broken off {broken} times");
    }
    let task = task(1e4, 800, sliders);
    let whole = assembled.transient(&task).unwrap();
    let (pieces, broken) = in_pieces(9, &|watch| assembled.transient_observed(&task, watch));
    assert!(broken > 0 && same(&pieces, &whole), "the full model, broken off {broken} times");
}

/// A run that is complete is not repeated, and a run with another law, step, load or model finds no state to use.
#[test]
fn a_state_serves_its_own_transient_alone() {
    let mut structure = paper::structure(Configuration::A, 1).unwrap();
    let place = tempfile::tempdir().unwrap();
    let kept = open(place.path());
    let states = || std::fs::read_dir(place.path()).unwrap().count();
    let run = |structure: &iwan_fem::Structure, model: Model, dt: f64, amplitude: f64| {
        let assembled = structure.assemble().unwrap();
        let task = Transient {
            dt,
            steps: 30,
            pulse: Pulse::Haversine { amplitude, duration: 1.6e-3 },
            load: assembled.load("tip", [0.0, 0.0, 1.0]).unwrap(),
            initial_velocity: None,
            representation: Representation::Continuum,
            outputs: vec![assembled.output("tip", "tip", [0.0, 0.0, 1.0]).unwrap()],
        };
        let watch = Watch { kept: Some(&kept), ..Watch::default() };
        assembled.integrate(model, &task, watch).unwrap().response
    };
    let before = states();
    let first = run(&structure, Model::Basis(10), 1e-5, 10.0);
    assert!(same(&first, &run(&structure, Model::Basis(10), 1e-5, 10.0)));
    assert_eq!(states(), before + 1);
    run(&structure, Model::Basis(10), 1e-5, 11.0);
    run(&structure, Model::Basis(10), 2e-5, 10.0);
    run(&structure, Model::Basis(12), 1e-5, 10.0);
    run(&structure, Model::Full, 1e-5, 10.0);
    // A law with another power, and the same stiffness and strength.
    let law = iwan_core::FourParameter::new(2.75e5, 300.0, -0.4, 0.02).unwrap();
    structure.joints[0].slips[0].law = Some(std::sync::Arc::new(law));
    run(&structure, Model::Basis(10), 1e-5, 10.0);
    assert_eq!(states(), before + 6);
}
