//! Records with defects: handled with a note, or refused with the reason.
#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use std::f64::consts::TAU;

use iwan_ident::curves::Quantity;
use iwan_ident::identify::{ModeRecord, Settings, identify};
use iwan_ident::signal::{Envelope, Method, Options, band_near, envelope, opinions};
use iwan_ident::{Error, Grade};

const DT: f64 = 1.0 / 4096.0;
const OMEGA: f64 = TAU * 80.0;
const ZETA: f64 = 0.002;

/// A linear mode of 80 Hz and 0.2 % damping.
fn decay(t: f64) -> f64 {
    (-ZETA * OMEGA * t).exp() * (OMEGA * (1.0 - ZETA * ZETA).sqrt() * t).cos()
}

fn record(f: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..8192).map(|n| f(f64::from(n) * DT)).collect()
}

/// Deterministic noise of zero mean and standard deviation 1: sums of twelve uniform numbers from a linear congruential generator.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        let mut uniform = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }
}

fn found(x: &[f64]) -> Envelope {
    envelope(x, DT, Method::Hilbert, &Options::default()).unwrap()
}

/// Asserts that the damping is within `part` of the truth over the inner 90 % of the trusted window, and the frequency within 0.01 Hz.
fn assert_true(envelope: &Envelope, part: f64) {
    let (a, b) = envelope.trusted;
    for i in 0..=20 {
        let t = a + (b - a) * (0.05 + 0.045 * f64::from(i));
        let at = envelope.at(t).unwrap();
        assert!((at.frequency / 80.0 - 1.0).abs() < 1.2e-4, "{:?} {t}: {at:?}", envelope.method);
        let ratio = at.damping_ratio / ZETA;
        assert!((ratio - 1.0).abs() < part, "{:?} {t}: {at:?} {:?}", envelope.method, envelope.notes);
    }
}

/// Whether a sentence names two components at these frequencies, Hz.
fn is_pair(words: &str, frequencies: [f64; 2]) -> bool {
    let told = words.split_once("two components at ").map(|(_, told)| told.split(' ').collect::<Vec<_>>());
    let near = |word: &str, f: f64| word.parse::<f64>().is_ok_and(|told| (told - f).abs() < 1e-3);
    told.is_some_and(|told| near(told[0], frequencies[0]) && near(told[2], frequencies[1]))
}

#[test]
fn all_methods_agree_on_a_linear_mode() {
    let opinions = opinions(&record(decay), DT, &Options::default()).unwrap();
    assert_eq!(opinions.envelopes.len(), 4);
    opinions.envelopes.iter().for_each(|e| assert_true(e, 0.006));
    let spread = opinions.spread.unwrap();
    assert!(spread.median_damping_ratio < 1e-3 && spread.frequency < 0.01, "{spread:?}");
}

#[test]
fn offset_and_drift_do_not_matter() {
    assert_true(&found(&record(|t| decay(t) + 20.0)), 0.01);
    assert_true(&found(&record(|t| decay(t) + 5.0 - 3.0 * t + 2.0 * t * t)), 0.01);
}

#[test]
fn a_pulse_at_the_start_is_left_out_of_the_window() {
    // A half-sine of 10 ms, ten times as high as the mode, and two other modes.
    let x = record(|t| {
        let pulse = if t < 0.01 { 10.0 * (TAU * 50.0 * t).sin() } else { 0.0 };
        let others = (-8.0 * t).exp() * (TAU * 297.0 * t).cos() + (-20.0 * t).exp() * (TAU * 845.0 * t).cos();
        decay(t) + pulse + others
    });
    let envelope = found(&x);
    assert!(envelope.trusted.0 > 0.04);
    assert_true(&envelope, 0.05);
}

#[test]
fn clipping_moves_the_window_and_says_so() {
    let envelope = found(&record(|t| decay(t).clamp(-0.6, 0.6)));
    // The record is below the clipping level of 0.6 from 0.51 s on.
    assert!(envelope.trusted.0 > 0.5 && envelope.trusted.0 < 0.6, "{:?}", envelope.trusted);
    assert!(envelope.notes.iter().any(|n| n.contains("clipped up to")), "{:?}", envelope.notes);
    assert_true(&envelope, 0.01);
}

#[test]
fn a_record_clipped_to_its_end_is_refused() {
    let x = record(|t| (decay(t)).clamp(-0.1, 0.1));
    let error = envelope(&x[..4000], DT, Method::Hilbert, &Options::default()).unwrap_err();
    assert!(matches!(error, Error::Refused { .. }) && error.to_string().contains("clipping"), "{error}");
}

#[test]
fn a_truncated_record_is_cut_where_it_stops() {
    let mut x = record(decay);
    x[5000..].fill(0.0);
    let envelope = found(&x);
    assert!(envelope.trusted.1 < 5000.0 * DT && envelope.trusted.1 > 4500.0 * DT);
    assert!(envelope.notes.iter().any(|n| n.contains("constant from")), "{:?}", envelope.notes);
    assert_true(&envelope, 0.02);
}

#[test]
fn a_second_mode_in_the_band_is_taken_out_or_refused_by_name() {
    let beside = |t: f64| 0.5 * (-ZETA * OMEGA * t).exp() * (1.05 * OMEGA * t).cos();
    // A mode four hertz away can be identified well enough in a band of its own and subtracted, …
    let envelope_found = found(&record(|t| decay(t) + beside(t)));
    assert!(
        envelope_found
            .notes
            .iter()
            .any(|n| n.contains("beside it at 83.9") || n.contains("beside it at 84.0")),
        "{:?}",
        envelope_found.notes
    );
    assert_true(&envelope_found, 0.12);
    // … and so can a line that does not decay, such as mains hum.
    let line = |part: f64| record(|t| decay(t) + part * (1.25 * OMEGA * t).cos());
    assert_true(&found(&line(0.3)), 0.12);
    // Without a filter nothing is subtracted: the record is refused with the name of the second mode, and the message says where that mode
    // is weak.
    let options = Options { filter_order: 0, ..Options::default() };
    let unfiltered =
        |part: f64| envelope(&record(|t| decay(t) + part * beside(t)), DT, Method::Hilbert, &options);
    let named = |words: &str| is_pair(words, [80.0, 84.0]);
    let error = unfiltered(1.0).unwrap_err().to_string();
    assert!(named(&error) && error.contains("modal filter"), "{error}");
    let notes = unfiltered(0.06).unwrap().notes;
    assert!(notes.iter().any(|n| named(n)), "{notes:?}");
}

/// A bell with two modes that beat two and a half times in the record: no spectrum resolves them, and smooth curves of degree twelve follow
/// the beat.
#[test]
fn two_modes_that_beat_a_few_times_are_named() {
    let beside =
        |t: f64, part: f64| part * (-1.15 * ZETA * OMEGA * t).exp() * ((OMEGA + TAU * 1.3) * t).cos();
    let of = |part: f64, noise: &mut dyn FnMut() -> f64| -> Vec<f64> {
        record(|t| decay(t) + beside(t, part)).iter().map(|x| x + 1e-3 * noise()).collect()
    };
    let mut random = noise(3);
    let run = |x: &[f64]| envelope(x, DT, Method::Hilbert, &Options::default());
    let named = |words: &str| is_pair(words, [80.0, 81.3]);
    let error = run(&of(0.4, &mut random)).unwrap_err().to_string();
    assert!(named(&error) && error.contains("--from"), "{error}");
    let notes = run(&of(0.05, &mut random)).unwrap().notes;
    assert!(notes.iter().any(|n| named(n)), "{notes:?}");
    let notes = run(&of(0.0, &mut random)).unwrap().notes;
    assert!(!notes.iter().any(|n| n.contains("components")), "{notes:?}");
}

/// Two modes of a glass, 1 % apart: the band of either mode once reached twenty-five times as far to the other side, and its filter let
/// both modes through.
#[test]
fn modes_one_per_cent_apart_are_separated() {
    let (dt, rate) = (1.0 / 8820.0, 2.7);
    let mode = |t: f64, f: f64| (-rate * t).exp() * (TAU * f * t).cos();
    let mut noise = noise(11);
    let at = |t: f64| mode(t, 1449.9) + 0.33 * mode(t, 1464.0);
    let x: Vec<f64> = (0..26_460).map(|n| at(f64::from(n) * dt) + 3e-4 * noise()).collect();
    for (frequency, size) in [(1449.9, 1.0), (1464.0, 0.33)] {
        let near = band_near(&[&x], dt, frequency).unwrap();
        let band = (size < 1.0).then_some((near.low, near.high));
        let envelope = envelope(&x, dt, Method::Hilbert, &Options { band, ..Options::default() }).unwrap();
        for t in [0.15, 0.4, 0.9] {
            let at = envelope.at(t).unwrap();
            assert!((at.frequency - frequency).abs() < 0.02, "{at:?} {:?}", envelope.notes);
            assert!((at.damping_ratio * TAU * frequency / rate - 1.0).abs() < 0.05, "{at:?}");
            assert!((at.amplitude / (size * (-rate * t).exp()) - 1.0).abs() < 0.05, "{at:?}");
        }
    }
}

#[test]
fn a_rate_too_low_is_refused_where_it_is() {
    // With five samples a cycle peaks cannot be found, but the analytic signal can be used.
    let x: Vec<f64> = (0..800).map(|n| decay(f64::from(n) / 400.0)).collect();
    let run = |method| envelope(&x, 1.0 / 400.0, method, &Options::default());
    assert_true(&run(Method::Hilbert).unwrap(), 0.01);
    for method in [Method::Peaks, Method::PeakFitting] {
        let message = run(method).unwrap_err().to_string();
        assert!(message.contains("samples per cycle = 5") && message.contains("hilbert"), "{message}");
    }
    let band = Some((60.0, 250.0));
    let error =
        envelope(&x, 1.0 / 400.0, Method::Hilbert, &Options { band, ..Options::default() }).unwrap_err();
    assert!(error.to_string().contains("200"), "{error}");
}

#[test]
fn noise_ends_the_window_and_standard_deviations_hold() {
    let mut random = noise(7);
    let x: Vec<f64> = record(decay).iter().map(|x| x + 0.3 * random()).collect();
    let opinions = opinions(&x, DT, &Options::default()).unwrap();
    for envelope in &opinions.envelopes {
        assert!(envelope.notes.iter().any(|n| n.contains("sinks into noise")), "{:?}", envelope.notes);
        for i in 0..envelope.t.len() {
            let z = (envelope.damping_ratio[i] - ZETA) / envelope.damping_ratio_sd[i];
            assert!(z.abs() < 6.0, "{:?} {} s: {z} standard deviations", envelope.method, envelope.t[i]);
        }
    }
}

#[test]
fn silence_noise_and_steady_vibration_are_refused() {
    let refused = |x: &[f64]| envelope(x, DT, Method::Hilbert, &Options::default()).unwrap_err().to_string();
    assert!(refused(&vec![0.0; 4096]).contains("no spectral peak"));
    let steady = record(|t| (OMEGA * t).sin() * (1.0 + 0.01 * t));
    assert!(refused(&steady).contains("does not decay"), "{}", refused(&steady));
    // A tone that falls by half a per cent over the record.
    let driven = found(&record(|t| (OMEGA * t).sin() * (1.0 - 0.0025 * t)));
    assert!(
        driven.notes.iter().any(|n| n.contains("falls by 0.") && n.contains("driven")),
        "{:?}",
        driven.notes
    );
    // A record of eleven cycles, nine of which the filter spoils.
    let few: Vec<f64> = (0..563).map(|n| decay(f64::from(n) * DT)).collect();
    assert!(refused(&few).contains("cycles of the mode behind its largest amplitude"), "{}", refused(&few));
    let mut random = noise(3);
    let x: Vec<f64> = (0..8192).map(|_| random()).collect();
    assert!(!refused(&x).is_empty());
    assert!(refused(&[1.0; 10]).contains("64"));
    let mut x = record(decay);
    x[100] = f64::NAN;
    assert!(refused(&x).contains("record[100]"));
}

/// A mode of 80 Hz and 1 % damping under white noise, as under traffic or wind: no part of the record is a free decay. The remedies in the
/// message were once "record longer" and "name the mode".
#[test]
fn vibration_under_random_forces_is_named() {
    let (rate, turn) = (-0.01 * OMEGA * DT, OMEGA * DT);
    let (a, b) = (2.0 * rate.exp() * turn.cos(), -(2.0 * rate).exp());
    for seed in 1..9 {
        let mut force = noise(seed);
        let (mut before, mut last) = (0.0, 0.0);
        let mut next = || {
            (before, last) = (last, a * last + b * before + force());
            last
        };
        let x: Vec<f64> = (0..45_000).map(|_| next()).skip(4_000).collect();
        let refused = envelope(&x, DT, Method::Hilbert, &Options::default()).unwrap_err().to_string();
        assert!(refused.contains("rises slowly") || refused.contains("two components"), "{seed}: {refused}");
    }
}

#[test]
fn a_short_record_is_refused_with_the_number_of_cycles() {
    let x = record(decay);
    let error = envelope(&x[..600], DT, Method::Hilbert, &Options::default()).unwrap_err().to_string();
    assert!(error.contains("cycles") || error.contains("nothing of the record is left"), "{error}");
}

/// A cutting tool struck at its tip: a mode of 1077 Hz that has decayed after 20 ms of a record of one second, beside the line of a turning
/// spindle. A spectrum over the whole record shows nothing of such a decay, so that noise or the spindle's line was once taken for the
/// mode.
#[test]
fn a_decay_at_the_begin_of_a_long_record_is_found() {
    let (dt, damping) = (1.0 / 51_200.0, 0.03);
    let omega = TAU * 1077.0;
    for (line, seed) in [(0.0, 1), (0.003, 2), (0.003, 3)] {
        let mut noise = noise(seed);
        let mode = |t: f64| if t < 0.0 { 0.0 } else { (-damping * omega * t).exp() * (omega * t).sin() };
        let at = |t: f64| mode(t - 0.002) + line * (TAU * 4414.0 * t).sin();
        let x: Vec<f64> = (0..51_200).map(|n| at(f64::from(n) * dt) + 0.002 * noise()).collect();
        for near in [None, Some(1077.0)] {
            let envelope =
                envelope(&x, dt, Method::Hilbert, &Options { near, ..Options::default() }).unwrap();
            assert!(envelope.trusted.0 < 0.01 && envelope.trusted.1 < 0.05, "{:?}", envelope.trusted);
            assert!(envelope.notes.iter().any(|n| n.contains("nothing but noise")), "{:?}", envelope.notes);
            let at = envelope.at(0.5 * (envelope.trusted.0 + envelope.trusted.1)).unwrap();
            assert!((at.frequency / 1077.0 - 1.0).abs() < 0.01, "{at:?}");
            assert!((at.damping_ratio / damping - 1.0).abs() < 0.1, "{at:?}");
        }
    }
    // After a short burst, a mode of small amplitude goes on for the whole record: it is the mode to be analysed, as before.
    let mut noise = noise(4);
    let burst = |t: f64| (-damping * omega * t).exp() * (omega * t).sin();
    let quiet = |t: f64| 0.005 * (-t).exp() * (TAU * 200.0 * t).sin();
    let x: Vec<f64> =
        (0..51_200).map(|n| f64::from(n) * dt).map(|t| burst(t) + quiet(t) + 0.002 * noise()).collect();
    let found = envelope(&x, dt, Method::Hilbert, &Options::default()).unwrap();
    let (from, to) = found.trusted;
    assert!(
        (found.at(0.5 * (from + to)).unwrap().frequency - 200.0).abs() < 0.5 && to > 0.5,
        "{:?}",
        found.trusted
    );
}

/// Hum that exceeds the end of a decay has a higher peak than the mode in the spectrum of the whole record. The decay goes on below the
/// hum, and the record must not be cut where the sum of both is steady.
#[test]
fn hum_that_is_louder_than_the_end_of_a_decay_does_not_end_it() {
    let (dt, f) = (1.0 / 2048.0, 6.9);
    // One decay fills most of the record, another ends in a part of it.
    for (damping, until) in [(0.006, 14.0), (0.02, 6.0)] {
        let mut noise = noise(5);
        let at = |t: f64| {
            let mode = (-damping * TAU * f * t).exp() * (TAU * f * t).cos();
            mode + 0.3 * (TAU * 50.01 * t).sin()
        };
        let x: Vec<f64> = (0..40_960).map(|n| at(f64::from(n) * dt) + 1e-4 * noise()).collect();
        let found = envelope(&x, dt, Method::Hilbert, &Options::default()).unwrap();
        assert!(found.trusted.1 > until, "{:?} {:?}", found.trusted, found.notes);
        let is_named = |n: &String| n.contains("50.01") && n.contains("does not decay");
        assert!(found.notes.iter().any(is_named), "{:?}", found.notes);
        for part in [0.2, 0.5, 0.9] {
            let at = found.at(part * until).unwrap();
            let (frequency, ratio) = (at.frequency / f, at.damping_ratio / damping);
            assert!((frequency - 1.0).abs() < 1e-3 && (ratio - 1.0).abs() < 0.03, "{damping} {at:?}");
        }
    }
}

/// The mode with the highest peak in the spectrum of the whole record is taken. Another mode that is higher just after the blow is named,
/// also where the first cannot be followed.
#[test]
fn a_mode_that_is_higher_behind_the_blow_is_named() {
    let wave = |t: f64, a: f64, rate: f64, f: f64| a * (-rate * t).exp() * (TAU * f * t).cos();
    let both = |t: f64| wave(t, 1.0, 6.0, 301.0) + wave(t, 0.1, 0.4, 80.0);
    let found = found(&record(both));
    assert!((found.frequency[0] - 80.0).abs() < 0.1, "{}", found.frequency[0]);
    assert!(found.notes.iter().any(|n| n.contains("301.0") && n.contains("--mode")), "{:?}", found.notes);
    let named = |options: &Options| {
        let one = envelope(&record(both), DT, Method::Hilbert, options).unwrap();
        one.notes.iter().any(|n| n.contains("--mode"))
    };
    assert!(!named(&Options { near: Some(80.0), ..Options::default() }));
    // The mode at 12 Hz has too few cycles in the record.
    let slow = |t: f64| wave(t, 1.0, 6.0, 301.0) + wave(t, 0.12, 0.4, 12.0);
    let refused =
        envelope(&record(slow)[..4000], DT, Method::Hilbert, &Options::default()).unwrap_err().to_string();
    assert!(
        refused.contains("of the mode at 11.9") && refused.contains("301.0") && refused.contains("--mode HZ"),
        "{refused}"
    );
}

/// Acceleration of a mode with a contact that opens and quadratic damping, by the classical Runge-Kutta method in steps of a 32nd of `dt`.
fn opening_contact(dt: f64, count: usize) -> Vec<f64> {
    let omega = TAU * 20.684265962695967;
    let damping = 2.0 * 0.0003861900915942574 * omega;
    let [spring, gap, quadratic] = [3539.4653514296147, 0.00024821345678237956, 183.393063595947];
    let acceleration = |x: f64, v: f64| {
        let open = x.abs() - gap;
        let pull = if open > 0.0 { -spring * open * x.signum() } else { 0.0 };
        -(omega * omega) * x - damping * v - (pull + quadratic * v.abs() * v)
    };
    let h = dt / 32.0;
    let (mut x, mut v) = (0.0004794651562869788, 0.0);
    let sample = |_| {
        let now = acceleration(x, v);
        for _ in 0..32 {
            let k1 = (v, acceleration(x, v));
            let from = (x, v);
            let at =
                |k: (f64, f64), h: f64| (from.1 + h * k.1, acceleration(from.0 + h * k.0, from.1 + h * k.1));
            let k2 = at(k1, 0.5 * h);
            let k3 = at(k2, 0.5 * h);
            let k4 = at(k3, h);
            x += h / 6.0 * (k1.0 + 2.0 * k2.0 + 2.0 * k3.0 + k4.0);
            v += h / 6.0 * (k1.1 + 2.0 * k2.1 + 2.0 * k3.1 + k4.1);
        }
        now
    };
    (0..count).map(sample).collect()
}

/// No joint describes such a record, and the search for what it misses wanders off to where no model is. The fit was refused then, for one rounding of the time step and not for the next.
#[test]
fn a_record_far_from_any_joint_is_fitted_all_the_same() {
    let dt = 1.0 / 602.0202184928163;
    let samples = opening_contact(dt, 3316);
    let record = ModeRecord { samples: &samples, dt, quantity: Quantity::Acceleration };
    let found = identify(&[record], &Settings::default()).unwrap();
    assert_eq!(found.verdict.grade, Grade::No, "{:?}", found.verdict);
}
