//! Numbers as the sentences and tables of a study write them.

/// A number with four digits, plain where that is short: between 0.001 and 100,000.
///
/// ```
/// use iwan_study::short;
/// assert_eq!((short(0.0), short(0.30009), short(-1234.56)), ("0".into(), "0.3001".into(), "-1235".into()));
/// assert_eq!((short(2.75e5), short(2.5e-4)), ("2.750e5".into(), "2.500e-4".into()));
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
