//! Half cycles in micro-slip under a power law. One number, the relative softening, determines each of them.
//!
//! With F_virgin(u) = K_T u - C u^p the energy gained is P(y) = s y - ½ω² y² + ρ y^(p+1). With P(L) = W the square of the phase velocity is
//! Ω² = ω² [1 - ε τ(θ)] plus a viscous term, with τ = (1 - x^p)/(1 - x) and x = sin²(θ/2). It depends on the relative softening ε = 2ρ
//! L^(p-1)/ω² alone, and so do the duration and the damper's work.
//!
//! The next half cycle also depends on ε alone. With the damping W/L² the pull at the start is s = [½ω² (1 - ε) + W/L²] L. The pull at the
//! end, in the opposite direction, is [½ω² (1 - p ε) - W/L²] L. That is the pull of the next half cycle, so the ratio of the next travel to
//! L is a function of ε as well. All four functions (duration, damping, ratio of travels, ratio of softenings) are tabled once per mode as
//! polynomials in ε, so that one half cycle leads to the next without a search for a root.

use core::array::from_fn;
use core::f64::consts::PI;

use super::phase::{MATRIX, MOST_PASSES, NODES, PASS_TOLERANCE, Panel, Phase, RULE, SHARE};
use crate::elementary::logarithm;
use crate::law::PowerLaw;

/// Largest number of terms of the polynomials: two blocks of eight.
const TERMS: usize = 16;
/// Required size of the first term left out, as minus its natural logarithm: e^-32 = 1e-14. Terms fall at least like (ε p / 4)^n, which
/// gives the number of terms n. Turning points are then exact to 1e-12, the rounding of the polynomials; with 24 they are exact to 1e-11,
/// with 16 to 1e-8.
const DIGITS: f64 = 32.0;
/// Smallest number of terms, for modes that soften so little that a straight line would suffice.
const FEWEST_TERMS: usize = 3;
/// Largest ε p for which [`TERMS`] terms reach [`DIGITS`]: 16 ln(4/0.54) = 32. If a mode softens more than that before φ_max, the table
/// ends there, and the general solver takes the rest.
const STRONGEST: f64 = 0.54;
/// Largest relative error of the polynomials at the check points; with a larger error they are not used. Of 150 modes (K_∞ from 1e-4 to 10
/// K_T, ζ_v up to 30 %, χ from -0.95 to 0.7) 134 pass. 1e-9 would pass all of them, 1e-13 refuses half because of rounding.
const TABLE_TOLERANCE: f64 = 1e-11;
/// Points at which the polynomials are compared with the quadrature, as shares of the table: near both ends, between Chebyshev nodes.
const CHECKED: [f64; 2] = [0.05, 0.97];
/// Largest relative difference between the pull of a tabled half cycle and the pull that acts; beyond it the travel is solved anew. At
/// 1e-13 that happens in one to five half cycles of 400. At 1e-14 rounding begins to cause more, at 3e-15 most; 1e-12 saves none of them
/// and loses a digit.
const PULL_TOLERANCE: f64 = 1e-13;
/// Allowed relative error of Ω at times within a half cycle, for output at uniform times; duration and travel of the half cycle come from
/// the table. Displacements are then exact to 1e-11, and a larger tolerance saves no measurable time.
const CLOCK_TOLERANCE: f64 = 1e-10;

/// The micro-slip half cycles of a mode.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MicroSlip {
    /// ½ω² = ½ (K_∞ + K_T).
    half_stiffness: f64,
    viscous: f64,
    /// ε of a half cycle of travel 1.
    softening: f64,
    /// p = χ + 2.
    exponent: f64,
    /// Largest L of the table.
    longest: f64,
    /// K_T.
    stiffness: f64,
    /// τ at the nodes.
    tau: [f64; NODES],
    /// The shapes as polynomials in ε·to_unit - 1, which runs from -1 to 1.
    to_unit: f64,
    terms: usize,
    shapes: [Shape; TERMS],
}

/// The functions of ε: duration of a half cycle, its damping W/L², and the ratios of the next half cycle's travel and ε to its own.
type Shape = [f64; 4];

/// A half cycle as found; the next one follows from it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Travel {
    pub(crate) length: f64,
    /// ε.
    softening: f64,
    shape: Shape,
}

impl MicroSlip {
    /// The tables for travels up to 2 φ_max, or up to the softening at which [`TERMS`] terms no longer suffice. None if the polynomials
    /// differ from the quadrature at the check points by more than [`TABLE_TOLERANCE`], as happens where K_∞ is next to nothing.
    pub(crate) fn new(k_inf: f64, viscous: f64, law: &PowerLaw) -> Option<Self> {
        let p = law.exponent;
        let omega_squared = k_inf + law.stiffness;
        let rho = 4.0 * law.coefficient / ((p + 1.0) * libm::pow(2.0, p + 1.0));
        let softening = 2.0 * rho / omega_squared;
        let whole = softening * libm::pow(2.0 * law.limit, p - 1.0);
        let steepest = whole.min(STRONGEST / p);
        let longest = 2.0 * law.limit * libm::pow(steepest / whole, 1.0 / (p - 1.0));
        let tau = from_fn(|i| (1.0 - libm::exp(p * LOG_SHARE[i])) / SHARE[NODES - 1 - i]);
        let decay = libm::log(4.0 / (steepest * p));
        let mut micro = Self {
            half_stiffness: 0.5 * omega_squared,
            viscous,
            softening,
            exponent: p,
            longest,
            stiffness: law.stiffness,
            tau,
            to_unit: 2.0 / steepest,
            terms: (libm::ceil(DIGITS / decay) as usize).clamp(FEWEST_TERMS, TERMS),
            shapes: [[0.0; 4]; TERMS],
        };
        micro.fill_table();
        let good = CHECKED.iter().all(|share| {
            let exact = micro.shape_by_quadrature(share * steepest);
            let found = micro.shape(share * steepest);
            exact.iter().zip(found).all(|(e, f)| libm::fabs(f - e) <= TABLE_TOLERANCE * e)
        });
        good.then_some(micro)
    }

    /// Ω at the nodes for the softening ε; the damper's part is found by fixed-point passes.
    ///
    /// Each pass shrinks the change by about the same factor. The error left by a pass is therefore about its change times the ratio of
    /// that change to the one before. The passes end when this estimate is below `tolerance`·Ω.
    fn omega(&self, softening: f64, tolerance: f64) -> [f64; NODES] {
        let base: [f64; NODES] = from_fn(|i| 2.0 * self.half_stiffness * (1.0 - softening * self.tau[i]));
        let mut omega = base.map(libm::sqrt);
        if self.viscous == 0.0 {
            return omega;
        }
        let mut last = 0.0;
        for _ in 0..MOST_PASSES {
            let mut lost = [0.0; NODES];
            for (column, o) in COUPLING.iter().zip(&omega) {
                lost.iter_mut().zip(column).for_each(|(s, c)| *s += c * o);
            }
            let next: [f64; NODES] = from_fn(|i| libm::sqrt(base[i] + self.viscous * lost[i]));
            let change = omega.iter().zip(&next).fold(0.0_f64, |m, (a, b)| m.max(libm::fabs(a - b)));
            omega = next;
            if change * (change / last).min(1.0) <= tolerance * omega[0] {
                break;
            }
            last = change;
        }
        omega
    }

    /// Duration and W/L² = ¼ c ∫Ω sin² of a half cycle, by quadrature.
    fn shape_by_quadrature(&self, softening: f64) -> [f64; 2] {
        let panel = Panel { omega: self.omega(softening, PASS_TOLERANCE), ..Panel::WHOLE };
        let work: f64 = (0..NODES).map(|i| WORK[i] * panel.omega[i]).sum();
        [panel.duration(), 0.25 * self.viscous * work]
    }

    /// Evaluates the tabled shape at the softening ε.
    #[inline]
    fn shape(&self, softening: f64) -> Shape {
        let x = softening * self.to_unit - 1.0;
        let (low, high) = self.shapes.split_at(TERMS / 2);
        let mut shape = eight(low, x);
        if self.terms > TERMS / 2 {
            let (x4, high) = ((x * x) * (x * x), eight(high, x));
            shape = from_fn(|i| shape[i] + high[i] * (x4 * x4));
        }
        shape
    }

    /// Tables duration and damping first, then the ratios of the next half cycle, which depend on both.
    fn fill_table(&mut self) {
        let n = self.terms;
        let nodes: [f64; TERMS] = from_fn(|i| libm::cos(PI * (i as f64 + 0.5) / n as f64));
        let softenings = nodes.map(|x| (1.0 + x) / self.to_unit);
        let mut values = [[0.0; 2]; TERMS];
        for i in 0..n {
            values[i] = self.shape_by_quadrature(softenings[i]);
        }
        self.tabulate(0, &nodes[..n], &values);
        for i in 0..n {
            values[i] = self.next_by_root(softenings[i], values[i][1]);
        }
        self.tabulate(2, &nodes[..n], &values);
    }

    /// Interpolates two components of the shape, `first` and the one after it, at Chebyshev nodes; the result is in powers of the argument.
    fn tabulate(&mut self, first: usize, nodes: &[f64], values: &[[f64; 2]]) {
        let n = nodes.len();
        // Chebyshev coefficients from T_{k+1}(x) = 2 x T_k(x) - T_{k-1}(x) at the nodes.
        let mut coefficients = [[0.0; 2]; TERMS];
        for (&x, value) in nodes.iter().zip(values) {
            let (mut now, mut before) = (1.0, x);
            for (k, c) in coefficients[..n].iter_mut().enumerate() {
                let weight = if k == 0 { now } else { 2.0 * now } / n as f64;
                *c = [c[0] + weight * value[0], c[1] + weight * value[1]];
                (now, before) = (2.0 * x * now - before, now);
            }
        }
        // The Chebyshev polynomials by the same recurrence, as coefficients of powers.
        let (mut now, mut before) = ([0.0; TERMS], [0.0; TERMS]);
        now[0] = 1.0;
        for (k, c) in coefficients[..n].iter().enumerate() {
            let mut next = [0.0; TERMS];
            for j in 0..n {
                self.shapes[j][first] += c[0] * now[j];
                self.shapes[j][first + 1] += c[1] * now[j];
                next[j] =
                    if j > 0 { if k == 0 { now[j - 1] } else { 2.0 * now[j - 1] } } else { 0.0 } - before[j];
            }
            (before, now) = (now, next);
        }
    }

    /// Ratio of pull to travel of a half cycle, from P(L) = W divided by L².
    #[inline]
    fn pull_over_travel(&self, softening: f64, damping: f64) -> f64 {
        self.half_stiffness * (1.0 - softening) + damping
    }

    /// Travel and ε of the half cycle that follows one of softening ε, relative to that one's own.
    ///
    /// The pull at the turning point is ω² L - drop·L^p minus the pull at the start, that is [½ω² (1 - p ε) - W/L²] L.
    fn next_by_root(&self, softening: f64, damping: f64) -> [f64; 2] {
        let pull = self.half_stiffness * (1.0 - self.exponent * softening) - damping;
        let start = pull / self.pull_over_travel(softening, damping);
        let growth = |travel: f64| libm::pow(travel, self.exponent - 1.0);
        let travel = self.root(pull, start, |travel| softening * growth(travel));
        [travel, growth(travel)]
    }

    /// The travel under a given pull, by Newton's method; `softening` gives ε for a travel. The ratio of pull to travel is convex and
    /// falling, so Newton's method needs no bracket. The slope neglects the change of the damping, which costs next to nothing.
    fn root(&self, pull: f64, start: f64, softening: impl Fn(f64) -> f64) -> f64 {
        /// Largest number of rounds; usually a handful suffices. When it is reached, the last travel is used.
        const MOST: u32 = 60;
        let mut travel = start;
        for _ in 0..MOST {
            let softening = softening(travel);
            let damping = self.shape(softening)[1];
            let slope = self.half_stiffness * (1.0 - self.exponent * softening) + damping;
            let change = (pull / travel - self.pull_over_travel(softening, damping)) / slope;
            travel += travel * change;
            if libm::fabs(change) <= 2.0 * f64::EPSILON {
                break;
            }
        }
        travel
    }

    /// Computes the half cycle under `pull`. `last` holds the half cycle before and is replaced by the new one. Beyond the table `last`
    /// stays unchanged and the function returns false.
    #[inline]
    pub(crate) fn travel(&self, pull: f64, last: &mut Travel) -> bool {
        let [_, _, travel, growth] = last.shape;
        let next = self.at(last.length * travel, last.softening * growth);
        let expected = next.length * self.pull_over_travel(next.softening, next.damping());
        // The prediction from `last` fails after a half cycle in macro-slip, and rarely because of rounding; then the equation is solved
        // anew.
        if libm::fabs(expected - pull) <= PULL_TOLERANCE * pull {
            *last = next;
            return true;
        }
        self.solve(pull).map(|found| *last = found).is_some()
    }

    #[inline]
    fn at(&self, length: f64, softening: f64) -> Travel {
        Travel { length, softening, shape: self.shape(softening) }
    }

    /// Solves for the travel under `pull`; none beyond the table.
    #[cold]
    fn solve(&self, pull: f64) -> Option<Travel> {
        let softening = |length: f64| self.softening * libm::pow(length, self.exponent - 1.0);
        let longest = self.at(self.longest, softening(self.longest));
        if pull > self.longest * self.pull_over_travel(longest.softening, longest.damping()) {
            return None;
        }
        let length = self.root(pull, pull / self.half_stiffness, softening);
        (length <= self.longest).then(|| self.at(length, softening(length)))
    }

    /// Increase of the joint force over a half cycle, as a magnitude: K_T L - drop·L^p.
    #[inline]
    pub(crate) fn force(&self, travel: &Travel) -> f64 {
        (self.stiffness - (self.exponent + 1.0) * self.half_stiffness * travel.softening) * travel.length
    }

    /// Ω over the half cycle, for output at times within it.
    pub(crate) fn phase(&self, travel: &Travel) -> Phase {
        Phase::single(self.omega(travel.softening, CLOCK_TOLERANCE))
    }
}

/// ln x at the nodes, with x = sin²(θ/2).
const LOG_SHARE: [f64; NODES] = {
    let mut log = [0.0; NODES];
    let mut i = 0;
    while i < NODES {
        log[i] = logarithm(SHARE[i]);
        i += 1;
    }
    log
};

/// Weights at the nodes with which the sum over Ω gives ∫Ω sin²θ dθ from 0 to π; sin²θ = 4 x (1 - x).
const WORK: [f64; NODES] = {
    let mut weight = [0.0; NODES];
    let mut i = 0;
    while i < NODES {
        weight[i] = 0.5 * PI * RULE.weights[i] * 4.0 * SHARE[i] * SHARE[NODES - 1 - i];
        i += 1;
    }
    weight
};

/// Matrix of the damper's work in Ω²: Ω_i² gains c Σ_j coupling[j][i] Ω_j.
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

/// Σ c_k x^k of eight terms, summed in pairs so that the processor's chains of dependent operations stay short.
#[inline]
fn eight(c: &[Shape], x: f64) -> Shape {
    let (x2, c) = (x * x, &c[..8]);
    let x4 = x2 * x2;
    from_fn(|i| {
        let pair = |k: usize| c[k][i] + c[k + 1][i] * x;
        (pair(0) + pair(2) * x2) + (pair(4) + pair(6) * x2) * x4
    })
}

impl Travel {
    /// Placeholder for the absence of a half cycle.
    pub(crate) const NONE: Self = Self { length: 0.0, softening: 0.0, shape: [0.0; 4] };

    /// Whether there is a half cycle in micro-slip.
    #[inline]
    pub(crate) fn is_some(&self) -> bool {
        self.length > 0.0
    }

    /// Duration of the half cycle, s.
    #[inline]
    pub(crate) fn duration(&self) -> f64 {
        self.shape[0]
    }

    /// Work of the damper over the square of the travel, W/L².
    #[inline]
    pub(crate) fn damping(&self) -> f64 {
        self.shape[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::{Backbone, FourParameter};

    /// Mode 1 of Table 2, and variants with other exponents and dampers.
    fn modes() -> impl Iterator<Item = MicroSlip> {
        [-0.95, -0.5, -0.183, -0.05].into_iter().flat_map(|chi| {
            let joint = FourParameter::new(4.45e4, 239.4, chi, 0.3).unwrap();
            let law = joint.power_law().unwrap();
            [0.0, 0.4, 15.0].map(move |viscous| MicroSlip::new(5.6e5, viscous, &law).unwrap())
        })
    }

    #[test]
    fn half_cycles_that_follow_are_those_found_anew() {
        for mode in modes() {
            let mut at = mode.at(mode.longest, mode.softening * libm::pow(mode.longest, mode.exponent - 1.0));
            for _ in 0..1000 {
                let pull =
                    at.length * (mode.half_stiffness * (1.0 - mode.exponent * at.softening) - at.damping());
                assert!(mode.travel(pull, &mut at));
                let anew = mode.solve(pull).unwrap();
                assert!((at.length / anew.length - 1.0).abs() < 1e-12);
                assert!((at.softening / anew.softening - 1.0).abs() < 1e-12);
                assert!((at.duration() / anew.duration() - 1.0).abs() < 1e-13);
                assert!((at.damping() - anew.damping()).abs() <= 1e-12 * anew.damping());
            }
        }
    }

    #[test]
    fn the_table_tells_the_next_half_cycle() {
        for mode in modes() {
            for share in [0.01, 0.3, 0.99] {
                let softening = share * 2.0 / mode.to_unit;
                let [_, damping, travel, growth] = mode.shape(softening);
                let exact = mode.next_by_root(softening, damping);
                assert!((travel / exact[0] - 1.0).abs() < 1e-14 && (growth / exact[1] - 1.0).abs() < 1e-14);
            }
        }
    }
}
