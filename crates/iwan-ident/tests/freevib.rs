//! FREEVIB on decays whose frequency and damping are known as functions of amplitude.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::f64::consts::TAU;

use iwan_ident::signal::{Method, Options, envelope};

const DT: f64 = 1.0 / 4096.0;

#[test]
fn a_linear_mode_has_its_frequency_and_damping() {
    let (omega, zeta) = (TAU * 80.0, 0.01_f64);
    let decay = |n: usize| {
        (-zeta * omega * n as f64 * DT).exp() * (omega * (1.0 - zeta * zeta).sqrt() * n as f64 * DT).cos()
    };
    let x: Vec<f64> = (0..4096).map(decay).collect();
    let found = envelope(&x, DT, Method::FreeVibration, &Options::default()).unwrap();
    let at = found.at(0.5).unwrap();
    assert!((at.damping_ratio / zeta - 1.0).abs() < 2e-3, "{at:?}");
    assert!((at.frequency / (80.0 * (1.0 - zeta * zeta).sqrt()) - 1.0).abs() < 1e-5, "{at:?}");
}

/// A hardening spring, x'' + 2 h x' + k x + c x³ = 0. Its backbone is ω²(A) = k + ¾ c A². The slope of ln A alone does not give h, because
/// the frequency falls with the amplitude.
#[test]
fn a_hardening_spring_has_its_backbone_and_a_constant_damping_coefficient() {
    let (k, c, h) = ((TAU * 40.0).powi(2), 0.4 * (TAU * 40.0).powi(2), 4.0);
    let acceleration = |x: f64, v: f64| -2.0 * h * v - k * x - c * x * x * x;
    let (mut x, mut v, mut record) = (1.0, 0.0, Vec::new());
    let step = DT / 4.0;
    for n in 0..4 * 4096 {
        if n % 4 == 0 {
            record.push(x);
        }
        // Runge-Kutta of fourth order.
        let (a1, b1) = (v, acceleration(x, v));
        let (a2, b2) = (v + 0.5 * step * b1, acceleration(x + 0.5 * step * a1, v + 0.5 * step * b1));
        let (a3, b3) = (v + 0.5 * step * b2, acceleration(x + 0.5 * step * a2, v + 0.5 * step * b2));
        let (a4, b4) = (v + step * b3, acceleration(x + step * a3, v + step * b3));
        x += step * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0;
        v += step * (b1 + 2.0 * b2 + 2.0 * b3 + b4) / 6.0;
    }
    let options = Options { band: Some((15.0, 110.0)), ..Options::default() };
    let found = envelope(&record, DT, Method::FreeVibration, &options).unwrap();
    let plain = envelope(&record, DT, Method::Demodulation, &options).unwrap();
    let coefficient = |e: &iwan_ident::signal::Envelope, t: f64| {
        let at = e.at(t).unwrap();
        (at.damping_ratio * TAU * at.frequency, at.frequency, at.amplitude)
    };
    // Reference by SciPy (tests/peers/decays.py): Feldman's equations on the solution by DOP853; time, natural frequency, damping
    // coefficient.
    for (t, natural, other) in [(0.2, 41.30978, 4.0036), (0.3, 40.60306, 3.9995)] {
        let (damping, frequency, _) = coefficient(&found, t);
        assert!(
            (frequency / natural - 1.0).abs() < 2e-3 && (damping / other - 1.0).abs() < 0.02,
            "{frequency} {damping}"
        );
    }
    let first = found.trusted.0.max(plain.trusted.0);
    for t in [first + 0.01, first + 0.03, first + 0.05] {
        let (damping, frequency, amplitude) = coefficient(&found, t);
        let backbone = (k + 0.75 * c * amplitude * amplitude).sqrt() / TAU;
        assert!((frequency / backbone - 1.0).abs() < 5e-3, "{t}: {frequency} {backbone}");
        // To first order in c A²/k, Feldman's coefficient is h (1 + c A²/8k), and the slope of ln A gives h (1 - c A²/4k).
        let ratio = c * amplitude * amplitude / k;
        assert!((damping / h - 1.0 - ratio / 8.0).abs() < 0.02, "{t}: {damping} {h} {amplitude}");
        assert!(coefficient(&plain, t).0 < damping, "{t}");
    }
}
