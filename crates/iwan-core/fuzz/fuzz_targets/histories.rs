//! Any law driven along any history of displacements and implicit steps: forces stay within the slip force, friction gives nothing
//! back, and all memories of one population agree.
#![no_main]

use iwan_core::{Backbone, Continuum, Hysteresis, Plain, Reversal, Run, Slider, Sliders};
use iwan_core_fuzz::{Bytes, Driven, Law, Move, elements, grid, law};
use libfuzzer_sys::fuzz_target;

fn moves(bytes: &mut Bytes<'_>, scale: &Law) -> Vec<Move> {
    let mut moves = Vec::new();
    let mut past = vec![0.0];
    while !bytes.is_empty() && moves.len() < 400 {
        let next = match bytes.byte() % 8 {
            0 | 1 => Move::To(bytes.displacement(scale.strongest)),
            2 => Move::To(past[usize::from(bytes.byte()) % past.len()]),
            3 => Move::By(bytes.displacement(scale.strongest)),
            4 => Move::By(0.0),
            5 => Move::Nowhere([f64::NAN, f64::INFINITY, f64::NEG_INFINITY][usize::from(bytes.byte() % 3)]),
            _ => {
                let stiffness = scale.k_t * 10_f64.powi(i32::from(bytes.byte() % 12) - 4);
                let way =
                    bytes.displacement(scale.strongest).clamp(-1e3 * scale.strongest, 1e3 * scale.strongest);
                Move::Load { stiffness, load: way * (stiffness + scale.k_t) }
            }
        };
        if let Move::To(u) = next {
            past.push(u);
        }
        moves.push(next);
    }
    moves
}

/// All memories of one population of sliders, side by side.
fn population(sliders: Sliders<'_>, bytes: &mut Bytes<'_>) {
    let scale = Law::of(&sliders);
    let plain = Plain::new(sliders);
    let masing = Continuum::new(sliders);
    let moves = moves(bytes, &scale);
    let (Ok(a), Ok(b), Ok(c)) = (
        plain.virgin(vec![0.0; sliders.len()]),
        sliders.virgin(vec![Run::default(); sliders.len()]),
        masing.virgin(vec![Reversal::default(); moves.len() + 3]),
    ) else {
        panic!("no room for {} sliders", sliders.len())
    };
    let (mut slow, mut runs, mut stack) =
        (Driven::new(&plain, a, scale), Driven::new(&sliders, b, scale), Driven::new(&masing, c, scale));
    for go in moves {
        let before = slow.displacement();
        let expected = slow.go(go);
        let room = slow.rounding() * 100.0;
        let mut to = go;
        if let Move::Load { stiffness, .. } = go {
            let (mut trial, way) = (runs.clone(), slow.displacement() - before);
            trial.go(go);
            let found = trial.displacement() - before;
            let room = room / stiffness + 64.0 * f64::EPSILON * (way.abs() + before.abs());
            assert!((found - way).abs() <= room, "runs go {found}, the plain loop {way}, {go:?}");
            // Soft steps magnify rounding: from here on both are where the plain loop is. The continuum is for laws without corners
            // inside, and implicit steps are not asked of it here.
            to = Move::To(slow.displacement());
        }
        for (name, found) in [("runs", runs.go_as_told(to)), ("Masing", stack.go_as_told(to))] {
            assert!(
                (found - expected).abs() <= room,
                "{name} {found}, plain loop {expected}, {room}, {go:?}"
            );
        }
    }
}

/// The continuum with room for all reversals, and with room for three, where loops are forgotten.
fn full_and_short(joint: &Continuum<&dyn Backbone>, moves: &[Move], scale: Law) {
    let virgin = |room: usize| match joint.virgin(vec![Reversal::default(); room]) {
        Ok(state) => state,
        Err(error) => panic!("{room} reversals: {error}"),
    };
    let mut driven = Driven::new(joint, virgin(moves.len() + 3), scale);
    let mut short = virgin(3);
    for go in moves {
        driven.go_as_told(*go);
        go.take(joint, &mut short);
        let (force, room) = (joint.joint_force(&short), short.forgotten() + driven.rounding());
        assert!(force.abs() <= scale.f_s + room, "force {force} of {scale:?}, {room} for what was forgotten");
    }
}

fuzz_target!(|bytes: &[u8]| {
    let mut bytes = Bytes::new(bytes);
    let kind = bytes.byte() % 3;
    if kind == 0 {
        let (strength, stiffness) = elements(&mut bytes);
        let mut table = vec![Slider::default(); strength.len() + 1];
        if let Ok(sliders) = Sliders::from_elements(&strength, &stiffness, &mut table) {
            population(sliders, &mut bytes);
        }
        return;
    }
    let Ok(law) = law(&mut bytes) else { return };
    let scale = Law::of(law.as_ref());
    if kind == 1 {
        let bins = 1 + usize::from(bytes.byte() % 40);
        let mut table = vec![Slider::default(); Sliders::table_len(bins)];
        if let Ok(sliders) = Sliders::discretise(law.as_ref(), grid(&mut bytes), bins, &mut table) {
            let (found, Law { k_t, f_s, strongest }) = (Law::of(&sliders), scale);
            assert!((found.k_t / k_t - 1.0).abs() < 1e-9, "{found:?} {scale:?}");
            let rounding = 1e-9 * f_s + 1e-13 * k_t * strongest;
            assert!((found.f_s - f_s).abs() <= rounding, "{found:?} {scale:?}");
            population(sliders, &mut bytes);
        }
        return;
    }
    let moves = moves(&mut bytes, &scale);
    full_and_short(&Continuum::new(law.as_ref()), &moves, scale);
});
