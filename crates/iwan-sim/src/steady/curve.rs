//! What a steady forced response returns: points along a curve that may turn back in frequency.

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
}
