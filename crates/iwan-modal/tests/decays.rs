//! Free decays without a force, and from when on they are linear.
#![allow(clippy::unwrap_used, reason = "tests may panic")]

use std::f64::consts::TAU;

use iwan_modal::measure::{Channel, Freedom, Motion};
use iwan_modal::modes::Scale;
use iwan_modal::poles::subspace;
use iwan_modal::responses::free_responses;
use iwan_modal::{Analysis, modal_fit, zeroed};

const DT: f64 = 1.0 / 2048.0;

/// Frequency in Hz, damping ratio.
const MODES: [(f64, f64); 3] = [(60.0, 2e-3), (63.0, 4e-3), (151.0, 1e-2)];

fn decay(amplitudes: [f64; 3], noise: u64) -> Vec<f64> {
    let mut state = noise;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let value = |n: usize| {
        let mode = |((f, z), a): (&(f64, f64), f64)| {
            let (w, t) = (TAU * f, n as f64 * DT);
            a * (-z * w * t).exp() * (w * (1.0 - z * z).sqrt() * t + a).cos()
        };
        MODES.iter().zip(amplitudes).map(mode).sum::<f64>()
    };
    (0..4096).map(|n| value(n) + if noise == 0 { 0.0 } else { 3e-3 * random() }).collect()
}

fn channel(name: &str, samples: Vec<f64>) -> Channel {
    Channel { name: name.into(), freedom: Freedom::point(name), samples }
}

#[test]
fn modes_of_decays_are_found_without_a_force() {
    let shapes = [[1.0, 0.7, 0.5], [0.4, -0.8, 0.6], [-0.5, 0.9, 0.3], [0.8, 0.3, -0.4]];
    let decays: Vec<Channel> =
        shapes.iter().enumerate().map(|(n, s)| channel(&format!("a{n}"), decay(*s, n as u64 + 1))).collect();
    let responses = free_responses(&[decays], DT, Motion::Acceleration).unwrap();
    let fit = modal_fit(&responses, Some((20.0, 300.0)), &Analysis::Chart, 30).unwrap();
    assert_eq!((fit.modes.len(), fit.scale), (3, Scale::LargestIsOne));
    for (mode, (f, z)) in fit.modes.iter().zip(MODES) {
        assert!((mode.frequency / f - 1.0).abs() < 2e-5, "{} {f}", mode.frequency);
        assert!((mode.damping_ratio / z - 1.0).abs() < 5e-3, "{} {z}", mode.damping_ratio);
        assert!((mode.frequency - f).abs() < 4.0 * mode.frequency_sd);
    }
}

#[test]
fn decays_that_do_not_fit_together_are_named() {
    let (long, short) = (channel("a", vec![0.0; 200]), channel("b", vec![0.0; 100]));
    let refused =
        |decays: &[Vec<Channel>]| free_responses(decays, DT, Motion::Velocity).unwrap_err().to_string();
    assert!(refused(&[vec![long.clone()], vec![short]]).contains("decay 2, channel b"));
    assert!(refused(&[]).contains("0 samples"));
    let mut bad = long;
    bad.samples[7] = f64::NAN;
    assert!(refused(&[vec![bad]]).contains("sample 7"));
}

/// A mode whose frequency falls with its amplitude until 0.4 s and stays then: linear from there on, in amplitude exp(-0.4 ζω).
#[test]
fn zeroed_spectra_say_from_when_on_a_decay_is_linear() {
    let (omega, zeta, until) = (TAU * 80.0, 4e-3, 0.4);
    let phase = |t: f64| omega * t + if t < until { 9.0 * (1.0 - t / until).powi(2) } else { 0.0 };
    let x: Vec<f64> = (0..4096_usize)
        .map(|n| {
            let t = n as f64 * DT;
            (-zeta * omega * t).exp() * phase(t).cos()
        })
        .collect();
    let found = zeroed(&x, DT, (40.0, 160.0)).unwrap();
    assert_eq!(found.modes.len(), 1);
    let (time, amplitude) = (found.modes[0].time.unwrap(), found.modes[0].amplitude.unwrap());
    assert!((0.2..0.45).contains(&time), "{time}");
    assert!((amplitude / (-zeta * omega * time).exp() - 1.0).abs() < 0.01, "{amplitude}");
    assert!(found.modes[0].misfit[0] > 0.2, "{:?}", found.modes[0].misfit);
    let linear: Vec<f64> = (0..4096_usize)
        .map(|n| (-zeta * omega * n as f64 * DT).exp() * (omega * n as f64 * DT).cos())
        .collect();
    assert_eq!(zeroed(&linear, DT, (40.0, 160.0)).unwrap().modes[0].time, Some(0.0));
}

#[test]
fn subspaces_find_the_modes_of_decays_and_end_in_the_same_fit() {
    let shapes = [[1.0, 0.7, 0.5], [0.4, -0.8, 0.6], [-0.5, 0.9, 0.3], [0.8, 0.3, -0.4]];
    let decays: Vec<Channel> =
        shapes.iter().enumerate().map(|(n, s)| channel(&format!("a{n}"), decay(*s, n as u64 + 1))).collect();
    let chart = subspace(std::slice::from_ref(&decays), DT, (20.0, 300.0), 24).unwrap();
    let first: Vec<_> = chart.candidates.iter().map(|c| c.pole).collect();
    for (f, z) in MODES {
        let near = |p: &&iwan_modal::Complex<f64>| (p.norm() / TAU / f - 1.0).abs() < 1e-3;
        let pole = first.iter().find(near).unwrap_or_else(|| panic!("{f} Hz is not in {first:?}"));
        assert!((-pole.re / pole.norm() / z - 1.0).abs() < 0.1, "{pole}");
    }
    let responses = free_responses(&[decays], DT, Motion::Acceleration).unwrap();
    let fit = |way: &Analysis| modal_fit(&responses, Some((20.0, 300.0)), way, 30).unwrap();
    let (own, other) = (fit(&Analysis::From(first)), fit(&Analysis::Chart));
    assert_eq!(own.modes.len(), 3);
    for (a, b) in own.modes.iter().zip(&other.modes) {
        assert!((a.pole - b.pole).norm() < 1e-5 * a.pole.re.abs(), "{} {}", a.pole, b.pole);
    }
    let refused = |order, band| {
        subspace(&[vec![channel("a", decay(shapes[0], 1))]], DT, band, order).unwrap_err().to_string()
    };
    assert!(refused(400, (20.0, 300.0)).contains("order = 400"));
    assert!(refused(24, (20.0, 3000.0)).contains("upper edge of the band = 3000"));
}

/// Two decays of one structure, thinned by the low-pass: the poles are those of the decays, not of the filter.
#[test]
fn thinning_decays_leaves_their_poles_where_they_are() {
    let decays: Vec<Vec<Channel>> = [[1.0, 0.5, 0.2], [0.2, -1.0, 0.4]]
        .iter()
        .map(|a| vec![channel("a", decay(*a, 0)), channel("b", decay([a[1], a[0], -a[2]], 0))])
        .collect();
    let chart = subspace(&decays, DT, (20.0, 90.0), 12).unwrap();
    assert_eq!(chart.candidates.len(), 2, "{:?}", chart.candidates);
    for (c, (f, z)) in chart.candidates.iter().zip(MODES) {
        assert!(
            (c.pole.norm() / TAU / f - 1.0).abs() < 1e-6
                && (-c.pole.re / c.pole.norm() / z - 1.0).abs() < 1e-3,
            "{c:?}"
        );
    }
}

/// The numbers are those of NumPy and SciPy (`tests/peers/decays.py`): spectra by an FFT of the zeroed record, the late model by least squares in time.
#[test]
fn zeroed_spectra_and_distances_are_those_of_scipy() {
    let (omega, zeta, until) = (TAU * 80.0, 4e-3, 0.4);
    let phase = |t: f64| omega * t + if t < until { 9.0 * (1.0 - t / until).powi(2) } else { 0.0 };
    let value = |t: f64| (-zeta * omega * t).exp() * phase(t).cos();
    let x: Vec<f64> = (0..4096).map(|n| value(f64::from(n) * DT)).collect();
    let found = zeroed(&x, DT, (40.0, 160.0)).unwrap();
    let mode = &found.modes[0];
    assert!(
        (mode.pole.re + 2.010_619).abs() < 1e-5 && (mode.pole.im - 502.654_825).abs() < 1e-5,
        "{}",
        mode.pole
    );
    let expected = [
        (0, 0.0, 1.336147973e-1, 1.446815),
        (3, 0.099609, 1.166891173e-1, 1.102449),
        (6, 0.199707, 1.410602701e-1, 5.032219e-1),
        (12, 0.399902, 1.069448314e-1, 0.0),
    ];
    for (k, time, line, distance) in expected {
        let spectrum = &found.spectra[k];
        let largest = spectrum.magnitude.iter().copied().fold(0.0, f64::max);
        assert!((spectrum.time - time).abs() < 1e-6 && (largest / line - 1.0).abs() < 1e-8, "{k}: {largest}");
        assert!((mode.misfit[k] - distance).abs() < 1e-5, "{k}: {} {distance}", mode.misfit[k]);
    }
}

/// A mode whose damping falls all the time is still one mode.
#[test]
fn a_peak_that_is_not_linear_is_one_mode() {
    let omega = TAU * 80.0;
    // The decay rate falls from 6 to 1 per second.
    let x: Vec<f64> = (0..8192)
        .map(|n| {
            let t = f64::from(n) * DT;
            (-t - 5.0 * (1.0 - (-t).exp())).exp() * (omega * t - 3.0 * (-t).exp()).cos()
        })
        .collect();
    let found = zeroed(&x, DT, (40.0, 160.0)).unwrap();
    assert_eq!(found.modes.len(), 1, "{:?}", found.modes.iter().map(|m| m.pole).collect::<Vec<_>>());
    assert!(found.modes[0].misfit[0] > 0.1, "{:?}", found.modes[0].misfit);
}
