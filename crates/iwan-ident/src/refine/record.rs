//! A record as the searches see it: its amplitudes in windows, and the turning point that its own unknowns are relative to.

use std::f64::consts::{PI, TAU};

use rustfft::num_complex::Complex64;
use serde::{Deserialize, Serialize};

use super::amplitudes::whitening::Whitening;
use super::amplitudes::windows::{OVERLAP, Windows};
use super::release::{Sampling, TurningPoint};
use super::ring_down::RingDown;
use crate::curves::Quantity;
use crate::error::{Error, check, check_dt, check_per_cycle, check_samples};
use crate::parameters::Parameters;
use crate::signal::sample_noise;

/// Part of the largest amplitude below which windows do not enter the first search, which compares logarithms and unwrapped phases: in noise of 30 dB
/// a phase is lost there. The last search sees all windows.
const LOUD: f64 = 0.03;

/// Standard deviation that is put down to the forward model's own error, relative to a record's amplitudes: the half-cycle map leaves 1e-7 to 5e-6 of
/// noise-free records that it made itself. Without this floor the intervals of a record without noise would have no width.
const NOISE_FLOOR: f64 = 1e-6;
/// Part of what sampling adds to the amplitudes that counts as an error: the addition is computed at one point of the search and used next to it.
const SAMPLING_ERROR: f64 = 0.01;
/// Part of other modes that is taken to remain in a record after they were subtracted. Of modes 8 % apart and half as loud three per cent remain at
/// the beginning; the value is a judgement, with room for records that are shorter or noisier. The remainder beats slowly with the mode, and a joint
/// would follow the beats.
const LEFT_OF_OTHERS: f64 = 0.05;
/// Noise and residuals relative to a record below which the record counts as clean: 80 dB, which no measured record reaches. Simulated records do.
/// Their sliders, filters or time steps are not in the law, and intervals of clean records allow for that. With 40 dB as the limit, this allowance
/// moved best fits by more than their intervals.
pub(super) const CLEAN: f64 = 1e-4;
/// Cycles of a record without noise that are kept as samples, because the joint slips as a whole in the first ones.
const HEAD: f64 = 3.0;
/// Samples per cycle below which a record is refused; the highest frequency in the span of common analysers has 2.56. Nearer to two, the filter
/// cannot tell the mode from its image about half the sampling rate.
const PER_CYCLE: f64 = 2.5;
/// Largest ratio of two amplitudes half a cycle apart that an estimated turning point allows for; a larger one is cut to it. A strongly softening
/// joint in macro-slip loses half of its amplitude in half a cycle.
const MOST_DECAY: f64 = 3.0;

/// Windows that a record needs: a single one has two numbers, fewer than the record has unknowns of its own.
const WINDOWS: usize = 2;

/// Refuses records with too few samples a cycle.
pub(crate) fn check_rate(per_cycle: f64) -> Result<f64, Error> {
    let allowed = format!("at least {PER_CYCLE}");
    check_per_cycle(per_cycle, PER_CYCLE, &allowed, "sample faster")
}

/// Noise of the whitened amplitudes.
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
pub(super) struct Noise {
    /// Standard deviation that all windows have in common.
    pub(super) floor: f64,
    /// Standard deviation that grows with the amplitude, as a part of it.
    pub(super) part: f64,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Windowed {
    pub(super) windows: Windows,
    pub(super) whitening: Whitening,
    pub(super) quantity: Quantity,
    pub(super) dt: f64,
    /// Number of samples.
    pub(super) samples: usize,
    /// What sampling adds to the amplitudes of a model in continuous time, one value per window ([`Task::take_samples`](super::task::Task)).
    pub(super) sampling: Vec<Complex64>,
    /// Complex amplitudes of the record, one per window: as they are, and whitened.
    pub(super) amplitudes: Vec<Complex64>,
    pub(super) white: Vec<Complex64>,
    /// Noise of the whitened amplitudes.
    pub(super) noise: Noise,
    /// Standard deviation of each window's whitened residual; residuals are divided by it.
    pub(super) deviations: Vec<f64>,
    /// The turning point that the record's own unknowns are relative to.
    pub(super) start: TurningPoint,
    /// Whether the samples were filtered to a band.
    banded: bool,
    /// Standard deviations, one per window, of what remains of other modes after they were subtracted, in the whitened amplitudes.
    beside: Vec<f64>,
    /// Standard deviation of the noise that the samples show, over their root mean square; none for a record in a band, whose filter took the noise
    /// away.
    sample_noise: Option<f64>,
    /// The samples of the first cycles of a record that shows no noise, of which windows keep only two numbers a cycle; empty for other records.
    pub(super) head: Vec<f64>,
}

impl Windowed {
    pub(super) fn new(record: &RingDown<'_>, first: &Parameters) -> Result<Self, Error> {
        check_dt(record.dt)?;
        check_samples("record", record.samples, 32, "record longer")?;
        let per_cycle = 1.0 / (first.frequency * record.dt);
        check_rate(per_cycle)?;
        // The windows pass ±3/(4H) Hz: this is half of the band at most, and half of the distance between the mode and its image, which sampling puts
        // at 1/dt - f.
        let cycles = record.band.map_or(1.0, |band| 1.5 * first.frequency / band);
        let cycles = cycles.max(1.5 / (per_cycle - 2.0));
        let seconds = (record.samples.len() - 1) as f64 * record.dt;
        let windows = Windows::over(seconds, first.frequency, cycles);
        if windows.count < WINDOWS {
            return Err(Error::TooShort {
                what: "independent amplitudes of a record",
                found: 2 * windows.count,
                needed: 2 * WINDOWS,
                remedy: "record longer",
            });
        }
        let amplitudes = windows.of_samples(record.samples, record.dt);
        let loudest = amplitudes.iter().map(|z| z.norm()).fold(0.0, f64::max);
        check("amplitude of the record", loudest, loudest > 0.0, "> 0", "check the channel")?;
        let whitening = Whitening::of(windows.count, windows.hop);
        let mut white = amplitudes.clone();
        whitening.apply(&mut white);
        let mut windowed = Self {
            windows,
            whitening,
            quantity: record.quantity,
            dt: record.dt,
            samples: record.samples.len(),
            sampling: vec![Complex64::default(); amplitudes.len()],
            amplitudes,
            white,
            noise: Noise::default(),
            deviations: vec![],
            start: turning_point(record, first.frequency),
            banded: record.band.is_some(),
            beside: vec![],
            sample_noise: sample_noise(record.samples).filter(|_| record.band.is_none()).map(|noise| {
                let square = record.samples.iter().map(|x| x * x).sum::<f64>() / record.samples.len() as f64;
                noise / square.sqrt()
            }),
            head: vec![],
        };
        if windowed.is_without_noise() {
            let length = ((HEAD * per_cycle) as usize).min(record.samples.len());
            windowed.head = record.samples[..length].to_vec();
        }
        windowed.beside = windowed.left_of(record.beside);
        windowed.take_noise(Noise { floor: windowed.root_mean_square(), part: 0.0 });
        Ok(windowed)
    }

    /// Standard deviations, one per window, of what remains of other modes after `taken` was subtracted from the record; zeros where no mode was
    /// subtracted.
    fn left_of(&self, taken: Option<&[f64]>) -> Vec<f64> {
        let Some(taken) = taken else { return vec![0.0; self.windows.count] };
        let mut amplitudes = self.windows.of_samples(taken, self.dt);
        self.whitening.apply(&mut amplitudes);
        amplitudes.iter().map(|z| LEFT_OF_OTHERS * z.norm()).collect()
    }

    /// Whether the samples show so little noise that they can only come from a simulation.
    pub(super) fn is_without_noise(&self) -> bool {
        self.sample_noise.is_some_and(|noise| noise < CLEAN)
    }

    /// Whether other modes were subtracted, so that standard deviations are known beside those that residuals show.
    pub(super) fn is_beside_others(&self) -> bool {
        self.beside.iter().any(|b| *b > 0.0)
    }

    /// Half cycles that one window of a record in a band covers; zero for a record that was not filtered.
    pub(super) fn gate_half_cycles(&self) -> usize {
        let cycles = OVERLAP as f64 * self.windows.hop * self.windows.omega / TAU;
        if self.banded { (2.0 * cycles).ceil() as usize } else { 0 }
    }

    /// From now on residuals are divided by the standard deviations of this noise, together with what remains of other modes.
    pub(super) fn take_noise(&mut self, noise: Noise) {
        self.noise = noise;
        let of_noise = self.white.iter().map(|z| noise.floor.hypot(noise.part * z.norm()));
        self.deviations = of_noise.zip(&self.beside).map(|(noise, beside)| noise.hypot(*beside)).collect();
    }

    /// Root mean square of what the model misses of the first samples (`head`), over the root mean square of these; none for a record that keeps
    /// none.
    pub(super) fn misses_of_head(&self, parameters: &Parameters, start: TurningPoint) -> Option<f64> {
        let sampling = Sampling { dt: self.dt, count: self.head.len() };
        let model = start.samples(parameters, sampling, self.quantity).ok()?;
        let missed = model.iter().zip(&self.head).map(|(m, x)| (x - m).powi(2)).sum::<f64>();
        let all = self.head.iter().map(|x| x * x).sum::<f64>();
        (all > 0.0).then(|| (missed / all).sqrt())
    }

    pub(super) fn root_mean_square(&self) -> f64 {
        root_mean_square(&self.white)
    }

    /// Standard deviation of whitened residuals that is due to the forward model itself.
    pub(super) fn floor(&self) -> f64 {
        let mut sampling = self.sampling.clone();
        self.whitening.apply(&mut sampling);
        (NOISE_FLOOR * self.root_mean_square()).max(SAMPLING_ERROR * root_mean_square(&sampling))
    }

    /// The turning point for the record's own unknowns: ln of the amplitude over the first guess, phase of the release (rad), and ln of the record's
    /// own frequency over that of the windows. The last one, less the same logarithm of the mode's frequency at the same amplitude (`ln_frequency`, ln Hz), is
    /// the day, where records have days. `omega` is the mode's frequency at rest, rad/s.
    pub(super) fn start_at(
        &self,
        own: &[f64],
        (omega, ln_frequency): (f64, f64),
        has_day: bool,
    ) -> TurningPoint {
        TurningPoint {
            displacement: self.start.displacement * own[0].exp(),
            time: self.start.time + own[1] / omega,
            day: if has_day { self.start.day + own[2] - self.over_windows(ln_frequency) } else { 0.0 },
        }
    }

    /// A ln frequency (Hz) less that of the windows.
    pub(super) fn over_windows(&self, ln_frequency: f64) -> f64 {
        ln_frequency - (self.windows.omega / TAU).ln()
    }

    /// Replaces each amplitude of a model by the record's amplitude times the logarithm of the ratio of record to model: the difference of the two to
    /// first order.
    pub(super) fn ratios(&self, model: &mut [Complex64]) {
        let logs: Vec<Complex64> = unwrapped(&self.amplitudes, model).collect();
        model.iter_mut().zip(&self.amplitudes).zip(logs).for_each(|((m, z), log)| *m = z * log);
    }

    /// Number of windows that the first search compares: all before the amplitude falls below `LOUD`, and at least eight.
    pub(super) fn loud(&self) -> usize {
        let loudest = self.amplitudes.iter().map(|z| z.norm()).fold(0.0, f64::max);
        let quiet = self.amplitudes.iter().position(|z| z.norm() < LOUD * loudest);
        quiet.unwrap_or(self.amplitudes.len()).max(8.min(self.amplitudes.len()))
    }
}

/// Logarithms of the ratios of a record's amplitudes to a model's, with phases that go on without jumps from window to window.
pub(super) fn unwrapped<'a>(
    record: &'a [Complex64],
    model: &'a [Complex64],
) -> impl Iterator<Item = Complex64> + 'a {
    let mut turned = (Complex64::new(1.0, 0.0), 0.0);
    record.iter().zip(model).map(move |(z, m)| {
        let ratio = z / m;
        let angle = turned.1 + (ratio / turned.0).arg();
        turned = (ratio, angle);
        Complex64::new(ratio.norm().max(f64::MIN_POSITIVE).ln(), angle)
    })
}

fn root_mean_square(values: &[Complex64]) -> f64 {
    (values.iter().map(Complex64::norm_sqr).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// Estimates the turning point next to the first sample: amplitude and phase over the first cycle and over the cycle that begins half a cycle later,
/// Hann-windowed, are carried back to the first sample.
fn turning_point(record: &RingDown<'_>, frequency: f64) -> TurningPoint {
    let omega = TAU * frequency;
    let cycle = ((1.0 / (frequency * record.dt)).round() as usize).min(record.samples.len() / 2);
    let amplitude = |from: usize| -> Complex64 {
        let part = &record.samples[from..from + cycle];
        let mean = part.iter().sum::<f64>() / cycle as f64;
        let term = |(n, x): (usize, &f64)| {
            let hann = 2.0 * (PI * (n as f64 + 0.5) / cycle as f64).sin().powi(2);
            Complex64::cis(-omega * (from + n) as f64 * record.dt) * ((x - mean) * hann * 2.0 / cycle as f64)
        };
        part.iter().enumerate().map(term).sum()
    };
    let half = cycle / 2;
    let (first, second) = (amplitude(0), amplitude(half));
    let rate = omega + (second / first).arg() / (half as f64 * record.dt);
    let middle = 0.5 * (cycle as f64 - 1.0) * record.dt;
    let (lag, power) = match record.quantity {
        Quantity::Displacement => (0.0, 0),
        Quantity::Velocity => (0.5 * PI, 1),
        Quantity::Acceleration => (PI, 2),
    };
    // Phase of the displacement at the first sample, between turning points at multiples of π.
    let phase = first.arg() + (omega - rate) * middle - lag;
    let turns = (phase / PI).round();
    let sign = if turns.rem_euclid(2.0) == 1.0 { -1.0 } else { 1.0 };
    // The first amplitude is that half a cycle after the first sample, the second that another half a cycle later.
    let decayed = (first.norm() / second.norm()).clamp(1.0, MOST_DECAY);
    TurningPoint {
        displacement: sign * decayed * first.norm() / rate.abs().powi(power),
        time: (turns * PI - phase) / rate,
        day: 0.0,
    }
}
