//! Quantiles of Student's distribution.

use std::f64::consts::FRAC_PI_2;

/// 97.5 % point of the normal distribution, for intervals of 95 %.
pub(crate) const NORMAL: f64 = 1.959_963_984_540_054;
/// Least number of degrees of freedom of a fit: a fit with fewer is refused before, and the number that correlated residuals leave is only an estimate.
pub(crate) const LEAST_FREEDOM: f64 = 3.0;
/// 97.5 % point of Student's t with one degree of freedom, tan(0.475 π).
const OF_ONE: f64 = 12.706_204_736;
/// 97.5 % point of Student's t with two degrees of freedom, 0.95 √(2 / 0.0975).
const OF_TWO: f64 = 4.302_652_730;

/// 97.5 % point of Student's t with ν degrees of freedom: Abramowitz and Stegun 26.7.5, within 0.3 % from ν = 3 on, in closed form for one and
/// two. A ν below three is rounded down to a whole number, and one below one counts as one.
pub(crate) fn student(freedom: f64) -> f64 {
    let (z, n) = (NORMAL, freedom);
    if n < 3.0 {
        return if n < 2.0 { OF_ONE } else { OF_TWO };
    }
    let z2 = z * z;
    let terms = [
        z * (z2 + 1.0) / 4.0,
        z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0,
        z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0,
        z * ((((79.0 * z2 + 776.0) * z2 + 1482.0) * z2 - 1920.0) * z2 - 945.0) / 92160.0,
    ];
    z + terms.iter().rev().fold(0.0, |sum, term| (sum + term) / n)
}

/// Number of intervals of the midpoint rule for tails of Student's distribution: it gives four digits of the quantile.
const MIDPOINTS: usize = 200;
/// Number of halvings of the interval in which the quantile lies: six digits.
const HALVINGS: usize = 20;

/// The value of Student's t beyond which, on both sides together, lies the probability `chance` (above 0, at most 1). The number of degrees of freedom is at least 1 and need
/// not be whole. It serves many comparisons at once, whose chances lie far below the 5 % of intervals. By t = √ν tan θ, where θ has the density cos^(ν-1) (Abramowitz and
/// Stegun 26.7.1), to 1e-3 of t.
///
/// ```
/// let t = iwan_ident::estimate::student_quantile(0.001, 30.0);
/// assert!((t - 3.646).abs() < 4e-3);
/// ```
#[must_use]
pub fn student_quantile(chance: f64, freedom: f64) -> f64 {
    let beyond = |theta: f64| {
        let step = (FRAC_PI_2 - theta) / MIDPOINTS as f64;
        let density = |i: usize| (theta + (i as f64 + 0.5) * step).cos().powf(freedom - 1.0);
        (0..MIDPOINTS).map(density).sum::<f64>() * step
    };
    let whole = beyond(0.0);
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if beyond(middle) > chance * whole { low = middle } else { high = middle }
    }
    freedom.sqrt() * low.tan()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn student_as_tabled() {
        // Abramowitz and Stegun, Table 26.10.
        let table = [
            (1.0, 12.706),
            (2.0, 4.303),
            (3.0, 3.182),
            (5.0, 2.571),
            (10.0, 2.228),
            (30.0, 2.042),
            (120.0, 1.980),
        ];
        for (freedom, t) in table {
            assert!((student(freedom) / t - 1.0).abs() < 3e-3, "{freedom}: {}", student(freedom));
        }
    }

    #[test]
    fn quantiles_as_tabled() {
        // Abramowitz and Stegun, Table 26.10, two-sided.
        for (freedom, chance, t) in
            [(2.0, 0.05, 4.303), (5.0, 0.05, 2.571), (10.0, 0.01, 3.169), (30.0, 0.001, 3.646)]
        {
            let found = student_quantile(chance, freedom);
            assert!((found / t - 1.0).abs() < 1e-3, "{freedom} {chance}: {found}");
        }
        // The expansion for 95 % agrees.
        for freedom in [3.0, 4.5, 12.3, 77.0] {
            let (a, b) = (student(freedom), student_quantile(0.05, freedom));
            assert!((a / b - 1.0).abs() < 4e-3, "{freedom}: {a} {b}");
        }
    }
}
