//! What a steady forced response returns: points along a curve that may turn back in frequency.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use super::sweep::Control;

/// One point of a steady response.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SteadyPoint {
    /// Frequency of the excitation, Hz.
    pub frequency: f64,
    /// Amplitude of the response's first harmonic: a displacement.
    pub amplitude: f64,
    /// Phase of the first harmonic against the excitation, rad: 0 well below a resonance, about -π/2 in it.
    pub phase: f64,
    /// Amplitude of the excitation: a force, or the acceleration of the base.
    pub excitation: f64,
    /// Amplitudes and phases of the harmonics 3, 5, … (of n times the excitation's angle), where they were asked for.
    pub harmonics: Vec<[f64; 2]>,
    /// Amplitude of the first harmonic of each joint's slip, where joints were followed; empty for one mode with its first harmonic
    /// alone, whose joint slips by the modal displacement.
    pub slips: Vec<f64>,
}

/// A steady response at one level, along the curve: successive points are neighbours, and where several motions
/// are possible at one frequency the curve passes through all of them.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyCurve {
    /// What is held.
    pub control: Control,
    /// At which amplitude.
    pub level: f64,
    /// The points.
    pub points: Vec<SteadyPoint>,
    /// What the reader should know: no resonance in the band, where a computation ended and why.
    pub remarks: Vec<String>,
}

/// A frequency at which the response jumps when the excitation's frequency creeps past it: the curve turns back there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Amplitude of the point that loses its neighbours.
    pub amplitude: f64,
}

/// A superharmonic resonance: a harmonic of the response is in resonance with a mode of some n times the excitation's frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Superharmonic {
    /// Which harmonic, 3, 5, …
    pub harmonic: usize,
    /// Frequency of the excitation at which it is largest, Hz.
    pub frequency: f64,
    /// Amplitude of the harmonic there.
    pub amplitude: f64,
}

/// How far a harmonic's phase turns, at the least, between the points at which a resonance has fallen to 1/√2 of its height. In the resonance
/// of a linear mode that is π/2; where a harmonic is large only because the fundamental is, its phase follows the fundamental's and turns by
/// next to nothing. Half of π/2 tells the two.
const TURN: f64 = std::f64::consts::FRAC_PI_4;

impl SteadyCurve {
    /// The point of the largest amplitude (of the smallest excitation, where the response is held): the resonance as it is
    /// seen. None on an empty curve.
    #[must_use]
    pub fn peak(&self) -> Option<&SteadyPoint> {
        let size = |point: &SteadyPoint| {
            if self.control.holds_response() { point.amplitude / point.excitation } else { point.amplitude }
        };
        self.points.iter().max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// Where the curve turns back in frequency.
    #[must_use]
    pub fn jumps(&self) -> Vec<Jump> {
        let turn =
            |w: &[SteadyPoint]| (w[1].frequency - w[0].frequency) * (w[2].frequency - w[1].frequency) < 0.0;
        let folds = self.points.windows(3).filter(|w| turn(w));
        folds.map(|w| Jump { frequency: w[1].frequency, amplitude: w[1].amplitude }).collect()
    }

    /// The superharmonic resonances along the curve, harmonic by harmonic: an amplitude that falls to 1/√2 of its height on both sides
    /// while the phase against that of the fundamental turns as a mode's does.
    #[must_use]
    pub fn superharmonics(&self) -> Vec<Superharmonic> {
        let count = self.points.iter().map(|point| point.harmonics.len()).min().unwrap_or(0);
        (0..count).flat_map(|index| self.resonances(index)).collect()
    }

    fn resonances(&self, index: usize) -> Vec<Superharmonic> {
        let (harmonic, points) = (2 * index + 3, &self.points);
        let amplitude = |i: usize| points[i].harmonics[index][0];
        // Against n times the fundamental's angle.
        let phase = |i: usize| points[i].harmonics[index][1] - harmonic as f64 * points[i].phase;
        let turned = |from: usize, to: usize| {
            let step = |i: usize| {
                let change = phase(i + 1) - phase(i);
                change - TAU * (change / TAU).round()
            };
            (from..to).map(step).sum::<f64>().abs()
        };
        let is_top = |i: &usize| amplitude(*i) > amplitude(i - 1) && amplitude(*i) >= amplitude(i + 1);
        let found = |top: usize| {
            // Down to 1/√2 on both sides, without anything higher on the way.
            let fallen = |i: &usize| amplitude(*i) <= FRAC_1_SQRT_2 * amplitude(top);
            let higher = |i: &usize| amplitude(*i) > amplitude(top);
            let below = (0..top).rev().find(|i| fallen(i) || higher(i)).filter(fallen)?;
            let above = (top + 1..points.len()).find(|i| fallen(i) || higher(i)).filter(fallen)?;
            let found =
                Superharmonic { harmonic, frequency: points[top].frequency, amplitude: amplitude(top) };
            (turned(below, above) >= TURN).then_some(found)
        };
        (1..points.len().saturating_sub(1)).filter(is_top).filter_map(found).collect()
    }
}
