//! Whether channels that each have times of their own were sampled at the same times.

use super::assemble::Axis;
use crate::error::ReadError;
use crate::file_bytes::FileBytes;

/// Largest relative difference of two channels' intervals, two units of the fifth and last digit that an ASCII header of a universal file
/// has. Channels that differ by more are refused.
pub(crate) const SAME_INTERVAL: f64 = 2e-5;
/// Largest difference of two channels' starts, as a part of an interval: within it they are the same to the nearest sample. Channels that
/// differ by more are refused.
const SAME_START: f64 = 0.5;

/// In words: the sampling of a channel that differs from the others', and the sampling expected.
pub(crate) struct Unlike {
    found: String,
    expected: String,
}

impl Unlike {
    fn new(found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self { found: found.into(), expected: expected.into() }
    }

    /// The error of channel `name`, whose sampling differs from that of the channel `reference`.
    pub(crate) fn refusal(self, source: &FileBytes, name: String, reference: String) -> ReadError {
        let Self { found, expected } = self;
        ReadError::Mismatch { file: source.file.into(), name, found, expected, reference }
    }
}

/// How the sampling found differs from the sampling expected; none where it does not differ.
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
