//! Complex numbers, as the libraries for Fourier transforms and matrices use them, and sums.

/// A complex number in double precision.
pub(crate) type Complex = nalgebra::Complex<f64>;

/// `re + i im`.
pub(crate) const fn complex(re: f64, im: f64) -> Complex {
    Complex { re, im }
}

/// The imaginary unit.
pub(crate) const I: Complex = complex(0.0, 1.0);

/// Modal assurance criterion of two shapes of equal length: |a* b|² over their squared lengths; 0 for a shape without length.
pub(crate) fn assurance(a: &[Complex], b: &[Complex]) -> f64 {
    let product: Complex = a.iter().zip(b).map(|(a, b)| a.conj() * b).sum();
    let power = |x: &[Complex]| x.iter().map(Complex::norm_sqr).sum::<f64>();
    let whole = power(a) * power(b);
    if whole > 0.0 { product.norm_sqr() / whole } else { 0.0 }
}

/// Median of finite values; 0 where there are none.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    let middle = sorted.len() / 2;
    if sorted.is_empty() { 0.0 } else { *sorted.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Number of independent sequences in sums and searches for extremes: eight keep a processor's units busy, and give the same result on all machines.
const LANES: usize = 8;

/// Sum of values.
pub(crate) fn sum(values: &[f64]) -> f64 {
    let (chunks, rest) = values.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for chunk in chunks {
        sums.iter_mut().zip(chunk).for_each(|(sum, x)| *sum += x);
    }
    sums.iter().chain(rest).sum()
}

/// Smallest and largest of finite values; infinities where there are none.
pub(crate) fn extent(values: &[f64]) -> (f64, f64) {
    let (chunks, rest) = values.as_chunks::<LANES>();
    let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    for chunk in chunks {
        for (i, x) in chunk.iter().enumerate() {
            // A single instruction, unlike `min` and `max`, which also look for NaN.
            low[i] = if *x < low[i] { *x } else { low[i] };
            high[i] = if *x > high[i] { *x } else { high[i] };
        }
    }
    let all = |values: [f64; LANES], better: fn(f64, f64) -> f64| {
        values.into_iter().chain(rest.iter().copied()).reduce(better)
    };
    (all(low, f64::min).unwrap_or(f64::INFINITY), all(high, f64::max).unwrap_or(f64::NEG_INFINITY))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_extremes_take_every_value_once() {
        for count in 0..20 {
            let values: Vec<f64> = (0..count).map(|n| f64::from((n * 7) % 11) - 4.0).collect();
            assert_eq!(sum(&values), values.iter().sum::<f64>(), "{count}");
            let fold = |f: fn(f64, f64) -> f64, from: f64| values.iter().copied().fold(from, f);
            assert_eq!(
                extent(&values),
                (fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY)),
                "{count}"
            );
        }
    }
}
