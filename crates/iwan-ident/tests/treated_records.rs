//! Records that were filtered or windowed before they came here, and records of the same kind that were not.
#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use std::f64::consts::TAU;

use iwan_core::SplitMix64;
use iwan_ident::curve_fit::Grade;
use iwan_ident::curves::Quantity;
use iwan_ident::identify::{Identification, ModeRecord, Settings, identify};
use iwan_ident::signal::{Butterworth, Options, Passband, Treatment, isolate, treatment};
use iwan_ident::{Parameter, Parameters};

use crate::law_records::in_noise::{add_noise, in_noise, phi_max, ring_down};
use crate::law_records::{normal, sliders};

const DT: f64 = 2e-4;
const COUNT: usize = 8192;
const MODE: Parameters =
    Parameters { frequency: 124.0, damping_ratio: 1e-3, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };

/// Acceleration of the mode, released at half of its slip limit.
fn clean() -> Vec<f64> {
    ring_down(&MODE, 0.5 * phi_max(&MODE).unwrap(), DT, COUNT).unwrap()
}

fn noisy(decibels: f64, seed: u64) -> Vec<f64> {
    let mut x = clean();
    add_noise(&mut x, decibels, &mut SplitMix64::new(seed));
    x
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, x| x.abs().max(m))
}

fn seen(x: &[f64]) -> Option<Treatment> {
    treatment(x, DT, 123.5)
}

fn passed(x: &[f64], order: usize, pass: Passband) -> Vec<f64> {
    Butterworth::new(order, pass, DT).unwrap().forward_backward(x).unwrap()
}

/// One pass of a low-pass or high-pass of fourth order (Butterworth) through two sections.
fn once(x: &[f64], edge: f64, is_high: bool) -> Vec<f64> {
    let w = (0.5 * TAU * edge * DT).tan();
    let mut y = x.to_vec();
    for quality in [0.541_196_1, 1.306_563] {
        let norm = 1.0 + w / quality + w * w;
        let (gain, turn) = if is_high { (1.0 / norm, -2.0) } else { (w * w / norm, 2.0) };
        let a = [2.0 * (w * w - 1.0) / norm, (1.0 - w / quality + w * w) / norm];
        let mut state = [0.0; 2];
        for sample in &mut y {
            let input = gain * *sample;
            *sample = input + state[0];
            state = [turn * input - a[0] * *sample + state[1], input - a[1] * *sample];
        }
    }
    y
}

fn windowed(x: &[f64], window: impl Fn(f64) -> f64) -> Vec<f64> {
    x.iter().enumerate().map(|(n, x)| x * window(n as f64 / COUNT as f64)).collect()
}

fn identified(x: &[f64]) -> Identification {
    let record = ModeRecord { samples: x, dt: DT, quantity: Quantity::Acceleration };
    identify(&[record], &Settings::default()).unwrap()
}

fn assert_tells_nothing(x: &[f64]) {
    let found = identified(x);
    assert!(found.verdict.treated && found.verdict.grade != Grade::Matches, "{}", found.verdict.misfit);
    assert!(!found.verdict.adequate);
    for parameter in Parameter::ALL {
        let profile = found.profile(parameter);
        assert_eq!((profile.low, profile.high), (None, None), "{parameter:?}");
    }
    let laws = found.laws.unwrap();
    assert!(laws.laws.iter().all(|law| law.grade != Grade::Matches));
    assert!(laws.laws.iter().flat_map(|law| &law.parameters).all(|p| (p.low, p.high) == (None, None)));
    assert!(found.notes.iter().any(|note| note.contains("give the record as it was measured")));
}

/// Without the detection this record "matched" with K_T far from 44,500 in a closed interval.
#[test]
fn a_band_pass_both_ways_is_named_with_its_edges() {
    for (seed, decibels) in [(1, 30.0), (2, 45.0), (3, 60.0)] {
        for order in [2, 3, 5] {
            let x = passed(&noisy(decibels, seed), order, Passband::Band { low: 100.0, high: 150.0 });
            let Some(Treatment::Filtered { low: Some(low), high: Some(high) }) = seen(&x) else {
                panic!("{decibels} dB, order {order}: {:?}", seen(&x));
            };
            assert!((low / 100.0 - 1.0).abs() < 0.2 && (high / 150.0 - 1.0).abs() < 0.1, "{low} {high}");
        }
    }
    let x = passed(&noisy(60.0, 3), 3, Passband::Band { low: 100.0, high: 150.0 });
    assert_tells_nothing(&x);
    let words = isolate(&x, DT, &Options::default()).unwrap().notes.join("\n");
    assert!(words.contains("the record was band-passed before: below about"), "{words}");
}

#[test]
fn a_filter_on_one_side_or_in_one_pass_is_named() {
    let x = noisy(50.0, 4);
    let low = seen(&passed(&x, 4, Passband::Low(200.0)));
    assert!(
        matches!(low, Some(Treatment::Filtered { low: None, high: Some(e) }) if (e / 200.0 - 1.0).abs() < 0.1)
    );
    let high = seen(&passed(&x, 4, Passband::High(85.0)));
    assert!(
        matches!(high, Some(Treatment::Filtered { low: Some(e), high: None }) if (e / 85.0 - 1.0).abs() < 0.1)
    );
    // Twice the fourth order, forwards only.
    let high = once(&once(&x, 90.0, true), 90.0, true);
    let both = seen(&once(&once(&high, 170.0, false), 170.0, false));
    assert!(matches!(both, Some(Treatment::Filtered { low: Some(_), high: Some(_) })), "{both:?}");
}

/// A filter far from the mode is named, and changes nothing else.
#[test]
fn a_filter_far_from_the_mode_takes_no_interval() {
    let x = passed(&noisy(60.0, 11), 4, Passband::Band { low: 62.0, high: 248.0 });
    assert!(matches!(seen(&x), Some(Treatment::Filtered { low: Some(_), high: Some(_) })), "{:?}", seen(&x));
    let found = identified(&x);
    assert!(!found.verdict.treated && found.verdict.adequate, "{}", found.verdict.misfit);
    assert!(found.notes.iter().any(|note| note.contains("too far from the mode")), "{:?}", found.notes);
    let (chi, frequency) = (found.profile(Parameter::Chi), found.profile(Parameter::Frequency));
    for (profile, truth) in [(chi, MODE.chi), (frequency, MODE.frequency)] {
        let (low, high) = (profile.low.unwrap(), profile.high.unwrap());
        assert!(low - (high - low) < truth && truth < high + (high - low), "{truth}: {low} {high}");
    }
}

#[test]
fn windows_are_named_by_the_noise_that_fades_with_them() {
    for (seed, decibels) in [(5, 30.0), (6, 45.0), (7, 60.0)] {
        let x = noisy(decibels, seed);
        for end in [0.01, 0.1_f64] {
            let constant = COUNT as f64 * DT / -end.ln();
            let found = seen(&windowed(&x, |part| end.powf(part)));
            let Some(Treatment::Exponential { time_constant }) = found else {
                panic!("{decibels} dB, to {end}: {found:?}");
            };
            assert!((time_constant / constant - 1.0).abs() < 0.1, "{time_constant} for {constant}");
        }
        let hann = windowed(&x, |part| (0.5 * TAU * part).sin().powi(2));
        assert_eq!(seen(&hann), Some(Treatment::Hann));
        let hamming = windowed(&x, |part| 0.54 - 0.46 * (TAU * part).cos());
        assert_eq!(seen(&hamming), Some(Treatment::Hamming));
    }
    // A record without noise shows a Hann window by its ends.
    let hann = windowed(&clean(), |part| (0.5 * TAU * part).sin().powi(2));
    assert_eq!(seen(&hann), Some(Treatment::Hann));
    let x = windowed(&noisy(60.0, 7), |part| 0.01_f64.powf(part));
    assert_tells_nothing(&x);
    let words = seen(&x).unwrap().in_words(124.0);
    // 1 % at the end of 1.638 s: τ = 0.3558 s, and 1/(2π 124 τ) = 0.361 %.
    assert!(words.contains("adds 0.3") && words.contains("% to the damping ratio at 124.00 Hz"), "{words}");
}

#[test]
fn a_record_as_it_was_measured_is_not_named() {
    let white = |decibels: f64| noisy(decibels, 8);
    for decibels in [30.0, 40.0, 60.0, 80.0] {
        assert_eq!(seen(&white(decibels)), None, "{decibels} dB");
    }
    let time = |n: usize| n as f64 * DT;
    let with = |f: &dyn Fn(usize) -> f64| -> Vec<f64> {
        white(50.0).iter().enumerate().map(|(n, x)| x + f(n)).collect()
    };
    let top = largest(&clean());
    let hum = |n: usize| 0.01 * top * ((TAU * 50.0 * time(n)).sin() + 0.3 * (TAU * 150.0 * time(n)).sin());
    assert_eq!(seen(&with(&hum)), None);
    let other = |n: usize| 0.3 * top * (-8.0 * time(n)).exp() * (TAU * 211.0 * time(n)).sin();
    assert_eq!(seen(&with(&other)), None);
    assert_eq!(seen(&with(&|_| 0.7 * top)), None);
    assert_eq!(seen(&with(&|n| top * time(n) - 0.4 * top)), None);
    for bits in [12, 16] {
        let step = top / f64::from(1 << (bits - 1));
        for decibels in [60.0, 100.0] {
            let x: Vec<f64> = white(decibels).iter().map(|x| (x / step).round() * step).collect();
            assert_eq!(seen(&x), None, "{bits} bits");
        }
    }
    // Pink noise, as a sum of random walks that forget; and digits that follow the samples, as a text has them.
    let (mut random, mut walks) = (SplitMix64::new(9), [0.0; 10]);
    let pink: Vec<f64> = clean()
        .iter()
        .map(|x| {
            let mut part = 1.0_f64;
            for walk in &mut walks {
                part *= 0.5;
                *walk += part.sqrt() * normal(&mut random) - part * *walk;
            }
            x + 1e-3 * top * walks.iter().sum::<f64>()
        })
        .collect();
    assert_eq!(seen(&pink), None);
    for digits in [3, 5] {
        let x: Vec<f64> = white(100.0).iter().map(|x| format!("{x:.digits$e}").parse().unwrap()).collect();
        assert_eq!(seen(&x), None, "{digits} digits");
    }
    let found = identified(&white(60.0));
    assert!(!found.verdict.treated && found.verdict.adequate, "{}", found.verdict.misfit);
}

#[test]
fn random_records_in_noise_are_not_named() {
    for decibels in [30.0, 60.0] {
        for seed in 0..40 {
            let made = in_noise(seed, decibels).unwrap();
            let found = treatment(&made.samples, made.dt, made.truth.frequency);
            assert_eq!(found, None, "{seed}, {decibels} dB, {:?}", made.truth);
        }
    }
}

#[test]
fn simulations_without_noise_are_not_named() {
    assert_eq!(seen(&clean()), None);
    for count in [20, 100, 1000] {
        for (amplitude, seconds) in [(100.0, 0.2), (1000.0, 1.0), (3000.0, 0.6)] {
            let x = sliders::blow(count, amplitude, seconds).unwrap();
            assert_eq!(treatment(&x, sliders::STEP, 123.0), None, "{count} sliders, {amplitude} N");
        }
    }
    for seed in 100..140 {
        let made = in_noise(seed, f64::INFINITY).unwrap();
        assert_eq!(treatment(&made.samples, made.dt, made.truth.frequency), None, "{seed}, {:?}", made.truth);
    }
}
