//! What a reader noticed in a file and corrected, or left as it is.

use crate::quantity::Quantity;

/// A remark about a file that was read in spite of what the remark says.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Warning {
    /// A header promises another number of points than the file holds; the points that are there were read.
    #[error("{place}: the header promises {promised} points, the file holds {found}; these were read")]
    Count {
        /// Dataset or variable.
        place: String,
        /// Number of points in the header.
        promised: u64,
        /// Number of points read.
        found: usize,
    },
    /// A UFF 58b header promises another number of data bytes than the file holds; the points are whole.
    #[error("{place}: the header promises {promised} data bytes, the file holds {found}; these were read")]
    Bytes {
        /// Dataset.
        place: String,
        /// Number of bytes in the header.
        promised: u64,
        /// Number of bytes up to the end of the dataset.
        found: usize,
    },
    /// The line that closes a UFF dataset is missing at the end of the file.
    #[error("{place}: the closing line '-1' is missing at the end of the file")]
    Unclosed {
        /// Dataset.
        place: String,
    },
    /// The time column is written in too few digits to be exactly uniform.
    #[error("the times are rounded to {quantum:e} s; taken as uniform with the mean interval {dt:e} s")]
    RoundedTime {
        /// Step of the rounding in seconds.
        quantum: f64,
        /// Mean interval in seconds.
        dt: f64,
    },
    /// The times lie so near an even grid that the difference does not matter; they are taken as even.
    #[error("the times lie within {jitter:.1e} s of an even grid of {dt:.6e} s; taken as even")]
    NearlyEven {
        /// Largest distance of a time from the grid in seconds.
        jitter: f64,
        /// Interval of the grid in seconds.
        dt: f64,
    },
    /// The samples were interpolated onto a uniform grid.
    #[error(
        "the times are not uniform: {merged} repeat the one before, the longest gap is {gap:.3e} s, and they lie up to {jitter:.3e} s \
         off an even grid; resampled every {dt:e} s"
    )]
    Resampled {
        /// Largest distance of a time from the even grid in seconds.
        jitter: f64,
        /// Longest interval between two different times, in seconds.
        gap: f64,
        /// Number of times that equal the time before.
        merged: usize,
        /// Interval of the new grid in seconds.
        dt: f64,
    },
    /// The times have no unit, and sampling rate or length of the record are unlike a ring-down when the times are seconds.
    #[error(
        "the times have no unit; as seconds they mean {rate:.6} samples a second and a record of {duration:.6} s, which is unlike a ring-down: \
         --time-unit ms (us, min, ...) says otherwise, --time-unit s confirms it"
    )]
    TimeUnitDoubtful {
        /// Sampling rate in Hz when the times are seconds.
        rate: f64,
        /// Length of the record in seconds when the times are seconds.
        duration: f64,
    },
    /// The sampling rate given by the user differs from the file's by more than 1e-3 of it.
    #[error("the rate given, {used:?} Hz, was used in place of the file's, {stored:?} Hz")]
    RateReplaced {
        /// Rate of the file in Hz.
        stored: f64,
        /// Rate given and used, in Hz.
        used: f64,
    },
    /// Times were converted to seconds.
    #[error("times in {unit} were multiplied by {factor:e} to give seconds")]
    TimeScaled {
        /// Unit of the file.
        unit: String,
        /// Factor to seconds.
        factor: f64,
    },
    /// Samples were converted to another unit at the user's request.
    #[error("'{name}' in {from} was multiplied by {factor:e} to give {to}")]
    Converted {
        /// Channel.
        name: String,
        /// Unit of the file.
        from: String,
        /// Unit of the record.
        to: String,
        /// Factor between them.
        factor: f64,
    },
    /// A column was taken as time because it increases uniformly.
    #[error("'{name}' increases uniformly and was taken as time in seconds")]
    TimeAssumed {
        /// Name of the column.
        name: String,
    },
    /// A dataset 1858 of a universal file says that a window was applied to a function.
    #[error("{window} lies over '{name}' by its dataset 1858: {advice}")]
    Windowed {
        /// Channel or function.
        name: String,
        /// The window in words.
        window: String,
        /// What the window means for damping and amplitudes, and what to do.
        advice: &'static str,
    },
    /// A channel or dataset was not read.
    #[error("'{name}' was left out: {reason}")]
    LeftOut {
        /// Name of the channel, dataset or variable.
        name: String,
        /// Why.
        reason: String,
    },
    /// The quantity that the user gave replaced the file's.
    #[error("the file says {stored}, {used} was used as told")]
    QuantityReplaced {
        /// Quantity of the file.
        stored: Quantity,
        /// Quantity that the user gave, and that was used.
        used: Quantity,
    },
    /// The chosen channels measure different things or have different units.
    #[error("the channels measure different things: {list}")]
    Mixed {
        /// Channels with quantity and unit.
        list: String,
    },
    /// Lines above the table that are neither comments, names nor numbers.
    #[error("{lines} lines above the table were skipped")]
    Preamble {
        /// Number of lines.
        lines: usize,
    },
}
