//! What of a ring-down is compared with a model: complex amplitudes in overlapping windows.
//!
//! z_k = ∫ w(t - kH) x(t) e^(-iω_r t) dt with w = sin⁴(πt/4H) on 0 … 4H and a fixed reference frequency ω_r, H a whole
//! number of its cycles. The same linear functional is taken of record and model, so that nothing is lost to smoothing
//! or to the windows' ends; offset, slow drift, harmonics and other modes (apart by more than 3/(4H) Hz) fall outside.
//! Windows share a quarter and more of each other: [`Whitening`] makes white noise of the record white again.
//! The record is taken to be free of aliases: higher harmonics are not folded into the model's amplitudes.

use std::f64::consts::{PI, TAU};

use iwan_core::{Decay, Reversal};
use rustfft::num_complex::Complex64;

use crate::curves::Quantity;
use crate::parameters::Parameters;

/// Windows that cover a moment.
const OVERLAP: usize = 4;
/// Cycles from window to window from which on a window is a cubic over half a cycle: what is left of sin⁴ is below
/// 40/24 (π/16/cycles)⁴ at the ends of the half cycle.
const LONG: f64 = 4.0;
/// Most windows of a record: more say no more about a slow amplitude, and cost time.
const MOST: f64 = 120.0;

/// Where the windows lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Windows {
    /// ω_r, rad/s.
    pub(crate) omega: f64,
    /// Step from window to window, s.
    pub(crate) hop: f64,
    pub(crate) count: usize,
}

impl Windows {
    /// As many as a record of `seconds` holds, at least `cycles` of the reference `frequency` (Hz) apart.
    pub(crate) fn over(seconds: f64, frequency: f64, cycles: f64) -> Self {
        let cycles = cycles.max(seconds * frequency / MOST).ceil().max(1.0);
        let hop = cycles / frequency;
        let count = ((seconds / hop + 1e-9) as usize + 1).saturating_sub(OVERLAP);
        Self { omega: TAU * frequency, hop, count }
    }

    /// End of the last window, s.
    pub(crate) fn end(&self) -> f64 {
        (self.count + OVERLAP - 1) as f64 * self.hop
    }

    /// Calls `add` with each window that covers the time `t`, its weight there and the derivative of the weight.
    fn covering(&self, t: f64, mut add: impl FnMut(usize, f64, f64)) {
        let place = t / self.hop;
        if place < 0.0 {
            return;
        }
        let last = place as usize;
        let (s, c) = (0.5 * PI * (place - last as f64)).sin_cos();
        let rate = 0.25 * PI / self.hop;
        // cos 2x and sin 2x of the angle x within window last - i, a quarter turn on for each i.
        let turns = [(c, s), (-s, c), (-c, -s), (s, -c)];
        for (i, (cos, sin)) in turns.into_iter().enumerate().take(last + 1) {
            if last - i < self.count {
                let square = 0.5 * (1.0 - cos);
                add(last - i, square * square, 2.0 * square * sin * rate);
            }
        }
    }

    /// Complex amplitudes of uniform samples from t = 0.
    pub(crate) fn of_samples(&self, samples: &[f64], dt: f64) -> Vec<Complex64> {
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        let mut out = vec![Complex64::default(); self.count];
        for (n, x) in samples.iter().enumerate() {
            let t = n as f64 * dt;
            let x = Complex64::cis(-(self.omega * t).rem_euclid(TAU)) * ((x - mean) * dt);
            self.covering(t, |k, weight, _| out[k] += x * weight);
        }
        out
    }

    /// Complex amplitudes of the model's ring-down from rest at `start` = (displacement, time of the release); false when
    /// there is none. Before the release the motion is mirrored: it is a turning point.
    pub(crate) fn of_model(
        &self,
        parameters: &Parameters,
        start: (f64, f64),
        quantity: Quantity,
        stack: &mut Vec<Reversal>,
        out: &mut [Complex64],
    ) -> bool {
        let Ok((oscillator, joint)) = parameters.model() else { return false };
        let half_cycles = (2.5 * (self.end() + start.1.abs()) * parameters.frequency) as usize + 16;
        if stack.len() < half_cycles {
            stack.resize(half_cycles, Reversal::default());
        }
        let released = iwan_core::Motion::held_at(start.0);
        let Ok(mut decay) = Decay::new(&oscillator, &joint, 0.0, released, stack.as_mut_slice()) else {
            return false;
        };
        out.fill(Complex64::default());
        let long = self.hop * self.omega >= LONG * TAU;
        let (end, mut now) = (self.end(), start.1);
        while now < end {
            let first = now == start.1;
            let mut moments = Moments::default();
            let middle = now + 0.5 * PI / self.omega;
            let turned = decay.next_with(|node| {
                let (t, motion) = (start.1 + node.time, (node.displacement, node.velocity));
                if long && !first {
                    let late = t - middle;
                    moments.add(late, self.term(late, motion, node.weight, quantity));
                    return;
                }
                self.add(t, motion, node.weight, quantity, out);
                if first && node.time < start.1 {
                    self.add(start.1 - node.time, (motion.0, -motion.1), node.weight, quantity, out);
                }
            });
            let Some(turned) = turned else { return false };
            if long && !first {
                self.add_moments(middle, &moments, quantity, out);
            }
            now = start.1 + turned.time;
        }
        true
    }

    /// The integrand of a moment but for the window: x e^(-iω_r t) dt, for acceleration -v e^(-iω_r t) dt.
    fn term(&self, t: f64, (q, v): (f64, f64), seconds: f64, quantity: Quantity) -> Complex64 {
        let (sin, cos) = (self.omega * t).sin_cos();
        let x = match quantity {
            Quantity::Displacement => q,
            Quantity::Velocity => v,
            Quantity::Acceleration => -v,
        };
        Complex64::new(cos, -sin) * (x * seconds)
    }

    /// Adds a half cycle about the time `t` to the windows that cover it, these by their Taylor series.
    fn add_moments(&self, t: f64, moments: &Moments, quantity: Quantity, out: &mut [Complex64]) {
        let place = t / self.hop;
        let last = place as usize;
        let (s, c) = (0.5 * PI * (place - last as f64)).sin_cos();
        let rate = 0.5 * PI / self.hop;
        let turns = [(c, s), (-s, c), (-c, -s), (s, -c)];
        let turn = Complex64::cis(-(self.omega * t).rem_euclid(TAU));
        let m = moments.0.map(|moment| moment * turn);
        for (i, (cos, sin)) in turns.into_iter().enumerate().take(last + 1) {
            if last - i >= self.count {
                continue;
            }
            // sin⁴x = (3 - 4 cos 2x + cos 4x)/8, and its derivatives with respect to time.
            let (cos_2, sin_2) = (cos * cos - sin * sin, 2.0 * sin * cos);
            let series = [
                0.125 * (3.0 - 4.0 * cos + cos_2),
                rate * 0.25 * (2.0 * sin - sin_2),
                rate * rate * 0.5 * (cos - cos_2),
                rate.powi(3) * 0.5 * (2.0 * sin_2 - sin),
                rate.powi(4) * 0.5 * (4.0 * cos_2 - cos),
            ];
            let weighted = |s: &[f64]| m[0] * s[0] + m[1] * s[1] + m[2] * (0.5 * s[2]) + m[3] * (s[3] / 6.0);
            out[last - i] += match quantity {
                Quantity::Acceleration => {
                    weighted(&series[1..]) + weighted(&series[..4]) * Complex64::new(0.0, -self.omega)
                }
                _ => weighted(&series[..4]),
            };
        }
    }

    /// Adds a moment of the motion. Acceleration by parts: the velocity times the derivative of the weight.
    fn add(&self, t: f64, (q, v): (f64, f64), seconds: f64, quantity: Quantity, out: &mut [Complex64]) {
        let (sin, cos) = (self.omega * t).sin_cos();
        let turn = Complex64::new(cos, -sin);
        match quantity {
            Quantity::Displacement => {
                let x = turn * (q * seconds);
                self.covering(t, |k, weight, _| out[k] += x * weight);
            }
            Quantity::Velocity => {
                let x = turn * (v * seconds);
                self.covering(t, |k, weight, _| out[k] += x * weight);
            }
            Quantity::Acceleration => {
                let x = turn * (-v * seconds);
                self.covering(t, |k, weight, slope| {
                    out[k] += x * Complex64::new(slope, -self.omega * weight);
                });
            }
        }
    }
}

/// Integrals over a half cycle, times 0 to 3 powers of the time from its middle.
#[derive(Debug, Clone, Copy, Default)]
struct Moments([Complex64; 4]);

impl Moments {
    fn add(&mut self, t: f64, mut term: Complex64) {
        for moment in &mut self.0 {
            *moment += term;
            term *= t;
        }
    }
}

/// Turns amplitudes with white noise in the record into values with independent noise of equal variance.
///
/// The Cholesky factor of the windows' overlaps, a band of four: z = L y, and E|y|² = 1 for noise of density 1
/// (variance of a sample times dt).
#[derive(Debug, Clone)]
pub(crate) struct Whitening {
    rows: Vec<[f64; OVERLAP]>,
}

impl Whitening {
    pub(crate) fn new(windows: &Windows) -> Self {
        // ∫ sin⁴(x) sin⁴(x + iπ/4) over the common support, in units of H·4/π.
        let overlap: [f64; OVERLAP] = std::array::from_fn(|i| {
            let (steps, shift) = (400, i as f64 * 0.25 * PI);
            let h = (PI - shift) / f64::from(steps);
            let term = |n: i32| {
                let x = h * (f64::from(n) + 0.5);
                x.sin().powi(4) * (x + shift).sin().powi(4)
            };
            h * (0..steps).map(term).sum::<f64>() * windows.hop * 4.0 / PI
        });
        // Row k holds L[k][k-3 ..= k].
        let mut rows: Vec<[f64; OVERLAP]> = Vec::with_capacity(windows.count);
        for k in 0..windows.count {
            let mut row = [0.0; OVERLAP];
            for i in (0..OVERLAP).rev().filter(|i| *i <= k) {
                // Column j = k - i.
                let mut sum = overlap[i];
                for back in i + 1..OVERLAP.min(k + 1) {
                    let (of_k, of_j) = (row[OVERLAP - 1 - back], rows_at(&rows, &row, k - i, k, back - i));
                    sum -= of_k * of_j;
                }
                row[OVERLAP - 1 - i] = if i == 0 { sum.sqrt() } else { sum / rows[k - i][OVERLAP - 1] };
            }
            rows.push(row);
        }
        Self { rows }
    }

    /// Solves L y = z in place.
    pub(crate) fn apply(&self, z: &mut [Complex64]) {
        for k in 0..z.len() {
            let row = &self.rows[k];
            let mut sum = z[k];
            for back in 1..OVERLAP.min(k + 1) {
                sum -= z[k - back] * row[OVERLAP - 1 - back];
            }
            z[k] = sum / row[OVERLAP - 1];
        }
    }
}

/// L[j][j - back], where row `k` is the one being made.
fn rows_at(rows: &[[f64; OVERLAP]], row: &[f64; OVERLAP], j: usize, k: usize, back: usize) -> f64 {
    if j == k { row[OVERLAP - 1 - back] } else { rows[j][OVERLAP - 1 - back] }
}

#[cfg(test)]
mod tests {
    use iwan_core::{Continuum, Hysteresis, Newmark, Samples};

    use super::*;

    const MODE: Parameters =
        Parameters { frequency: 124.0, damping_ratio: 1e-3, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };

    /// Time steps of the continuum: displacement, velocity, acceleration every `dt`.
    fn motion(ratio: f64, dt: f64, samples: usize) -> [Vec<f64>; 4] {
        let (oscillator, joint) = MODE.model().unwrap();
        let law = Continuum::new(&joint);
        let mut memory = law.virgin(vec![Reversal::default(); 4096]).unwrap();
        law.advance(&mut memory, ratio * joint.phi_max());
        let fraction = 40;
        let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; (samples - 1) * fraction + 1]);
        let [displacement, velocity, acceleration, joint_force] = &mut out;
        let scheme = Newmark::prewarped(dt / fraction as f64, oscillator.omega0()).unwrap();
        let mut buffers = Samples { displacement, velocity, acceleration, joint_force };
        scheme.integrate(&oscillator, &law, &mut memory, 0.0, &[], &mut buffers).unwrap();
        out.map(|x| x.into_iter().step_by(fraction).collect())
    }

    #[test]
    fn amplitudes_of_the_model_are_those_of_its_samples() {
        let dt = 1.0 / (124.0 * 40.0);
        let joint = MODE.model().unwrap().1;
        // Windows one cycle apart take every node, those five apart take half cycles.
        for (ratio, cycles, count) in [(0.1, 1.0, 46), (2.0, 1.0, 46), (0.1, 5.0, 6), (2.0, 5.0, 6)] {
            let samples = motion(ratio, dt, 2001);
            let windows = Windows::over(2000.0 * dt, 123.0, cycles);
            assert_eq!(windows.count, count);
            for (i, quantity) in
                [Quantity::Displacement, Quantity::Velocity, Quantity::Acceleration].into_iter().enumerate()
            {
                let mut model = vec![Complex64::default(); windows.count];
                let start = (ratio * joint.phi_max(), 0.0);
                assert!(windows.of_model(&MODE, start, quantity, &mut vec![], &mut model));
                let record = windows.of_samples(&samples[i], dt);
                for (k, (a, b)) in model.iter().zip(&record).enumerate() {
                    // A residual displacement of the centre is slow, and its windows do not see it.
                    let error = (a - b).norm() / b.norm();
                    assert!(error < 2e-5, "{ratio} {cycles} {quantity:?} window {k}: {error:e}");
                }
            }
        }
    }

    #[test]
    fn a_release_between_samples_is_a_shift() {
        let dt = 1.0 / (124.0 * 400.0);
        let joint = MODE.model().unwrap().1;
        let samples = &motion(0.5, dt, 8001)[2];
        let windows = Windows::over(6000.0 * dt, 124.0, 1.0);
        for early in [30_usize, 90] {
            let record = windows.of_samples(&samples[early..], dt);
            let mut model = record.clone();
            let start = (0.5 * joint.phi_max(), -(early as f64) * dt);
            assert!(windows.of_model(&MODE, start, Quantity::Acceleration, &mut vec![], &mut model));
            for (a, b) in model.iter().zip(&record) {
                assert!((a - b).norm() < 2e-5 * b.norm());
            }
        }
    }

    #[test]
    fn whitened_noise_is_white() {
        let windows = Windows { omega: 50.0, hop: 0.1, count: 40 };
        let (dt, whitening) = (1e-3_f64, Whitening::new(&windows));
        let mut state = 1_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let (mut square, mut neighbour, repetitions) = (0.0, 0.0, 200);
        for _ in 0..repetitions {
            let samples: Vec<f64> = (0..4300).map(|_| (12.0 / dt).sqrt() * uniform()).collect();
            let mut z = windows.of_samples(&samples, dt);
            whitening.apply(&mut z);
            square += z.iter().map(Complex64::norm_sqr).sum::<f64>() / f64::from(40 * repetitions);
            neighbour +=
                z.windows(2).map(|z| (z[0].conj() * z[1]).re).sum::<f64>() / f64::from(39 * repetitions);
        }
        // Density 1 in all: ½ in each quadrature.
        assert!((square - 1.0).abs() < 0.05 && neighbour.abs() < 0.05, "{square} {neighbour}");
    }
}
