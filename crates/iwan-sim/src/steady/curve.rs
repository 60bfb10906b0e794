//! Results of a steady forced response: points along a curve that may turn back in frequency.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use super::sweep::Control;

/// One point of a steady response.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SteadyPoint {
    /// Frequency of the excitation, Hz.
    pub frequency: f64,
    /// Amplitude of the first harmonic of the response, a displacement.
    pub amplitude: f64,
    /// Phase of the first harmonic against the excitation, rad: 0 well below a resonance, about -π/2 at the resonance.
    pub phase: f64,
    /// Amplitude of the excitation: a force, or the acceleration of the base.
    pub excitation: f64,
    /// Amplitudes and phases (rad, against n times the excitation's angle) of the harmonics n = 3, 5, …, if they were requested.
    pub harmonics: Vec<[f64; 2]>,
    /// Amplitude of the first harmonic of each joint's slip, if joints were computed. Empty for one mode with its first harmonic alone,
    /// where the joint's slip is the modal displacement.
    pub slips: Vec<f64>,
}

/// A steady response at one level, as a curve: successive points are neighbours. Where several motions are possible at one frequency, the
/// curve passes through all of them.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyCurve {
    /// The quantity whose amplitude is held constant.
    pub control: Control,
    /// The amplitude at which it is held.
    pub level: f64,
    /// The points along the curve.
    pub points: Vec<SteadyPoint>,
    /// Remarks for the reader: no resonance in the band, or where and why a computation ended.
    pub remarks: Vec<String>,
}

/// A frequency at which the response jumps when the excitation's frequency is changed slowly past it: the curve turns back there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Amplitude of the response at the turn.
    pub amplitude: f64,
}

/// A superharmonic resonance: n times the excitation's frequency meets the frequency of some mode, so that harmonic n of the response is in
/// resonance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Superharmonic {
    /// The order n of the harmonic: 3, 5, …
    pub harmonic: usize,
    /// Frequency of the excitation at which the harmonic is largest, Hz.
    pub frequency: f64,
    /// Largest amplitude of the harmonic.
    pub amplitude: f64,
}

/// Smallest turn of a harmonic's phase, rad, between the points at which its amplitude has fallen to 1/√2 of the maximum, that counts as a
/// resonance. In the resonance of a linear mode the phase turns by π/2. A harmonic that is large only because the fundamental is large
/// follows the fundamental's phase and turns by next to nothing. Half of π/2 separates the two cases.
const TURN: f64 = std::f64::consts::FRAC_PI_4;

impl SteadyCurve {
    /// The resonance: the point of the largest amplitude, or, where the response is held, of the largest ratio of response to excitation.
    /// None on an empty curve.
    #[must_use]
    pub fn peak(&self) -> Option<&SteadyPoint> {
        let size = |point: &SteadyPoint| {
            if self.control.holds_response() { point.amplitude / point.excitation } else { point.amplitude }
        };
        self.points.iter().max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// The points at which the curve turns back in frequency.
    #[must_use]
    pub fn jumps(&self) -> Vec<Jump> {
        let turn =
            |w: &[SteadyPoint]| (w[1].frequency - w[0].frequency) * (w[2].frequency - w[1].frequency) < 0.0;
        let folds = self.points.windows(3).filter(|w| turn(w));
        folds.map(|w| Jump { frequency: w[1].frequency, amplitude: w[1].amplitude }).collect()
    }

    /// The superharmonic resonances along the curve, harmonic by harmonic. At such a resonance the amplitude of the harmonic falls to 1/√2 of
    /// its maximum on both sides, and the phase against that of the fundamental turns by at least π/4.
    #[must_use]
    pub fn superharmonics(&self) -> Vec<Superharmonic> {
        let count = self.points.iter().map(|point| point.harmonics.len()).min().unwrap_or(0);
        (0..count).flat_map(|index| self.resonances(index)).collect()
    }

    fn resonances(&self, index: usize) -> Vec<Superharmonic> {
        let (harmonic, points) = (2 * index + 3, &self.points);
        let amplitude = |i: usize| points[i].harmonics[index][0];
        // Phase against n times the fundamental's angle.
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
            // The points on both sides at which the amplitude has fallen to 1/√2; none if a higher point comes first.
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
