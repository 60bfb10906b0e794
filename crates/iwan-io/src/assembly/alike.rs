//! Whether channels that each have a clock of their own were sampled alike.

use super::assemble::Axis;
use crate::error::ReadError;
use crate::file_bytes::FileBytes;

/// Intervals of channels may differ by this part, two units of the fifth and last digit that an ASCII header of a universal file has.
const SAME_INTERVAL: f64 = 2e-5;
/// Starts of channels may differ by this part of an interval: to the nearest sample they are the same.
const SAME_START: f64 = 0.5;

/// Sampling of a channel that does not go with the others, in words.
pub(crate) struct Unlike {
    found: String,
    expected: String,
}

impl Unlike {
    fn new(found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { found: found.into(), expected: expected.into() }
    }

    /// The error of channel `name` beside the channel `reference`.
    pub(crate) fn refusal(self, source: &FileBytes, name: String, reference: String) -> ReadError {
        let Self { found, expected } = self;
        ReadError::Mismatch { file: source.file.into(), name, found, expected, reference }
    }
}

/// How the sampling found differs from the one expected, if it does.
pub(crate) fn unlike(expected: &Axis, found: &Axis) -> Option<Unlike> {
    match (expected, found) {
        (Axis::Even { start: s, step: a }, Axis::Even { start, step }) => {
            let same =
                (step - a).abs() <= SAME_INTERVAL * a.abs() && (start - s).abs() <= SAME_START * a.abs();
            let text = |start, step| format!("interval {step:e} s from {start:e} s");
            (!same).then(|| Unlike::new(text(*start, *step), text(*s, *a)))
        }
        (Axis::Times { values: a, .. }, Axis::Times { values: b, .. }) if a.len() != b.len() => {
            let text = |times: &[f64]| format!("{} samples", times.len());
            Some(Unlike::new(text(b), text(a)))
        }
        (Axis::Times { values: a, .. }, Axis::Times { values: b, .. }) => {
            (a != b).then(|| Unlike::new("other times", "the same times"))
        }
        (Axis::None, Axis::None) => None,
        _ => Some(Unlike::new("another kind of abscissa", "the same kind")),
    }
}
