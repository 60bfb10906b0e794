//! Motion of one harmonic, u = a cos θ: the force's coefficients in closed form in micro-slip, by quadrature beyond.
//!
//! With F = K_T u - C u^p in micro-slip the loop is K_T a cos θ - C a^p [1 - 2 sin^(2p)(θ/2)] from 0 to π and its
//! negative on the other half. Its odd coefficients are
//!
//! c_n = K_T a δ_n1 + 4 C a^p (-1)^n Γ(2p+1) / (4^p Γ(p+n+1) Γ(p-n+1)),  s_n = -(4/π) C a^p E_n,
//!
//! with E_n = 1/n - ∫ sin^(2p)(θ/2) sin nθ from 0 to π. If the path of that integral is turned by a right angle at both ends, it becomes,
//! for n > p, E_n = -cos(πp) 4^-p Γ(n-p) Γ(2p+1) / Γ(n+p+1) - ∫ (cosh^(2p)(y/2) - 1) e^(-ny) dy over y > 0. This form has no oscillating
//! integrand and no terms of the size 1/n that cancel; both parts have two-term recurrences that are stable upwards.

use core::f64::consts::PI;

use super::harmonics::MOST_HARMONICS;
use crate::error::{Error, check, check_length};
use crate::law::{Backbone, PowerLaw, check_masing};
use crate::quadrature::Rule;

/// Largest number of odd harmonics.
const MOST_ODD: usize = MOST_HARMONICS.div_ceil(2);

/// Fourier coefficients of the force in a steady motion a cos θ. `cosine[i]` and `sine[i]` receive those of the harmonic n = 2i + 1; the
/// even ones vanish by Masing's rule.
///
/// `cosine[0]`/a is [`Backbone::harmonic_stiffness`], and -π a `sine[0]` is [`Backbone::dissipation`].
///
/// ```
/// use iwan_core::{FourParameter, one_harmonic};
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let (mut cosine, mut sine) = ([0.0; 3], [0.0; 3]);
/// one_harmonic(&joint, 0.6 * joint.phi_max(), &mut cosine, &mut sine)?;
/// assert!((cosine[0] / 179.00368718787860 - 1.0).abs() < 1e-14);
/// assert!((sine[2] / 0.7651743132561698 - 1.0).abs() < 1e-13);
/// # Ok::<(), iwan_core::Error>(())
/// ```
///
/// # Errors
/// [`Error::OutOfRange`] unless the amplitude `a` is finite and >= 0; [`Error::Length`] where the slices differ in length or
/// hold more than the 16 odd harmonics up to the 31st; [`Error::Unsupported`] for a law that does not obey Masing's rule.
pub fn one_harmonic<B: Backbone>(law: &B, a: f64, cosine: &mut [f64], sine: &mut [f64]) -> Result<(), Error> {
    check_masing(law)?;
    check("amplitude", a, a >= 0.0, "must be a finite number >= 0")?;
    check_length("sine", sine.len(), cosine.len())?;
    if cosine.len() > MOST_ODD {
        return Err(Error::Length { name: "cosine", needed: MOST_ODD, found: cosine.len() });
    }
    match law.power_law() {
        // For p >= 3 the integral's path cannot be turned at n = 3; no law of the literature has such an exponent.
        Some(power) if a <= power.limit && power.exponent > 1.0 && power.exponent < 3.0 => {
            closed_form(&power, a, cosine, sine);
        }
        _ => by_parts(law, a, cosine, sine),
    }
    Ok(())
}

/// The micro-slip loop of a power law.
fn closed_form(law: &PowerLaw, a: f64, cosine: &mut [f64], sine: &mut [f64]) {
    let p = law.exponent;
    let softening = law.coefficient * libm::pow(a, p);
    let whole = libm::tgamma(2.0 * p + 1.0) * libm::pow(4.0, -p);
    // Γ(2p+1) / (4^p Γ(p+n+1) Γ(p-n+1)), n = 0.
    let mut even = whole / (libm::tgamma(p + 1.0) * libm::tgamma(p + 1.0));
    let mut rest = Rest::new(p);
    let mut n = 0.0;
    for (index, (cosine, sine)) in cosine.iter_mut().zip(sine).enumerate() {
        let steps = if index == 0 { 1 } else { 2 };
        for _ in 0..steps {
            even *= (p - n) / (p + n + 1.0);
            rest.step();
            n += 1.0;
        }
        let linear = if index == 0 { law.stiffness * a } else { 0.0 };
        *cosine = linear - 4.0 * softening * even;
        *sine = -4.0 / PI * softening * if index == 0 { (p - 1.0) / (p + 1.0) } else { rest.value(whole) };
    }
}

/// The two parts of E_n in the upward recurrence.
struct Rest {
    p: f64,
    n: f64,
    /// (n - q) ∫ cosh^(2q)(y/2) e^(-ny) dy with q = p - 1.
    scaled: f64,
    /// Γ(n-p) / Γ(n+p+1), from n = 3 on.
    ratio: f64,
}

impl Rest {
    /// The parts at n = 1. There the integral is [2 (1-q) - cos(πq) 4^-q Γ(2-q) Γ(2q+1) / Γ(q+1)] / (q+1), divided by 1 - q, because the
    /// integral of sin^(2q)(θ/2) sin nθ vanishes at n = 0.
    fn new(p: f64) -> Self {
        let q = p - 1.0;
        let zero =
            libm::cos(PI * q) * libm::pow(4.0, -q) * libm::tgamma(2.0 - q) * libm::tgamma(2.0 * q + 1.0)
                / libm::tgamma(q + 1.0);
        let scaled = (2.0 * (1.0 - q) - zero) / (q + 1.0);
        let ratio = libm::tgamma(3.0 - p) / libm::tgamma(4.0 + p);
        Self { p, n: 0.0, scaled, ratio }
    }

    fn step(&mut self) {
        let (n, q) = (self.n, self.p - 1.0);
        if n >= 1.0 {
            self.scaled = (n + 1.0 - q) * (2.0 - self.scaled) / (n + q + 1.0);
        }
        if n >= 3.0 {
            self.ratio *= (n - self.p) / (n + self.p + 1.0);
        }
        self.n = n + 1.0;
    }

    /// E_n for n >= 3. Integration by parts gives ∫ (cosh^(2p) - 1) e^(-ny) = p [p/n - (p - ½) ∫ cosh^(2q) e^(-ny)] / (n² - p²).
    fn value(&self, whole: f64) -> f64 {
        let (n, p) = (self.n, self.p);
        let below = self.scaled / (n - (p - 1.0));
        let excess = p * (p / n - (p - 0.5) * below) / (n * n - p * p);
        -(libm::cos(PI * p) * whole * self.ratio + excess)
    }
}

/// Largest angle of a panel of sixteen nodes times the highest harmonic, rad: up to it the rule is exact to rounding.
const FASTEST: f64 = 4.0;

/// Coefficients for any law, integrated by parts: c_n + i s_n = (2a/iπn) ∫ K(a sin²(θ/2)) sin θ e^(inθ) dθ from 0 to the angle where all
/// sliders slip, because the force is constant beyond. The substitution by s^4 crowds the nodes at the start of a piece and so removes the
/// tangent's corner there.
fn by_parts<B: Backbone>(law: &B, a: f64, cosine: &mut [f64], sine: &mut [f64]) {
    cosine.fill(0.0);
    sine.fill(0.0);
    if a == 0.0 {
        return;
    }
    let (weakest, strongest) = law.strengths();
    let angle = |phi: f64| 2.0 * libm::asin(libm::sqrt((phi / a).min(1.0)));
    let mut from = 0.0;
    for to in [angle(weakest), angle(strongest)] {
        if to > from {
            between(law, a, [from, to], [&mut *cosine, &mut *sine]);
            from = to;
        }
    }
    for (index, (c, s)) in cosine.iter_mut().zip(sine).enumerate() {
        let factor = 2.0 * a / (PI * (2 * index + 1) as f64);
        // The factor 1/i exchanges the parts: the imaginary part of the integral gives the cosine's coefficient, minus the real part the
        // sine's.
        (*c, *s) = (factor * *s, -factor * *c);
    }
}

/// Adds ∫ K sin θ e^(inθ) between two angles; the tangent may have a corner at the first angle only.
fn between<B: Backbone>(law: &B, a: f64, [from, to]: [f64; 2], [re, im]: [&mut [f64]; 2]) {
    const RULE: Rule<16> = Rule::gauss_legendre();
    let span = to - from;
    // At the far end dθ/ds is four times the span.
    let panels =
        if law.is_smooth() { 1.0 } else { 16.0 } + libm::ceil(4.0 * span * (2 * re.len()) as f64 / FASTEST);
    let width = 1.0 / panels;
    let mut panel = 0.0;
    while panel < panels {
        for (x, w) in RULE.nodes.iter().zip(&RULE.weights) {
            let s = (panel + 0.5 * (1.0 + x)) * width;
            let theta = from + span * s * s * s * s;
            let half = libm::sin(0.5 * theta);
            let (sine, cosine) = libm::sincos(theta);
            let weight = 2.0 * w * width * span * s * s * s * law.tangent(a * half * half) * sine;
            let (mut c, mut d) = (weight * cosine, weight * sine);
            let (twice_c, twice_s) = (cosine * cosine - sine * sine, 2.0 * cosine * sine);
            for (re, im) in re.iter_mut().zip(im.iter_mut()) {
                *re += c;
                *im += d;
                (c, d) = (c * twice_c - d * twice_s, c * twice_s + d * twice_c);
            }
        }
        panel += 1.0;
    }
}
