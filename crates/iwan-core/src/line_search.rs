//! The line search with which Newton's method on a convex function converges from any start.

/// Searches along a direction in which a convex function falls with `slope` > 0 (minus its derivative for a step of length 1). The search
/// takes the whole step if the function still falls at its end. Otherwise the search shortens the step until the function still falls at
/// its end, but at most half as steeply as at the start. `fall` evaluates the function's fall after a given part of the step; it returns
/// `None` when the caller accepts that point as the solution, and the search then returns true.
///
/// ```
/// // x²/2 - x from x = 0 with a step of 4: the function rises again behind x = 1.
/// let mut x = 0.0;
/// let settled = iwan_core::search_line(4.0, |part| {
///     x = 4.0 * part;
///     Some(4.0 * (1.0 - x))
/// });
/// assert!(!settled && x > 0.5 && x <= 1.0);
/// ```
pub fn search_line(slope: f64, mut fall: impl FnMut(f64) -> Option<f64>) -> bool {
    let (mut low, mut high, mut length) = ((0.0, slope), None, 1.0);
    loop {
        let Some(here) = fall(length) else { return true };
        if here >= 0.0 {
            if high.is_none() || here <= 0.5 * slope {
                return false;
            }
            low = (length, here);
        } else {
            high = Some((length, here));
        }
        let Some((end, below)) = high else { return false };
        // The interval is at the rounding of a step of length 1: no point inside is any better.
        if end - low.0 <= 1e-12 {
            return false;
        }
        // Secant, kept a twentieth of the interval away from both ends: a point next to an end would hardly shorten the interval.
        let (secant, margin) = (low.0 + (end - low.0) * low.1 / (low.1 - below), 0.05 * (end - low.0));
        length = if secant > low.0 + margin { secant } else { low.0 + margin };
        length = if length < end - margin { length } else { end - margin };
    }
}
