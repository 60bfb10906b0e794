//! First-harmonic moments of powers of the displacement measured from a turning point. The first-harmonic stiffness K_1 of a power law is a
//! sum of them.

use core::f64::consts::PI;

/// x^(-p) ∫ sin^(2p)(θ/2) cos θ dθ from θ = 0 to the angle where sin²(θ/2) = x, for 0 < x <= 1. Integrated by parts: x^(-p) [2 x^(p+½)
/// (1-x)^½ - p B_x(p+½, ½)]/(p+1). `beta` is the complete beta function B(p+½, ½).
///
/// For x beyond (a+1)/(a+b+2) the continued fraction of B_x(a, b) converges slowly, and the fraction at 1 - x is used: B_x(a, b) = B(a, b)
/// - B_(1-x)(b, a) (DLMF 8.17.4).
pub(super) fn cosine_moment(p: f64, beta: f64, x: f64) -> f64 {
    let (a, b, root) = (p + 0.5, 0.5, libm::sqrt(x * (1.0 - x)));
    let incomplete = if x < (a + 1.0) / (a + b + 2.0) {
        root / a * beta_fraction(a, b, x)
    } else {
        libm::pow(x, -p) * beta - root / b * beta_fraction(b, a, 1.0 - x)
    };
    (2.0 * root - p * incomplete) / (p + 1.0)
}

/// Value of x above which the closed form of the linear spring's moment loses less than a digit by cancellation: at 0.3 its terms are six
/// times their sum. At and below it the general [`cosine_moment`] is used.
const ELEMENTARY: f64 = 0.3;

/// [`cosine_moment`] for p = 1, a linear spring: (sin θ/2 - θ/4 - sin 2θ/8)/x with sin²(θ/2) = x.
pub(super) fn linear_moment(x: f64) -> f64 {
    /// Value of x above which asin √(1 - x) replaces asin √x: there the rounding of √x, divided by √(1 - x), exceeds 1e-13 of asin √x, and
    /// next to 1 it reaches 1e-8.
    const NEXT_TO_ONE: f64 = 1.0 - 1e-6;
    if x <= ELEMENTARY {
        // B(3/2, ½) = π/2.
        return cosine_moment(1.0, 0.5 * PI, x);
    }
    let (sine, cosine) = (2.0 * libm::sqrt(x * (1.0 - x)), 1.0 - 2.0 * x);
    let half =
        if x < NEXT_TO_ONE { libm::asin(libm::sqrt(x)) } else { 0.5 * PI - libm::asin(libm::sqrt(1.0 - x)) };
    (0.5 * sine - 0.5 * half - 0.25 * sine * cosine) / x
}

/// Largest number of terms of the continued fraction. For χ <= 1 it needs at most 35 terms (all x, to the last bit); the bound only stops
/// the loop for NaN, which never converges.
const MOST_TERMS: i32 = 200;

/// The continued fraction of a B_x(a, b) / (x^a (1-x)^b), for x below (a+1)/(a+b+2): DLMF 8.17.22, by Lentz's method.
fn beta_fraction(a: f64, b: f64, x: f64) -> f64 {
    let (mut fraction, mut up, mut down) = (1.0, 1.0, 0.0);
    for n in 1..MOST_TERMS {
        let m = f64::from(n / 2);
        let term = if n % 2 == 0 {
            m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m))
        } else {
            -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0))
        };
        down = 1.0 / (1.0 + term * down);
        up = 1.0 + term / up;
        fraction *= up * down;
        if libm::fabs(up * down - 1.0) < f64::EPSILON {
            break;
        }
    }
    1.0 / fraction
}
