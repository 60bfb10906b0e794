//! How far printed errors are from true ones: random laws, forces, amplitudes and steps for each method. `printed_errors [COUNT]`, which `scripts/validate` runs
//! 200 times a method; the last figures stand in the book's chapter on validation.
//!
//! True is the difference to the continuum at a fortieth of the step and 32,000 steps a period at least, extrapolated from twice that; sets where this is not ten times nearer
//! to what twice and four times the step extrapolate to are left out and counted, as are errors at rounding.
#![allow(clippy::print_stdout, reason = "a program that prints its result")]

use std::f64::consts::TAU;

use iwan_core::{Backbone, FourParameter, Jenkins, Motion, Pulse, Representation, SplitMix64, Uniform};
use iwan_sim::{JointLaw, Method, Mode, Response, Settings, simulate};

/// Sets that are listed at most at either end: those out of bounds, and the three least.
const LISTED: usize = 12;

/// Errors below this are rounding over a million steps, as those of a joint that never slips, and tell nothing of estimates.
const ROUNDING: f64 = 1e-9;

/// A force that owns its samples.
enum Force {
    Plain(Pulse<'static>),
    Samples { dt: f64, samples: Vec<f64> },
}

impl Force {
    fn pulse(&self) -> Pulse<'_> {
        match self {
            Self::Plain(pulse) => *pulse,
            Self::Samples { dt, samples } => Pulse::Sampled { dt: *dt, samples },
        }
    }
}

/// One random set.
struct Set {
    words: String,
    mode: Mode,
    force: Force,
    dt: f64,
    duration: f64,
}

struct Random(SplitMix64);

impl Random {
    /// Between two numbers.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * 0.5 * (1.0 + self.0.next_symmetric())
    }

    /// Between two numbers, evenly in their logarithms.
    fn scale(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    fn choice(&mut self, count: usize) -> usize {
        (self.between(0.0, count as f64) as usize).min(count - 1)
    }

    fn law(&mut self, k_t: f64) -> Option<JointLaw> {
        let f_s = self.scale(1.0, 1e3);
        match self.choice(4) {
            0 => Jenkins::new(k_t, f_s).ok().map(JointLaw::Jenkins),
            1 => {
                let width = self.between(0.2, 1.9);
                Uniform::new(k_t, f_s, width).ok().map(JointLaw::Uniform)
            }
            2 => {
                let strengths: Vec<f64> = [0.0, 0.03, 0.1, 0.3, 1.0].map(|s| s * f_s / k_t).into();
                let densities: Vec<f64> =
                    strengths.iter().map(|_| self.scale(0.05, 2.0) * k_t * k_t / f_s).collect();
                JointLaw::tabulated(&strengths, &densities, self.between(0.0, 0.3) * k_t).ok()
            }
            _ => {
                let (chi, beta) = (self.between(-0.9, -0.05), self.scale(0.01, 10.0));
                FourParameter::new(k_t, f_s, chi, beta).ok().map(JointLaw::FourParameter)
            }
        }
    }

    /// Peak of a force that brings a linear mode to about `displacement`.
    fn force(&mut self, frequency: f64, displacement: f64, dt: f64, duration: f64) -> Force {
        let omega = TAU * frequency;
        let period = 1.0 / frequency;
        let length = self.scale(0.1, 3.0) * period;
        let impulse = displacement * omega;
        let amplitude = (2.0 * impulse / length).min(displacement * omega * omega);
        match self.choice(5) {
            0 => Force::Plain(Pulse::Haversine { amplitude, duration: length }),
            1 => Force::Plain(Pulse::HalfSine { amplitude, duration: length }),
            2 => {
                Force::Plain(Pulse::Step { amplitude: 0.5 * omega * omega * displacement, duration: length })
            }
            3 => {
                let detuned = frequency * self.between(0.5, 1.5);
                let amplitude = 0.3 * omega * omega * displacement;
                Force::Plain(Pulse::Sine { amplitude, frequency: detuned, duration: 0.5 * duration })
            }
            _ => {
                let interval = self.scale(0.1, 8.0) * dt;
                let count = ((0.5 * duration / interval) as usize).max(2);
                let level = 0.5 * omega * omega * displacement;
                let samples = (0..count).map(|_| level * self.0.next_symmetric()).collect();
                Force::Samples { dt: interval, samples }
            }
        }
    }

    fn set(&mut self) -> Option<Set> {
        let frequency = self.scale(20.0, 2000.0);
        let omega_squared = (TAU * frequency).powi(2);
        let k_t = self.scale(0.02, 0.8) * omega_squared;
        let law = self.law(k_t)?;
        if law.initial_stiffness() > 0.9 * omega_squared {
            return None;
        }
        let ratio = self.scale(0.03, 6.0);
        let displacement = ratio * law.strengths().1;
        let (per_period, periods) = (self.scale(12.0, 400.0), self.between(4.0, 40.0));
        let dt = 1.0 / (frequency * per_period);
        let duration = periods / frequency;
        let damping_ratio = if self.choice(3) == 0 { 0.0 } else { self.scale(1e-4, 3e-2) };
        let free = self.choice(4) == 0;
        let force =
            if free { Force::Plain(Pulse::None) } else { self.force(frequency, displacement, dt, duration) };
        let initial = if free { Motion::held_at(displacement) } else { Motion::default() };
        let words = format!(
            "{frequency:.1} Hz, {law:?}, K_T {:.2} of omega0^2, to {ratio:.2} phi_max, {per_period:.0} steps a period, {periods:.0} periods, zeta {damping_ratio:.1e}, {}",
            law.initial_stiffness() / omega_squared,
            match &force {
                Force::Plain(pulse) => format!("{pulse:?}"),
                Force::Samples { dt: own, .. } => format!("samples every {:.2} steps", own / dt),
            }
        );
        let mode = Mode { damping_ratio, initial, ..Mode::new("mode", frequency, Some(law)) };
        Some(Set { words, mode, force, dt, duration })
    }
}

fn newmark(joint: Representation) -> Method {
    Method::Newmark { beta: 0.25, gamma: 0.5, prewarp: true, joint }
}

/// Displacements at the steps of a set, and how far they may be off.
fn reference(set: &Set) -> Option<(Vec<f64>, f64)> {
    /// Steps a period: half-cycle steps its force at 4000.
    const FINE: f64 = 32_000.0;
    let parts = 4 * (0.25 * set.dt * set.mode.frequency * FINE).ceil().max(10.0) as usize;
    let at = |parts: usize| {
        let method = newmark(Representation::Continuum);
        let settings =
            Settings { method, quality: false, ..Settings::new(set.dt / parts as f64, set.duration) };
        let fine = simulate(&set.mode, &set.force.pulse(), &settings).ok()?;
        Some(fine.displacement.into_iter().step_by(parts).collect::<Vec<f64>>())
    };
    let (fine, half, quarter) = (at(parts)?, at(parts / 2)?, at(parts / 4)?);
    let extrapolated = |fine: &[f64], coarse: &[f64]| -> Vec<f64> {
        fine.iter().zip(coarse).map(|(f, c)| f + (f - c) / 3.0).collect()
    };
    let (best, other) = (extrapolated(&fine, &half), extrapolated(&half, &quarter));
    let off = other.iter().zip(&best).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    Some((best, off))
}

/// True error, and the printed one.
fn errors(set: &Set, method: Method, exact: &(Vec<f64>, f64)) -> Option<(f64, f64)> {
    let settings = Settings { method, ..Settings::new(set.dt, set.duration) };
    let response: Response = simulate(&set.mode, &set.force.pulse(), &settings).ok()?;
    let peak = response.peak_displacement();
    let pairs = response.displacement.iter().zip(&exact.0);
    let is = pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / peak;
    let said = response.quality.time_step_error? + response.quality.discretisation_error?;
    (is > ROUNDING.max(10.0 * exact.1 / peak)).then_some((is, said))
}

fn main() {
    let count: usize = std::env::args().nth(1).and_then(|a| a.parse().ok()).unwrap_or(200);
    let mut random = Random(SplitMix64::new(17));
    let ways: [(&str, Method); 4] = [
        ("sliders", newmark(Representation::default_sliders())),
        ("continuum", newmark(Representation::Continuum)),
        ("half-cycle", Method::HalfCycle),
        ("averaging", Method::Averaging),
    ];
    let (mut found, mut unknown) = (ways.map(|_| Vec::new()), [0; 4]);
    let mut sets = 0;
    while sets < count {
        let Some(set) = random.set() else { continue };
        let Some(exact) = reference(&set) else { continue };
        sets += 1;
        for (i, (_, method)) in ways.iter().enumerate() {
            match errors(&set, *method, &exact) {
                Some((is, said)) => found[i].push((said / is, is, set.words.clone())),
                None => unknown[i] += 1,
            }
        }
    }
    for ((name, _), (mut found, unknown)) in ways.iter().zip(found.into_iter().zip(unknown)) {
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |part: f64| found.get((part * found.len() as f64) as usize).map_or(f64::NAN, |f| f.0);
        let small = found.iter().filter(|f| f.0 < 1.0 / 3.0).count();
        let large = found.iter().filter(|f| f.0 > 3.0).count();
        println!(
            "{name}: {} sets ({unknown} more: the step refused, or the answer nearer to the reference than that is sure of, or at rounding); printed over true: least {:.2}, 5 % {:.2}, half {:.2}, 95 % {:.2}; below a third {small}, above three {large}",
            found.len(),
            at(0.0),
            at(0.05),
            at(0.5),
            at(0.95)
        );
        let worst =
            found.iter().take(small.clamp(3, LISTED)).chain(found.iter().rev().take(large.min(LISTED)));
        for (ratio, is, words) in worst {
            println!("  {ratio:.2} of {is:.1e}: {words}");
        }
    }
}
