//! Numbers as text, for messages, tables and sentences.

/// A number with four significant digits; without an exponent from 0.001 up to 100,000.
///
/// ```
/// use iwan_sim::numbers::short;
/// assert_eq!([0.0, 0.30009, -1234.56].map(short), ["0", "0.3001", "-1235"]);
/// assert_eq!([2.75e5, 2.5e-4].map(short), ["2.750e5", "2.500e-4"]);
/// ```
#[must_use]
pub fn short(value: f64) -> String {
    significant(value, 4, 1e5)
}

/// A number with `digits` significant digits; without an exponent from 0.001 up to `plain_below`.
///
/// ```
/// assert_eq!(iwan_sim::numbers::significant(80.123_456_7, 7, 1e7), "80.12346");
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
