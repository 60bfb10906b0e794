//! The fast evaluations of the hysteretic force against the plain loop, on random histories.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a failed test may panic and say why")]

use iwan_core::{
    Backbone, Continuum, FourParameter, Grid, Hysteresis, Plain, Reversal, Run, Slider, Sliders,
};
use proptest::prelude::*;

/// One leg of a history, in units of the strongest slider.
#[derive(Debug, Clone)]
enum Leg {
    Step(f64),
    Plateau,
    NegativeZero,
    Jump(f64),
    Far(f64),
    Decay { amplitude: f64, ratio: f64, cycles: usize },
    OntoAStrength(usize, bool),
}

fn leg() -> impl Strategy<Value = Leg> {
    prop_oneof![
        4 => (-0.5..0.5).prop_map(Leg::Step),
        1 => Just(Leg::Plateau),
        1 => Just(Leg::NegativeZero),
        1 => prop_oneof![Just(10.0), Just(-10.0)].prop_map(Leg::Jump),
        1 => (-1e4..1e4).prop_map(Leg::Far),
        2 => (0.01..2.0, 0.6..0.99, 1_usize..12).prop_map(|(amplitude, ratio, cycles)| Leg::Decay { amplitude, ratio, cycles }),
        2 => (any::<prop::sample::Index>(), any::<bool>()).prop_map(|(i, back)| Leg::OntoAStrength(i.index(1000), back)),
    ]
}

/// Displacements of a history on a population with the given strengths.
fn displacements(legs: &[Leg], strengths: &[f64]) -> Vec<f64> {
    let scale = strengths.last().copied().unwrap();
    let mut path = vec![0.0_f64];
    for leg in legs {
        let here = *path.last().unwrap();
        match *leg {
            Leg::Step(x) | Leg::Jump(x) => path.push(here + x * scale),
            Leg::Plateau => path.extend([here, here]),
            Leg::NegativeZero => path.extend([0.0, -0.0, 0.0]),
            Leg::Far(x) => path.push(x * scale),
            Leg::Decay { amplitude, ratio, cycles } => {
                let mut a = amplitude * scale;
                for _ in 0..cycles {
                    path.extend([here + a, here + 0.3 * a, here, here - a, here - 0.1 * a]);
                    a *= ratio;
                }
            }
            Leg::OntoAStrength(i, back) => {
                let phi = strengths[i % strengths.len()];
                path.push(if back { here - 2.0 * phi } else { phi });
            }
        }
    }
    path
}

fn population() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
    prop_oneof![
        // Sliders of equal strength and a slider of zero strength are included.
        prop::collection::vec((prop_oneof![Just(0.0), Just(0.25), Just(1.0), 0.0..1.0], 0.01..1.0), 1..24)
            .prop_map(|mut e: Vec<(f64, f64)>| {
                e.sort_by(|a, b| a.0.total_cmp(&b.0));
                e.last_mut().unwrap().0 = 1.0;
                e.into_iter().unzip()
            }),
        (-0.9..0.5, 0.0..2.0, 1_usize..200).prop_map(|(chi, beta, bins)| {
            let joint = FourParameter::new(3.0, 2.0, chi, beta).unwrap();
            let mut table = vec![Slider::default(); Sliders::table_len(bins)];
            let sliders = Sliders::discretise(&joint, Grid::graded(bins), bins, &mut table).unwrap();
            sliders.elements().unzip()
        }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Run-length memory, and Masing's rule on the same population, agree with the plain loop to 1e-13 of the largest force.
    #[test]
    fn run_length_and_masing_agree_with_the_plain_loop((strength, stiffness) in population(), legs in prop::collection::vec(leg(), 1..12)) {
        let mut table = vec![Slider::default(); strength.len() + 1];
        let sliders = Sliders::from_elements(&strength, &stiffness, &mut table).unwrap();
        let plain = Plain::new(sliders);
        let masing = Continuum::new(sliders);
        let mut slow = plain.virgin(vec![0.0; sliders.len()]).unwrap();
        let mut fast = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
        let path = displacements(&legs, &strength);
        let mut stack = masing.virgin(vec![Reversal::default(); path.len() + 2]).unwrap();
        let largest = sliders.slip_force();
        let room = 0.5 * sliders.initial_stiffness() * strength.last().unwrap().powi(2) + 1e-300;
        let far = path.iter().fold(1.0_f64, |a, u| a.max(u.abs()));
        for u in path {
            let expected = plain.advance(&mut slow, u);
            let found = sliders.advance(&mut fast, u);
            prop_assert!((found - expected).abs() <= 1e-13 * largest, "runs at {u}: {found} {expected}");
            prop_assert!((sliders.stored_energy(&fast) - plain.stored_energy(&slow)).abs() <= 1e-12 * room);
            let found = masing.advance(&mut stack, u);
            // The stack stores displacements; where these are large, their own rounding adds to the error.
            prop_assert!((found - expected).abs() <= 1e-13 * largest * far, "masing at {u}: {found} {expected}");
            prop_assert!((masing.stored_energy(&stack) - plain.stored_energy(&slow)).abs() <= 1e-12 * room * far);
        }
    }

    /// One implicit step solves its equation, whichever memory evaluates the force.
    #[test]
    fn implicit_steps_agree((strength, stiffness) in population(), loads in prop::collection::vec((-2.0..2.0, 0.0..1.0), 1..30), log_k in -2.0..6.0) {
        let mut table = vec![Slider::default(); strength.len() + 1];
        let sliders = Sliders::from_elements(&strength, &stiffness, &mut table).unwrap();
        let (plain, masing) = (Plain::new(sliders), Continuum::new(sliders));
        let mut slow = plain.virgin(vec![0.0; sliders.len()]).unwrap();
        let mut fast = sliders.virgin(vec![Run::default(); sliders.len()]).unwrap();
        let mut stack = masing.virgin(vec![Reversal::default(); loads.len() + 2]).unwrap();
        let k = 10.0_f64.powf(log_k) * sliders.initial_stiffness();
        for (size, share) in loads {
            let load = size * share * k * strength.last().unwrap();
            let expected = plain.solve(&mut slow, k, load);
            let found = sliders.solve(&mut fast, k, load);
            let other = masing.solve(&mut stack, k, load);
            let scale = 1e-12 * (1.0 + expected.abs());
            prop_assert!((found - expected).abs() <= scale, "runs {found} {expected}");
            prop_assert!((other - expected).abs() <= scale, "masing {other} {expected}");
            prop_assert!((sliders.joint_force(&fast) - plain.joint_force(&slow)).abs() <= 1e-11 * sliders.initial_stiffness());
        }
    }
}
