//! From a record to the parameters of its joint, with 95 % intervals and a verdict.

use std::error::Error;

use iwan::core::{Decay, Motion, Reversal, Samples};
use iwan::ident::Parameters;
use iwan::ident::curves::Quantity;
use iwan::ident::identify::{ModeRecord, Settings, identify};
use iwan::io::Record;

/// Mode 1 of Table 2 of Deaner et al. with a viscous damper: K_T in 1/s², F_S in mass^½·length/s².
const TRUTH: Parameters =
    Parameters { frequency: 124.0, damping_ratio: 2.5e-4, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };

/// A synthetic record: acceleration sampled at 5 kHz after a release at 1.5 φ_max, with noise 40 dB below the signal.
fn record() -> Result<Record, Box<dyn Error>> {
    let (oscillator, joint) = TRUTH.model()?;
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; 1500]);
    let [displacement, velocity, acceleration, joint_force] = &mut out;
    let release = Motion::held_at(1.5 * joint.phi_max());
    Decay::new(&oscillator, &joint, 0.0, release, vec![Reversal::default(); 200])?
        .sample(2e-4, &mut Samples { displacement, velocity, acceleration, joint_force })?;
    let [_, _, clean, _] = out;
    let noise = 0.01 * (clean.iter().map(|x| x * x).sum::<f64>() / clean.len() as f64).sqrt();
    let mut state = 1_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    // The sum of twelve uniform numbers minus its mean, 6, is normal enough.
    let noisy = clean.iter().map(|x| x + noise * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0));
    Ok(Record::new(2e-4, vec![noisy.collect()], vec!["tip".into()])?)
}

#[expect(clippy::print_stdout, reason = "an example shows its result")]
pub(crate) fn main() -> Result<(), Box<dyn Error>> {
    // A record of your own: `iwan::io::read("hammer.mat", &iwan::io::ReadOptions::default())?`.
    let record = record()?;
    let mode = ModeRecord { samples: record.channel(0), dt: record.dt(), quantity: Quantity::Acceleration };
    let found = identify(&[mode], &Settings::default())?;

    let end = |value: Option<f64>| value.map_or("open".into(), |v| format!("{v:.4e}"));
    for profile in &found.profiles.parameters {
        let (low, high) = (end(profile.low), end(profile.high));
        println!("{:13} {:.4e}  [{low}, {high}]", profile.parameter.name(), profile.value);
        // The noise has a fixed seed; with it the intervals contain the true values.
        let truth = TRUTH.get(profile.parameter);
        assert!(profile.low.is_none_or(|low| low <= truth) && profile.high.is_none_or(|high| truth <= high));
    }
    println!("{}", found.verdict.misfit);
    assert!(found.verdict.adequate);
    // At 40 dB and 0.3 s of record F_S is determined to some 6 %; this noise moves it by 1.4 %.
    assert!((found.parameters.f_s / TRUTH.f_s - 1.0).abs() < 0.02);
    Ok(())
}
