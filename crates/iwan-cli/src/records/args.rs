//! Options of the commands that work on records.

use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};
use iwan_io::TimeUnit;

use crate::args::{finite, positive};

/// What is in a record and which mode is wanted.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "The record")]
pub(crate) struct RecordArgs {
    /// Name of the time vector: a column, a variable or a struct field such as HIdata.time
    #[arg(long, value_name = "NAME")]
    pub(crate) time: Option<String>,
    /// Name of a channel; repeat it for several [default: all that fit]
    #[arg(long = "channel", value_name = "NAME")]
    pub(crate) channels: Vec<String>,
    /// What the channels measure [default: what the file says, else acceleration]
    #[arg(long, value_enum)]
    pub(crate) quantity: Option<Motion>,
    /// Sampling rate in Hz, for files without time; goes before what the file says
    #[arg(long, value_name = "HZ", value_parser = positive)]
    pub(crate) rate: Option<f64>,
    /// Interpolate unevenly sampled records onto an even grid instead of refusing them
    #[arg(long)]
    pub(crate) resample: bool,
    /// Unit of the times: s, ms, us, ns, min or h; goes before what the file says
    #[arg(long, value_name = "UNIT", value_parser = time_unit)]
    pub(crate) time_unit: Option<TimeUnit>,
    /// Convert the samples to this unit, SI or a label such as m/s^2 [default: the unit of the file]
    #[arg(long, value_name = "UNIT")]
    pub(crate) unit: Option<String>,
    /// Cut the record before anything else: start in s, on the record's own clock
    #[arg(long, value_name = "S", value_parser = finite, allow_negative_numbers = true)]
    pub(crate) from: Option<f64>,
    /// Cut the record before anything else: end in s, on the record's own clock
    #[arg(long, value_name = "S", value_parser = finite, allow_negative_numbers = true)]
    pub(crate) to: Option<f64>,
    /// Which hits to use where one record holds several: all, first, or a number counted from 1
    #[arg(long, value_name = "WHICH", value_parser = hits, default_value = "all")]
    pub(crate) hits: Hits,
    /// Band of the mode in Hz; repeat it for several modes [default: around the highest spectral peak]
    #[arg(long = "band", value_name = "LOW:HIGH", value_parser = band)]
    pub(crate) bands: Vec<(f64, f64)>,
    /// Rough frequency of the mode in Hz: the band around the spectral peak nearest to it; repeat it for several modes
    #[arg(long = "mode", value_name = "HZ", value_parser = positive, conflicts_with_all = ["bands", "shapes"])]
    pub(crate) modes: Vec<f64>,
    /// Mass-normalised mode shapes as text: a header of channel names, one row for each mode; a column `frequency` (Hz)
    /// says where each mode is. Or a universal file with datasets 55, whose channels are called by node and direction as in 12:+z
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) shapes: Option<PathBuf>,
    /// Modal mass behind the record, for records that are not mass-normalised: q = sqrt(mass) x [default: 1]
    #[arg(long, value_name = "MASS", value_parser = mass, conflicts_with = "shapes")]
    pub(crate) mass: Option<f64>,
    /// Force on the axis of dissipation against force: of the joint alone, or the whole modal force
    #[arg(long, value_enum, default_value_t = Axis::Modal)]
    pub(crate) force_axis: Axis,
}

impl RecordArgs {
    /// Whether a mass or mode shapes make modal quantities of the record, which carry the root of a mass.
    pub(crate) fn mass_normalised(&self) -> bool {
        self.mass.is_some() || self.shapes.is_some()
    }
}

/// Ways to amplitude and frequency.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodChoice {
    /// Analytic signal and polynomials
    Hilbert,
    /// Peaks, zero crossings and cubic splines
    Peaks,
    /// Peak finding and fitting
    Pff,
    /// FREEVIB: Feldman's equations on the analytic signal
    Freevib,
}

/// Kinds of motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Motion {
    /// Second derivative of displacement
    Acceleration,
    /// First derivative of displacement
    Velocity,
    /// Displacement
    Displacement,
}

/// Forces on the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Axis {
    /// The joint's force
    Joint,
    /// The whole modal force
    Modal,
}

/// Which of several hits are used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Hits {
    /// Every one, as a record of its own.
    All,
    /// This one, counted from 0.
    One(usize),
}

/// Reads `all`, `first` or a number.
fn hits(text: &str) -> Result<Hits, String> {
    match (text, text.parse::<usize>()) {
        ("all", _) => Ok(Hits::All),
        ("first", _) => Ok(Hits::One(0)),
        (_, Ok(number)) if number > 0 => Ok(Hits::One(number - 1)),
        _ => Err("must be all, first, or a number counted from 1".into()),
    }
}

/// Reads a modal mass. Outside the range it is a slip of the hand, with which squares of amplitudes leave the range of numbers.
fn mass(text: &str) -> Result<f64, String> {
    let wrong = || "must lie between 1e-30 and 1e30".to_string();
    finite(text).ok().filter(|mass| (1e-30..=1e30).contains(mass)).ok_or_else(wrong)
}

/// Reads a unit of time.
fn time_unit(text: &str) -> Result<TimeUnit, String> {
    text.parse().map_err(|e: iwan_io::UnknownTimeUnit| e.to_string())
}

/// Reads `LOW:HIGH` in Hz.
pub(crate) fn band(text: &str) -> Result<(f64, f64), String> {
    let wrong = || "must be LOW:HIGH in Hz with 0 < LOW < HIGH, as in 60:105".to_string();
    let (low, high) = text.split_once(':').ok_or_else(wrong)?;
    match (positive(low), positive(high)) {
        (Ok(low), Ok(high)) if low < high => Ok((low, high)),
        _ => Err(wrong()),
    }
}
