//! A range of time, frequency or any other quantity, given by its two ends.

use serde::Serialize;

/// From one value to another: the limits of a band, or the first and the last entry of a curve.
///
/// Serialised as a pair of numbers.
///
/// ```
/// use iwan_study::Span;
/// assert_eq!(Span::ends(&[3.0, 7.0, 5.0]), Span { from: 3.0, to: 5.0 });
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(into = "(f64, f64)")]
pub struct Span {
    /// The lower limit, or the value at the beginning.
    pub from: f64,
    /// The upper limit, or the value at the end.
    pub to: f64,
}

impl Span {
    /// The first and the last of some values; zeros where there are none.
    #[must_use]
    pub fn ends(values: &[f64]) -> Self {
        Self { from: values.first().copied().unwrap_or(0.0), to: values.last().copied().unwrap_or(0.0) }
    }
}

impl From<(f64, f64)> for Span {
    fn from((from, to): (f64, f64)) -> Self {
        Self { from, to }
    }
}

impl From<Span> for (f64, f64) {
    fn from(Span { from, to }: Span) -> Self {
        (from, to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_is_written_as_a_pair() {
        let text = serde_json::to_string(&Span { from: 120.0, to: 135.0 }).unwrap();
        assert_eq!(text, "[120.0,135.0]");
    }
}
