//! Gauss-Legendre rules, computed at compile time.
//!
//! Nodes are the roots of the Legendre polynomial P_N by Newton's method from
//! Tricomi's guess cos(π (i - 1/4) / (N + 1/2)); weights 2 / ((1 - x²) P_N'²)
//! (Abramowitz and Stegun 25.4.29).

use crate::elementary::cosine;

/// An N-point Gauss-Legendre rule on [-1, 1], nodes ascending.
#[derive(Debug, Clone, Copy)]
pub struct Rule<const N: usize> {
    /// Nodes.
    pub nodes: [f64; N],
    /// Weights, of sum 2.
    pub weights: [f64; N],
}

/// Rounds of Newton's method for a root. Tricomi's guess is off by less than 0.012 (N = 2, and less for more nodes), and the fourth round
/// already changes nothing; all eight rounds are always run, because they only cost compile time.
const ROUNDS: u32 = 8;

/// Legendre polynomials of two successive degrees at one point.
struct Legendre {
    /// P_n.
    value: f64,
    /// P_{n-1}.
    lower: f64,
}

/// P_n(x) and P_{n-1}(x) by the three-term recurrence, n >= 1.
const fn legendre(n: usize, x: f64) -> Legendre {
    let (mut p, mut before, mut k) = (x, 1.0, 1.0);
    let mut i = 1;
    while i < n {
        let next = ((2.0 * k + 1.0) * x * p - k * before) / (k + 1.0);
        before = p;
        p = next;
        k += 1.0;
        i += 1;
    }
    Legendre { value: p, lower: before }
}

impl<const N: usize> Rule<N> {
    /// The N-point rule (N >= 2), exact for polynomials of degree 2N - 1.
    ///
    /// ```
    /// use iwan_core::quadrature::Rule;
    /// const RULE: Rule<5> = Rule::gauss_legendre();
    /// let ninth: f64 = RULE.integrate(0.0, 1.0, |x| x.powi(9));
    /// assert!((ninth - 0.1).abs() < 1e-15);
    /// ```
    #[must_use]
    pub const fn gauss_legendre() -> Self {
        let (mut nodes, mut weights) = ([0.0; N], [0.0; N]);
        let mut i = 0;
        while i < N {
            let mut x = -cosine(core::f64::consts::PI * (i as f64 + 0.75) / (N as f64 + 0.5));
            let mut slope = 1.0;
            let mut round = 0;
            while round < ROUNDS {
                let Legendre { value: p, lower: before } = legendre(N, x);
                slope = N as f64 * (before - x * p) / (1.0 - x * x);
                x -= p / slope;
                round += 1;
            }
            nodes[i] = x;
            weights[i] = 2.0 / ((1.0 - x * x) * slope * slope);
            i += 1;
        }
        Self { nodes, weights }
    }

    /// ∫ f dx from `a` to `b`.
    pub fn integrate(&self, a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
        let (half, middle) = (0.5 * (b - a), 0.5 * (b + a));
        let sum: f64 = self.nodes.iter().zip(&self.weights).map(|(x, w)| w * f(middle + half * x)).sum();
        half * sum
    }

    /// The integration matrix B of the rule's interpolating polynomial:
    /// ∫ f from -1 to `nodes[i]` is Σ_j `B[i][j]` f(`nodes[j]`), exact for degree N - 1.
    ///
    /// From the Legendre expansion of the interpolant,
    /// `B[i][j]` = w_j Σ_k ½ P_k(x_j) (P_{k+1}(x_i) - P_{k-1}(x_i)).
    #[must_use]
    pub const fn integration_matrix(&self) -> [[f64; N]; N] {
        let mut matrix = [[0.0; N]; N];
        let mut i = 0;
        while i < N {
            let mut j = 0;
            while j < N {
                let (xi, xj) = (self.nodes[i], self.nodes[j]);
                let mut sum = 0.5 * (xi + 1.0);
                let mut k = 1;
                while k < N {
                    let (up, down) = (legendre(k + 1, xi).value, legendre(k, xi).lower);
                    sum += 0.5 * legendre(k, xj).value * (up - down);
                    k += 1;
                }
                matrix[i][j] = self.weights[j] * sum;
                j += 1;
            }
            i += 1;
        }
        matrix
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_two_and_nodes_are_symmetric() {
        let rule = Rule::<12>::gauss_legendre();
        assert!((rule.weights.iter().sum::<f64>() - 2.0).abs() < 1e-15);
        for i in 0..12 {
            assert!((rule.nodes[i] + rule.nodes[11 - i]).abs() < 1e-15);
        }
    }

    #[test]
    fn integration_matrix_integrates_powers_exactly() {
        let rule = Rule::<8>::gauss_legendre();
        let matrix = rule.integration_matrix();
        for degree in 0..8_i32 {
            for (i, row) in matrix.iter().enumerate() {
                let found: f64 = row.iter().zip(rule.nodes).map(|(b, x)| b * x.powi(degree)).sum();
                let exact =
                    (rule.nodes[i].powi(degree + 1) - (-1.0_f64).powi(degree + 1)) / f64::from(degree + 1);
                assert!((found - exact).abs() < 1e-14, "degree {degree}, node {i}: {found} {exact}");
            }
        }
    }
}
