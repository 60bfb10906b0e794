//! What the guide states in numbers: accuracy at three levels of force, random systems, calibration.
#![allow(clippy::expect_used, reason = "tests may panic")]

use crate::support;
use crate::support::{Bench, TrueMode, ten_modes};
use iwan_core::SplitMix64;
use iwan_modal::measure::{Channel, Freedom, Hit, Motion, levels};
use iwan_modal::modes::{Scale, mac};
use iwan_modal::responses::{Estimator, Windows, frequency_responses};
use iwan_modal::{Analysis, Complex, ModalFit, modal_fit};

fn found(hits: &[Hit], band: (f64, f64)) -> ModalFit {
    let responses = frequency_responses(hits, Motion::Acceleration, Estimator::H1, Windows::default())
        .expect("hits belong together");
    modal_fit(&responses, Some(band), &Analysis::Chart, 60).expect("modes")
}

/// 54 points, three levels of five hits, noise of 40 dB, calibrations spread by 1 %.
#[test]
fn ten_modes_at_three_levels_of_force_keep_within_what_is_stated() {
    let bench = Bench { rate: 4096.0, samples: 8192, ..Bench::new(ten_modes()) };
    let hits: Vec<Hit> = [40.0, 120.0, 360.0]
        .iter()
        .enumerate()
        .flat_map(|(n, force)| bench.hits(*force, 5, 40 + n as u64))
        .collect();
    let peaks: Vec<f64> = hits.iter().map(Hit::peak_force).collect();
    let sorted = levels(&peaks);
    assert_eq!(sorted.iter().map(Vec::len).collect::<Vec<_>>(), [5, 5, 5]);
    for members in sorted {
        let own: Vec<Hit> = members.iter().map(|i| hits[*i].clone()).collect();
        let fit = found(&own, (60.0, 1100.0));
        assert_eq!((fit.modes.len(), fit.scale), (10, Scale::DrivePoint));
        for (mode, truth) in fit.modes.iter().zip(&bench.modes) {
            let shape: Vec<Complex<f64>> = bench.shape(truth).iter().map(|x| Complex::new(*x, 0.0)).collect();
            let off = [
                mode.frequency / truth.frequency - 1.0,
                mode.damping_ratio / truth.damping_ratio - 1.0,
                1.0 - mac(&mode.shape, &shape),
                mode.real_shape[0].abs() / shape[0].re.abs() - 1.0,
            ];
            let allowed = [2e-4, 3e-2, 1e-3, 1e-2];
            assert!(
                off.iter().zip(allowed).all(|(x, most)| x.abs() < most),
                "{} Hz: {off:?}",
                truth.frequency
            );
        }
    }
}

/// Four to ten modes between 100 and 950 Hz, 0.01 % to 1 % of damping, 1.5 half-power bandwidths apart or more.
fn random_modes(random: &mut SplitMix64) -> Vec<TrueMode> {
    let mut unit = || 0.5 * (random.next_symmetric() + 1.0);
    let count = 4 + (7.0 * unit()) as usize;
    let mut modes: Vec<TrueMode> = Vec::new();
    while modes.len() < count {
        let one = TrueMode {
            frequency: 100.0 + 850.0 * unit(),
            damping_ratio: 10f64.powf(-4.0 + 2.0 * unit()),
            half_waves: (1 + modes.len()) as f64,
            twists: unit() < 0.5,
        };
        let apart = |other: &TrueMode| {
            let widths = [one, *other].map(|m| 2.0 * m.damping_ratio * m.frequency);
            (one.frequency - other.frequency).abs() > 1.5 * widths[0].max(widths[1])
        };
        if modes.iter().all(apart) {
            modes.push(one);
        }
    }
    modes.sort_by(|a, b| a.frequency.total_cmp(&b.frequency));
    modes
}

#[test]
fn of_twenty_random_systems_no_mode_is_missed_and_none_invented() {
    let mut random = SplitMix64::new(20);
    for system in 0..20 {
        let modes = random_modes(&mut random);
        let bench = Bench { stations: 6, rate: 4096.0, samples: 8192, ..Bench::new(modes) };
        let fit = found(&bench.hits(100.0, 3, 500 + system), (60.0, 1000.0));
        let listed: Vec<f64> = fit.modes.iter().map(|m| m.frequency).collect();
        let truth: Vec<f64> = bench.modes.iter().map(|m| m.frequency).collect();
        assert_eq!(listed.len(), truth.len(), "system {system}: {listed:?} for {truth:?}");
        assert_eq!(fit.sidebands(), None, "system {system}: {listed:?}");
        for (mode, truth) in fit.modes.iter().zip(&bench.modes) {
            let off = (mode.frequency - truth.frequency).abs();
            let width = 2.0 * truth.damping_ratio * truth.frequency;
            assert!(
                off < 2e-4 * truth.frequency && off < 0.1 * width,
                "system {system}: {} for {}",
                mode.frequency,
                truth.frequency
            );
            assert!((mode.damping_ratio / truth.damping_ratio - 1.0).abs() < 0.1);
        }
    }
}

/// One hammer point sees two modes of one frequency as one; two points tell them apart.
#[test]
fn two_hammer_points_tell_modes_of_one_frequency_apart() {
    let mode = |half_waves, twists| TrueMode { frequency: 301.7, damping_ratio: 3e-3, half_waves, twists };
    let mut pair = vec![ten_modes()[0], mode(1.0, true), mode(3.0, false), ten_modes()[3]];
    // A twentieth of the half-power bandwidth.
    pair[2].frequency += 0.05 * 2.0 * 3e-3 * 301.7;
    let base = Bench { stations: 6, rate: 4096.0, samples: 8192, calibration: 0.0, ..Bench::new(pair) };
    let hits: Vec<Hit> =
        [0, 8].iter().flat_map(|drive| Bench { drive: *drive, ..base.clone() }.hits(100.0, 3, 70)).collect();
    let fit = found(&hits, (60.0, 480.0));
    let listed: Vec<f64> = fit.modes.iter().map(|m| m.frequency).collect();
    assert_eq!(fit.modes.len(), 4, "{listed:?}");
    for (mode, truth) in fit.modes.iter().zip(&base.modes) {
        let shape: Vec<Complex<f64>> = base.shape(truth).iter().map(|x| Complex::new(*x, 0.0)).collect();
        let alike = mac(&mode.shape, &shape);
        assert!(
            alike > 0.999 && (mode.frequency / truth.frequency - 1.0).abs() < 2e-4,
            "{} {alike}",
            mode.frequency
        );
        assert!((mode.real_shape[0].abs() / shape[0].re.abs() - 1.0).abs() < 0.01);
        assert!(mode.reciprocity.is_some_and(|r| r < 0.05), "{:?}", mode.reciprocity);
    }
}

/// An error of the drive point's gain goes into the shape by half; standard deviations with the spread of calibrations hold it.
#[test]
fn calibration_goes_into_shapes_and_into_their_standard_deviations() {
    let modes: Vec<TrueMode> = ten_modes().into_iter().take(3).collect();
    // At 8192 Hz: at four samples a pulse what folds back in the force moves the scale by 0.2 %.
    let bench = Bench { stations: 3, calibration: 0.0, ..Bench::new(modes) };
    let spread = 0.01;
    let mut gains = support::Normal::new(5);
    let (mut inside, mut all) = (0, 0);
    for repeat in 0..12 {
        let mut hits = bench.hits(100.0, 3, 800 + repeat);
        let gains: Vec<f64> = (0..6).map(|_| 1.0 + spread * gains.next()).collect();
        for (channel, gain) in hits.iter_mut().flat_map(|h| h.responses.iter_mut().zip(&gains)) {
            channel.samples.iter_mut().for_each(|x| *x *= gain);
        }
        let fit = found(&hits, (60.0, 380.0));
        let own = fit.modes[0].real_shape[0].abs() / bench.shape(&bench.modes[0])[0].abs() - 1.0;
        // What is not half the gain's error is within four of the standard deviations that noise leaves.
        let noise = fit.modes[0].shape_sd[0] / fit.modes[0].real_shape[0].abs();
        assert!(
            (own - 0.5 * (gains[0] - 1.0)).abs() < 4.0 * noise,
            "{own} for a gain of {}, {noise}",
            gains[0]
        );
        assert!(noise < 0.4 * spread, "noise hides the gains: {noise}");
        let fit = fit.with_calibration(spread).expect("a spread of 1 %");
        for (mode, truth) in fit.modes.iter().zip(&bench.modes) {
            for (i, exact) in bench.shape(truth).iter().enumerate() {
                all += 1;
                inside +=
                    usize::from((mode.real_shape[i].abs() - exact.abs()).abs() < 1.96 * mode.shape_sd[i]);
            }
        }
    }
    // Modes of a repeat share their gains: 72 independent errors, 95 % of them within, give or take 2.5 %.
    let share = inside as f64 / f64::from(all);
    assert!((0.88..=1.0).contains(&share), "{inside} of {all}");
    let refused =
        found(&bench.hits(100.0, 2, 3), (60.0, 380.0)).with_calibration(-0.1).expect_err("negative");
    assert!(refused.to_string().contains("-0.1"), "{refused}");
}

/// A mode of unit mass whose damping falls while it decays: the whole decay shows too small a shape, its begin the true one. The hammer may hit at the begin of the record or late in it,
/// where noise before the blow must not count.
#[test]
fn the_begin_of_a_decay_tells_the_scale_wherever_the_blow_is() {
    let (rate, after, omega, damping) = (2048.0, 8192, std::f64::consts::TAU * 80.0, 2e-3);
    let (motion, estimator) = (Motion::Displacement, Estimator::H1);
    for (blow, after) in [(40_usize, after), (6000, after), (9000, 60), (9001, 301)] {
        let mut normal = support::Normal::new(8);
        let mut channel = |name: &str, size: f64| Channel {
            name: name.into(),
            freedom: Freedom::point(name),
            samples: (0..blow + after)
                .map(|n| {
                    let t = n.saturating_sub(blow) as f64 / rate;
                    let lost = (1.0 + 4.0 * t).powf(-0.15);
                    let decay = size * lost * (-damping * omega * t).exp() * (omega * t).sin() / omega;
                    decay + 2e-3 * size / omega * normal.next()
                })
                .collect(),
        };
        let hit = |n: usize, responses| Hit {
            name: format!("hit {n}"),
            dt: 1.0 / rate,
            force: Channel {
                name: "hammer".into(),
                freedom: Freedom::point("tip"),
                samples: (0..blow + after).map(|n| if n == blow { rate } else { 0.0 }).collect(),
            },
            responses,
        };
        let mut all = || {
            let sizes = [("tip", 1.0), ("root", 0.25), ("a", -0.5), ("b", 0.7), ("c", -0.3)];
            sizes.map(|(name, size)| channel(name, size)).to_vec()
        };
        let hits: Vec<Hit> = (0..3).map(|n| hit(n, all())).collect();
        let whole = frequency_responses(&hits, motion, estimator, Windows::default()).expect("hits");
        let high = if after < 1000 { whole.frequency(whole.lines() - 1) } else { 160.0 };
        let fit = modal_fit(&whole, Some((40.0, high)), &Analysis::Given(vec![80.0]), 20).expect("modes");
        if after < 1000 {
            // What follows the blow is too short to tell another scale; the fit stays, also where its band reaches the highest line.
            let scaled = fit.scaled_at_begin(&hits, motion, estimator, false).expect("hits");
            assert_eq!(scaled.modes[0].stretch, None, "{blow}");
            continue;
        }
        let plain = fit.modes[0].real_shape[0].abs();
        let fit = fit.scaled_at_begin(&hits, motion, estimator, false).expect("hits");
        let [tip, root] = [0, 1].map(|point: usize| fit.modes[0].real_shape[point].abs());
        assert!(plain < 0.98 && fit.modes[0].stretch.is_some(), "{blow}: {plain}");
        let off = [tip - 1.0, root / 0.25 - 1.0];
        assert!(off.iter().all(|off| off.abs() < 6e-3), "{blow}: {plain} {tip} {root}");
    }
}
