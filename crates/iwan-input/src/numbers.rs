//! Numbers as text.

/// A number with so many significant digits: plain from 0.001 up to `plain_below`, with an exponent elsewhere.
///
/// ```
/// use iwan_input::significant;
/// assert_eq!(significant(12.345, 4, 1e5), "12.35");
/// assert_eq!(significant(607_012.0, 4, 1e5), "6.070e5");
/// ```
#[must_use]
pub fn significant(value: f64, digits: u8, plain_below: f64) -> String {
    let behind = i32::from(digits.max(1)) - 1;
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-3..plain_below).contains(&size) => {
            let decimals = (behind - size.log10().floor() as i32).clamp(0, behind + 3) as usize;
            format!("{value:.decimals$}")
        }
        _ => format!("{value:.*e}", behind as usize),
    }
}
