//! Sums over many half cycles of a slow decay at once.
//!
//! A window's amplitude is a sum over half cycles of a function that changes slowly from one to the next: the window, the decaying amplitude, and the phase
//! against the reference. A stride takes the half cycles of one step from window to window together. A rule of Gauss for sums over n equal steps (zeros of the discrete
//! Chebyshev polynomials; W. Gautschi, *Orthogonal Polynomials: Computation and Approximation*, Oxford 2004, Sec. 1.5) is exact for polynomials of degree nine with five
//! nodes, so that a stride costs five half cycles however many it covers. Where in the decay its nodes and its end lie are smooth functions of the amplitude at its
//! beginning, and tabled like single half cycles.

use std::f64::consts::PI;

use rustfft::num_complex::Complex64;

use crate::turn::turn;

/// Nodes of the rule. The sum over a stride of a window's quarter, times a decay that changes by [`MOST_CHANGE`], is then right to 3.6e-6 of the window's integral (a test below), also where the window
/// begins within the stride; with four nodes to 1.5e-5.
pub(super) const NODES: usize = 5;
/// Fewest half cycles of a stride: below twice the nodes a stride saves next to nothing.
const FEWEST: usize = 2 * NODES;
/// Largest change of the decay's logarithm within a stride, of ln amplitude and of the phase against the reference (rad) together. Beyond it half cycles are added one by one: windows let such a decay
/// hardly pass, and the rule would. With 2.4 in place of 1.6 the test in `decay` is off by up to 2.6e-5.
pub(super) const MOST_CHANGE: f64 = 1.6;
/// Half cycles between which places within a stride are interpolated, on either side: amplitude and time change by parts of 1e-3 of their own course from one half cycle to the
/// next.
const BESIDE: usize = 3;

/// Numbers in a stride: changes of ln amplitude and time at each node and at the end.
pub(super) const STRIDE_VALUES: usize = 2 * (NODES + 1);

/// A rule that sums a slow function over consecutive half cycles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rule {
    /// Number of half cycles.
    pub(super) length: usize,
    /// Place of each node, in half cycles from the first one.
    places: [f64; NODES],
    /// Weight of each node, turned by half a turn a half cycle: displacements change their sign from one half cycle to the next.
    pub(super) weights: [Complex64; NODES],
}

/// Where the nodes of a stride lie, and where it ends: changes of ln amplitude, and seconds from the beginning of the stride.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stride {
    pub(super) nodes: [(f64, f64); NODES],
    pub(super) end: (f64, f64),
}

impl Rule {
    /// The rule over the half cycles of `cycles` of the reference; none where these are too few.
    pub(super) fn over(cycles: f64) -> Option<Self> {
        let length = (2.0 * cycles).floor() as usize;
        (length >= FEWEST).then(|| Self::of(length))
    }

    /// The sign of the displacement behind a stride that begins with the sign `before`.
    pub(super) const fn sign_behind(&self, before: f64) -> f64 {
        if self.length.is_multiple_of(2) { before } else { -before }
    }

    fn of(length: usize) -> Self {
        let n = length as f64;
        // p_(k+1) = x p_k - b_k p_(k-1), with x from the middle of the half cycles.
        let b = |k: f64| k * k * (n * n - k * k) / (4.0 * (4.0 * k * k - 1.0));
        let [b1, b2, b3, b4] = [1.0, 2.0, 3.0, 4.0].map(b);
        let (sum, product) = (b1 + b2 + b3 + b4, b1 * b3 + b1 * b4 + b2 * b4);
        let root = (sum * sum - 4.0 * product).sqrt();
        let (outer, inner) = (0.5 * (sum + root), 0.5 * (sum - root));
        // Weights from the sums of 1, x² and x⁴.
        let second = n * (n * n - 1.0) / 12.0;
        let fourth = second * (3.0 * n * n - 7.0) / 20.0;
        let of_outer = 0.5 * (fourth - inner * second) / (outer * (outer - inner));
        let of_inner = 0.5 * (fourth - outer * second) / (inner * (inner - outer));
        let (outer, inner, middle) = (outer.sqrt(), inner.sqrt(), 0.5 * (n - 1.0));
        let places = [-outer, -inner, 0.0, inner, outer].map(|x| middle + x);
        let weights = [of_outer, of_inner, n - 2.0 * (of_outer + of_inner), of_inner, of_outer];
        Self { length, places, weights: std::array::from_fn(|i| turn(PI * places[i]).conj() * weights[i]) }
    }

    /// The values that tell the stride from the ln amplitude `log` on. `half_cycle` gives change of ln amplitude and duration of the half cycle at a ln amplitude; none where it
    /// gives none.
    pub(super) fn values(
        &self,
        log: f64,
        mut half_cycle: impl FnMut(f64) -> Option<(f64, f64)>,
    ) -> Option<[f64; STRIDE_VALUES]> {
        let mut course = vec![(0.0, 0.0)];
        for i in 0..self.length {
            let (gone, late) = course[i];
            let (growth, duration) = half_cycle(log + gone)?;
            course.push((gone + growth, late + duration));
        }
        let nodes = self.places.map(|place| between(&course, place));
        let all = nodes.into_iter().chain(course.last().copied());
        let mut values = [0.0; STRIDE_VALUES];
        values
            .chunks_exact_mut(2)
            .zip(all)
            .for_each(|(pair, (gone, late))| pair.copy_from_slice(&[gone, late]));
        Some(values)
    }
}

impl Stride {
    pub(super) fn of(values: &[f64; STRIDE_VALUES]) -> Self {
        let pair = |i: usize| (values[2 * i], values[2 * i + 1]);
        Self { nodes: std::array::from_fn(pair), end: pair(NODES) }
    }
}

/// Values at a place between the entries of a list, by the polynomial through the entries next to it.
fn between(course: &[(f64, f64)], place: f64) -> (f64, f64) {
    let count = 2 * BESIDE;
    let first = (place as usize + 1).saturating_sub(BESIDE).min(course.len() - count);
    let near = course[first..first + count].iter().enumerate();
    near.fold((0.0, 0.0), |sum, (i, (gone, late))| {
        let others = (0..count).filter(|j| *j != i).map(|j| j as f64);
        let share: f64 = others.map(|j| (place - first as f64 - j) / (i as f64 - j)).product();
        (sum.0 + share * gone, sum.1 + share * late)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_sums_polynomials_of_degree_nine() {
        for length in [10, 11, 24, 61] {
            let rule = Rule::of(length);
            for degree in 0..10 {
                let of = |x: f64| (2.0 * x / length as f64 - 0.7).powi(degree);
                let sum: f64 = (0..length).map(|i| of(i as f64)).sum();
                let signs = rule.places.map(|x| Complex64::cis(-PI * x));
                let by_rule: Complex64 =
                    (0..NODES).map(|i| rule.weights[i] * signs[i] * of(rule.places[i])).sum();
                assert!((by_rule - sum).norm() < 1e-12 * length as f64, "{length} {degree}: {by_rule} {sum}");
            }
        }
        assert!(Rule::over(4.9).is_none() && Rule::over(5.0).is_some());
    }

    #[test]
    fn a_stride_sums_windows_times_decays() {
        let mut most: f64 = 0.0;
        for length in [10, 20, 80] {
            let (rule, n) = (Rule::of(length), length as f64);
            for angle in (0..=18).map(|i| 0.5 * PI + PI * f64::from(i) / 18.0) {
                // Strides that begin before the window, and within it.
                for quarters in (0..=24).map(|i| f64::from(i) / 6.0 - 1.0) {
                    let of = |x: f64| {
                        let begun = (x + 0.5) / n + quarters;
                        let window = if begun > 0.0 { (0.25 * PI * begun).sin().powi(4) } else { 0.0 };
                        (Complex64::from_polar(MOST_CHANGE, angle) * (x / n)).exp() * window
                    };
                    let sum: Complex64 = (0..length).map(|i| of(i as f64)).sum();
                    let signs = rule.places.map(|x| Complex64::cis(-PI * x));
                    let by_rule: Complex64 =
                        (0..NODES).map(|i| rule.weights[i] * signs[i] * of(rule.places[i])).sum();
                    // The integral of the window is three eighths of its four quarters.
                    most = most.max((by_rule - sum).norm() / (1.5 * n));
                }
            }
        }
        assert!(most < 3.6e-6 && most > 1e-6, "{most:e}");
    }

    #[test]
    fn places_between_half_cycles_lie_on_the_polynomial_through_them() {
        let of = |x: f64| (0.3 + 1e-2 * x - 1e-4 * x.powi(5), x + 1e-3 * x.powi(4));
        let course: Vec<(f64, f64)> = (0..13).map(|i| of(f64::from(i))).collect();
        for place in [0.0, 0.4, 5.5, 11.9, 12.0] {
            let (a, b) = between(&course, place);
            let (c, d) = of(place);
            assert!((a - c).abs() < 1e-11 && (b - d).abs() < 1e-11, "{place}");
        }
    }
}
