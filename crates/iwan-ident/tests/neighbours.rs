//! Records of several modes: the envelope of the wanted mode is as if it were alone, and remains of the other modes are not taken for
//! macro-slip.
#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use std::f64::consts::TAU;

use iwan_core::{Decay, Motion, Reversal, Samples};
use iwan_ident::curves::Quantity;
use iwan_ident::identify::{ModeRecord, Settings, identify};
use iwan_ident::signal::{Options, isolate};
use iwan_ident::{Parameter, Parameters};

const DT: f64 = 1.0 / 4000.0;
const SAMPLES: usize = 8000;

/// A joint with a tenth of the mode's stiffness.
fn mode(frequency: f64, damping_ratio: f64) -> Parameters {
    let k_t = 0.1 * (TAU * frequency).powi(2);
    Parameters { frequency, damping_ratio, k_t, f_s: 200.0, chi: -0.2, beta: 0.3 }
}

/// Acceleration after release at `ratio` φ_max.
fn ring_down(mode: &Parameters, ratio: f64) -> Vec<f64> {
    let (oscillator, joint) = mode.model().unwrap();
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; SAMPLES]);
    let [displacement, velocity, acceleration, joint_force] = &mut out;
    let start = Motion::held_at(ratio * joint.phi_max());
    Decay::new(&oscillator, &joint, 0.0, start, vec![Reversal::default(); SAMPLES])
        .unwrap()
        .sample(DT, &mut Samples { displacement, velocity, acceleration, joint_force })
        .unwrap();
    let [_, _, acceleration, _] = out;
    acceleration
}

/// The record of a mode plus that of another mode whose initial amplitude is `level` times as large.
fn beside(own: &[f64], frequency: f64, level: f64) -> Vec<f64> {
    let other = ring_down(&mode(frequency, 1e-3), 0.3);
    let factor = level * own[0].abs() / other[0].abs();
    own.iter().zip(&other).map(|(x, y)| x + factor * y).collect()
}

/// Root mean square of the difference from the mode alone, relative to that of the mode, in the first and the last 60 samples of the
/// window.
fn off(own: &[f64], record: &[f64]) -> [f64; 2] {
    let options = Options { near: Some(124.0), ..Options::default() };
    let found = isolate(record, DT, &options).unwrap();
    let error = |from: usize| {
        let part = from..from + 60;
        let square = |x: &dyn Fn(usize) -> f64| part.clone().map(|n| x(n).powi(2)).sum::<f64>();
        (square(&|n| found.samples[n] - own[n]) / square(&|n| own[n])).sqrt()
    };
    [error(found.window.start), error(found.window.end - 60)]
}

/// The filter removes only the mode's own harmonics, a thousandth. Its skirts once passed 9 % of a mode at 134 Hz and 0.7 % of a mode at
/// 200 Hz.
#[test]
fn a_mode_beside_another_is_as_it_is_alone() {
    let own = ring_down(&mode(124.0, 5e-4), 0.3);
    for (frequency, level, least) in
        [(134.0, 0.5, 4e-3), (200.0, 0.5, 2e-3), (344.0, 0.5, 2e-3), (90.0, 0.3, 2e-3), (60.0, 1.0, 2e-3)]
    {
        let found = off(&own, &beside(&own, frequency, level));
        assert!(found.iter().all(|e| *e < least), "{frequency} Hz: {found:?}");
    }
}

/// The windows' gate responds to the sudden begin of the other mode as long as its memory lasts. This once looked like a knee just below
/// the largest amplitude, and K_T came out at a third of its value, with an interval of 0.2 %.
#[test]
fn what_other_modes_leave_is_no_macro_slip() {
    let truth = mode(124.0, 5e-4);
    let own = ring_down(&truth, 0.3);
    let given = Some((110.0, 129.0));
    // With and without a band; scripts/validate draws such neighbours by the hundred.
    let cases =
        [(134.0, 0.3, None), (134.0, 0.3, given), (200.0, 1.0, None), (344.0, 0.5, given), (60.0, 0.3, None)];
    for (frequency, level, band) in cases {
        let record = beside(&own, frequency, level);
        let options = Options { band, near: Some(124.0), ..Options::default() };
        let settings = Settings { options, ..Settings::default() };
        let record = ModeRecord { samples: &record, dt: DT, quantity: Quantity::Acceleration };
        let found = identify(&[record], &settings).unwrap();
        for parameter in [Parameter::KT, Parameter::FS, Parameter::Beta] {
            let profile = found.profile(parameter);
            let value = truth.get(parameter);
            let held = profile.low.is_none_or(|l| l <= value) && profile.high.is_none_or(|h| value <= h);
            let [low, high] = [profile.low, profile.high];
            assert!(held, "{frequency} Hz, {}: {value} not in {low:?}..{high:?}", parameter.name());
        }
        let frequency_found = found.parameters.frequency;
        assert!((frequency_found - 124.0).abs() < 0.02, "{frequency} Hz: {frequency_found}");
    }
}
