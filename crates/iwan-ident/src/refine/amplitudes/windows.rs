//! The part of a ring-down that is compared with a model: complex amplitudes in overlapping windows.
//!
//! z_k = ∫ w(t - kH) x(t) e^(-iω_r t) dt with w = sin⁴(πt/4H) on 0 … 4H and a fixed reference frequency ω_r, of which H is a whole number of cycles.
//! The same linear functional is taken of record and model, so that nothing is lost to smoothing or to the windows' ends; offset, slow drift,
//! harmonics and other modes (more than 3/(4H) Hz away) fall outside. Neighbouring windows share a quarter and more of their length, which correlates
//! the noise of their amplitudes: [`Whitening`](super::whitening::Whitening) makes white noise of the record white again. The record is taken to be
//! free of aliases: higher harmonics are not folded into the model's amplitudes.

use std::f64::consts::{PI, TAU};

use rustfft::num_complex::Complex64;
use serde::{Deserialize, Serialize};

use crate::curves::Quantity;
use crate::turn::{cosine_and_sine, turn};

/// Number of windows that cover any one moment: sin⁴ windows shifted by a quarter of their length sum to a constant, so that no moment counts more
/// than another.
pub(crate) const OVERLAP: usize = 4;
/// Most windows of a record: more say no more about a slowly varying amplitude, and cost time. Longer records have longer windows.
const MOST: f64 = 120.0;

/// Longest record without noise, in cycles, whose half cycles are all computed one by one: a judgement between time and error. Longer records without
/// noise, which only simulations make, keep the error of the tables.
const MOST_WITHOUT_TABLES: f64 = 1000.0;

/// Where the windows lie.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(in crate::refine) struct Windows {
    /// Reference frequency ω_r, rad/s.
    pub(in crate::refine) omega: f64,
    /// Step H from window to window, s.
    pub(in crate::refine) hop: f64,
    pub(in crate::refine) count: usize,
    /// Whether half cycles of a model are taken from tables where they are many.
    pub(in crate::refine) tables: bool,
}

impl Windows {
    /// As many windows as a record of `seconds` holds, at least `cycles` of the reference `frequency` (Hz) apart.
    pub(in crate::refine) fn over(seconds: f64, frequency: f64, cycles: f64) -> Self {
        let cycles = cycles.max(seconds * frequency / MOST).ceil().max(1.0);
        let hop = cycles / frequency;
        let count = ((seconds / hop + 1e-9) as usize + 1).saturating_sub(OVERLAP);
        Self { omega: TAU * frequency, hop, count, tables: true }
    }

    /// From now on half cycles of a model are computed one by one, where the record is not too long for that.
    pub(in crate::refine) fn leave_tables(&mut self) {
        self.tables &= self.end() * self.omega > MOST_WITHOUT_TABLES * TAU;
    }

    /// End of the last window, s.
    pub(in crate::refine) fn end(&self) -> f64 {
        (self.count + OVERLAP - 1) as f64 * self.hop
    }

    /// Index of the last window that has begun by the time `t` (s, not negative), and cosine and sine of the angle 2x = π(t - kH)/2H in that window.
    fn phase_at(&self, t: f64) -> (usize, [f64; 2]) {
        let place = t / self.hop;
        let last = place as usize;
        (last, cosine_and_sine(0.5 * PI * (place - last as f64)))
    }

    /// Complex amplitudes of uniform samples from t = 0, less their mean, one per window; `dt` in s.
    pub(in crate::refine) fn of_samples(&self, samples: &[f64], dt: f64) -> Vec<Complex64> {
        let mean = samples.iter().sum::<f64>() / samples.len() as f64;
        let mut out = vec![Complex64::default(); self.count];
        let mut gathered = Gathered::default();
        for (n, x) in samples.iter().enumerate() {
            self.gather(n as f64 * dt, (x - mean) * dt, Quantity::Displacement, &mut gathered, &mut out);
        }
        self.spread_gathered(&gathered, Quantity::Displacement, &mut out);
        out
    }

    /// Adds the moments of a half cycle about the time `t` (s) to the windows that cover it, with each window's Taylor series about `t`.
    pub(super) fn add_moments(&self, t: f64, moments: &Moments, quantity: Quantity, out: &mut [Complex64]) {
        let [m0, m1, m2, m3] = moments.0;
        let integrals = |rate: f64, [c, s]: [f64; 2]| {
            let even = m0 - m2 * (0.5 * rate * rate);
            let odd = (m1 - m3 * (rate * rate / 6.0)) * rate;
            [even * c - odd * s, even * s + odd * c]
        };
        self.add_following(t, integrals, quantity, out);
    }

    /// Adds integrals of a signal near or behind the time `t` (s), with τ as the time from there. `integrals` is given a rate ν (rad/s) and cosine and sine of an angle θ, and
    /// gives the integrals of the signal times cos(θ + ντ) e^(-iω_r τ) and times sin(θ + ντ) e^(-iω_r τ).
    pub(super) fn add_following(
        &self,
        t: f64,
        integrals: impl Fn(f64, [f64; 2]) -> [Complex64; 2],
        quantity: Quantity,
        out: &mut [Complex64],
    ) {
        let (last, [c, s]) = self.phase_at(t);
        let rate = 0.5 * PI / self.hop;
        let parts = |rate: f64, angle: [f64; 2]| {
            let [cosine, sine] = integrals(rate, angle);
            [cosine, -sine]
        };
        let parts = Parts {
            mean: integrals(0.0, [1.0, 0.0])[0],
            single: parts(rate, [c, s]),
            double: parts(2.0 * rate, [c * c - s * s, 2.0 * s * c]),
        };
        self.spread(last, parts, turn(self.omega * t), quantity, out);
    }

    /// Adds integrals to the last window that has begun and to the three before it. A window is sin⁴x = ⅜ - ½ cos 2x + ⅛ cos 4x, and the angle 2x in
    /// each window is a quarter turn ahead of the angle in the next one.
    fn spread(
        &self,
        last: usize,
        Parts { mean, mut single, double: [double, double_on] }: Parts,
        turn: Complex64,
        quantity: Quantity,
        out: &mut [Complex64],
    ) {
        let (mut mean, mut double) = (mean * 0.375, double * 0.125);
        if quantity == Quantity::Acceleration {
            // Integration by parts: minus iω_r times the same integrals, and those with the windows' derivatives.
            let (minus, rate) = (Complex64::new(0.0, -self.omega), 0.5 * PI / self.hop);
            mean *= minus;
            single = [single[0] * minus + single[1] * rate, single[1] * minus - single[0] * rate];
            double = double * minus + double_on * (0.25 * rate);
        }
        let (mean, double) = (mean * turn, double * turn);
        let single = single.map(|x| x * (0.5 * turn));
        let (above, below) = (mean + double, mean - double);
        let added = [above - single[0], below - single[1], above + single[0], below + single[1]];
        for (i, added) in added.into_iter().enumerate().take(last + 1) {
            if let Some(out) = out.get_mut(last - i) {
                *out += added;
            }
        }
    }

    /// Adds x dt at the time `t` (s) to what is gathered, which is handed on to the windows as soon as another window begins. Times before 0 are left
    /// out.
    pub(super) fn gather(
        &self,
        t: f64,
        x: f64,
        quantity: Quantity,
        gathered: &mut Gathered,
        out: &mut [Complex64],
    ) {
        if t < 0.0 {
            return;
        }
        let (last, [c, s]) = self.phase_at(t);
        if last != gathered.last {
            self.spread_gathered(gathered, quantity, out);
            *gathered = Gathered { last, ..Gathered::default() };
        }
        let (x, Parts { mean, single, double }) = (turn(self.omega * t) * x, &mut gathered.parts);
        *mean += x;
        single[0] += x * c;
        single[1] -= x * s;
        double[0] += x * (c * c - s * s);
        double[1] -= x * (2.0 * s * c);
    }

    pub(super) fn spread_gathered(&self, gathered: &Gathered, quantity: Quantity, out: &mut [Complex64]) {
        self.spread(gathered.last, gathered.parts, Complex64::new(1.0, 0.0), quantity, out);
    }
}

/// Integrals of the signal times e^(-iω_r t): by itself, times the cosine of the last window's angle 2x and of the angle a quarter turn ahead, and
/// the same for 4x.
#[derive(Debug, Clone, Copy, Default)]
struct Parts {
    mean: Complex64,
    single: [Complex64; 2],
    double: [Complex64; 2],
}

/// Integrals over a stretch of time in which no window begins; `last` is the window that began last before it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Gathered {
    last: usize,
    parts: Parts,
}

/// Integrals over a half cycle of the signal times powers 0 to 3 of the time from the middle of the half cycle.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Moments(pub(super) [Complex64; 4]);

impl Moments {
    pub(super) fn add(&mut self, t: f64, mut term: Complex64) {
        for moment in &mut self.0 {
            *moment += term;
            term *= t;
        }
    }
}
