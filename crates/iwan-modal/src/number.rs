//! Complex numbers, as the Fourier transforms and the matrices have them.

/// A complex number in double precision.
pub(crate) type Complex = nalgebra::Complex<f64>;

/// `re + i im`.
pub(crate) const fn complex(re: f64, im: f64) -> Complex {
    Complex { re, im }
}

/// The imaginary unit.
pub(crate) const I: Complex = complex(0.0, 1.0);

/// Median of finite values; 0 of nothing.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    let middle = sorted.len() / 2;
    if sorted.is_empty() { 0.0 } else { *sorted.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
