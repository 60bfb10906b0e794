//! From record files and options to the records of single modes; all commands read records here.

use iwan_machine::listed;
use std::path::Path;

use iwan_ident::channels::{NoMode, Shape, one_mode};
use iwan_ident::curves::Quantity;
use iwan_ident::signal::{Options, band_near};
use iwan_io::{ReadOptions, Record, Warning};
use iwan_machine::memory::ask;

use super::args::{MethodChoice, Motion, RecordArgs};
use super::shapes::Shapes;
use crate::failure::Failure;
use crate::session::Session;
use crate::shown;

/// Memory in bytes that the analysis of a record takes per sample: measured 305, for the envelopes of a million samples by all methods.
const ANALYSIS: u64 = 320;

/// A record file as read, with the quantity it measures.
#[derive(Debug, Clone)]
pub(crate) struct Recording {
    /// Path as the user wrote it.
    pub(crate) name: String,
    pub(crate) record: Record,
    pub(crate) quantity: Quantity,
    /// What the reader noticed, and what was assumed, as sentences.
    pub(crate) warnings: Vec<String>,
    /// Those of the warnings that make the results doubtful: of windows over the samples, whose damping is found with the structure's.
    pub(crate) doubts: Vec<String>,
    /// Whether a window lies over the samples, as their file says.
    pub(crate) windowed: bool,
}

/// The record of one mode, in the unit of the file times the root of the modal mass.
#[derive(Debug, Clone)]
pub(crate) struct ModalRecord {
    /// Index of the recording from which the record comes.
    pub(crate) source: usize,
    pub(crate) samples: Vec<f64>,
}

/// A mode to be extracted, with one record for each recording.
#[derive(Debug, Clone)]
pub(crate) struct Wanted {
    pub(crate) name: String,
    /// Number of the mode among the mode shapes, or among the bands, from 0.
    pub(crate) number: usize,
    /// How the mode is isolated: its band, or a frequency near it.
    pub(crate) options: Options,
    pub(crate) records: Vec<ModalRecord>,
    /// Notes on how the channels were combined.
    pub(crate) notes: Vec<String>,
}

/// Reads one file as the options say.
pub(crate) fn read(path: &Path, args: &RecordArgs) -> Result<Recording, Failure> {
    let name = shown::path(path);
    let options = ReadOptions {
        format: None,
        time: args.time.clone(),
        channels: args.channels.clone(),
        rate: args.rate,
        quantity: args.quantity.map(|q| match q {
            Motion::Acceleration => iwan_io::Quantity::Acceleration,
            Motion::Velocity => iwan_io::Quantity::Velocity,
            Motion::Displacement => iwan_io::Quantity::Displacement,
        }),
        resample: args.resample,
        time_unit: args.time_unit,
        unit: args.unit.clone(),
    };
    let record = iwan_io::read(path, &options).map_err(|e| Failure::read(&name, &e))?;
    let record = record.between(args.from, args.to).map_err(|e| Failure::said(&name, &e))?;
    let numbers = record.samples().iter().map(Vec::len).sum::<usize>() as u64;
    let remedy = "cut the record with --from and --to, or sample it less often";
    ask(format!("{name}: the analysis of {numbers} samples"), numbers.saturating_mul(ANALYSIS), remedy)?;
    let mut warnings: Vec<String> = record.warnings().iter().map(|w| format!("{name}: {w}")).collect();
    let windowed = |w: &&Warning| matches!(w, Warning::Windowed { .. });
    let doubts = record.warnings().iter().filter(windowed).map(|w| format!("{name}: {w}")).collect();
    let quantity = motion(&name, &record, &mut warnings)?;
    let windowed = record.is_windowed();
    Ok(Recording { name, record, quantity, warnings, doubts, windowed })
}

/// The kind of motion that the channels measure. Where the channels measure no motion, or their unit is not known, the user is asked; they are never
/// simply taken for accelerations.
fn motion(name: &str, record: &Record, warnings: &mut Vec<String>) -> Result<Quantity, Failure> {
    let channels = listed(record.names());
    match record.quantity() {
        iwan_io::Quantity::Acceleration => Ok(Quantity::Acceleration),
        iwan_io::Quantity::Velocity => Ok(Quantity::Velocity),
        iwan_io::Quantity::Displacement => Ok(Quantity::Displacement),
        iwan_io::Quantity::Unknown if record.unit().is_empty() => {
            warnings.push(format!(
                "{name}: the file does not say what it measures: taken as acceleration; --quantity says otherwise"
            ));
            Ok(Quantity::Acceleration)
        }
        other => {
            let message = if other == iwan_io::Quantity::Unknown {
                format!("{name}: {channels} in \"{}\": what that measures is not known", record.unit())
            } else {
                format!("{name}: {channels} measures {other}, not a motion")
            };
            let remedy = "choose channels of motion with --channel NAME, or say with --quantity what motion the numbers are \
                          proportional to (amplitudes and forces are then in the unit of the file)";
            Err(Failure::input(message, remedy))
        }
    }
}

/// The modes that the options ask for, extracted from recordings that have the same channels.
pub(crate) fn modes(recordings: &[Recording], args: &RecordArgs) -> Result<Vec<Wanted>, Failure> {
    same_channels(recordings)?;
    no_copies(recordings)?;
    let shapes = args.shapes.as_ref().map(|path| Shapes::read(path, recordings[0].record.names()));
    taken(
        recordings,
        &Sought {
            shapes: shapes.transpose()?,
            bands: args.bands.clone(),
            near: args.modes.clone(),
            mass: args.mass.unwrap_or(1.0),
        },
    )
}

/// Which modes are sought, as the options say.
#[derive(Debug, Clone)]
pub(crate) struct Sought {
    pub(crate) shapes: Option<Shapes>,
    /// Frequency bands, Hz.
    pub(crate) bands: Vec<(f64, f64)>,
    /// Rough frequencies, Hz, where there are neither bands nor shapes.
    pub(crate) near: Vec<f64>,
    /// Modal mass.
    pub(crate) mass: f64,
}

impl Sought {
    /// Extracts these modes from recordings that have the same channels.
    pub(crate) fn modes(&self, recordings: &[Recording]) -> Result<Vec<Wanted>, Failure> {
        same_channels(recordings)?;
        no_copies(recordings)?;
        taken(recordings, self)
    }
}

fn taken(recordings: &[Recording], sought: &Sought) -> Result<Vec<Wanted>, Failure> {
    let mut wanted = match &sought.shapes {
        Some(shapes) => by_shapes(recordings, shapes, &sought.bands)?,
        None => by_bands(recordings, sought)?,
    };
    let scale = sought.mass.sqrt();
    let samples = wanted.iter_mut().flat_map(|w| &mut w.records).flat_map(|r| &mut r.samples);
    samples.for_each(|x| *x *= scale);
    Ok(wanted)
}

/// Refuses recordings with different channels: several force levels of one structure must have the same ones.
fn same_channels(recordings: &[Recording]) -> Result<(), Failure> {
    let first = &recordings[0];
    for other in &recordings[1..] {
        let differ = if other.record.names() != first.record.names() {
            format!("channels {} and {}", listed(first.record.names()), listed(other.record.names()))
        } else if other.quantity != first.quantity {
            format!("{:?} and {:?}", first.quantity, other.quantity).to_lowercase()
        } else if other.record.unit() != first.record.unit() {
            format!("units \"{}\" and \"{}\"", first.record.unit(), other.record.unit())
        } else {
            continue;
        };
        let message = format!("{} and {} do not belong together: {differ}", first.name, other.name);
        let remedy = "give records of the same channels, or choose them with --channel and --quantity";
        return Err(Failure::input(message, remedy));
    }
    Ok(())
}

/// Refuses a record that occurs twice: a copy would narrow every interval without adding information.
fn no_copies(recordings: &[Recording]) -> Result<(), Failure> {
    for (n, one) in recordings.iter().enumerate() {
        if let Some(other) = recordings[..n].iter().find(|other| one.record.is_copy_of(&other.record)) {
            let message =
                format!("{} holds the same samples as {}: it is the same record", one.name, other.name);
            return Err(Failure::input(message, "give every record once"));
        }
    }
    Ok(())
}

/// The channels of a recording.
fn channels(recording: &Recording) -> iwan_ident::channels::Recording<'_> {
    let Recording { record, .. } = recording;
    let channels = record.samples().iter().map(Vec::as_slice).collect();
    iwan_ident::channels::Recording { names: record.names(), channels, dt: record.dt() }
}

/// Modes without given shapes: from the one channel, or from the dominant shape of all channels in each band.
fn by_bands(recordings: &[Recording], sought: &Sought) -> Result<Vec<Wanted>, Failure> {
    let bands: Vec<_> = match sought.bands.as_slice() {
        [] if sought.near.is_empty() => vec![None],
        [] => sought
            .near
            .iter()
            .map(|near| around(&recordings[0], *near).map(Some))
            .collect::<Result<_, _>>()?,
        bands => bands.iter().copied().map(Some).collect(),
    };
    let mode = |(n, band): (usize, Option<(f64, f64)>)| {
        let options = Options { band, ..Options::default() };
        wanted(recordings, n, Shape::Unknown, options, "")
    };
    bands.into_iter().enumerate().map(mode).collect()
}

/// The band around the spectral peak nearest to a frequency.
fn around(recording: &Recording, near: f64) -> Result<(f64, f64), Failure> {
    let channels: Vec<&[f64]> = recording.record.samples().iter().map(Vec::as_slice).collect();
    let band =
        band_near(&channels, recording.record.dt(), near).map_err(|e| Failure::said(&recording.name, &e))?;
    Ok((band.low, band.high))
}

/// Modes by given shapes, with the modal filter, and a check of whether the channels move as the shapes say.
fn by_shapes(
    recordings: &[Recording],
    shapes: &Shapes,
    bands: &[(f64, f64)],
) -> Result<Vec<Wanted>, Failure> {
    let mode = |(mode, options)| {
        let shape = Shape::Known { shapes: &shapes.values, mode };
        wanted(recordings, mode, shape, options, &shapes.name)
    };
    shapes.select(bands)?.into_iter().map(mode).collect()
}

/// Mode `n` (from 0) of all recordings; `shapes` is the name of the file of mode shapes.
fn wanted(
    recordings: &[Recording],
    n: usize,
    shape: Shape<'_>,
    options: Options,
    shapes: &str,
) -> Result<Wanted, Failure> {
    let all: Vec<_> = recordings.iter().map(channels).collect();
    // What one record of several lies under spoils what they tell together.
    let options = Options { windowed: recordings.iter().any(|r| r.windowed), ..options };
    let mode = one_mode(&all, shape, &options).map_err(|fault| match fault {
        NoMode::Shapes(error) => Failure::said(shapes, &error),
        NoMode::Recording { index, error } => Failure::said(&recordings[index].name, &error),
    })?;
    let record = |(source, samples)| ModalRecord { source, samples };
    let records = mode.records.into_iter().enumerate().map(record).collect();
    Ok(Wanted { name: format!("mode {}", n + 1), number: n, options, records, notes: mode.notes })
}

impl Recording {
    /// Prints the warnings about recordings before they are worked with.
    pub(crate) fn announce(recordings: &[Self], session: &mut Session) {
        let all = |of: fn(&Self) -> &Vec<String>| recordings.iter().flat_map(of).cloned().collect::<Vec<_>>();
        session.warnings(&all(|r| &r.warnings), &all(|r| &r.doubts));
    }
}

impl MethodChoice {
    /// The same method in the library's type.
    pub(crate) const fn method(self) -> iwan_ident::signal::Method {
        match self {
            Self::Hilbert => iwan_ident::signal::Method::Hilbert,
            Self::Peaks => iwan_ident::signal::Method::Peaks,
            Self::Pff => iwan_ident::signal::Method::PeakFitting,
            Self::Freevib => iwan_ident::signal::Method::FreeVibration,
        }
    }
}
