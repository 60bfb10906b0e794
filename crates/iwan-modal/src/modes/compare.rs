//! Measures of how alike two shapes are, and of how real one shape is.

use crate::number::assurance;

/// Modal assurance criterion of two shapes, 0 (nothing in common) to 1 (the same but for a complex factor): R. J. Allemang, D. L. Brown,
/// *A correlation coefficient for modal vector analysis*, Proc. 1st IMAC, 1982. 0 for a shape without length, and for shapes of different length.
///
/// ```
/// use nalgebra::Complex;
/// let shape = |values: [f64; 3]| values.map(|x| Complex::new(x, 0.0));
/// assert_eq!(iwan_modal::modes::mac(&shape([1.0, 2.0, 3.0]), &shape([-2.0, -4.0, -6.0])), 1.0);
/// assert_eq!(iwan_modal::modes::mac(&shape([1.0, 1.0, 0.0]), &shape([1.0, -1.0, 5.0])), 0.0);
/// ```
#[must_use]
pub fn mac(a: &[nalgebra::Complex<f64>], b: &[nalgebra::Complex<f64>]) -> f64 {
    if a.len() == b.len() { assurance(a, b) } else { 0.0 }
}

/// Modal phase collinearity, 1 for a real shape in whatever phase, 0 for one that turns: R. S. Pappa, K. B. Elliott, A. Schenk, *Consistent-mode
/// indicator for the eigensystem realization algorithm*, J. Guidance 16:852, 1993. 0 for a shape without length.
///
/// ```
/// use nalgebra::Complex;
/// let turned = [1.0, -2.0, 0.5].map(|x| Complex::from_polar(x, 0.7));
/// assert!((iwan_modal::modes::phase_collinearity(&turned) - 1.0).abs() < 1e-12);
/// let circle = [Complex::new(1.0, 0.0), Complex::new(0.0, 1.0)];
/// assert_eq!(iwan_modal::modes::phase_collinearity(&circle), 0.0);
/// ```
#[must_use]
pub fn phase_collinearity(shape: &[nalgebra::Complex<f64>]) -> f64 {
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for v in shape {
        xx += v.re * v.re;
        yy += v.im * v.im;
        xy += v.re * v.im;
    }
    if xx + yy > 0.0 { ((xx - yy).powi(2) + 4.0 * xy * xy) / (xx + yy).powi(2) } else { 0.0 }
}
