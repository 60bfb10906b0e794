//! From what a reader found to a checked record: quantity, unit, and a uniform grid of times.

use super::sampling::{self, Times, UNIFORM};
use crate::error::ReadError;
use crate::file_bytes::{FileBytes, list};
use crate::options::ReadOptions;
use crate::quantity::Quantity;
use crate::record::Record;
use crate::warning::Warning;

/// When the samples were taken.
pub(crate) enum Axis {
    /// Not stored.
    None,
    /// First time and interval, both in seconds.
    Even { start: f64, step: f64 },
    /// One time for each sample, in seconds.
    Times { name: String, values: Vec<f64> },
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
    /// Whether the user named the channels, so that none may be left out.
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

/// Makes the record.
pub(crate) fn assemble(source: &FileBytes, mut raw: Raw, options: &ReadOptions) -> Result<Record, ReadError> {
    if let Some(value) = options.rate.filter(|r| !(r.is_finite() && *r > 0.0)) {
        return Err(ReadError::Rate { file: source.file.into(), value });
    }
    if !raw.chosen {
        keep_one_quantity(source, &mut raw, options.quantity)?;
    }
    let (quantity, unit) = describe(&raw.channels, options.quantity, &mut raw.warnings);
    let Grid { start, dt } = place_in_time(source, &mut raw, options)?;
    let (names, samples) = raw.channels.into_iter().map(|c| (c.name, c.values)).unzip();
    let record = Record::new(dt, samples, names).and_then(|r| r.with_start(start));
    let record = record.map_err(|e| source.record(e))?;
    Ok(record.with_quantity(quantity, unit).with_warnings(raw.warnings))
}

/// Leaves out channels of another quantity than the one wanted; a force beside one kind of motion is left out, too.
fn keep_one_quantity(source: &FileBytes, raw: &mut Raw, wanted: Option<Quantity>) -> Result<(), ReadError> {
    let found = quantities(&raw.channels);
    let motions: Vec<Quantity> = found.iter().copied().filter(|q| *q != Quantity::Force).collect();
    let kept = match wanted {
        Some(wanted) if found.contains(&wanted) => wanted,
        Some(_) => return Ok(()),
        None if found.len() <= 1 => return Ok(()),
        None if motions.len() == 1 => motions[0],
        None => {
            let found = found.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
            let names = list(raw.channels.iter().map(|c| c.name.as_str()));
            let found = format!("the channels measure different things ({found})");
            return Err(ReadError::Ambiguous { file: source.file.into(), found, names });
        }
    };
    let warnings = &mut raw.warnings;
    raw.channels.retain(|c| {
        let keep = c.quantity == kept || c.quantity == Quantity::Unknown;
        if !keep {
            let reason = format!("it measures {}, not {kept}", c.quantity);
            warnings.push(Warning::LeftOut { name: c.name.clone(), reason });
        }
        keep
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
        warnings.push(Warning::Mixed { list: list(each.iter().map(String::as_str)) });
    }
    let stored = if let [one] = found[..] { one } else { Quantity::Unknown };
    let used = wanted.unwrap_or(stored);
    if stored != used && stored != Quantity::Unknown {
        warnings.push(Warning::QuantityReplaced { stored, used });
    }
    let unit = if let [one] = units[..] { one.to_string() } else { String::new() };
    (used, unit)
}

/// When the samples were taken; interpolates the channels when asked to.
fn place_in_time(source: &FileBytes, raw: &mut Raw, options: &ReadOptions) -> Result<Grid, ReadError> {
    if let Axis::Times { name, values } = &raw.axis {
        check_times(source, name, values, &raw.channels)?;
    }
    let given = options.rate.map(|rate| 1.0 / rate);
    match (given, &raw.axis) {
        (Some(dt), axis) => Ok(follow_rate(dt, axis, &mut raw.warnings)),
        (None, Axis::Even { start, step }) => Ok(Grid { start: *start, dt: *step }),
        (None, Axis::None) => {
            let names = list(raw.channels.iter().map(|c| c.name.as_str()));
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
    let Axis::Times { name, values } = &raw.axis else { return Ok(Grid { start: 0.0, dt: 0.0 }) };
    let (file, start) = (source.file, values[0]);
    match sampling::judge(values) {
        Times::Uniform { dt } => Ok(Grid { start, dt }),
        Times::Rounded { dt, quantum } => {
            raw.warnings.push(Warning::RoundedTime { quantum, dt });
            Ok(Grid { start, dt })
        }
        Times::Unordered { sample } => {
            let (value, previous) = (values[sample], values[sample - 1]);
            Err(ReadError::TimeOrder { file: file.into(), name: name.clone(), sample, value, previous })
        }
        Times::Uneven { dt, deviation, .. } if resample => {
            for channel in &mut raw.channels {
                channel.values = sampling::resample(values, &channel.values, dt);
            }
            raw.warnings.push(Warning::Resampled { deviation, dt });
            Ok(Grid { start, dt })
        }
        Times::Uneven { dt, sample, .. } => {
            let interval = values[sample] - values[sample - 1];
            let name = name.clone();
            Err(ReadError::NotUniform { file: file.into(), name, sample, interval, dt, allowed: UNIFORM })
        }
    }
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
