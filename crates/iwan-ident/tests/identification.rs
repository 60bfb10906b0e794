//! From records to intervals: what is told, what stays open.
#![allow(clippy::unwrap_used, clippy::print_stderr, reason = "a failed test may panic and say why")]

use iwan_core::{Backbone, Continuum, Hysteresis, Newmark, Reversal, Samples};
use iwan_ident::curves::Quantity;
use iwan_ident::identify::{Identification, Settings, Source, identify};
use iwan_ident::{Parameter, Parameters};

const MODE_1: Parameters =
    Parameters { frequency: 124.0, damping_ratio: 2.5e-4, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };

/// Acceleration after release at `ratio` φ_max: time steps of the continuum, 40 a sample, so that the half-cycle map
/// of the identification is not its own witness.
fn record(mode: &Parameters, ratio: f64, dt: f64, samples: usize) -> Vec<f64> {
    let (oscillator, joint) = mode.model().unwrap();
    let law = Continuum::new(&joint);
    let mut memory = law.virgin(vec![Reversal::default(); 8192]).unwrap();
    law.advance(&mut memory, ratio * joint.phi_max());
    let fraction = 40;
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; (samples - 1) * fraction + 1]);
    let [displacement, velocity, acceleration, joint_force] = &mut out;
    let scheme = Newmark::prewarped(dt / f64::from(fraction as u32), oscillator.omega0()).unwrap();
    let mut buffers = Samples { displacement, velocity, acceleration, joint_force };
    scheme.integrate(&oscillator, &law, &mut memory, 0.0, &[], &mut buffers).unwrap();
    out[2].iter().copied().step_by(fraction).collect()
}

/// Normal deviates by the polar method on a multiplicative congruential generator.
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
    let source = |samples| Source { samples, dt, quantity: Quantity::Acceleration };
    let sources: Vec<_> = records.iter().map(|r| source(r.as_slice())).collect();
    identify(&sources, &Settings::default()).unwrap()
}

fn print(found: &Identification) {
    for p in &found.profiles.parameters {
        eprintln!("{:13} {:.6e} [{:?}, {:?}] {}", p.parameter.name(), p.value, p.low, p.high, p.points.len());
    }
    eprintln!("{:#?} {:?}", found.in_words(), found.linear);
    eprintln!("left {:e} correlation {}", found.refined.relative_residual, found.refined.correlation);
}

/// How often intervals held the truth, of those that were closed, and how often they were closed.
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
    eprintln!("{decibels} dB: covered {:?} of {:?} closed, missed {:?}", count.covered, count.closed, count.missed);
    count
}

#[test]
fn try_it() {
    let dt = 1.0 / 5000.0;
    for (ratio, level) in [(1.5, 20.0), (0.3, 40.0)] {
        let now = std::time::Instant::now();
        let clean = record(&MODE_1, ratio, dt, 1500);
        coverage(&MODE_1, &clean, dt, level, 16);
        eprintln!("ratio {ratio} {level} {:?}", now.elapsed());
    }
}
