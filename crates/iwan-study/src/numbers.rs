//! Numbers as the sentences and tables of a study write them.

/// A number with four digits, plain where that is short: between 0.001 and 100,000.
///
/// ```
/// use iwan_study::short;
/// assert_eq!([0.0, 0.30009, -1234.56].map(short), ["0", "0.3001", "-1235"]);
/// assert_eq!([2.75e5, 2.5e-4].map(short), ["2.750e5", "2.500e-4"]);
/// ```
#[must_use]
pub fn short(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        x if (1e-3..1e5).contains(&x) => {
            let digits = (3 - x.log10().floor() as i32).clamp(0, 6) as usize;
            format!("{value:.digits$}")
        }
        _ => format!("{value:.3e}"),
    }
}
