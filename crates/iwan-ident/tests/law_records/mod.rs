//! Ring-downs of every law, by time steps and by half cycles: forward models that share nothing with the averaging in the fit.
#![allow(
    dead_code,
    clippy::unwrap_used,
    reason = "shared by several programs; a failed test may panic and say why"
)]

pub(crate) mod in_noise;
pub(crate) mod random;
pub(crate) mod sliders;
pub(crate) mod softening;

use std::f64::consts::TAU;

use iwan_core::{
    Backbone, Continuum, Coulomb, Decay, FourParameter, Hysteresis, Jenkins, Motion, Newmark, NoJoint,
    Oscillator, Part, Pinning, PowerDamping, PowerSpring, ResidualStiffness, Reversal, Samples, SplitMix64,
    WithParts,
};
pub(crate) use random::normal;
use random::{between, scale};

/// A record, and the law and parameters from which it was made.
pub(crate) struct Simulated {
    /// Displacement.
    pub(crate) samples: Vec<f64>,
    pub(crate) dt: f64,
    /// Names and values of the parameters.
    pub(crate) truth: Vec<(&'static str, f64)>,
}

/// Names of the laws that are simulated.
pub(crate) const LAWS: [&str; 16] = [
    "linear",
    "viscous-coulomb",
    "viscous-quadratic",
    "duffing",
    "viscous-coulomb-quadratic",
    "duffing-coulomb",
    "duffing-quadratic",
    "power-damping",
    "jenkins",
    "pinning",
    "duffing-coulomb-quadratic",
    "separate-powers",
    "iwan",
    "iwan-coulomb",
    "iwan-quadratic",
    "iwan-duffing",
];

/// The parts of a mode's law.
struct Made {
    frequency: f64,
    damping_ratio: f64,
    parts: Vec<Part>,
    truth: Vec<(&'static str, f64)>,
}

/// Parts of a law whose parameters show in a ring-down of some hundred cycles from amplitude 1: at that amplitude each damper contributes a
/// damping ratio of about 0.3 %, and a spring shifts the frequency by a tenth of a per cent to some per cent.
fn made(law: &str, random: &mut SplitMix64) -> Made {
    let frequency = scale(random, 20.0, 500.0);
    let (omega, zeta) = (TAU * frequency, scale(random, 1e-3, 4e-3));
    let mut out = Made { frequency, damping_ratio: zeta, parts: vec![], truth: vec![] };
    // A damper that contributes this damping ratio at amplitude 1.
    let damper = |part: Part, ratio: f64| ratio * TAU * omega * omega / part.dissipation(1.0, omega);
    let mut add = |part: Part, named: &[(&'static str, f64)]| {
        out.parts.push(part);
        out.truth.extend_from_slice(named);
    };
    if law.contains("coulomb") {
        let unit = Coulomb::new(1.0).unwrap().into();
        let force = damper(unit, zeta * scale(random, 0.05, 0.2));
        add(Coulomb::new(force).unwrap().into(), &[("coulomb_force", force)]);
    }
    if law.contains("quadratic") {
        let unit = PowerDamping::new(1.0, 2.0).unwrap().into();
        let c = damper(unit, zeta * scale(random, 0.5, 2.0));
        add(PowerDamping::new(c, 2.0).unwrap().into(), &[("quadratic_c", c)]);
    }
    if law.contains("duffing") {
        let k = 4.0 / 3.0 * omega * omega * scale(random, 3e-3, 3e-2) * random.next_symmetric().signum();
        add(PowerSpring::new(k, 3.0).unwrap().into(), &[("cubic_k", k)]);
    }
    if law == "power-damping" || law == "separate-powers" {
        let n = if law == "power-damping" { between(random, 1.5, 1.8) } else { between(random, 1.3, 1.9) };
        let unit = PowerDamping::new(1.0, n).unwrap().into();
        let c = damper(unit, zeta * scale(random, 1.0, 3.0));
        add(PowerDamping::new(c, n).unwrap().into(), &[("damping_c", c), ("damping_n", n)]);
    }
    if law == "separate-powers" {
        let m = between(random, 1.3, 2.2);
        let unit = PowerSpring::new(1.0, m).unwrap().harmonic_stiffness(1.0);
        let k = -omega * omega * scale(random, 5e-3, 3e-2) / unit;
        add(PowerSpring::new(k, m).unwrap().into(), &[("spring_k", k), ("spring_exponent", m)]);
    }
    if law == "pinning" {
        let (k, gap) = (omega * omega * scale(random, 5e-3, 5e-2), scale(random, 0.15, 0.6));
        add(Pinning::new(k, gap).unwrap().into(), &[("pinning_k", k), ("pinning_gap", gap)]);
    }
    out.truth.extend([("frequency", frequency), ("damping_ratio", zeta)]);
    out
}

/// A ring-down of a law with random parameters, without noise.
pub(crate) fn ring_down(law: &str, seed: u64) -> Simulated {
    let mut random = SplitMix64::new(77 + 1000 * seed);
    let Made { frequency, damping_ratio, parts, mut truth } = made(law, &mut random);
    let per_cycle = between(&mut random, 12.0, 40.0);
    // The record is as long as a viscous decay over two decades.
    let cycles = (scale(&mut random, 2.5, 4.6) / (TAU * damping_ratio)).min(500.0);
    let (dt, count) = (1.0 / (frequency * per_cycle), (cycles * per_cycle) as usize);
    let k = (TAU * frequency).powi(2);
    let samples = match law {
        "jenkins" => {
            let k_t = k * scale(&mut random, 3e-3, 3e-2);
            let f_s = k_t * scale(&mut random, 0.1, 0.5);
            truth.extend([("k_t", k_t), ("f_s", f_s)]);
            let joint = Jenkins::new(k_t, f_s).unwrap();
            let mode = Oscillator::new(frequency, damping_ratio, k_t, ResidualStiffness::Positive).unwrap();
            stepped(&mode, Some(&joint), &parts, dt, count)
        }
        _ if law.starts_with("iwan") => {
            let k_t = k * scale(&mut random, 1e-2, 0.2);
            let (chi, beta) = (between(&mut random, -0.7, 0.0), scale(&mut random, 0.1, 2.0));
            let phi_max = scale(&mut random, 0.4, 5.0);
            let f_s = k_t * phi_max * (beta + (chi + 1.0) / (chi + 2.0)) / (1.0 + beta);
            truth.extend([("k_t", k_t), ("f_s", f_s), ("chi", chi), ("beta", beta)]);
            let joint = FourParameter::new(k_t, f_s, chi, beta).unwrap();
            let mode = Oscillator::new(frequency, damping_ratio, k_t, ResidualStiffness::Positive).unwrap();
            if parts.is_empty() {
                by_half_cycles(&mode, &joint, dt, count)
            } else {
                stepped(&mode, Some(&joint), &parts, dt, count)
            }
        }
        _ => {
            let mode = Oscillator::new(frequency, damping_ratio, 0.0, ResidualStiffness::Positive).unwrap();
            stepped::<Jenkins>(&mode, None, &parts, dt, count)
        }
    };
    Simulated { samples, dt, truth }
}

/// The record with noise whose standard deviation is `decibels` below the amplitude of the first cycle.
pub(crate) fn noisy(clean: &Simulated, decibels: f64, seed: u64) -> Vec<f64> {
    let mut random = SplitMix64::new(0xabcd_0123 ^ (seed << 8));
    let top = clean.samples.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let deviation = top * 10.0_f64.powf(-decibels / 20.0);
    clean.samples.iter().map(|x| x + deviation * normal(&mut random)).collect()
}

fn buffers(count: usize) -> [Vec<f64>; 4] {
    std::array::from_fn(|_| vec![0.0; count])
}

/// Displacement after release from rest at amplitude 1, by time steps that are a fraction of `dt`.
fn stepped<B: Backbone>(
    mode: &Oscillator,
    joint: Option<&B>,
    parts: &[Part],
    dt: f64,
    count: usize,
) -> Vec<f64> {
    const FRACTION: usize = 8;
    let mut out = buffers((count - 1) * FRACTION + 1);
    let [displacement, velocity, acceleration, joint_force] = &mut out;
    let scheme = Newmark::prewarped(dt / FRACTION as f64, mode.omega0()).unwrap();
    let with = WithParts::new(&scheme, mode, parts).unwrap();
    let mut samples = Samples { displacement, velocity, acceleration, joint_force };
    if let Some(joint) = joint {
        let law = Continuum::new(joint);
        let mut memory = law.virgin(vec![Reversal::default(); 4096]).unwrap();
        law.advance(&mut memory, 1.0);
        with.integrate(&law, &mut memory, 0.0, &[], &mut samples).unwrap();
    } else {
        with.integrate(&NoJoint, &mut 1.0, 0.0, &[], &mut samples).unwrap();
    }
    let [displacement, ..] = out;
    displacement.into_iter().step_by(FRACTION).collect()
}

fn by_half_cycles(mode: &Oscillator, joint: &FourParameter, dt: f64, count: usize) -> Vec<f64> {
    let mut out = buffers(count);
    let [displacement, velocity, acceleration, joint_force] = &mut out;
    let stack = vec![Reversal::default(); (3.0 * count as f64 * dt * mode.omega0() / TAU) as usize + 64];
    Decay::new(mode, joint, 0.0, Motion::held_at(1.0), stack)
        .unwrap()
        .sample(dt, &mut Samples { displacement, velocity, acceleration, joint_force })
        .unwrap();
    let [displacement, ..] = out;
    displacement
}
