//! Half cycles in micro-slip under a power law: one number tells them all.
//!
//! With F_virgin(u) = K_T u - C u^p the energy gained is P(y) = s y - ½ω² y² + ρ y^(p+1), and with P(L) = W
//! the phase velocity is Ω² = ω² [1 - ε τ(θ)] and a viscous term, τ = (1 - x^p)/(1 - x), x = sin²(θ/2). It depends on
//! the relative softening ε = 2ρ L^(p-1)/ω² alone, and so do the duration and the damper's work: both are
//! tabled once per mode as polynomials in ε.

use core::f64::consts::PI;

use crate::backbone::PowerLaw;
use crate::phase::{MATRIX, NODES, Panel, Phase, RULE};

/// Most terms of the polynomials.
const TERMS: usize = 16;
/// Fixed-point passes stop when nothing changes by more than this share.
pub(crate) const PASS_TOLERANCE: f64 = 1e-12;
/// … and after this many at the latest.
pub(crate) const MOST_PASSES: u32 = 60;
/// Largest relative error of the polynomials at the check points.
const TABLE_TOLERANCE: f64 = 1e-11;

/// The micro-slip half cycles of a mode.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MicroSlip {
    /// ω² = K_∞ + K_T.
    omega_squared: f64,
    viscous: f64,
    rho: f64,
    /// p = χ + 2.
    exponent: f64,
    /// Largest L in micro-slip, 2 φ_max.
    longest: f64,
    /// Joint force gained over L, without direction: K_T L - drop·L^p.
    stiffness: f64,
    drop: f64,
    /// τ at the nodes.
    tau: [f64; NODES],
    /// Binomial coefficients of (1 + e)^(p-1).
    series: [f64; 8],
    /// Duration and damping W/L² over ε, for argument ε·to_unit - 1 from -1 to 1.
    to_unit: f64,
    terms: usize,
    durations: [f64; TERMS],
    dampings: [f64; TERMS],
    damping_slopes: [f64; TERMS],
}

/// A half cycle found: what the next one starts from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Travel {
    pub(crate) length: f64,
    /// W/L².
    pub(crate) damping: f64,
    pub(crate) duration: f64,
    /// Joint force gained, without direction.
    pub(crate) force: f64,
    /// L^(p-1).
    power: f64,
    /// L over the L before, and the same for the one before.
    ratio: f64,
    ratio_before: f64,
    /// Series updates since the power was last taken in full.
    age: u32,
}

impl MicroSlip {
    /// None when the softening is too strong for short polynomials (K_∞ next to nothing).
    pub(crate) fn new(k_inf: f64, viscous: f64, law: &PowerLaw) -> Option<Self> {
        let p = law.exponent;
        let omega_squared = k_inf + law.stiffness;
        let rho = 4.0 * law.coefficient / ((p + 1.0) * libm::pow(2.0, p + 1.0));
        let longest = 2.0 * law.limit;
        let steepest = 2.0 * rho * libm::pow(longest, p - 1.0) / omega_squared;
        let tau = core::array::from_fn(|i| (1.0 - libm::exp(p * LOG_SHARE[i])) / SHARE[NODES - 1 - i]);
        // Chebyshev coefficients fall like (ε p / 4)^n at least.
        let decay = libm::log(4.0 / (steepest * p));
        let terms = (libm::ceil(32.0 / decay.max(0.1)) as usize).clamp(3, TERMS);
        let mut micro = Self {
            omega_squared,
            viscous,
            rho,
            exponent: p,
            longest,
            stiffness: law.stiffness,
            drop: 2.0 * law.coefficient / libm::pow(2.0, p),
            tau,
            series: binomial(p - 1.0),
            to_unit: 2.0 / steepest,
            terms,
            durations: [0.0; TERMS],
            dampings: [0.0; TERMS],
            damping_slopes: [0.0; TERMS],
        };
        micro.fill_table();
        let good = [0.05, 0.97].iter().all(|share| {
            let softening = share * steepest;
            let (duration, damping) = micro.shape_by_quadrature(softening);
            let near = |found: f64, exact: f64| libm::fabs(found - exact) <= TABLE_TOLERANCE * exact;
            near(micro.duration(softening), duration) && near(micro.damping(softening).0, damping)
        });
        good.then_some(micro)
    }

    /// Ω at the nodes for the softening ε, the damper's part by fixed-point passes.
    fn omega(&self, softening: f64) -> [f64; NODES] {
        let base: [f64; NODES] =
            core::array::from_fn(|i| self.omega_squared * (1.0 - softening * self.tau[i]));
        let mut omega = base.map(libm::sqrt);
        if self.viscous == 0.0 {
            return omega;
        }
        for _ in 0..MOST_PASSES {
            let mut lost = [0.0; NODES];
            for (column, o) in COUPLING.iter().zip(&omega) {
                lost.iter_mut().zip(column).for_each(|(s, c)| *s += c * o);
            }
            let next: [f64; NODES] = core::array::from_fn(|i| libm::sqrt(base[i] + self.viscous * lost[i]));
            let change = omega.iter().zip(&next).fold(0.0_f64, |m, (a, b)| m.max(libm::fabs(a - b)));
            omega = next;
            if change <= PASS_TOLERANCE * omega[0] {
                break;
            }
        }
        omega
    }

    /// Duration and W/L² = ¼ c ∫Ω sin² of a half cycle, by quadrature.
    fn shape_by_quadrature(&self, softening: f64) -> (f64, f64) {
        let panel = Panel { omega: self.omega(softening), ..Panel::WHOLE };
        let work: f64 = (0..NODES).map(|i| WORK[i] * panel.omega[i]).sum();
        (panel.duration(), 0.25 * self.viscous * work)
    }

    /// Tabled damping W/L², and its derivative times ε.
    #[inline]
    fn damping(&self, softening: f64) -> (f64, f64) {
        let s = softening * self.to_unit - 1.0;
        (sixteen(&self.dampings, s), sixteen(&self.damping_slopes, s) * (s + 1.0))
    }

    /// Tabled duration.
    #[inline]
    fn duration(&self, softening: f64) -> f64 {
        sixteen(&self.durations, softening * self.to_unit - 1.0)
    }

    /// ε of a travel.
    #[inline]
    fn softening(&self, travel: &Travel) -> f64 {
        2.0 * self.rho / self.omega_squared * travel.power
    }

    /// Interpolation at Chebyshev nodes, turned into powers of the argument.
    fn fill_table(&mut self) {
        let n = self.terms;
        // Chebyshev coefficients from T_{k+1}(x) = 2 x T_k(x) - T_{k-1}(x) at the nodes.
        let mut coefficients = [(0.0, 0.0); TERMS];
        for i in 0..n {
            let x = libm::cos(PI * (i as f64 + 0.5) / n as f64);
            let value = self.shape_by_quadrature((1.0 + x) / self.to_unit);
            let (mut now, mut before) = (1.0, x);
            for (k, c) in coefficients[..n].iter_mut().enumerate() {
                let weight = if k == 0 { now } else { 2.0 * now } / n as f64;
                *c = (c.0 + weight * value.0, c.1 + weight * value.1);
                (now, before) = (2.0 * x * now - before, now);
            }
        }
        // The polynomials themselves by the same recurrence, as coefficients of powers.
        let (mut now, mut before) = ([0.0; TERMS], [0.0; TERMS]);
        now[0] = 1.0;
        for (k, c) in coefficients[..n].iter().enumerate() {
            let mut next = [0.0; TERMS];
            for j in 0..n {
                self.durations[j] += c.0 * now[j];
                self.dampings[j] += c.1 * now[j];
                next[j] =
                    if j > 0 { if k == 0 { now[j - 1] } else { 2.0 * now[j - 1] } } else { 0.0 } - before[j];
            }
            (before, now) = (now, next);
        }
        for j in 1..n {
            self.damping_slopes[j - 1] = j as f64 * self.dampings[j];
        }
    }

    /// The half cycle under the pull `s`: the root of s - (½ω² + damping) L + ρ L^p, which is P(L) = W over L.
    /// `last` is the half cycle before and becomes this one; beyond micro-slip it stays, and the answer is false.
    /// Convex and falling, so Newton's method needs no guard.
    #[inline]
    pub(crate) fn travel(&self, pull: f64, last: &mut Travel) -> bool {
        const MOST: u32 = 60;
        let mut at = if last.age < Travel::OLDEST {
            last.continued(&self.series, self.exponent - 1.0)
        } else {
            self.first_guess(pull, last)
        };
        let power = self.exponent - 1.0;
        for _ in 0..MOST {
            let (damping, damping_slope) = self.damping(self.softening(&at));
            let linear = 0.5 * self.omega_squared + damping;
            let steep = self.exponent * self.rho * at.power;
            let inverse = 1.0 / (linear - steep + power * damping_slope);
            let newton = (pull / at.length - linear + self.rho * at.power) * inverse;
            // Halley's correction: the second derivative costs nothing here.
            let change = newton * (1.0 + 0.5 * power * steep * inverse * newton);
            // The error is cubed: nothing is left to gain.
            if libm::fabs(change) < 1e-4 {
                at = at.nudged(change, &self.series);
                at.damping = damping + power * damping_slope * change;
                break;
            }
            at = at.moved(change, &self.series, power);
        }
        if !(at.length > 0.0 && at.length <= self.longest) {
            return false;
        }
        at.duration = self.duration(self.softening(&at));
        at.force = (self.stiffness - self.drop * at.power) * at.length;
        *last = at;
        true
    }

    #[cold]
    fn first_guess(&self, pull: f64, last: &Travel) -> Travel {
        let length = if last.is_some() { last.length * last.ratio } else { 2.0 * pull / self.omega_squared };
        let length = length.min(self.longest);
        let power = libm::pow(length, self.exponent - 1.0);
        Travel {
            length,
            damping: 0.0,
            duration: 0.0,
            force: 0.0,
            power,
            ratio: 1.0,
            ratio_before: 1.0,
            age: 0,
        }
    }

    /// Ω over the half cycle, for dense output.
    pub(crate) fn phase(&self, travel: &Travel) -> Phase {
        Phase::single(self.omega(self.softening(travel)))
    }
}

/// x = sin²(θ/2) at the nodes: the share y/L of the travel.
const SHARE: [f64; NODES] = {
    let mut share = [0.0; NODES];
    let mut i = 0;
    while i < NODES {
        let s = sine(0.25 * PI * (1.0 + RULE.nodes[i]));
        share[i] = s * s;
        i += 1;
    }
    share
};

/// ln x at the nodes.
const LOG_SHARE: [f64; NODES] = {
    let mut log = [0.0; NODES];
    let mut i = 0;
    while i < NODES {
        log[i] = logarithm(SHARE[i]);
        i += 1;
    }
    log
};

/// ∫Ω sin²θ dθ from 0 to π is the sum over these times Ω at the nodes; sin²θ = 4 x (1 - x).
const WORK: [f64; NODES] = {
    let mut weight = [0.0; NODES];
    let mut i = 0;
    while i < NODES {
        weight[i] = 0.5 * PI * RULE.weights[i] * 4.0 * SHARE[i] * SHARE[NODES - 1 - i];
        i += 1;
    }
    weight
};

/// The damper's work up to node i enters there: Ω_i² gains c Σ_j coupling[j][i] Ω_j.
const COUPLING: [[f64; NODES]; NODES] = {
    let mut matrix = [[0.0; NODES]; NODES];
    let mut i = 0;
    while i < NODES {
        let mut j = 0;
        while j < NODES {
            let share = SHARE[i] * RULE.weights[j] - MATRIX[i][j];
            let ratio = SHARE[j] * SHARE[NODES - 1 - j] / (SHARE[i] * SHARE[NODES - 1 - i]);
            matrix[j][i] = PI * share * ratio;
            j += 1;
        }
        i += 1;
    }
    matrix
};

/// sin x for 0 <= x <= π/2 by its Taylor series.
const fn sine(x: f64) -> f64 {
    let (mut term, mut sum, mut k) = (x, 0.0, 1.0);
    while k < 30.0 {
        sum += term;
        term = -term * x * x / ((k + 1.0) * (k + 2.0));
        k += 2.0;
    }
    sum
}

/// ln x for 0 < x <= 1 from the series of artanh, the powers of two taken out.
const fn logarithm(x: f64) -> f64 {
    let (mut m, mut twos) = (x, 0.0);
    while m < 0.7 {
        m *= 2.0;
        twos += 1.0;
    }
    let z = (m - 1.0) / (m + 1.0);
    let (mut term, mut sum, mut k) = (2.0 * z, 0.0, 1.0);
    while k < 60.0 {
        sum += term / k;
        term *= z * z;
        k += 2.0;
    }
    sum - twos * core::f64::consts::LN_2
}

/// Coefficients of e, e², … in (1 + e)^p.
fn binomial(p: f64) -> [f64; 8] {
    let mut coefficient = 1.0;
    core::array::from_fn(|k| {
        coefficient *= (p - k as f64) / (k as f64 + 1.0);
        coefficient
    })
}

/// Σ c_k x^k of eight terms, pairs first: short chains for the processor.
#[inline]
fn eight(c: &[f64; 8], x: f64) -> f64 {
    let x2 = x * x;
    ((c[0] + c[1] * x) + (c[2] + c[3] * x) * x2) + ((c[4] + c[5] * x) + (c[6] + c[7] * x) * x2) * (x2 * x2)
}

/// The same of sixteen.
#[inline]
fn sixteen(c: &[f64; TERMS], x: f64) -> f64 {
    let (low, high) = c.split_at(8);
    let half = |c: &[f64]| eight(&core::array::from_fn(|k| c[k]), x);
    let x4 = (x * x) * (x * x);
    half(low) + half(high) * (x4 * x4)
}

impl Travel {
    /// Rounding grows by a unit in the last place per update: this many are harmless.
    const OLDEST: u32 = 64;

    /// Nothing to start from.
    pub(crate) const NONE: Self = Self {
        length: 0.0,
        damping: 0.0,
        duration: 0.0,
        force: 0.0,
        power: 0.0,
        ratio: 1.0,
        ratio_before: 1.0,
        age: Self::OLDEST,
    };

    /// Whether there is a half cycle in micro-slip.
    #[inline]
    pub(crate) fn is_some(&self) -> bool {
        self.length > 0.0
    }

    /// The next travel if the ratio of successive travels goes on changing as it did.
    #[inline]
    fn continued(&self, series: &[f64; 8], power: f64) -> Self {
        let next = 2.0 * self.ratio - self.ratio_before;
        let fresh = Self { ratio: 1.0, ratio_before: self.ratio, age: self.age + 1, ..*self };
        fresh.moved(next - 1.0, series, power)
    }

    /// The travel (1 + e) L for |e| < 1e-4, where four terms of the series are exact.
    #[inline]
    fn nudged(self, e: f64, c: &[f64; 8]) -> Self {
        let (length, ratio) = (self.length + self.length * e, self.ratio + self.ratio * e);
        let growth = (c[0] * e + c[1] * (e * e)) + (c[2] + c[3] * e) * (e * e * e);
        Self { length, ratio, power: self.power + self.power * growth, ..self }
    }

    /// The travel (1 + e) L, with (1 + e)^(p-1) by its binomial series where that is exact.
    #[inline]
    fn moved(self, e: f64, series: &[f64; 8], power: f64) -> Self {
        let (length, ratio) = (self.length + self.length * e, self.ratio + self.ratio * e);
        if libm::fabs(e) < 0.02 {
            return Self { length, ratio, power: self.power + self.power * (e * eight(series, e)), ..self };
        }
        Self { length, ratio, power: libm::pow(length, power), age: 0, ..self }
    }
}
