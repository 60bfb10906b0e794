//! The search along a direction that makes Newton's method on a convex function find its way from anywhere.

/// Goes along a direction in which a convex function falls with `slope`: the whole step, or, where the function rises again
/// at its end, shorter until it still falls there, but at most half as steeply as at the start. `fall` goes a part of
/// the step and tells how steeply the function falls there, or nothing when that settles it, which is then returned.
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
        // Secant, kept a twentieth of the interval off its ends: next to an end it would hardly shorten the interval.
        let (secant, margin) = (low.0 + (end - low.0) * low.1 / (low.1 - below), 0.05 * (end - low.0));
        length = if secant > low.0 + margin { secant } else { low.0 + margin };
        length = if length < end - margin { length } else { end - margin };
    }
}
