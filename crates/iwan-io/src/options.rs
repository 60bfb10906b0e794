//! What the user may say about a file before it is read.

use crate::quantity::Quantity;
use crate::time_unit::TimeUnit;

/// Formats of records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Columns of numbers as text: comma, semicolon, tab or white space between them.
    Text,
    /// One NumPy array.
    Npy,
    /// Several NumPy arrays in a zip archive.
    Npz,
    /// Universal file format, dataset 58 and 58b.
    Uff,
    /// MATLAB level 5 and 7.3.
    Mat,
    /// LabVIEW measurement file.
    Lvm,
    /// RIFF/WAVE sound file.
    Wav,
}

/// What the user says about a file. The default says nothing: format, time and channels are then found in the file.
///
/// ```
/// use iwan_io::{read_bytes, ReadOptions};
/// let options = ReadOptions { rate: Some(100.0), ..ReadOptions::default() };
/// let record = read_bytes("one.csv".as_ref(), b"acc [m/s^2]\n1\n2\n3\n", &options)?;
/// assert_eq!((record.dt(), record.unit()), (0.01, "m/s^2"));
/// # Ok::<(), iwan_io::ReadError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ReadOptions {
    /// Format; `None`: found from content and extension.
    pub format: Option<Format>,
    /// Name of the time vector: a column, a variable, or a struct field such as `HIdata.time`.
    pub time: Option<String>,
    /// Names of the channels in the order wanted; empty: all channels that fit the time.
    pub channels: Vec<String>,
    /// Sampling rate in Hz, finite and > 0; it overrides what the file says.
    pub rate: Option<f64>,
    /// Quantity; it overrides what the file says, and chooses among channels of several quantities.
    pub quantity: Option<Quantity>,
    /// Interpolate non-uniform samples onto a uniform grid instead of refusing them.
    pub resample: bool,
    /// Unit of the times; it overrides what the file says.
    pub time_unit: Option<TimeUnit>,
    /// Convert samples to this unit: `SI` (m, m/s, m/s^2, rad, N, ...), or a label such as `m/s^2` or `mm`; `None`: samples stay as they
    /// are.
    pub unit: Option<String>,
}
