//! Frequency responses of a measurement, with what is needed to model the records that they come from.

use crate::measure::{Freedom, Motion, Pulse};
use crate::number::{Complex, I, complex};

/// A response over a force, against frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Function {
    /// Name of the channel that measured the response.
    pub name: String,
    /// Where the response was measured.
    pub response: Freedom,
    /// Where the force acted.
    pub force: Freedom,
    /// Number of hits that were averaged.
    pub hits: usize,
    /// Response over force at each line, motion per unit of force.
    pub values: Vec<Complex>,
    /// Coherence at each line, 0 to 1; empty below two hits, where it is 1 by construction.
    pub coherence: Vec<f64>,
    /// Variance of `values` at each line, real and imaginary part together; empty below two hits.
    pub variance: Vec<f64>,
}

/// Frequency responses at the lines `0, step, 2 step, …`.
#[derive(Debug, Clone, PartialEq)]
pub struct FrequencyResponses {
    /// Distance of lines, Hz.
    pub step: f64,
    /// All pairs of response and force.
    pub functions: Vec<Function>,
    /// What the responses measure.
    pub motion: Motion,
    /// Root mean square of the force's spectrum over the hits, force times s; empty where it is not known.
    pub force: Vec<f64>,
    /// Decay of the exponential window, 1/s: the responses are those at s = iω + decay.
    pub decay: f64,
    /// The records that the responses come from; none for responses that other programs computed.
    pub record: Option<FiniteRecord>,
}

impl FrequencyResponses {
    /// Number of lines.
    #[must_use]
    pub fn lines(&self) -> usize {
        self.functions.first().map_or(0, |f| f.values.len())
    }

    /// Frequency of a line, Hz.
    #[must_use]
    pub fn frequency(&self, line: usize) -> f64 {
        line as f64 * self.step
    }

    /// Root of the mean square over all functions at each line: the composite response.
    #[must_use]
    pub fn composite(&self) -> Vec<f64> {
        let n = self.functions.len().max(1) as f64;
        let at = |k: usize| self.functions.iter().map(|f| f.values[k].norm_sqr()).sum::<f64>();
        (0..self.lines()).map(|k| (at(k) / n).sqrt()).collect()
    }
}

/// Largest number of pulses whose form is kept: pulses of one hammer differ in height more than in form.
const MOST: usize = 16;

/// The part of a free decay that the end of a record cuts off.
///
/// The discrete Fourier transform of a response that still moves when the record ends has a known form: at the lines
/// k/T of a record of length T, a decay c e^(λt) contributes c/(s-λ) less c e^((λ-s)T) Δt/(1 - e^((λ-s)Δt)), and c is the residue times
/// the force's transform at λ. With that in the model no window is needed, and so none adds damping.
#[derive(Debug, Clone, PartialEq)]
pub struct FiniteRecord {
    /// Length of the records, s.
    pub length: f64,
    /// Sampling interval, s.
    pub dt: f64,
    /// Force pulses before the free decay; empty for free decays from the first sample on.
    pulses: Vec<Pulse>,
    /// Weight of each pulse at each line: the conjugate of its windowed spectrum over the sum of squares of all pulses' spectra there.
    weights: Vec<Vec<Complex>>,
}

impl FiniteRecord {
    /// For records of hits, from their pulses and the windowed spectra of these at all lines.
    pub(super) fn new(pulses: &[Pulse], spectra: &[Vec<Complex>]) -> Self {
        let stride = pulses.len().div_ceil(MOST);
        let chosen: Vec<usize> = (0..pulses.len()).step_by(stride).collect();
        let lines = spectra[0].len();
        let power =
            |k: usize| chosen.iter().map(|h| spectra[*h][k].norm_sqr()).sum::<f64>().max(f64::MIN_POSITIVE);
        let total: Vec<f64> = (0..lines).map(power).collect();
        let weight = |h: &usize| spectra[*h].iter().zip(&total).map(|(f, p)| f.conj() / *p).collect();
        Self {
            length: pulses[0].samples as f64 * pulses[0].dt,
            dt: pulses[0].dt,
            weights: chosen.iter().map(weight).collect(),
            pulses: chosen.iter().map(|h| pulses[*h].clone()).collect(),
        }
    }

    /// For free decays from the first of `samples` samples on, whose "responses" are the transforms themselves.
    #[must_use]
    pub fn free(samples: usize, dt: f64) -> Self {
        Self { length: samples as f64 * dt, dt, pulses: Vec::new(), weights: Vec::new() }
    }

    /// For records of `length` seconds whose hits were not kept: an impulse `delay` seconds after the first sample stands for the hammer. The difference from
    /// the true pulse is smooth in frequency, and goes into the terms for what lies outside the band. The number of `lines`, of responses that reach the
    /// Nyquist frequency, gives the sampling interval; `decay` is that of their exponential window, 1/s.
    #[must_use]
    pub fn of_impulse(length: f64, lines: usize, delay: f64, decay: f64) -> Self {
        let samples = 2 * lines.saturating_sub(1).max(1);
        let dt = length / samples as f64;
        let start = ((delay / dt).round().max(0.0) as usize).min(samples - 1);
        let pulse = Pulse { start, force: vec![dt.recip()], samples, dt };
        let spectrum: Vec<Complex> =
            (0..lines).map(|k| pulse.transform(laplace(k as f64 / length, decay)).0).collect();
        Self::new(&[pulse], &[spectrum])
    }

    /// Whether the records are free decays without a force.
    #[must_use]
    pub fn is_free(&self) -> bool {
        self.pulses.is_empty()
    }

    /// The transforms of the force pulses at a pole, ready for use at all lines.
    pub(crate) fn at(&self, pole: Complex) -> PoleInRecord<'_> {
        let forces = self.pulses.iter().map(|p| p.transform(pole)).collect();
        let over = self.pulses.iter().map(|p| p.start + p.force.len()).max().unwrap_or(0) as f64 * self.dt;
        PoleInRecord { record: self, pole, turns: self.turns(pole), quiet: self.length - over, forces }
    }

    /// The factors e^(s Δt) and e^(s T).
    pub(crate) fn turns(&self, s: Complex) -> [Complex; 2] {
        [(s * self.dt).exp(), (s * self.length).exp()]
    }
}

/// Where a decay falls by more than e to this power between the end of the last pulse and that of the record, it has ended there: what is cut off is 1e-20 of it, far below
/// rounding.
const ENDED: f64 = -46.0;

/// What the end of the record cuts off one mode, ready for use at all lines.
pub(crate) struct PoleInRecord<'a> {
    pub(crate) record: &'a FiniteRecord,
    pole: Complex,
    /// e^(λ Δt) and e^(λ T).
    turns: [Complex; 2],
    /// Time from the end of the last pulse to that of the record, s.
    quiet: f64,
    forces: Vec<(Complex, Complex)>,
}

impl PoleInRecord<'_> {
    /// The contributions of unit residues of the pole and of its conjugate at a line, each with its derivative with respect to its pole. `back` holds e^(-s Δt) and
    /// e^(-s T).
    pub(crate) fn pair(&self, line: usize, s: Complex, back: [Complex; 2]) -> [(Complex, Complex); 2] {
        let (dt, length) = (self.record.dt, self.record.length);
        let once = |turn: Complex| inverse(1.0 - turn) * dt;
        let turned = [self.turns[0] * back[0], self.turns[1] * back[1]];
        let conjugate = [self.turns[0].conj() * back[0], self.turns[1].conj() * back[1]];
        if self.record.is_free() {
            let free = |[turn, rest]: [Complex; 2]| {
                let once = once(turn);
                let value = once * (1.0 - rest);
                (value, value * (turn * once) - once * rest * length)
            };
            return [free(turned), free(conjugate)];
        }
        let [direct, direct_conjugate] = [inverse(s - self.pole), inverse(s - self.pole.conj())];
        if (self.pole.re - s.re) * self.quiet < ENDED {
            return [(direct, direct * direct), (direct_conjugate, direct_conjugate * direct_conjugate)];
        }
        let cut_off = |direct: Complex, [turn, rest]: [Complex; 2], (share, moment): (Complex, Complex)| {
            let once = once(turn);
            let tail = rest * once;
            (direct - tail * share, direct * direct - tail * (share * (turn * once + length) - moment))
        };
        let [own, other] = self.shares(line);
        [cut_off(direct, turned, own), cut_off(direct_conjugate, conjugate, other)]
    }

    /// The pulses' transforms at the pole and at its conjugate, weighted as at a line, each with its derivative. The unweighted transform at the conjugate is the conjugate of
    /// that at the pole, so that both come from the same four products.
    fn shares(&self, line: usize) -> [(Complex, Complex); 2] {
        let (mut share, mut moment) = ([0.0; 4], [0.0; 4]);
        for ((f, m), weights) in self.forces.iter().zip(&self.record.weights) {
            let w = weights[line];
            for (sums, x) in [(&mut share, f), (&mut moment, m)] {
                sums[0] += w.re * x.re;
                sums[1] += w.im * x.im;
                sums[2] += w.re * x.im;
                sums[3] += w.im * x.re;
            }
        }
        let own = |x: [f64; 4]| complex(x[0] - x[1], x[2] + x[3]);
        let conjugate = |x: [f64; 4]| complex(x[0] + x[1], x[3] - x[2]);
        [(own(share), own(moment)), (conjugate(share), conjugate(moment))]
    }
}

/// The inverse of a complex number, with one division.
fn inverse(z: Complex) -> Complex {
    let power = z.norm_sqr().recip();
    complex(z.re * power, -z.im * power)
}

/// Laplace variable s = iω + decay at a frequency (Hz), 1/s.
pub(crate) fn laplace(frequency: f64, decay: f64) -> Complex {
    I * (std::f64::consts::TAU * frequency) + decay
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_those_of_differences() {
        let pulse = Pulse { start: 5, force: vec![1.0, 3.0, 2.0], samples: 400, dt: 1e-2 };
        let spectrum: Vec<Complex> =
            (0..20).map(|k| pulse.transform(laplace(f64::from(k) / 4.0, 0.0)).0).collect();
        let records = [FiniteRecord::new(&[pulse], &[spectrum]), FiniteRecord::free(400, 1e-2)];
        let (pole, h, s) = (complex(-0.3, 20.0), 1e-6, laplace(13.0 / 4.0, 0.0));
        for record in &records {
            let at = |p: Complex| record.at(p).pair(13, s, record.turns(-s)).map(|x| x.0);
            let slopes = record.at(pole).pair(13, s, record.turns(-s)).map(|x| x.1);
            let (above, below) = (at(pole + h), at(pole - h));
            for (i, slope) in slopes.into_iter().enumerate() {
                let found = (above[i] - below[i]) / (2.0 * h);
                assert!((slope - found).norm() < 1e-6 * slope.norm(), "{slope} {found}");
            }
            // What belongs to the conjugate is what the conjugate would have if it were the pole.
            let (conjugate, alone) = (at(pole)[1], at(pole.conj())[0]);
            assert!((conjugate - alone).norm() < 1e-13 * alone.norm(), "{conjugate} {alone}");
        }
    }

    #[test]
    fn a_free_decay_that_is_cut_off_is_exact() {
        let (pole, dt, n) = (complex(-0.05, 30.0), 1e-2, 300);
        let record = FiniteRecord::free(n, dt);
        for line in [3, 14, 40] {
            let s = laplace(f64::from(line) / (n as f64 * dt), 0.0);
            let sum: Complex = (0..n).map(|k| ((pole - s) * (k as f64 * dt)).exp() * dt).sum();
            let [(value, _), _] = record.at(pole).pair(line as usize, s, record.turns(-s));
            assert!((value - sum).norm() < 1e-11 * sum.norm(), "{line}: {value} {sum}");
        }
    }
}
