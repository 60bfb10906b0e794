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

#[test]
fn try_it() {
    let dt = 1.0 / 8192.0;
    for ratio in [0.3, 2.0] {
        let clean = record(&MODE_1, ratio, dt, 8192);
        for level in [200.0, 40.0, 20.0] {
            let now = std::time::Instant::now();
            let found = identified(&[noisy(&clean, level, 7)], dt);
            eprintln!("ratio {ratio} {level} dB {:?}", now.elapsed());
            print(&found);
        }
    }
}
