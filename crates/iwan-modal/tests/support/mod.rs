//! A plate-like beam of known modes under known blows, measured by sensors with noise and calibration errors.
#![allow(dead_code, reason = "each test uses its part")]

use std::f64::consts::{PI, TAU};

use iwan_core::SplitMix64;
use iwan_modal::Complex;
use iwan_modal::measure::{Channel, Direction, Freedom, Hit};

/// A mode: frequency in Hz, damping ratio, half waves along the beam, and whether it twists.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TrueMode {
    pub(crate) frequency: f64,
    pub(crate) damping_ratio: f64,
    pub(crate) half_waves: f64,
    pub(crate) twists: bool,
}

/// Ten modes with damping from 0.01 % to 1 %; the seventh and eighth are 1.5 half-power bandwidths apart.
pub(crate) fn ten_modes() -> Vec<TrueMode> {
    let mode = |frequency, damping_ratio, half_waves, twists| TrueMode {
        frequency,
        damping_ratio,
        half_waves,
        twists,
    };
    vec![
        mode(122.4, 1e-3, 2.0, false),
        mode(243.1, 1e-4, 3.0, false),
        mode(301.7, 3e-3, 1.0, true),
        mode(402.3, 5e-4, 4.0, false),
        mode(515.8, 1e-2, 2.0, true),
        mode(601.5, 2e-4, 5.0, false),
        mode(743.0, 4e-3, 6.0, false),
        mode(743.0 + 1.5 * 2.0 * 4e-3 * 743.0, 4e-3, 3.0, true),
        mode(875.2, 2e-3, 7.0, false),
        mode(958.4, 7e-4, 4.0, true),
    ]
}

/// Length of the hammer's pulse, s.
const PULSE: f64 = 1e-3;

/// Normal numbers of a seed.
pub(crate) struct Normal(SplitMix64);

impl Normal {
    pub(crate) fn new(seed: u64) -> Self {
        Self(SplitMix64::new(seed))
    }

    pub(crate) fn next(&mut self) -> f64 {
        loop {
            let (x, y) = (self.0.next_symmetric(), self.0.next_symmetric());
            let square = x * x + y * y;
            if square > 0.0 && square < 1.0 {
                return x * (-2.0 * square.ln() / square).sqrt();
            }
        }
    }
}

/// What is measured and how.
#[derive(Debug, Clone)]
pub(crate) struct Bench {
    pub(crate) modes: Vec<TrueMode>,
    /// Sensors along each of two edges.
    pub(crate) stations: usize,
    pub(crate) rate: f64,
    pub(crate) samples: usize,
    /// Root mean square of noise over that of each response.
    pub(crate) noise: f64,
    /// Standard deviation of the sensors' gains.
    pub(crate) calibration: f64,
    /// Sensor at which the hammer hits.
    pub(crate) drive: usize,
}

impl Bench {
    pub(crate) fn new(modes: Vec<TrueMode>) -> Self {
        Self { modes, stations: 27, rate: 8192.0, samples: 16_384, noise: 1e-2, calibration: 1e-2, drive: 0 }
    }

    /// Mass-normalised shape at every sensor; the first is at the tip, where the hammer hits.
    pub(crate) fn shape(&self, mode: &TrueMode) -> Vec<f64> {
        let n = self.stations;
        let value = |i: usize| {
            let (x, edge) = ((i % n) as f64 / (n - 1).max(1) as f64, if i < n { 1.0 } else { -1.0 });
            (mode.half_waves * PI * x).cos() * if mode.twists { edge } else { 1.0 }
        };
        (0..2 * n).map(value).collect()
    }

    /// Of the sensors, around 1; evenly spread, as sensors are sorted out that are off by more.
    pub(crate) fn gains(&self) -> Vec<f64> {
        let mut spread = SplitMix64::new(77);
        (0..2 * self.stations)
            .map(|_| 1.0 + self.calibration * 3.0_f64.sqrt() * spread.next_symmetric())
            .collect()
    }

    pub(crate) fn pole(mode: &TrueMode) -> Complex<f64> {
        let w = TAU * mode.frequency;
        Complex::new(-mode.damping_ratio * w, w * (1.0 - mode.damping_ratio * mode.damping_ratio).sqrt())
    }

    /// One blow with a haversine of 1 ms that begins at sample 100, at a tip of the beam or at another sensor.
    pub(crate) fn hit(&self, force: f64, seed: u64) -> Hit {
        let gains = self.gains();
        let (dt, start, length) = (1.0 / self.rate, 100, PULSE);
        let time = |n: usize| (n as f64 - f64::from(start)) * dt;
        let pulse = |t: f64| {
            if (0.0..length).contains(&t) { 0.5 * force * (1.0 - (TAU * t / length).cos()) } else { 0.0 }
        };
        let shapes: Vec<Vec<f64>> = self.modes.iter().map(|m| self.shape(m)).collect();
        let mut noise = Normal::new(seed);
        let modal: Vec<Vec<f64>> = self
            .modes
            .iter()
            .map(|m| {
                (0..self.samples).map(|n| modal_acceleration(Self::pole(m), force, length, time(n))).collect()
            })
            .collect();
        let response = |i: usize| {
            let at = |n: usize| {
                (0..shapes.len()).map(|m| shapes[m][i] * shapes[m][self.drive] * modal[m][n]).sum::<f64>()
            };
            let clean: Vec<f64> = (0..self.samples).map(at).collect();
            let rms = (clean.iter().map(|x| x * x).sum::<f64>() / clean.len() as f64).sqrt();
            let samples = clean.iter().map(|x| gains[i] * x + self.noise * rms * noise.next()).collect();
            Channel { name: format!("a{}", i + 1), freedom: point(i + 1), samples }
        };
        let responses = (0..2 * self.stations).map(response).collect();
        let force_noise = 1e-4 * force;
        let mut other = Normal::new(seed ^ 0xabc);
        let samples = (0..self.samples).map(|n| pulse(time(n)) + force_noise * other.next()).collect();
        let force = Channel { name: "hammer".into(), freedom: point(self.drive + 1), samples };
        Hit { name: format!("hit {seed}"), dt, force, responses }
    }

    /// Without noise and calibration errors.
    pub(crate) fn clean(self) -> Self {
        Self { noise: 0.0, calibration: 0.0, ..self }
    }

    /// Several hits, their forces a few per cent apart.
    pub(crate) fn hits(&self, force: f64, count: usize, seed: u64) -> Vec<Hit> {
        (0..count).map(|h| self.hit(force * (1.0 + 0.05 * h as f64), seed * 1000 + h as u64)).collect()
    }
}

pub(crate) fn point(number: usize) -> Freedom {
    Freedom { point: number.to_string(), direction: Direction::from_name("z").expect("z") }
}

/// Acceleration of a mode of mass 1 under a haversine of unit shape, exactly: the force is a sum of three exponentials.
fn modal_acceleration(pole: Complex<f64>, force: f64, length: f64, t: f64) -> f64 {
    if t < 0.0 {
        return 0.0;
    }
    let turn = Complex::new(0.0, TAU / length);
    let parts = [(0.5, Complex::new(0.0, 0.0)), (-0.25, turn), (-0.25, -turn)];
    let end = t.min(length);
    let at_end: Complex<f64> =
        parts.iter().map(|(c, p)| ((p * end).exp() - (pole * end).exp()) / (p - pole) * *c * force).sum();
    let q = at_end * (pole * (t - end)).exp();
    let f = if t < length { 0.5 * force * (1.0 - (TAU * t / length).cos()) } else { 0.0 };
    let amplitude = Complex::new(0.0, -0.5 / pole.im);
    2.0 * (amplitude * (pole * pole * q + pole * f)).re
}
