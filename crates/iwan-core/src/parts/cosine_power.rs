//! The integral of a power of the cosine over a quarter of a cycle.

/// Largest exponent of a part. A force with a larger exponent acts like a wall, for which there is [`Pinning`](super::Pinning), and from
/// 340 on the Gamma function overflows. A larger exponent is refused. Joint laws have exponents below 4.
pub(super) const MOST_EXPONENT: f64 = 100.0;

/// ∫ cos^p θ dθ from 0 to π/2, for p > -1: (√π/2) Γ((p+1)/2)/Γ((p+2)/2) (Abramowitz and Stegun 6.2.1, 6.2.2).
pub(super) fn quarter_integral(p: f64) -> f64 {
    // √π/2.
    const HALF_ROOT_PI: f64 = 0.886_226_925_452_758;
    HALF_ROOT_PI * libm::tgamma(0.5 * (p + 1.0)) / libm::tgamma(0.5 * (p + 2.0))
}

#[cfg(test)]
mod tests {
    use core::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::quadrature::Rule;

    const RULE: Rule<32> = Rule::gauss_legendre();

    #[test]
    fn whole_powers_have_their_known_values_and_others_agree_with_quadrature() {
        let known =
            [(0.0, FRAC_PI_2), (1.0, 1.0), (2.0, 0.25 * PI), (3.0, 2.0 / 3.0), (4.0, 3.0 * PI / 16.0)];
        for (p, exact) in known {
            assert!((quarter_integral(p) / exact - 1.0).abs() < 2e-15, "{p}");
        }
        for p in [1.2, 1.5, 2.3, 7.9, 31.0] {
            // θ = π/2 (1 - s^4) flattens the corner where the cosine vanishes; eight panels resolve a high power.
            let integrand = |s: f64| {
                let to_corner = FRAC_PI_2 * s * s * s * s;
                4.0 * FRAC_PI_2 * s * s * s * libm::pow(libm::sin(to_corner), p)
            };
            let panel = |i: u32| RULE.integrate(0.125 * f64::from(i), 0.125 * f64::from(i + 1), integrand);
            let by_rule: f64 = (0..8).map(panel).sum();
            assert!((by_rule / quarter_integral(p) - 1.0).abs() < 1e-11, "{p}");
        }
    }
}
