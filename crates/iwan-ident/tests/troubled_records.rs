//! Records with defects: handled with a note, or refused with the reason.
#![allow(clippy::unwrap_used, reason = "a failed test may panic and say why")]

use std::f64::consts::TAU;

use iwan_ident::Error;
use iwan_ident::signal::{Envelope, Method, Options, envelope, opinions};

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

/// Deterministic, zero mean, standard deviation 1: sums of twelve uniform numbers from a linear congruence.
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

/// Damping within `part` of the truth over the inner 90 % of the trusted window, frequency within 0.01 Hz.
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
    // A half sine of 10 ms, ten times as high, and two other modes.
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
    // Below 0.6 from 0.51 s on.
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
    // Four hertz away it is known well enough from a band of its own, …
    let envelope_found = found(&record(|t| decay(t) + beside(t)));
    assert!(
        envelope_found.notes.iter().any(|n| n.contains("beside it at 84.")),
        "{:?}",
        envelope_found.notes
    );
    assert_true(&envelope_found, 0.12);
    // … and so is a line that does not decay, such as mains hum.
    let line = |part: f64| record(|t| decay(t) + part * (1.25 * OMEGA * t).cos());
    assert_true(&found(&line(0.3)), 0.12);
    // Without a filter nothing is taken out: refused by name, and told where it is weak.
    let options = Options { filter_order: 0, ..Options::default() };
    let unfiltered =
        |part: f64| envelope(&record(|t| decay(t) + part * beside(t)), DT, Method::Hilbert, &options);
    let error = unfiltered(1.0).unwrap_err().to_string();
    assert!(error.contains("second component") && error.contains("modal filter"), "{error}");
    let notes = unfiltered(0.06).unwrap().notes;
    assert!(notes.iter().any(|n| n.contains("second component")), "{notes:?}");
}

#[test]
fn a_rate_too_low_is_refused_where_it_is() {
    // Five samples a cycle: no peaks, but the analytic signal does not mind.
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
    assert!(!refused(&steady).is_empty());
    let mut random = noise(3);
    let x: Vec<f64> = (0..8192).map(|_| random()).collect();
    assert!(!refused(&x).is_empty());
    assert!(refused(&[1.0; 10]).contains("64"));
    let mut x = record(decay);
    x[100] = f64::NAN;
    assert!(refused(&x).contains("record[100]"));
}

#[test]
fn a_short_record_is_refused_with_the_number_of_cycles() {
    let x = record(decay);
    let error = envelope(&x[..600], DT, Method::Hilbert, &Options::default()).unwrap_err().to_string();
    assert!(error.contains("cycles") || error.contains("nothing of the record is left"), "{error}");
}
