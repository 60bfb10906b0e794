//! From what a reader found in a file to a checked record: quantity, unit, and a uniform grid of times.

use super::sampling::{self, JITTER, Resampled, Times, UNIFORM};
use super::scales::{Scale, scale};
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::options::ReadOptions;
use crate::quantity::Quantity;
use crate::record::Record;
use crate::warning::Warning;
use iwan_machine::listed;

/// When the samples were taken.
pub(crate) enum Axis {
    /// The file stores no times.
    None,
    /// First time and interval, both in seconds.
    Even { start: f64, step: f64 },
    /// One time for each sample, in seconds; `unit_known` where the file or the user states the unit.
    Times { name: String, values: Vec<f64>, unit_known: bool },
}

/// One channel as found in a file.
pub(crate) struct Channel {
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) quantity: Quantity,
    pub(crate) values: Vec<f64>,
}

/// What a reader found in a file.
pub(crate) struct Raw {
    pub(crate) axis: Axis,
    pub(crate) channels: Vec<Channel>,
    /// Whether the user named the channels; if so, none may be left out.
    pub(crate) chosen: bool,
    pub(crate) warnings: Vec<Warning>,
}

/// The uniform times of a record.
struct Grid {
    /// Time of the first sample, s.
    start: f64,
    /// Interval, s.
    dt: f64,
}

/// Least number of samples of a record whose times are judged for their unit: a table of a few rows tells nothing.
const ENOUGH: usize = 64;
/// Least sampling rate, Hz, that is not doubted where times have no unit. The slowest structures, tall buildings and bridges, are sampled
/// at 20 Hz and more; times in ms of a record at less than 20 kHz, taken as seconds, give a rate below it. A judgement, which leads to a
/// warning only.
const SLOWEST_RATE: f64 = 20.0;
/// Longest record, s, that is not doubted where times have no unit: times in ms of a ring-down of 0.6 s and more, taken as seconds, are
/// longer. Ring-downs of 600 s belong to structures below 1 Hz. A judgement, which leads to a warning only.
const LONGEST: f64 = 600.0;

/// A warning on times without a unit, in seconds, whose sampling rate or length is unlike a ring-down.
fn doubt(times: &[f64]) -> Option<Warning> {
    let duration = times[times.len() - 1] - times[0];
    let rate = (times.len() - 1) as f64 / duration;
    let unlike = times.len() >= ENOUGH && duration > 0.0 && (rate < SLOWEST_RATE || duration > LONGEST);
    unlike.then_some(Warning::TimeUnitDoubtful { rate, duration })
}

/// Rates of measurements, Hz: a sample in 30 years, and a period of light. A rate outside is a slip of the hand, which gave results in
/// numbers of three hundred digits.
const RATES: std::ops::RangeInclusive<f64> = 1e-9..=1e15;

fn check_rate(source: &FileBytes, options: &ReadOptions) -> Result<(), ReadError> {
    match options.rate.filter(|rate| !RATES.contains(rate)) {
        Some(value) => Err(ReadError::Rate { file: source.file.into(), value }),
        None => Ok(()),
    }
}

/// Makes the record from what a reader found.
pub(crate) fn assemble(source: &FileBytes, mut raw: Raw, options: &ReadOptions) -> Result<Record, ReadError> {
    check_rate(source, options)?;
    if !raw.chosen {
        keep_one_quantity(source, &mut raw, options.quantity)?;
    }
    if let Some(wanted) = &options.unit {
        convert(source, &mut raw, wanted)?;
    }
    let (quantity, unit) = describe(&raw.channels, options.quantity, &mut raw.warnings);
    let Grid { start, dt } = place_in_time(source, &mut raw, options)?;
    let (names, samples) = raw.channels.into_iter().map(|c| (c.name, c.values)).unzip();
    let record = Record::new(dt, samples, names).and_then(|r| r.with_start(start));
    let record = record.map_err(|e| source.record(e))?;
    Ok(record.with_quantity(quantity, unit).with_warnings(raw.warnings))
}

/// All channels, whatever they measure, with their sampling interval in s and the warnings.
pub(crate) fn all_channels(
    source: &FileBytes,
    mut raw: Raw,
    options: &ReadOptions,
) -> Result<(f64, Vec<Channel>, Vec<Warning>), ReadError> {
    check_rate(source, options)?;
    let Grid { dt, .. } = place_in_time(source, &mut raw, options)?;
    // `Record::new` checks interval, lengths and samples.
    let (names, samples) = raw.channels.iter().map(|c| (c.name.clone(), c.values.clone())).unzip();
    Record::new(dt, samples, names).map_err(|e| source.record(e))?;
    Ok((dt, raw.channels, raw.warnings))
}

/// Keeps the channels of one quantity: of the quantity `wanted`, else of the only kind of motion. Channels of other quantities are left
/// out, and beside a motion those whose unit is not known, too. Channels without quantity and unit stay.
fn keep_one_quantity(source: &FileBytes, raw: &mut Raw, wanted: Option<Quantity>) -> Result<(), ReadError> {
    let found = quantities(&raw.channels);
    let motions: Vec<Quantity> = found.iter().copied().filter(|q| q.is_motion()).collect();
    // The units of all motions are known, so a channel with an unknown unit is no motion.
    let is_foreign = |c: &Channel| c.quantity == Quantity::Unknown && !c.unit.is_empty();
    let is_mixed = found.len() > 1 || raw.channels.iter().any(is_foreign);
    let kept = match wanted {
        Some(wanted) if found.contains(&wanted) => wanted,
        Some(_) => return Ok(()),
        None if motions.len() == 1 && is_mixed => motions[0],
        // Beside a force alone, a channel of unknown quantity may be the motion.
        None if motions.is_empty()
            && !found.is_empty()
            && raw.channels.iter().any(|c| c.quantity == Quantity::Unknown) =>
        {
            Quantity::Unknown
        }
        None if found.len() <= 1 => return Ok(()),
        None => {
            let found = found.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
            let names = listed(raw.channels.iter().map(|c| c.name.as_str()));
            let found = format!("the channels measure different things ({found})");
            return Err(ReadError::Ambiguous { file: source.file.into(), found, names });
        }
    };
    let warnings = &mut raw.warnings;
    raw.channels.retain(|c| {
        let other = if kept == Quantity::Unknown { "a motion".into() } else { kept.to_string() };
        let reason = match c.quantity {
            Quantity::Unknown if kept.is_motion() && is_foreign(c) => {
                format!("what \"{}\" measures is not known, and beside it stands {other}", c.unit)
            }
            Quantity::Unknown => return true,
            quantity if quantity == kept => return true,
            quantity => format!("it measures {quantity}, not {other}"),
        };
        warnings.push(Warning::LeftOut { name: c.name.clone(), reason });
        false
    });
    Ok(())
}

fn quantities(channels: &[Channel]) -> Vec<Quantity> {
    let mut found = Vec::new();
    for q in channels.iter().map(|c| c.quantity).filter(|q| *q != Quantity::Unknown) {
        if !found.contains(&q) {
            found.push(q);
        }
    }
    found
}

/// Quantity and unit of the record, with a warning where the channels do not agree.
fn describe(
    channels: &[Channel],
    wanted: Option<Quantity>,
    warnings: &mut Vec<Warning>,
) -> (Quantity, String) {
    let found = quantities(channels);
    let mut units: Vec<&str> = Vec::new();
    for unit in channels.iter().map(|c| c.unit.as_str()).filter(|u| !u.is_empty()) {
        if !units.contains(&unit) {
            units.push(unit);
        }
    }
    if found.len() > 1 || units.len() > 1 {
        let each: Vec<String> =
            channels.iter().map(|c| format!("{} {} [{}]", c.name, c.quantity, c.unit)).collect();
        warnings.push(Warning::Mixed { list: listed(each.iter().map(String::as_str)) });
    }
    let stored = if let [one] = found[..] { one } else { Quantity::Unknown };
    let used = wanted.unwrap_or(stored);
    if stored != used && stored != Quantity::Unknown {
        warnings.push(Warning::QuantityReplaced { stored, used });
    }
    let unit = if let [one] = units[..] { one.to_string() } else { String::new() };
    (used, unit)
}

/// The uniform times of the samples; interpolates the channels onto them where the user asked for it.
fn place_in_time(source: &FileBytes, raw: &mut Raw, options: &ReadOptions) -> Result<Grid, ReadError> {
    if let Axis::Times { name, values, unit_known } = &raw.axis {
        check_times(source, name, values, &raw.channels)?;
        if !unit_known && options.rate.is_none() {
            raw.warnings.extend(doubt(values));
        }
    }
    let given = options.rate.map(|rate| 1.0 / rate);
    match (given, &raw.axis) {
        (Some(dt), axis) => Ok(follow_rate(dt, axis, &mut raw.warnings)),
        (None, Axis::Even { start, step }) => Ok(Grid { start: *start, dt: *step }),
        (None, Axis::None) => {
            let names = listed(raw.channels.iter().map(|c| c.name.as_str()));
            let found = "no time is stored".into();
            Err(ReadError::NoTime { file: source.file.into(), found, names })
        }
        (None, Axis::Times { .. }) => follow_times(source, raw, options.resample),
    }
}

fn follow_rate(dt: f64, axis: &Axis, warnings: &mut Vec<Warning>) -> Grid {
    let (start, step) = match axis {
        Axis::None => return Grid { start: 0.0, dt },
        Axis::Even { start, step } => (*start, *step),
        Axis::Times { values, .. } => {
            (values[0], (values[values.len() - 1] - values[0]) / (values.len() - 1) as f64)
        }
    };
    if (step / dt - 1.0).abs() > UNIFORM || step.is_nan() {
        warnings.push(Warning::RateReplaced { stored: 1.0 / step, used: 1.0 / dt });
    }
    Grid { start, dt }
}

fn follow_times(source: &FileBytes, raw: &mut Raw, resample: bool) -> Result<Grid, ReadError> {
    let Axis::Times { name, values, .. } = &raw.axis else { return Ok(Grid { start: 0.0, dt: 0.0 }) };
    let (file, name, start) = (source.file.into(), name.clone(), values[0]);
    match sampling::judge(values) {
        Times::Uniform { dt } => Ok(Grid { start, dt }),
        Times::Rounded { dt, quantum } => {
            raw.warnings.push(Warning::RoundedTime { quantum, dt });
            Ok(Grid { start, dt })
        }
        Times::Near { dt, jitter } => {
            raw.warnings.push(Warning::NearlyEven { jitter, dt });
            Ok(Grid { start, dt })
        }
        Times::Unordered { sample } => {
            let (value, previous) = (values[sample], values[sample - 1]);
            Err(ReadError::TimeOrder { file, name, sample, value, previous })
        }
        Times::Uneven { .. } | Times::Repeated { .. } if resample && values[values.len() - 1] > start => {
            let mut channels: Vec<&mut Vec<f64>> = raw.channels.iter_mut().map(|c| &mut c.values).collect();
            let Resampled { dt, jitter, gap, merged } = sampling::on_even_grid(values, &mut channels);
            raw.warnings.push(Warning::Resampled { jitter, gap, merged, dt });
            Ok(Grid { start, dt })
        }
        Times::Repeated { .. } if values[values.len() - 1] <= start => {
            let found = format!("{start} s at all {} samples", values.len());
            Err(source.malformed(format!("'{name}'"), found, "times that increase, or the rate by --rate HZ"))
        }
        Times::Repeated { sample, count } => {
            let (value, samples) = (values[sample], values.len());
            let rate = (samples - 1) as f64 / (values[samples - 1] - start);
            Err(ReadError::TimeRepeated { file, name, sample, value, count, samples, rate })
        }
        Times::Uneven { dt, sample, off } => {
            let interval = values[sample] - values[sample - 1];
            Err(ReadError::NotUniform { file, name, sample, interval, dt, off, allowed: JITTER })
        }
    }
}

/// Converts every channel to the unit wanted: `SI`, or a label of the same kind of quantity.
fn convert(source: &FileBytes, raw: &mut Raw, wanted: &str) -> Result<(), ReadError> {
    for channel in &mut raw.channels {
        let refuse = |reason| ReadError::UnitConversion {
            file: source.file.into(),
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            wanted: wanted.into(),
            reason,
        };
        let from = scale(&channel.unit).ok_or_else(|| refuse("the unit of the channel is not known"))?;
        let si = wanted.eq_ignore_ascii_case("si");
        let to = if si {
            Scale { factor: Some(1.0), ..from }
        } else {
            scale(wanted).ok_or_else(|| refuse("that unit is not known"))?
        };
        if to.kind != from.kind {
            return Err(refuse("the two measure different things"));
        }
        let (Some(a), Some(b)) = (from.factor, to.factor) else {
            return Err(refuse("the label has two meanings"));
        };
        let label = if si { from.si } else { wanted };
        if a != b {
            let factor = a / b;
            channel.values.iter_mut().for_each(|v| *v *= factor);
            let (name, from, to) = (channel.name.clone(), channel.unit.clone(), label.into());
            raw.warnings.push(Warning::Converted { name, from, to, factor });
        }
        channel.unit = label.into();
    }
    Ok(())
}

/// Times must be at least two, finite, and one for each sample.
fn check_times(source: &FileBytes, name: &str, times: &[f64], channels: &[Channel]) -> Result<(), ReadError> {
    if times.len() < 2 {
        let found = format!("{} times", times.len());
        return Err(source.malformed(format!("'{name}'"), found, "at least 2"));
    }
    if let Some(sample) = times.iter().position(|t| !t.is_finite()) {
        let place = format!("'{name}', sample {sample} (counted from 0)");
        return Err(source.malformed(place, times[sample].to_string(), "a finite time in seconds"));
    }
    if let Some(channel) = channels.iter().find(|c| c.values.len() != times.len()) {
        return Err(ReadError::Mismatch {
            file: source.file.into(),
            name: channel.name.clone(),
            found: format!("{} samples", channel.values.len()),
            expected: format!("{} samples", times.len()),
            reference: name.into(),
        });
    }
    Ok(())
}
