//! Why a file could not be read: the place, what was found there, what is allowed, what helps.

use crate::record::RecordError;
use iwan_machine::{Kind, lacking};
use std::path::PathBuf;

/// Why a file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The operating system refused the file.
    #[error("{}: cannot be read: {source}; {}", .file.display(), lacking(source).unwrap_or("check the path and the permissions"))]
    Io {
        /// File.
        file: PathBuf,
        /// Reason given by the operating system.
        source: std::io::Error,
    },
    /// Neither the content nor the extension is one of the known formats.
    #[error("{}: unknown format ({found}); known are csv, tsv, txt, lvm, npy, npz, uff, unv, mat and wav: export to one of these", .file.display())]
    UnknownFormat {
        /// File.
        file: PathBuf,
        /// Extension and first bytes of the file, which decide its format.
        found: String,
    },
    /// A known format, in a variant that this library does not read.
    #[error("{}: {place}: {found} cannot be read; {remedy}", .file.display())]
    Unsupported {
        /// File.
        file: PathBuf,
        /// Dataset, variable, key or column.
        place: String,
        /// What stands there.
        found: String,
        /// What helps.
        remedy: String,
    },
    /// The bytes break the rules of the format.
    #[error("{}: {place}: found {found}, expected {expected}; export the file again, or repair this place", .file.display())]
    Malformed {
        /// File.
        file: PathBuf,
        /// Line, column, dataset, variable or byte offset.
        place: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        expected: String,
    },
    /// The file ends long before the number of points or bytes that its header promises is reached.
    #[error("{}: {place}: the file is cut short: {promised} {what} promised, {found} there; copy or export the file again, or put the true count into the header if nothing is missing", .file.display())]
    CutShort {
        /// File.
        file: PathBuf,
        /// Dataset, variable or byte offset.
        place: String,
        /// What is counted: points or bytes.
        what: &'static str,
        /// Number promised by the header.
        promised: u64,
        /// Number found.
        found: u64,
    },
    /// No time is stored and no rate was given.
    #[error("{}: {found}; give the sampling rate with --rate HZ, or name the time with --time NAME (there are: {names})", .file.display())]
    NoTime {
        /// File.
        file: PathBuf,
        /// Where a time was looked for, and what was found there.
        found: String,
        /// Names in the file.
        names: String,
    },
    /// A name given by the user does not stand in the file.
    #[error("{}: there is no {role} '{name}'; there are: {names}", .file.display())]
    UnknownName {
        /// File.
        file: PathBuf,
        /// `time` or `channel`.
        role: &'static str,
        /// Name given.
        name: String,
        /// Names in the file.
        names: String,
    },
    /// The file does not make clear which channels the user means.
    #[error("{}: {found}; choose with --channel NAME, or --quantity for channels that measure different things (there are: {names})", .file.display())]
    Ambiguous {
        /// File.
        file: PathBuf,
        /// Why it is not clear.
        found: String,
        /// Names in the file.
        names: String,
    },
    /// A channel is not as long as the time, or channels differ in their sampling.
    #[error("{}: '{name}' has {found}, expected {expected} as '{reference}' has; choose channels that belong together with --channel NAME, or export all with one rate and length", .file.display())]
    Mismatch {
        /// File.
        file: PathBuf,
        /// Channel.
        name: String,
        /// Its length or sampling.
        found: String,
        /// Length or sampling expected.
        expected: String,
        /// Name of the channel or time with that length or sampling.
        reference: String,
    },
    /// A time is smaller than the time before it.
    #[error("{}: '{name}' runs backwards in row {} of the numbers (sample {sample} counted from 0): {value} s after {previous} s; times must increase: sort or cut the record, or give --rate HZ", .file.display(), .sample + 1)]
    TimeOrder {
        /// File.
        file: PathBuf,
        /// Name of the time vector.
        name: String,
        /// Index of the sample, counted from 0.
        sample: usize,
        /// Its time in seconds.
        value: f64,
        /// Time before it in seconds.
        previous: f64,
    },
    /// The clock stutters: the same time is stored for several samples.
    #[error("{}: '{name}' says {value} s twice, in row {} of the numbers (sample {sample} counted from 0) again, and repeats itself at {count} of {samples} samples: the clock stutters; give --rate HZ where the samples were taken evenly (on average {rate:.6} Hz), or average and interpolate them with --resample", .file.display(), .sample + 1)]
    TimeRepeated {
        /// File.
        file: PathBuf,
        /// Name of the time vector.
        name: String,
        /// Index of the first sample whose time equals that of the sample before, counted from 0.
        sample: usize,
        /// Its time in seconds.
        value: f64,
        /// Number of samples whose time equals that of the sample before.
        count: usize,
        /// Number of samples.
        samples: usize,
        /// Samples a second on average.
        rate: f64,
    },
    /// The times increase unevenly.
    #[error("{}: '{name}' is not uniform: the interval before row {} of the numbers (sample {sample} counted from 0) is {interval:e} s, the mean is {dt:e} s, and the times lie up to {off:.2} of an interval off an even grid, allowed is {allowed}; resample with --resample, or give --rate HZ", .file.display(), .sample + 1)]
    NotUniform {
        /// File.
        file: PathBuf,
        /// Name of the time vector.
        name: String,
        /// Index of the sample at the end of the interval that differs most from the mean, counted from 0.
        sample: usize,
        /// The interval that differs most from the mean, in seconds.
        interval: f64,
        /// Mean interval in seconds.
        dt: f64,
        /// Largest distance of a time from the nearest even grid, in intervals.
        off: f64,
        /// The largest distance that is allowed, in intervals.
        allowed: f64,
    },
    /// The times have a unit that is no known unit of time.
    #[error("{}: '{name}' is in '{unit}', which is no unit of time (known are {known}); {remedy}", .file.display())]
    TimeUnit {
        /// File.
        file: PathBuf,
        /// Name of the time vector.
        name: String,
        /// What stands in place of a unit.
        unit: String,
        /// Units that are known.
        known: &'static str,
        /// The option that helps.
        remedy: &'static str,
    },
    /// Several time vectors that differ: one file holds records of different specimens or tests.
    #[error("{}: several times that differ stand in the file ({times}): its channels do not belong together; choose one with --time NAME, or channels with --channel NAME (there are: {names})", .file.display())]
    SeveralTimes {
        /// File.
        file: PathBuf,
        /// Names of the times.
        times: String,
        /// Names in the file.
        names: String,
    },
    /// A channel cannot be converted to the unit wanted.
    #[error("{}: channel '{name}' in '{unit}' cannot be converted to {wanted}: {reason}; leave --unit out, or convert the file", .file.display())]
    UnitConversion {
        /// File.
        file: PathBuf,
        /// Channel.
        name: String,
        /// Its unit.
        unit: String,
        /// Unit wanted.
        wanted: String,
        /// Why not.
        reason: &'static str,
    },
    /// The rate given is no sampling rate of a measurement.
    #[error("{}: the rate is {value:?} Hz; it must lie between 1e-9 and 1e15 Hz: give --rate HZ", .file.display())]
    Rate {
        /// File.
        file: PathBuf,
        /// Rate given in Hz.
        value: f64,
    },
    /// The values do not make a record.
    #[error("{}: {source}", .file.display())]
    Record {
        /// File.
        file: PathBuf,
        /// What is wrong with the values.
        source: RecordError,
    },
}

impl ReadError {
    /// The error's kind in the catalogue of errors.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::Io { source, .. } if source.kind() == std::io::ErrorKind::OutOfMemory => Kind::Memory,
            Self::Io { .. } => Kind::Unreadable,
            Self::UnknownFormat { .. } => Kind::UnknownFormat,
            Self::Unsupported { .. } => Kind::Unsupported,
            Self::Malformed { .. } => Kind::Damaged,
            Self::CutShort { .. } => Kind::CutShort,
            Self::NoTime { .. } => Kind::NoTime,
            Self::UnknownName { .. } => Kind::UnknownName,
            Self::Ambiguous { .. } => Kind::Ambiguous,
            Self::Mismatch { .. } => Kind::Mismatch,
            Self::TimeOrder { .. } => Kind::TimeOrder,
            Self::TimeRepeated { .. } => Kind::TimeRepeated,
            Self::NotUniform { .. } => Kind::TimeUneven,
            Self::TimeUnit { .. } => Kind::TimeUnit,
            Self::SeveralTimes { .. } => Kind::SeveralTimes,
            Self::UnitConversion { .. } => Kind::Unit,
            Self::Rate { .. } => Kind::Value,
            Self::Record { source, .. } => source.kind(),
        }
    }
}
