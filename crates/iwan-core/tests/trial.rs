//! The force that a memory predicts ahead is the force that the motion then meets, and the prediction does not change the memory.
#![allow(clippy::unwrap_used, reason = "a failed test may panic")]

use iwan_core::{Backbone, Continuum, FourParameter, Grid, Reversal, Run, Slider, Sliders, Trial};
use proptest::prelude::*;

/// Displacements in units of the strongest slider: small and large steps, returns to old points.
fn path() -> impl Strategy<Value = Vec<(f64, usize)>> {
    let step = prop_oneof![6 => -0.3..0.3, 2 => -2.0..2.0, 1 => Just(0.0), 1 => -1e3..1e3];
    prop::collection::vec((step, 0_usize..8), 1..60)
}

/// Follows a path, and compares at every point the predicted force with that of a copy that moves there.
fn agree<State: Clone, J: Trial<State>>(
    joint: &J,
    mut state: State,
    scale: f64,
    force: f64,
    path: &[(f64, usize)],
) {
    let mut past = vec![0.0];
    for &(step, back) in path {
        let here = joint.displacement(&state);
        let u = if back == 0 { past[past.len() / 2] } else { here + step * scale };
        let before = joint.joint_force(&state);
        let (ahead, tangent) = joint.trial(&state, u);
        assert_eq!((joint.displacement(&state), joint.joint_force(&state)), (here, before));
        let mut copy = state.clone();
        let there = joint.advance(&mut copy, u);
        assert!((ahead - there).abs() <= 1e-13 * force, "{here} -> {u}: {ahead} ahead, {there} there");
        // A further small step in the same direction has the predicted tangent as its slope, or a smaller slope behind a break.
        let more = 1e-7 * scale * 1.0_f64.copysign(u - here);
        let (beyond, next) = joint.trial(&state, u + more);
        let slope = (beyond - ahead) / more;
        let rounding = 1e-13 * force + 4.0 * f64::EPSILON * (u.abs() + here.abs()) * 2.75e5;
        let noise = rounding / more.abs() + 1e-6 * force / scale;
        let follows = slope <= tangent + noise && slope >= next - noise;
        assert!(u == here || follows, "slope {slope} between {next} and {tangent}");
        state = copy;
        past.push(u);
    }
}

proptest! {
    #[test]
    fn sliders_tell_the_force_ahead(path in path(), bins in 1_usize..40, beta in 0.0..0.5) {
        let law = FourParameter::new(2.75e5, 300.0, -0.3, beta).unwrap();
        let mut table = vec![Slider::default(); Sliders::table_len(bins)];
        let sliders = Sliders::discretise(&law, Grid::graded(bins), bins, &mut table).unwrap();
        let state = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
        agree(&sliders, state, law.phi_max(), law.slip_force(), &path);
    }

    #[test]
    fn the_continuum_tells_the_force_ahead(path in path(), chi in -0.9..0.5) {
        let law = FourParameter::new(2.75e5, 300.0, chi, 0.02).unwrap();
        let joint = Continuum::new(law);
        let state = joint.virgin(vec![Reversal::default(); 100]).unwrap();
        agree(&joint, state, law.phi_max(), law.slip_force(), &path);
    }
}
