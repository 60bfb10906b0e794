//! From records to intervals: which parameters a record determines, and which intervals stay open.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a failed test may panic and say why")]

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use iwan_core::{Backbone, Continuum, Hysteresis, Newmark, Reversal, Samples};
use iwan_ident::curves::Quantity;
use iwan_ident::identify::{
    Held, Identification, ModeRecord, Settings, identify, identify_isolated, identify_until,
};
use iwan_ident::refine::{Discrepancy, RingDown, refine};
use iwan_ident::signal::isolate;
use iwan_ident::{Error, Grade, Parameter, Parameters};

use crate::law_records::in_noise::{MadeRecord, in_noise};
use crate::law_records::sliders::{README, STEP, blow};
use crate::law_records::softening::softening;

const MODE_1: Parameters =
    Parameters { frequency: 124.0, damping_ratio: 2.5e-4, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };

/// Acceleration after release at `ratio` φ_max, by 40 time steps of the continuum for each sample: not by the half-cycle map, which the
/// identification itself uses.
fn record(mode: &Parameters, ratio: f64, dt: f64, samples: usize) -> Vec<f64> {
    finely(mode, ratio, dt, samples, 40)
}

/// The same acceleration, with `fraction` steps for each sample.
fn finely(mode: &Parameters, ratio: f64, dt: f64, samples: usize, fraction: usize) -> Vec<f64> {
    let (oscillator, joint) = mode.model().unwrap();
    let law = Continuum::new(&joint);
    let mut memory = law.virgin(vec![Reversal::default(); 8192]).unwrap();
    law.advance(&mut memory, ratio * joint.phi_max());
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; (samples - 1) * fraction + 1]);
    let [displacement, velocity, acceleration, joint_force] = &mut out;
    let scheme = Newmark::prewarped(dt / f64::from(fraction as u32), oscillator.omega0()).unwrap();
    let mut buffers = Samples { displacement, velocity, acceleration, joint_force };
    scheme.integrate(&oscillator, &law, &mut memory, 0.0, &[], &mut buffers).unwrap();
    out[2].iter().copied().step_by(fraction).collect()
}

/// Normally distributed numbers, by the polar method from a linear congruential generator.
struct Noise(u64);

impl Noise {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        loop {
            let (a, b) = (2.0 * self.uniform() - 1.0, 2.0 * self.uniform() - 1.0);
            let s = a * a + b * b;
            if s > 0.0 && s < 1.0 {
                return a * (-2.0 * s.ln() / s).sqrt();
            }
        }
    }
}

/// The record with white noise, `decibels` below its root mean square.
fn noisy(x: &[f64], decibels: f64, seed: u64) -> Vec<f64> {
    let mut noise = Noise(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    (0..8).for_each(|_| _ = noise.uniform());
    let rms = (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
    let sd = rms * 10.0_f64.powf(-decibels / 20.0);
    x.iter().map(|x| x + sd * noise.normal()).collect()
}

fn identified(records: &[Vec<f64>], dt: f64) -> Identification {
    let record = |samples| ModeRecord { samples, dt, quantity: Quantity::Acceleration };
    let records: Vec<_> = records.iter().map(|r| record(r.as_slice())).collect();
    identify(&records, &Settings::default()).unwrap()
}

/// For each parameter, how many intervals were closed, and how many of these held the truth.
struct Coverage {
    covered: [usize; 6],
    closed: [usize; 6],
    missed: [usize; 6],
}

/// Identifies `repetitions` noisy copies of a record, on two threads.
fn coverage(truth: &Parameters, clean: &[f64], dt: f64, decibels: f64, repetitions: u64) -> Coverage {
    let run = |seeds: std::ops::Range<u64>| -> Vec<Identification> {
        seeds.map(|seed| identified(&[noisy(clean, decibels, seed + 1)], dt)).collect()
    };
    let half = repetitions / 2;
    let all: Vec<Identification> = std::thread::scope(|scope| {
        let first = scope.spawn(|| run(0..half));
        let mut second = run(half..repetitions);
        second.extend(first.join().unwrap());
        second
    });
    let mut count = Coverage { covered: [0; 6], closed: [0; 6], missed: [0; 6] };
    for found in &all {
        for (i, p) in found.profiles.parameters.iter().enumerate() {
            let value = truth.get(p.parameter);
            let inside = p.low.is_none_or(|l| l <= value) && p.high.is_none_or(|h| value <= h);
            count.missed[i] += usize::from(!inside);
            if p.identifiable() {
                count.closed[i] += 1;
                count.covered[i] += usize::from(inside);
            }
        }
    }
    eprintln!(
        "{decibels} dB: covered {:?} of {:?} closed, missed {:?}",
        count.covered, count.closed, count.missed
    );
    count
}

#[test]
fn intervals_at_40_decibels_hold_the_truth_as_often_as_they_say() {
    let dt = 1.0 / 5000.0;
    let clean = record(&MODE_1, 1.5, dt, 1500);
    // `scripts/validate` takes two hundred and more.
    let count = coverage(&MODE_1, &clean, dt, 40.0, 24);
    for i in 0..6 {
        // A record through macro-slip determines all six parameters, except for rare noise.
        assert!(count.closed[i] >= 23, "{}: {}", Parameter::ALL[i].name(), count.closed[i]);
        let share = count.covered[i] as f64 / count.closed[i] as f64;
        assert!(share >= 0.83, "{}: {share}", Parameter::ALL[i].name());
    }
}

/// Ring-down of a mode of 124 Hz whose dissipation exceeds the linear one in proportion to the amplitude's power 1.6, and whose frequency falls
/// with the power 1.1: no Iwan joint has both, since its two powers are equal. `scatter` shifts frequency and damping of the hit.
fn another_law(amplitude: f64, dt: f64, samples: usize, scatter: [f64; 2]) -> Vec<f64> {
    let (mut a, mut phase, fraction) = (amplitude, 0.0_f64, 20);
    let h = dt / f64::from(fraction);
    let frequency = |a: f64| 124.0 * (1.0 + scatter[0]) - 0.25 * a.powf(1.1);
    let decay = |a: f64| std::f64::consts::TAU * 124.0 * (1.0 + scatter[1]) * (4e-4 + 6e-4 * a.powf(0.6));
    let sample = |_| {
        let x = a * phase.cos();
        for _ in 0..fraction {
            let middle = a * (1.0 - 0.5 * h * decay(a));
            phase += std::f64::consts::TAU * frequency(middle) * h;
            a *= (-h * decay(middle)).exp();
        }
        x
    };
    (0..samples).map(sample).collect()
}

/// Four hits of a specimen whose frequency varies by 0.3 % from day to day, and its damping by 3 %: by the end of the records phases differ
/// by radians. The parameters found are those of the mean.
#[test]
fn hits_of_other_days_are_told_by_their_mean() {
    let dt = 1.0 / 2000.0;
    let strays: [[f64; 2]; 4] = [[2e-3, -0.02], [-4e-3, 0.03], [4e-3, 0.01], [-2e-3, -0.02]];
    let records: Vec<Vec<f64>> = strays
        .iter()
        .zip([0.5, 0.4, 0.3, 0.2])
        .zip(1..)
        .map(|(([frequency, damping], ratio), seed)| {
            let own = Parameters {
                frequency: MODE_1.frequency * (1.0 + frequency),
                damping_ratio: 1e-3 * (1.0 + damping),
                // Dissipation in micro-slip is proportional to R, and R to K_T over φ_max to the power 1 + χ.
                f_s: MODE_1.f_s * (1.0 + damping).powf(-1.0 / (1.0 + MODE_1.chi)),
                ..MODE_1
            };
            noisy(&record(&own, ratio, dt, 3000), 50.0, seed)
        })
        .collect();
    let found = identified(&records, dt);
    assert!(found.verdict.adequate, "{}", found.verdict.misfit);
    for (parameter, truth) in [
        (Parameter::Frequency, MODE_1.frequency),
        (Parameter::DampingRatio, 1e-3),
        (Parameter::Chi, MODE_1.chi),
    ] {
        let profile = found.profile(parameter);
        let (low, high) = (profile.low.unwrap(), profile.high.unwrap());
        assert!(
            low < profile.value && profile.value < high,
            "{parameter:?}: {} in {low} to {high}",
            profile.value
        );
        assert!(low < truth && truth < high, "{parameter:?}: {low} to {high}");
    }
    // The interval of the mean of four hits with a scatter of 0.37 % is ± 0.58 % by Student's t.
    let frequency = found.profile(Parameter::Frequency);
    let width = (frequency.high.unwrap() - frequency.low.unwrap()) / MODE_1.frequency;
    assert!((0.006..0.02).contains(&width), "{width}");
    // Differences between days are those with which the hits were made, except for the softening that goes with their dissipation.
    for (start, [stray, _]) in found.refined.starts.iter().zip(&strays) {
        let apart = start.day - found.refined.starts[0].day;
        assert!((apart - (stray - strays[0][0])).abs() < 5e-4, "{apart}");
    }
    assert!(found.in_words().iter().any(|w| w.contains("a day of its own")), "{:?}", found.in_words());
}

/// Two modes 5 % apart were once taken for one mode whose frequency differs between days, and called "usable".
#[test]
fn records_of_two_modes_are_refused_whichever_is_given_first() {
    let dt = 1.0 / 2000.0;
    for other in [118.0, 130.0, 140.0, 186.0] {
        let second = Parameters { frequency: other, ..MODE_1 };
        let records = [record(&MODE_1, 0.5, dt, 2000), record(&second, 0.4, dt, 2000)];
        let record = |n: usize| ModeRecord { samples: &records[n], dt, quantity: Quantity::Acceleration };
        for order in [[0, 1], [1, 0]] {
            let refused = identify(&order.map(record), &Settings::default()).unwrap_err().to_string();
            assert!(refused.contains("these are not one mode"), "{other}: {refused}");
        }
    }
}

/// Hits of a law that is no Iwan joint, with the scatter of measured hits (0.003 Hz, 1 %): the intervals of different hits overlap.
#[test]
fn hits_of_another_law_do_not_contradict_each_other() {
    let dt = 1.0 / 2500.0;
    let hits: Vec<Identification> = [(1.0, 0.0, 0.0), (1.3, -2.4e-5, -0.01), (0.6, 2.4e-5, 0.01)]
        .iter()
        .zip(1..)
        .map(|((a, f, d), seed)| identified(&[noisy(&another_law(*a, dt, 4000, [*f, *d]), 60.0, seed)], dt))
        .collect();
    for found in &hits {
        assert!(found.refined.discrepancy.dissipation > 0.0, "{:?}", found.refined.discrepancy);
        assert!(
            found.in_words().iter().any(|w| w.contains("the law itself misses")),
            "{:?}",
            found.in_words()
        );
        for p in &found.profiles.parameters {
            assert!(p.low.is_none_or(|l| l <= p.value) && p.high.is_none_or(|h| p.value <= h), "{p:?}");
        }
    }
    let apart = |a: Option<f64>, b: Option<f64>| a.zip(b).is_some_and(|(low, high)| low > high);
    let (mut pairs, mut together) = (0, 0);
    for (i, one) in hits.iter().enumerate() {
        for other in &hits[..i] {
            for (p, q) in one.profiles.parameters.iter().zip(&other.profiles.parameters) {
                pairs += 1;
                together += usize::from(!apart(p.low, q.high) && !apart(q.low, p.high));
            }
        }
    }
    // Sixty of sixty-six pairs must overlap, as required of measured hits: these hits cover different amplitudes of a law whose powers no Iwan joint has.
    assert!(66 * together >= 60 * pairs, "{together} of {pairs}");
}

#[test]
fn noise_at_20_decibels_brings_no_wrong_certainty() {
    let dt = 1.0 / 5000.0;
    for ratio in [0.3, 1.5] {
        let clean = record(&MODE_1, ratio, dt, 1500);
        let count = coverage(&MODE_1, &clean, dt, 20.0, 4);
        // With 95 % intervals, three misses in four happen once in 2,000 tries.
        assert!(count.missed.iter().all(|m| *m <= 2), "{ratio}: {:?}", count.missed);
    }
}

/// Where an interval ends at one knee (value of φ_max), another knee may accept values beyond. Walks along a parameter that kept their knee
/// once put the lower end of the first joint's damping ratio at 2.4 times the truth, that of the second at 1.2 times, and that of the third
/// joint's frequency above the truth.
#[test]
fn what_another_knee_accepts_lies_inside_the_interval() {
    for seed in [10, 29, 38] {
        let MadeRecord { truth, dt, samples } = in_noise(seed, 20.0).unwrap();
        let found = identified(&[samples], dt);
        assert!(found.profile(Parameter::DampingRatio).identifiable(), "{seed}");
        for parameter in Parameter::ALL {
            holds(&found, &truth, parameter);
        }
    }
}

/// Decays through macro-slip that are at rest before the record is half over. The joint's own law was once graded `no`, with all intervals
/// open, because the curves' tails in noise missed 25 to 60 % of dissipation, and because the record's filter, but not the model's, included
/// the samples before the release.
#[test]
fn fast_decays_into_noise_are_matched() {
    let soft =
        Parameters { frequency: 80.0, damping_ratio: 1e-3, k_t: 9e4, f_s: 150.0, chi: -0.6, beta: 0.0 };
    let damped = Parameters { damping_ratio: 0.03, ..MODE_1 };
    for (truth, start, seconds, decibels) in
        [(soft, 5.0, 1.5, 50.0), (MODE_1, 6.0, 1.0, 35.0), (damped, 1.5, 0.5, 45.0)]
    {
        let dt = 1.0 / 4000.0;
        let samples = (seconds / dt) as usize;
        let decay = noisy(&finely(&truth, start, dt, samples, 20), decibels, 7);
        // Noise before the release, as a recorder with a trigger keeps it.
        let mut noise = Noise(3);
        let mut hit: Vec<f64> = (0..80).map(|_| 1e-4 * decay[0].abs() * noise.normal()).collect();
        hit.extend_from_slice(&decay);
        let found = identified(&[hit], dt);
        assert!(found.verdict.adequate, "{truth:?}: {}", found.verdict.misfit);
        let chi = found.profile(Parameter::Chi);
        assert!(chi.low.is_some() && chi.high.is_some(), "{truth:?}");
        for parameter in Parameter::ALL {
            holds(&found, &truth, parameter);
        }
    }
}

#[test]
fn micro_slip_tells_the_power_and_the_level_and_leaves_the_rest_open() {
    let dt = 1.0 / 5000.0;
    let found = identified(&[record(&MODE_1, 0.3, dt, 2500)], dt);
    assert!(found.verdict.adequate, "{}", found.verdict.misfit);
    assert!((found.parameters.chi / MODE_1.chi - 1.0).abs() < 0.02, "{:?}", found.parameters);
    let (truth, joint) = (MODE_1.model().unwrap().1, found.parameters.model().unwrap().1);
    for ratio in [0.03, 0.1, 0.25] {
        let u = ratio * truth.phi_max();
        assert!((joint.dissipation(u) / truth.dissipation(u) - 1.0).abs() < 0.02, "{ratio}");
    }
    let [k_t, f_s, beta] = [Parameter::KT, Parameter::FS, Parameter::Beta].map(|p| found.profile(p));
    assert!(!k_t.identifiable() && !f_s.identifiable() && !beta.identifiable());
    assert!(k_t.high.is_none() && f_s.high.is_none() && beta.low.is_none() && beta.high.is_none());
    // What is said to be too little is too little.
    assert!(k_t.low.is_some_and(|low| low < MODE_1.k_t) && f_s.low.is_some_and(|low| low < MODE_1.f_s));
    assert!(found.in_words().iter().any(|w| w.contains("f_s") && w.contains("no upper bound")));
}

/// Where K_T and F_S are given, the knee φ_max follows from them, and no search may move it.
#[test]
fn given_parameters_keep_their_values() {
    let dt = 1.0 / 5000.0;
    let samples = record(&MODE_1, 1.5, dt, 1500);
    let mode = ModeRecord { samples: &samples, dt, quantity: Quantity::Acceleration };
    for names in [&[Parameter::KT][..], &[Parameter::FS], &[Parameter::KT, Parameter::FS], &[Parameter::Beta]]
    {
        let held = names.iter().map(|p| Held { parameter: *p, value: MODE_1.get(*p) }).collect();
        let found = identify(&[mode], &Settings { held, ..Settings::default() }).unwrap();
        for p in names {
            let error = found.parameters.get(*p) / MODE_1.get(*p) - 1.0;
            assert!(error.abs() < 1e-12, "{names:?}: {} is off by {error:e}", p.name());
            assert!(found.profile(*p).held);
        }
        let chi = found.parameters.chi;
        assert!((chi / MODE_1.chi - 1.0).abs() < 0.01, "{names:?}: chi {chi}");
    }
}

#[test]
fn two_force_levels_are_one_structure() {
    let dt = 1.0 / 5000.0;
    let records =
        [noisy(&record(&MODE_1, 0.3, dt, 1200), 40.0, 5), noisy(&record(&MODE_1, 1.5, dt, 1200), 40.0, 6)];
    let found = identified(&records, dt);
    assert!(found.verdict.adequate, "{}", found.verdict.misfit);
    for p in Parameter::ALL {
        let profile = found.profile(p);
        assert!(profile.identifiable(), "{}", p.name());
        let (low, high) = (profile.low.unwrap(), profile.high.unwrap());
        let slack = 0.5 * (high - low);
        assert!((low - slack..=high + slack).contains(&MODE_1.get(p)), "{}: {low} {high}", p.name());
    }
    assert_eq!(found.curves.len(), 2);
}

#[test]
fn a_linear_mode_needs_no_joint() {
    let (omega, zeta, dt) = (std::f64::consts::TAU * 124.0, 0.004, 1.0 / 5000.0);
    let clean: Vec<f64> = (0..2500)
        .map(|n| f64::from(n) * dt)
        .map(|t| (-zeta * omega * t).exp() * (omega * (1.0 - zeta * zeta).sqrt() * t).cos())
        .collect();
    let found = identified(&[noisy(&clean, 40.0, 11)], dt);
    assert!(found.linear.is_enough(), "{:?}", found.linear);
    assert!((found.linear.frequency - 124.0).abs() < 0.01);
    assert!((found.linear.damping_ratio / zeta - 1.0).abs() < 0.02);
    assert!(found.verdict.adequate, "{}", found.verdict.misfit);
    assert!(found.in_words().iter().any(|w| w.contains("joint is not needed")));
}

/// A mode that was isolated before gives the bits of one that the identification isolates itself; one of another record is refused.
#[test]
fn modes_isolated_before_give_the_same_bits() {
    let samples = noisy(&record(&MODE_1, 0.4, 2e-4, 2500), 50.0, 3);
    let own = ModeRecord { samples: &samples, dt: 2e-4, quantity: Quantity::Acceleration };
    let settings = Settings::default();
    let isolated = isolate(&samples, 2e-4, &settings.options).unwrap();
    let before = identify_isolated(&[(own, &isolated)], &settings, None).unwrap();
    let itself = identify(&[own], &settings).unwrap();
    assert_eq!(before.parameters, itself.parameters);
    assert_eq!(before.profiles, itself.profiles);
    assert_eq!(before.verdict, itself.verdict);
    let shorter = ModeRecord { samples: &samples[..2000], ..own };
    let slower = ModeRecord { dt: 4e-4, ..own };
    for other in [shorter, slower] {
        let refused = identify_isolated(&[(other, &isolated)], &settings, None).unwrap_err().to_string();
        assert!(refused.contains("isolated from another record"), "{refused}");
    }
}

/// An identification that is stopped before it begins, or while it works, ends without a result.
#[test]
fn an_identification_can_be_stopped() {
    let records: Vec<Vec<f64>> = (0..8).map(|i| record(&MODE_1, 0.3 * 1.4_f64.powi(i), 2e-4, 2500)).collect();
    let records: Vec<_> = records
        .iter()
        .map(|samples| ModeRecord { samples, dt: 2e-4, quantity: Quantity::Acceleration })
        .collect();
    for milliseconds in [0, 30] {
        let stopped = Arc::new(AtomicBool::new(milliseconds == 0));
        std::thread::scope(|scope| {
            let worker = scope.spawn(|| identify_until(&records, &Settings::default(), &stopped));
            std::thread::sleep(std::time::Duration::from_millis(milliseconds));
            stopped.store(true, Ordering::Relaxed);
            assert!(matches!(worker.join().unwrap(), Err(Error::Stopped)), "{milliseconds}");
        });
    }
}

#[test]
fn two_and_a_half_samples_a_cycle_are_enough() {
    for (per_cycle, seed) in [(2.9, 0), (2.56, 0), (2.56, 7)] {
        let dt = 1.0 / (124.0 * per_cycle);
        // With a quarter of these steps the error of the record itself would exceed the width of its intervals, 1e-5.
        let clean = finely(&MODE_1, 0.43, dt, (1.5 / dt) as usize, 2560);
        let found = identified(&[if seed == 0 { clean } else { noisy(&clean, 50.0, seed) }], dt);
        for p in &found.profiles.parameters {
            let (truth, (low, high)) = (MODE_1.get(p.parameter), (p.low, p.high));
            // Since these are single records, a closed end may miss the truth by a tenth of the interval.
            let slack = low.zip(high).map_or(0.0, |(low, high)| 0.1 * (high - low));
            let inside = low.is_none_or(|l| l <= truth + slack) && high.is_none_or(|h| truth <= h + slack);
            assert!(inside, "{per_cycle}, {seed}: {:?} [{low:?}, {high:?}]", p.parameter);
        }
        let told = |n: usize| found.profiles.parameters[n].identifiable();
        assert!(told(0) && told(4), "{per_cycle}, {seed}: {:?}", found.profiles.parameters);
        // Close to half the sampling rate the curves that the verdict compares lose accuracy: 4 % of damping at 2.56 samples a cycle.
        let misfit = found.verdict.dissipation_misfit;
        assert!(misfit < if per_cycle < 2.6 { 0.06 } else { 0.01 }, "{per_cycle}, {seed}: {misfit}");
    }
    let dt = 1.0 / (124.0 * 2.3);
    let x = record(&MODE_1, 0.43, dt, 600);
    let record = ModeRecord { samples: &x, dt, quantity: Quantity::Acceleration };
    let error = identify(&[record], &Settings::default()).unwrap_err().to_string();
    assert!(error.contains("samples per cycle = 2.3") && error.contains("at least 2.5"), "{error}");
}

/// Tables of half cycles have errors, once of 4e-5 where macro-slip ends: without noise this put K_T off by 1e-3, with an interval of 2.5e-4
/// (record 12). Where the joint slips as a whole in the first half cycle only, two knees reproduce all windows to the last digit: K_T was
/// once off by 4 %, with an interval of 0.3 % (149).
#[test]
fn records_without_noise_through_macro_slip_close_no_wrong_interval() {
    // Numbers of the softening records that `scripts/validate` draws.
    for number in [12, 22, 149] {
        let MadeRecord { truth, dt, samples } = softening(number).unwrap();
        let found = identified(&[samples], dt);
        for parameter in Parameter::ALL {
            let (profile, value) = (found.profile(parameter), truth.get(parameter));
            // In 149 the windows alone do not distinguish two knees.
            let is_told = number == 149 || profile.low.is_some() && profile.high.is_some();
            assert!(is_told, "{number}: {parameter:?} is open");
            holds(&found, &truth, parameter);
            let off = (found.parameters.get(parameter) / value - 1.0).abs();
            // The first samples of number 149, ten a cycle, determine its knee only to half a per cent; the intervals are open.
            assert!(off < if number == 149 { 5e-3 } else { 1e-4 }, "{number}: {parameter:?} is off by {off}");
        }
    }
}

/// Laws are compared on curves, which are not exact to the last digits. Records that the joint reproduces to 1e-13 were once said to speak
/// against it and for quadratic damping beside it: *usable*, and the frequency's interval a fifth of a per cent wide.
#[test]
fn curves_do_not_speak_against_a_joint_that_misses_nothing() {
    for number in [23, 30] {
        let MadeRecord { truth, dt, samples } = softening(number).unwrap();
        let found = identified(&[samples], dt);
        assert_eq!(found.verdict.grade, Grade::Matches, "{number}: {}", found.verdict.misfit);
        assert!(found.as_likely.is_empty() && found.refined.discrepancy == Discrepancy::default());
        assert_eq!(found.laws.as_ref().unwrap().chosen().law.name, "iwan");
        for (parameter, within) in
            [(Parameter::Frequency, 2e-6), (Parameter::DampingRatio, 1e-3), (Parameter::Chi, 1e-4)]
        {
            holds(&found, &truth, parameter);
            let profile = found.profile(parameter);
            let width = profile.high.unwrap() - profile.low.unwrap();
            assert!(width < within * truth.get(parameter).abs(), "{number}: {parameter:?} {width}");
        }
        assert!(found.profile(Parameter::KT).low.is_some_and(|low| low < truth.k_t && low > 0.9 * truth.k_t));
    }
}

/// Asserts that no closed end of an interval excludes the truth.
fn holds(found: &Identification, truth: &Parameters, parameter: Parameter) {
    let (profile, value) = (found.profile(parameter), truth.get(parameter));
    let inside = profile.low.is_none_or(|low| low <= value) && profile.high.is_none_or(|high| value <= high);
    assert!(inside, "{parameter:?}: {value} in {:?} to {:?}", profile.low, profile.high);
}

/// A joint of few sliders is not the law of the fit, and its record shows no noise. One slider that began to slip was once taken for the onset
/// of macro-slip (F_S 8.4 instead of 239), and intervals of a thousandth missed β by a tenth.
#[test]
fn sliders_in_place_of_the_continuum_exclude_no_truth() {
    for (sliders, amplitude, seconds) in
        [(20, 100.0, 0.5), (20, 1000.0, 0.5), (20, 3000.0, 0.2), (100, 1000.0, 0.5)]
    {
        let found = identified(&[blow(sliders, amplitude, seconds).unwrap()], STEP);
        for parameter in Parameter::ALL {
            holds(&found, &README, parameter);
            let profile = found.profile(parameter);
            let own = found.parameters.get(parameter);
            assert!(profile.low.is_none_or(|low| low <= own) && profile.high.is_none_or(|high| own <= high));
        }
        // The frequency is determined all the same, except where few sliders have begun to slip, or the whole joint slips in every cycle.
        let told = found.profile(Parameter::Frequency).identifiable();
        assert!(told || !(500.0..2000.0).contains(&amplitude), "{sliders} {amplitude} {seconds}");
    }
}

/// A tone of a shaker that falls by half a per cent in four seconds: the linear law, an Iwan joint and every other law fit it, so that the
/// record cannot decide between them.
#[test]
fn a_tone_that_hardly_falls_is_refused() {
    let dt = 1e-3;
    let tone = |n: u32| (1.0 - 0.005 * f64::from(n) / 4000.0) * (345.0 * f64::from(n) * dt).sin();
    let clean: Vec<f64> = (0..4000).map(tone).collect();
    for samples in [&clean, &noisy(&clean, 50.0, 5)] {
        let record = ModeRecord { samples, dt, quantity: Quantity::Acceleration };
        let refused = identify(&[record], &Settings::default()).unwrap_err().to_string();
        assert!(refused.contains("the amplitude changes by 0.") && refused.contains("driven"), "{refused}");
    }
}

/// A record of three cycles has no windows: beside a long one it made a panic.
#[test]
fn a_record_too_short_for_its_unknowns_is_refused_beside_a_long_one() {
    let (dt, quantity) = (8e-4, Quantity::Acceleration);
    let long = record(&MODE_1, 0.3, dt, 1200);
    let ring_down = |samples| RingDown { samples, dt, quantity, band: None, beside: None };
    let refused = refine(&[ring_down(&long), ring_down(&long[..33])], &MODE_1, &[]).unwrap_err().to_string();
    assert!(refused.contains("independent amplitudes of a record: 0 found, at least 4 needed"), "{refused}");
}
