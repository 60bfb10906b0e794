//! Cosine, sine and logarithm at compile time.
//!
//! The quadrature's tables are constants, and `libm` cannot be called while the compiler computes a constant. Each function is a Taylor
//! series on the range that its one caller needs. The series have more terms than double precision needs; the surplus terms cost the
//! compiler a moment and the running program nothing.

/// `cos x` for 0 <= x <= π.
///
/// The series ends at the term x^40; the terms left out are below π^42/42! = 6e-31. Near π the terms reach 5 and cancel, which leaves an
/// error of 1e-15. That is enough for the caller, which uses the value to start Newton's method.
pub(crate) const fn cosine(x: f64) -> f64 {
    let (mut term, mut sum, mut k) = (1.0, 1.0, 1.0);
    while k < 40.0 {
        term = -term * x * x / (k * (k + 1.0));
        sum += term;
        k += 2.0;
    }
    sum
}

/// `sin x` for 0 <= x <= π/2.
///
/// Terms up to x^29: what is left out is below (π/2)^31/31! = 2e-28.
pub(crate) const fn sine(x: f64) -> f64 {
    let (mut term, mut sum, mut k) = (x, 0.0, 1.0);
    while k < 30.0 {
        sum += term;
        term = -term * x * x / ((k + 1.0) * (k + 2.0));
        k += 2.0;
    }
    sum
}

/// `ln x` for 0 < x <= 1: x = m 2^-n, and ln m = 2 artanh z with z = (m - 1)/(m + 1).
///
/// Doubling x until it is at least 0.7 leaves m between 0.7 and 1.4, so |z| < 0.177; the 30 terms up to z^59 leave out less than
/// 0.177^61/61 = 3e-48.
pub(crate) const fn logarithm(x: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_agree_with_libm() {
        for i in 1..=1000 {
            let share = f64::from(i) / 1000.0;
            let (x, half) = (share * core::f64::consts::PI, share * core::f64::consts::FRAC_PI_2);
            assert!((cosine(x) - libm::cos(x)).abs() < 2e-15, "cos {x}");
            assert!((sine(half) - libm::sin(half)).abs() < 4e-16, "sin {half}");
            assert!((logarithm(share) - libm::log(share)).abs() < 2e-15, "ln {share}");
        }
        let tiny = libm::ldexp(1.0, -60);
        assert!((logarithm(tiny) / libm::log(tiny) - 1.0).abs() < 1e-15);
    }
}
