//! What a fit itself casts doubt on: sidebands of a modulation, channels that do not go with the others, modes that are missing.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::f64::consts::TAU;

use crate::support::Normal;
use iwan_modal::measure::{Channel, Freedom, Hit, Motion};
use iwan_modal::responses::{Disagreement, disagreements, free_responses};
use iwan_modal::{Analysis, ModalFit, modal_fit};

const DT: f64 = 1e-3;
const SAMPLES: usize = 4096;
/// Frequency (Hz), damping ratio, amplitude and half waves of each mode.
const MODES: [(f64, f64, f64, f64); 4] =
    [(82.0, 3e-3, 1.0, 1.0), (133.0, 2e-3, 0.8, 2.0), (195.0, 2e-3, 0.9, 3.0), (251.0, 2.5e-3, 0.7, 4.0)];
/// Of the sway that modulates: frequency (Hz) and decay (1/s).
const SWAY: (f64, f64) = (5.8, 1.0);

/// Decays of modes at sensors along a beam, their phase modulated by the sway by so many radians at first.
fn decays(modes: &[(f64, f64, f64, f64)], sensors: usize, modulation: f64) -> Vec<Channel> {
    let mut noise = Normal::new(5);
    let channel = |i: usize| {
        let value = |n: usize| {
            let t = n as f64 * DT;
            let sway = modulation * (-SWAY.1 * t).exp() * (TAU * SWAY.0 * t).sin();
            let mode = |(f, damping, amplitude, waves): &(f64, f64, f64, f64)| {
                let shape = (waves * std::f64::consts::PI * (i as f64 + 0.3) / sensors as f64).cos();
                amplitude * shape * (-damping * TAU * f * t).exp() * (TAU * f * t + sway).cos()
            };
            modes.iter().map(mode).sum::<f64>()
        };
        let name = format!("a{i}");
        let samples = (0..SAMPLES).map(|n| value(n) + 1e-4 * noise.next()).collect();
        Channel { freedom: Freedom::point(&name), name, samples }
    };
    (0..sensors).map(channel).collect()
}

fn fit(channels: Vec<Channel>, band: (f64, f64), way: &Analysis) -> ModalFit {
    let responses = free_responses(&[channels], DT, Motion::Acceleration).unwrap();
    modal_fit(&responses, Some(band), way, 40).unwrap()
}

fn listed(fit: &ModalFit) -> Vec<f64> {
    fit.modes.iter().map(|m| m.frequency).collect()
}

#[test]
fn sidebands_of_a_modulation_are_named_and_modes_are_not() {
    // A weak mode as far from the first as the sway's frequency, and one at another distance from the second.
    let mut modes = MODES.to_vec();
    modes.extend([(87.9, 3e-3, 0.05, 3.5), (148.0, 3e-3, 0.05, 2.0)]);
    for sensors in [8, 1] {
        let fit = fit(decays(&modes, sensors, 0.2), (50.0, 300.0), &Analysis::Chart);
        let found = fit.sidebands().unwrap_or_else(|| panic!("{:?}", listed(&fit)));
        assert!((found.frequency - SWAY.0).abs() < 0.2, "{}", found.frequency);
        assert!(found.all.len() >= 6, "{sensors}: {found:?} {:?}", listed(&fit));
        for sideband in &found.all {
            let [own, of] = [sideband.mode, sideband.of].map(|n| fit.modes[n].frequency);
            assert!(modes.iter().any(|m| (of - m.0).abs() < 0.3), "{of}");
            let turns = ((own - of).abs() / SWAY.0).round();
            assert!(turns > 0.0 && ((own - of).abs() - turns * SWAY.0).abs() < 1.0, "{own} of {of}");
            // On one sensor nothing tells the weak mode at 87.9 Hz from a sideband.
            let is_true = modes.iter().any(|m| (own - m.0).abs() < 0.1);
            assert!(!is_true || sensors == 1, "{own} is a mode");
        }
        let words = fit.sideband_doubt().unwrap();
        assert!(words.contains("probably none, but sidebands") && words.contains("133.0"), "{words}");
    }
}

#[test]
fn structures_without_a_modulation_have_no_sidebands() {
    let still = fit(decays(&MODES, 8, 0.0), (50.0, 300.0), &Analysis::Chart);
    assert_eq!((still.modes.len(), still.sidebands()), (4, None));
    // A string: all modes at one distance, every other one weak, on one sensor.
    let string: Vec<_> =
        (1..=9).map(|n| (f64::from(n) * 40.0, 2e-3, if n % 2 == 0 { 1.0 } else { 0.2 }, 0.1)).collect();
    let string = fit(decays(&string, 1, 0.0), (20.0, 380.0), &Analysis::Chart);
    assert_eq!((string.modes.len(), string.sidebands()), (9, None), "{:?}", listed(&string));
    // A ring whose pairs of modes are split alike, on one sensor.
    let pairs = MODES.iter().flat_map(|m| [(m.0, m.1, m.2, 0.1), (m.0 + 4.0, 2.0 * m.1, 0.2 * m.2, 0.1)]);
    let ring = fit(decays(&pairs.collect::<Vec<_>>(), 1, 0.0), (50.0, 300.0), &Analysis::Chart);
    assert_eq!((ring.modes.len(), ring.sidebands()), (8, None), "{:?}", listed(&ring));
}

#[test]
fn modes_that_are_missing_are_not_laid_at_the_door_of_a_channel() {
    let band = (50.0, 300.0);
    let all = fit(decays(&MODES, 8, 0.0), band, &Analysis::Chart);
    assert!(!all.leaves_most() && all.strangers().is_empty());
    let one = fit(decays(&MODES, 8, 0.0), band, &Analysis::Given(vec![133.0]));
    assert!(one.leaves_most() && one.strangers().is_empty(), "{:?}", one.fitted.left);
    let mut other = decays(&MODES, 8, 0.0);
    let mut noise = Normal::new(9);
    other[3].samples.fill_with(|| noise.next());
    let other = fit(other, band, &Analysis::Chart);
    assert!(!other.leaves_most() && other.strangers() == [3], "{:?}", other.fitted.left);
}

#[test]
fn modes_that_were_found_are_overruled_one_by_one() {
    let channels = decays(&MODES, 8, 0.0);
    let responses = free_responses(&[channels], DT, Motion::Acceleration).unwrap();
    let found = || modal_fit(&responses, Some((50.0, 300.0)), &Analysis::Chart, 40).unwrap();
    let without = found().overruled(&responses, &[], &[133.1, 251.2]).unwrap();
    let is_at = |fit: &ModalFit, n: usize, f: f64| (fit.modes[n].frequency - f).abs() < 0.05;
    assert!(without.modes.len() == 2 && is_at(&without, 0, 82.0) && is_at(&without, 1, 195.0));
    assert!(without.stabilisation.is_some());
    let again = without.overruled(&responses, &[133.0], &[]).unwrap();
    assert!(again.modes.len() == 3 && is_at(&again, 1, 133.0), "{:?}", listed(&again));
    assert_eq!((again.mode_at(133.2, &responses), again.mode_at(140.0, &responses)), (Some(1), None));
    let nothing_there = again.overruled(&responses, &[], &[140.0]).unwrap_err().to_string();
    assert!(nothing_there.contains("140") && nothing_there.contains("133.0"), "{nothing_there}");
    let outside = found().overruled(&responses, &[400.0], &[]).unwrap_err().to_string();
    assert!(outside.contains("400") && outside.contains("within the band"), "{outside}");
}

/// A decay whose frequency falls with its amplitude, as that of a bolted joint; linear modes tell it in parts.
#[test]
fn parts_of_a_decay_that_is_not_linear_are_named() {
    let decays = |softening: f64| -> Vec<Channel> {
        let channel = |i: usize| {
            let mut noise = Normal::new(7 + i as u64);
            let mut phase = 0.0;
            let value = |n: usize| {
                let t = n as f64 * DT;
                let amplitude = (-4.0 * t).exp();
                phase += TAU * DT * (133.0 - softening * amplitude);
                (1.0 + i as f64) * amplitude * f64::cos(phase) + 1e-4 * noise.next()
            };
            let samples = (0..SAMPLES).map(value).collect();
            let name = format!("a{i}");
            Channel { freedom: Freedom::point(&name), name, samples }
        };
        (0..3).map(channel).collect()
    };
    let band = (100.0, 160.0);
    let linear = fit(decays(0.0), band, &Analysis::Chart);
    assert_eq!((linear.modes.len(), linear.parts_doubt()), (1, None), "{:?}", listed(&linear));
    let falling = fit(decays(4.0), band, &Analysis::Chart);
    let doubt = falling.parts_doubt().unwrap_or_else(|| panic!("{:?}", listed(&falling)));
    assert!(doubt.contains("133.0") || doubt.contains("132.9"), "{doubt}");
}

/// Hits between which the structure was warmed up, so that its first mode falls by one per cent.
#[test]
fn a_mode_that_moves_between_hits_is_named() {
    let channel = |name: &str, samples| Channel { name: name.into(), freedom: Freedom::point(name), samples };
    let hit = |name: &str, first: f64| {
        let force = (0..SAMPLES).map(|n| if n == 10 { 1.0 } else { 0.0 }).collect();
        let mut noise = Normal::new(3);
        let sample = |n: usize| {
            let t = (n as f64 - 10.0) * DT;
            let mode = |f: f64, damping: f64| {
                if t < 0.0 { 0.0 } else { (-damping * TAU * f * t).exp() * (TAU * f * t).sin() }
            };
            mode(first, 2e-3) + 0.4 * mode(243.0, 2e-3) + 1e-3 * noise.next()
        };
        let samples = (0..SAMPLES).map(sample).collect();
        Hit {
            name: name.into(),
            dt: DT,
            force: channel("hammer", force),
            responses: vec![channel("a", samples)],
        }
    };
    let found =
        |second| disagreements(&[hit("cold", 133.0), hit("warm", second), hit("again", 132.9)]).unwrap();
    let [Disagreement::Shifted { hits, frequencies, width }] = &found(131.7)[..] else {
        panic!("{:?}", found(131.7))
    };
    assert_eq!(hits, &["warm", "cold"]);
    assert!(
        (frequencies[0] - 131.7).abs() < 0.05 && (frequencies[1] - 133.0).abs() < 0.05,
        "{frequencies:?}"
    );
    // Half-power width 2ζf, and that of a record of four seconds.
    assert!((0.5..0.9).contains(width), "{width}");
    assert_eq!(found(132.8), []);
}
