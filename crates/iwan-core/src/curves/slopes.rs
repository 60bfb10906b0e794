//! Slopes of a monotone cubic through given points.

/// One secant between neighbouring points: its width in x, and its slope.
#[derive(Debug, Clone, Copy)]
pub(super) struct Secant {
    pub(super) width: f64,
    pub(super) slope: f64,
}

/// Slope at a point between two secants: their weighted harmonic mean, or 0 where they have opposite signs, so that the cubic has no
/// extremum between its points (F. N. Fritsch and J. Butland, A method for constructing local monotone piecewise cubic interpolants, SIAM
/// J. Sci. Stat. Comput. 5:300, 1984; most libraries call this PCHIP).
pub(super) fn inner(before: Secant, after: Secant) -> f64 {
    if before.slope * after.slope <= 0.0 {
        return 0.0;
    }
    let (w, x) = (2.0 * after.width + before.width, after.width + 2.0 * before.width);
    (w + x) / (w / before.slope + x / after.slope)
}

/// Slope at an end point: that of the parabola through the end point and the next two, limited to between 0 and three times the first
/// secant's slope (C. Moler, Numerical Computing with MATLAB, 2004, Sec. 3.6). `first` is the secant at the end point, `second` the one
/// next to it.
pub(super) fn end(first: Secant, second: Option<Secant>) -> f64 {
    let Some(second) = second else { return first.slope };
    let (h, g) = (first.width, second.width);
    let slope = ((2.0 * h + g) * first.slope - h * second.slope) / (h + g);
    if slope * first.slope <= 0.0 {
        0.0
    } else if first.slope * second.slope <= 0.0 && libm::fabs(slope) > 3.0 * libm::fabs(first.slope) {
        3.0 * first.slope
    } else {
        slope
    }
}

/// The cubic on 0 <= s <= 1 with given values and slopes at both ends; the slopes are multiplied by the width.
pub(super) fn hermite(s: f64, [a, da]: [f64; 2], [b, db]: [f64; 2]) -> f64 {
    let r = 1.0 - s;
    r * r * ((1.0 + 2.0 * s) * a + s * da) + s * s * ((1.0 + 2.0 * r) * b - r * db)
}
