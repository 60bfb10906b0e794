//! The uniformly sampled record; its values are checked once, when it is made.

use crate::quantity::Quantity;
use crate::warning::Warning;
use iwan_machine::Kind;

/// Why values do not make a [`Record`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The sampling interval is zero, negative, NaN or infinite.
    #[error("the sampling interval is {value} s; it must be finite and greater than 0")]
    Step {
        /// The interval given, in seconds.
        value: f64,
    },
    /// The time of the first sample is NaN or infinite.
    #[error("the start time is {value} s; it must be finite")]
    Start {
        /// The start time given, in seconds.
        value: f64,
    },
    /// No channel at all.
    #[error("the record has no channel; it needs at least one")]
    NoChannel,
    /// The number of names differs from the number of channels.
    #[error("{names} names for {channels} channels; give one name for each channel")]
    Names {
        /// Number of names.
        names: usize,
        /// Number of channels.
        channels: usize,
    },
    /// Fewer than two samples.
    #[error("channel '{channel}' has {samples} samples; a record needs at least 2")]
    TooShort {
        /// Name of the channel.
        channel: String,
        /// Its number of samples.
        samples: usize,
    },
    /// Channels of different lengths.
    #[error(
        "channel '{channel}' has {samples} samples, the first channel has {expected}; all must be equally long"
    )]
    Lengths {
        /// Name of the channel.
        channel: String,
        /// Its number of samples.
        samples: usize,
        /// Number of samples of the first channel.
        expected: usize,
    },
    /// A stretch that holds fewer than two samples.
    #[error(
        "from {from} to {to} s there are {samples} samples, at least 2 are needed; the record runs from {start} to {end} s: choose a stretch within it"
    )]
    Stretch {
        /// Start wanted in seconds.
        from: f64,
        /// End wanted in seconds.
        to: f64,
        /// Number of samples in the stretch.
        samples: usize,
        /// Time of the first sample in seconds.
        start: f64,
        /// Time of the last sample in seconds.
        end: f64,
    },
    /// A sample is NaN or infinite.
    #[error(
        "channel '{channel}', sample {sample} (counted from 0) is {value}; every sample must be finite: cut the record there, or repair the value"
    )]
    NotFinite {
        /// Name of the channel.
        channel: String,
        /// Index of the sample, counted from 0.
        sample: usize,
        /// The value found.
        value: f64,
    },
}

impl RecordError {
    /// The error's kind in the catalogue of errors.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Step { .. } | Self::Start { .. } | Self::Names { .. } => Kind::Value,
            Self::NoChannel => Kind::Ambiguous,
            Self::TooShort { .. } => Kind::TooShort,
            Self::Lengths { .. } => Kind::Mismatch,
            Self::Stretch { .. } => Kind::Stretch,
            Self::NotFinite { .. } => Kind::NotFinite,
        }
    }
}

/// One or many channels sampled together at a constant interval.
///
/// Guaranteed by construction: the interval is finite and positive, there is at least one channel, all channels
/// are equally long with at least two samples, and every sample is finite.
///
/// ```
/// use iwan_io::{Quantity, Record};
/// let record = Record::new(0.5, vec![vec![0.0, 1.0, 4.0]], vec!["tip".into()])?.with_quantity(Quantity::Displacement, "m");
/// assert_eq!(record.time(2), 1.0);
/// assert_eq!(record.channel(0), [0.0, 1.0, 4.0]);
/// assert!(Record::new(0.0, vec![vec![0.0, 1.0]], vec!["tip".into()]).is_err());
/// # Ok::<(), iwan_io::RecordError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    dt: f64,
    start: f64,
    samples: Vec<Vec<f64>>,
    names: Vec<String>,
    quantity: Quantity,
    unit: String,
    warnings: Vec<Warning>,
}

impl Record {
    /// Checks and keeps `samples` (channels x samples) taken every `dt` seconds; the first one at time 0.
    ///
    /// # Errors
    /// [`RecordError`] when one of the conditions named at [`Record`] does not hold; it names the channel and sample.
    pub fn new(dt: f64, samples: Vec<Vec<f64>>, names: Vec<String>) -> Result<Self, RecordError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(RecordError::Step { value: dt });
        }
        check_channels(&samples, &names)?;
        let (quantity, unit, warnings) = (Quantity::Unknown, String::new(), Vec::new());
        Ok(Self { dt, start: 0.0, samples, names, quantity, unit, warnings })
    }

    /// The same record with its first sample at `start` seconds.
    ///
    /// # Errors
    /// [`RecordError::Start`] unless `start` is finite.
    pub fn with_start(mut self, start: f64) -> Result<Self, RecordError> {
        if !start.is_finite() {
            return Err(RecordError::Start { value: start });
        }
        self.start = start;
        Ok(self)
    }

    /// The same record with its quantity and the unit of its samples as text (empty = not known).
    #[must_use]
    pub fn with_quantity(mut self, quantity: Quantity, unit: impl Into<String>) -> Self {
        self.quantity = quantity;
        self.unit = unit.into();
        self
    }

    /// The samples from `from` to `to` (s, on the record's own clock, both included; `None`: from the first, or to the last sample). The
    /// reader's warnings are kept.
    ///
    /// # Errors
    /// [`RecordError::Stretch`] where fewer than two samples are left, or a time is NaN.
    ///
    /// ```
    /// let record = iwan_io::Record::new(0.5, vec![vec![0.0, 1.0, 4.0, 9.0]], vec!["tip".into()])?.with_start(-0.5)?;
    /// let cut = record.between(Some(0.0), None)?;
    /// assert_eq!((cut.start(), cut.channel(0)), (0.0, &[1.0, 4.0, 9.0][..]));
    /// assert!(record.between(Some(2.0), None).is_err());
    /// # Ok::<(), iwan_io::RecordError>(())
    /// ```
    pub fn between(&self, from: Option<f64>, to: Option<f64>) -> Result<Self, RecordError> {
        let (n, end) = (self.len(), self.time(self.len() - 1));
        // A time that is written as that of a sample means this sample, although it may differ in the last bits: hence 1e-6 of an interval.
        let place = |t: f64| (t - self.start) / self.dt;
        let first = from.map_or(0.0, |t| (place(t) - 1e-6).ceil().max(0.0));
        let last = to.map_or(n as f64 - 1.0, |t| (place(t) + 1e-6).floor().min(n as f64 - 1.0));
        let (from, to) = (from.unwrap_or(self.start), to.unwrap_or(end));
        if last < first + 1.0 || from.is_nan() || to.is_nan() {
            let samples = usize::from(last >= first && !from.is_nan() && !to.is_nan());
            return Err(RecordError::Stretch { from, to, samples, start: self.start, end });
        }
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // whole numbers from 0 to n - 1
        let (first, last) = (first as usize, last as usize);
        let samples = self.samples.iter().map(|c| c[first..=last].to_vec()).collect();
        Ok(Self {
            start: self.time(first),
            samples,
            names: self.names.clone(),
            unit: self.unit.clone(),
            warnings: self.warnings.clone(),
            ..*self
        })
    }

    /// Whether another record holds the same samples and so is the same record, whatever its file is called. Such a copy adds no
    /// information, but would make every estimate look more certain.
    ///
    /// ```
    /// use iwan_io::Record;
    /// let record = |x: f64| Record::new(0.5, vec![vec![0.0, x]], vec!["tip".into()]);
    /// assert!(record(1.0)?.is_copy_of(&record(1.0)?) && !record(1.0)?.is_copy_of(&record(2.0)?));
    /// # Ok::<(), iwan_io::RecordError>(())
    /// ```
    #[must_use]
    pub fn is_copy_of(&self, other: &Self) -> bool {
        self.samples == other.samples
    }

    pub(crate) fn with_warnings(mut self, warnings: Vec<Warning>) -> Self {
        self.warnings = warnings;
        self
    }

    /// Sampling interval in seconds.
    #[must_use]
    pub fn dt(&self) -> f64 {
        self.dt
    }

    /// Sampling rate in Hz, `1 / dt`.
    #[must_use]
    pub fn rate(&self) -> f64 {
        1.0 / self.dt
    }

    /// Time of the first sample in seconds.
    #[must_use]
    pub fn start(&self) -> f64 {
        self.start
    }

    /// Time of sample `i` in seconds, `start + i dt`.
    #[must_use]
    pub fn time(&self, i: usize) -> f64 {
        self.start + i as f64 * self.dt
    }

    /// All channels.
    #[must_use]
    pub fn samples(&self) -> &[Vec<f64>] {
        &self.samples
    }

    /// Samples of channel `i`, counted from 0.
    ///
    /// # Panics
    /// When there is no channel `i`; [`Record::channels`] says how many there are.
    #[must_use]
    pub fn channel(&self, i: usize) -> &[f64] {
        &self.samples[i]
    }

    /// Samples of the first channel called `name`.
    #[must_use]
    pub fn channel_named(&self, name: &str) -> Option<&[f64]> {
        let i = self.names.iter().position(|n| n == name)?;
        Some(&self.samples[i])
    }

    /// Number of channels, at least 1.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.samples.len()
    }

    /// Number of samples of each channel, at least 2.
    #[must_use]
    pub fn len(&self) -> usize {
        self.samples[0].len()
    }

    /// Always false: a record has at least two samples.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Names of the channels, in their order.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// What the samples measure.
    #[must_use]
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// Unit of the samples as the file writes it; empty when it says none.
    #[must_use]
    pub fn unit(&self) -> &str {
        &self.unit
    }

    /// What the reader noticed in the file and corrected, or left as it is.
    #[must_use]
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Whether the file says that a window lies over a channel ([`Warning::Windowed`]): a decay is then the structure's and the window's together.
    #[must_use]
    pub fn is_windowed(&self) -> bool {
        self.warnings.iter().any(|warning| matches!(warning, Warning::Windowed { .. }))
    }

    /// The channels by value.
    #[must_use]
    pub fn into_samples(self) -> Vec<Vec<f64>> {
        self.samples
    }
}

fn check_channels(samples: &[Vec<f64>], names: &[String]) -> Result<(), RecordError> {
    let Some(first) = samples.first() else { return Err(RecordError::NoChannel) };
    if names.len() != samples.len() {
        return Err(RecordError::Names { names: names.len(), channels: samples.len() });
    }
    for (channel, name) in samples.iter().zip(names) {
        check_channel(channel, name, first.len())?;
    }
    Ok(())
}

fn check_channel(channel: &[f64], name: &str, expected: usize) -> Result<(), RecordError> {
    let samples = channel.len();
    if samples < 2 {
        return Err(RecordError::TooShort { channel: name.into(), samples });
    }
    if samples != expected {
        return Err(RecordError::Lengths { channel: name.into(), samples, expected });
    }
    match channel.iter().position(|v| !v.is_finite()) {
        Some(sample) => Err(RecordError::NotFinite { channel: name.into(), sample, value: channel[sample] }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(n: usize) -> Vec<String> {
        (0..n).map(|i| format!("c{i}")).collect()
    }

    #[test]
    fn a_record_needs_a_positive_finite_interval() {
        for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let made = Record::new(dt, vec![vec![0.0; 3]], names(1));
            assert!(matches!(made, Err(RecordError::Step { .. })), "{dt}");
        }
    }

    #[test]
    fn channels_are_equally_long_and_named() {
        assert_eq!(Record::new(1.0, vec![], vec![]), Err(RecordError::NoChannel));
        let uneven = Record::new(1.0, vec![vec![0.0; 3], vec![0.0; 2]], names(2));
        assert!(matches!(uneven, Err(RecordError::Lengths { samples: 2, expected: 3, .. })));
        assert!(matches!(
            Record::new(1.0, vec![vec![0.0; 3]], names(2)),
            Err(RecordError::Names { names: 2, channels: 1 })
        ));
        assert!(matches!(Record::new(1.0, vec![vec![0.0]], names(1)), Err(RecordError::TooShort { .. })));
    }

    #[test]
    fn a_value_that_is_not_finite_is_named_by_channel_and_sample() {
        let made = Record::new(1.0, vec![vec![0.0; 3], vec![0.0, 1.0, f64::NAN]], names(2));
        let text = made.expect_err("NaN is refused").to_string();
        assert!(text.contains("'c1'") && text.contains("sample 2"), "{text}");
    }

    #[test]
    fn times_start_where_they_are_told_to() {
        let record = Record::new(0.25, vec![vec![0.0; 3]], names(1)).unwrap().with_start(-1.0).unwrap();
        assert_eq!(record.time(2), -0.5);
        assert_eq!(record.rate(), 4.0);
        assert!(record.with_start(f64::NAN).is_err());
    }
}
