//! Exact derivatives of the four-parameter law with respect to its parameters, for identification.

use super::backbone::Backbone;
use super::four_parameter::FourParameter;

/// A four-parameter law at a displacement u >= 0 on the virgin curve, with its derivatives. The parameters are, in this order,
/// ln K_T, ln F_S, χ and β.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawSlopes {
    /// N = F(u) - K_T u <= 0: the force of the joint less the force that it would have if stuck.
    pub missing: f64,
    /// dN/du.
    pub missing_slope: f64,
    /// Derivatives of N with respect to the parameters at constant u.
    pub missing_by: [f64; 4],
    /// Dissipation D(u) of a closed cycle.
    pub dissipation: f64,
    /// dD/du.
    pub dissipation_slope: f64,
    /// Derivatives of D with respect to the parameters at constant u.
    pub dissipation_by: [f64; 4],
}

impl FourParameter {
    /// The law at `u` >= 0 with its derivatives.
    ///
    /// In micro-slip N = -A u^(χ+2) with A = (K_T - S) / ((χ+2) φ_max^(χ+1)), and D = 4 A (χ+1)/(χ+3) u^(χ+3): Deaner et al.,
    /// Eq. 15 and 16; in macro-slip N = F_S - K_T u and D = D(φ_max) + 4 F_S (u - φ_max).
    ///
    /// ```
    /// use iwan_core::FourParameter;
    /// // χ = 0, β = 0: φ_max = 2 F_S/K_T, N = -K_T u²/(2 φ_max) = -u² K_T²/(4 F_S): twice per ln K_T, minus once per ln F_S.
    /// let slopes = FourParameter::new(4.0, 1.0, 0.0, 0.0)?.slopes(0.1);
    /// assert!((slopes.missing + 0.04).abs() < 1e-15);
    /// assert!((slopes.missing_by[0] + 0.08).abs() < 1e-15 && (slopes.missing_by[1] - 0.04).abs() < 1e-15);
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    #[must_use]
    pub fn slopes(&self, u: f64) -> LawSlopes {
        let (k, f, chi, beta) = (self.k_t(), self.f_s(), self.chi(), self.beta());
        let c = (chi + 1.0) / (chi + 2.0);
        // Logarithmic derivatives of φ_max = F_S (1+β) / (K_T (β+c)) and of K_T - S = K_T/(1+β).
        let of_c = 1.0 / ((chi + 2.0) * (chi + 2.0) * (beta + c));
        let phi = [-1.0, 1.0, -of_c, 1.0 / (1.0 + beta) - 1.0 / (beta + c)];
        let power = [1.0, 0.0, 0.0, -1.0 / (1.0 + beta)];
        // Logarithmic derivatives of A; the term ln u of χ is added below.
        let mut a = [0.0; 4];
        for (a, (power, phi)) in a.iter_mut().zip(power.iter().zip(&phi)) {
            *a = power - (chi + 1.0) * phi;
        }
        a[2] -= 1.0 / (chi + 2.0) + libm::log(self.phi_max());
        // Logarithmic derivative with respect to χ of the factor 4 (χ+1)/(χ+3) beside A.
        let factor = 1.0 / (chi + 1.0) - 1.0 / (chi + 3.0);
        if u < self.phi_max() {
            // N is not computed as the difference F - K_T u: in small motion N is a small part of both terms.
            let share = libm::pow(u / self.phi_max(), chi + 1.0);
            let (missing, d) = (-u * self.k_power / (chi + 2.0) * share, self.dissipation(u));
            let log = if u > 0.0 { libm::log(u) } else { 0.0 };
            let with_log = |i: usize| a[i] + if i == 2 { log } else { 0.0 };
            let each = [0, 1, 2, 3];
            return LawSlopes {
                missing,
                missing_slope: -self.k_power * share,
                missing_by: each.map(|i| missing * with_log(i)),
                dissipation: d,
                dissipation_slope: if u > 0.0 { (chi + 3.0) * d / u } else { 0.0 },
                dissipation_by: each.map(|i| d * (with_log(i) + if i == 2 { factor } else { 0.0 })),
            };
        }
        let edge = self.phi_max();
        let at_edge = self.dissipation(edge);
        let log = libm::log(edge);
        let by = |i: usize| {
            let shape = if i == 2 { log + factor } else { 0.0 };
            // D(φ_max) = 4 A (χ+1)/(χ+3) φ_max^(χ+3), and its derivative less that of 4 F_S φ_max.
            let edge_part = at_edge * (a[i] + shape + (chi + 3.0) * phi[i]) - 4.0 * f * edge * phi[i];
            edge_part + if i == 1 { 4.0 * f * (u - edge) } else { 0.0 }
        };
        LawSlopes {
            missing: f - k * u,
            missing_slope: -k,
            missing_by: [-k * u, f, 0.0, 0.0],
            dissipation: self.dissipation(u),
            dissipation_slope: 4.0 * f,
            dissipation_by: [by(0), by(1), by(2), by(3)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(p: [f64; 4]) -> FourParameter {
        FourParameter::new(libm::exp(p[0]), libm::exp(p[1]), p[2], p[3]).unwrap()
    }

    #[test]
    fn derivatives_against_central_differences() {
        for p in [[1.3, 0.2, -0.3, 0.02], [0.4, 1.0, 0.4, 1.5], [2.0, -1.0, -0.9, 0.0]] {
            let edge = law(p).phi_max();
            for u in [0.03, 0.5, 0.97, 1.2, 5.0].map(|share| share * edge) {
                let s = law(p).slopes(u);
                let h = 1e-5;
                let n = |p: [f64; 4], u: f64| law(p).force(u) - law(p).k_t() * u;
                let d = |p: [f64; 4], u: f64| law(p).dissipation(u);
                let size = law(p).f_s();
                for i in 0..4 {
                    let moved = |by: f64| core::array::from_fn(|j| p[j] + if i == j { by } else { 0.0 });
                    // Differences of four points, because φ_max contains 1/(χ+1): the error of two points is h²/6 times a third derivative
                    // of 6/(χ+1)⁴. The range of β ends at 0, so there the difference takes three points on one side.
                    let at_end = i == 3 && p[3] == 0.0;
                    let allowed = if at_end { 2e-6 } else { 1e-8 };
                    let slope = |of: &dyn Fn([f64; 4], f64) -> f64| {
                        if at_end {
                            let ahead = 4.0 * of(moved(h), u) - of(moved(2.0 * h), u);
                            (ahead - 3.0 * of(p, u)) / (2.0 * h)
                        } else {
                            let far = of(moved(2.0 * h), u) - of(moved(-2.0 * h), u);
                            (8.0 * (of(moved(h), u) - of(moved(-h), u)) - far) / (12.0 * h)
                        }
                    };
                    assert!((s.missing_by[i] - slope(&n)).abs() < allowed * size, "N {p:?} {u} {i}");
                    let size = size * edge;
                    assert!((s.dissipation_by[i] - slope(&d)).abs() < allowed * size, "D {p:?} {u} {i}");
                }
                let h = 1e-5 * edge;
                assert!(
                    (s.missing_slope - (n(p, u + h) - n(p, u - h)) / (2.0 * h)).abs() < 1e-8 * law(p).k_t()
                );
                assert!((s.dissipation_slope - (d(p, u + h) - d(p, u - h)) / (2.0 * h)).abs() < 1e-8 * size);
            }
        }
    }
}
