//! The relative difference between two records.

/// Root mean square of `x - reference` over that of `reference`; both have the same number of samples.
///
/// ```
/// let apart = iwan_study::relative_difference(&[3.0, 4.4], &[3.0, 4.0]);
/// assert!((apart - 0.4 / 5.0).abs() < 1e-15);
/// ```
#[must_use]
pub fn relative_difference(x: &[f64], reference: &[f64]) -> f64 {
    debug_assert_eq!(x.len(), reference.len());
    let square = |x: &mut dyn Iterator<Item = f64>| x.map(|x| x * x).sum::<f64>();
    let difference = square(&mut x.iter().zip(reference).map(|(a, b)| a - b));
    (difference / square(&mut reference.iter().copied())).sqrt()
}
