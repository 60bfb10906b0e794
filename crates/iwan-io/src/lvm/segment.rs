//! One segment of data, or several that follow each other: each channel has its own clock, from which the times of the record are made.

use crate::assembly::{Axis, Channel, Raw, last_digit, units, unlike};
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::options::ReadOptions;
use crate::quantity::Quantity;
use crate::warning::Warning;
use iwan_machine::listed;

/// Largest relative difference between the interval in the header and that of the column of X, beyond the rounding of both, at which the
/// two agree: the header and the column may follow different quartz clocks, which differ by less. Where the header is used, frequencies are
/// off by no more. Files with a larger difference are refused.
const SAME: f64 = 1e-4;
/// Largest distance, as a part of an interval, between the start of a segment and the time one interval behind the last sample of the
/// segment before it: to the nearest sample the segment then continues it. Other segments are refused.
const NEXT: f64 = 0.5;

/// A sampling interval as the header writes it.
#[derive(Clone, Copy)]
pub(super) struct Interval {
    pub(super) step: f64,
    /// Unit of the last digit with which the interval is written.
    pub(super) digit: f64,
}

/// One segment: what its header says of each channel, and the numbers.
#[derive(Default)]
pub(super) struct Segment {
    pub(super) names: Vec<String>,
    pub(super) units: Vec<String>,
    pub(super) x_names: Vec<String>,
    pub(super) x_units: Vec<String>,
    pub(super) starts: Vec<f64>,
    pub(super) steps: Vec<Interval>,
    pub(super) x: Vec<Vec<f64>>,
    pub(super) y: Vec<Vec<f64>>,
}

/// Which of the times of a file is used.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Time {
    /// Start and interval in the header, or the column of X where the header has no interval.
    Header,
    /// The column of X.
    X,
    /// The samples of this channel.
    Channel(usize),
}

/// What a header says of channel `k`; a single entry holds for all channels.
fn of_channel<T: Clone>(said: &[T], k: usize) -> Option<T> {
    if said.len() == 1 { said.first() } else { said.get(k) }.cloned()
}

impl Segment {
    /// Interval of a channel as the header states it; none where it is not positive and finite.
    fn interval(&self, k: usize) -> Option<Interval> {
        of_channel(&self.steps, k).filter(|i| i.step > 0.0 && i.step.is_finite())
    }

    fn start(&self, k: usize) -> f64 {
        of_channel(&self.starts, k).unwrap_or(0.0)
    }

    /// The column of X of a channel: its own, or the only column, which belongs to the first channel and to all channels with the same
    /// interval.
    fn x_of(&self, k: usize) -> Option<&Vec<f64>> {
        let step = |k| self.interval(k).map(|i| i.step);
        if self.x.len() == 1 { self.x.first().filter(|_| step(k) == step(0)) } else { self.x.get(k) }
    }

    /// The interval of a channel: the header's, or that of its column of X where the header rounds the interval to fewer digits. An error
    /// in words where the two contradict each other: programs that thin out samples leave the header as it was.
    fn judged(&self, k: usize, Interval { step, digit }: Interval) -> Result<Interval, String> {
        // X may begin anew with each segment: only the times before the first decrease count.
        let all = self.x_of(k).map_or(&[][..], Vec::as_slice);
        let x = &all[..all.windows(2).position(|w| w[1] < w[0]).map_or(all.len(), |back| back + 1)];
        let [first, .., last] = x else { return Ok(Interval { step, digit }) };
        let count = (x.len() - 1) as f64;
        let seen = (last - first) / count;
        let written = last_digit(x);
        // Largest error of the mean interval: half a unit of rounding at both ends.
        let resolution = written / count;
        let apart = (seen - step).abs();
        if apart > 0.5 * digit + resolution + SAME * step {
            return Err(format!("steps of {seen:.6e} in the column X_Value where Delta_X is {step:.6e}"));
        }
        let finer = resolution < 0.5 * digit && apart > resolution;
        Ok(if finer { Interval { step: seen, digit: written } } else { Interval { step, digit } })
    }

    /// Appends a segment that continues this one; an error in words where it does not continue this one.
    pub(super) fn append(&mut self, other: Self) -> Result<(), String> {
        if other.y.iter().all(Vec::is_empty) {
            return Ok(());
        }
        if self.y.len() != other.y.len() || self.names != other.names {
            return Err("segments of different channels".into());
        }
        for (k, mine) in self.y.iter().enumerate().filter(|(k, _)| !other.y[*k].is_empty()) {
            let (Some(Interval { step, .. }), Some(next)) = (self.interval(k), other.interval(k)) else {
                return Err("several segments without a start and an interval".into());
            };
            let gap = other.start(k) - (self.start(k) + mine.len() as f64 * step);
            if (next.step - step).abs() > 1e-9 * step || gap.is_nan() || gap.abs() > NEXT * step {
                return Err(format!(
                    "segments that do not follow each other (the next begins {gap:.6e} s away from where it would)"
                ));
            }
        }
        for (mine, more) in self.y.iter_mut().zip(other.y).chain(self.x.iter_mut().zip(other.x)) {
            mine.extend(more);
        }
        Ok(())
    }

    pub(super) fn into_raw(self, source: &FileBytes, options: &ReadOptions) -> Result<Raw, ReadError> {
        let name = |k: usize| match self.names.get(k).map(String::as_str) {
            None | Some("") => format!("channel {}", k + 1),
            Some(name) => name.to_string(),
        };
        let names: Vec<String> = (0..self.y.len()).map(name).collect();
        let place = |role: &'static str, name: &String| {
            names.iter().position(|n| n == name).ok_or_else(|| {
                let all = self.x_names.iter().chain(&names).map(String::as_str);
                ReadError::UnknownName {
                    file: source.file.into(),
                    role,
                    name: name.clone(),
                    names: listed(all),
                }
            })
        };
        // The time that the user names is the column of X, or else a channel, which is then left out of the channels.
        let time = match &options.time {
            None => Time::Header,
            Some(name) if self.x_names.contains(name) => Time::X,
            Some(name) => Time::Channel(place("time", name)?),
        };
        let chosen = !options.channels.is_empty();
        // LabVIEW allows several channels of one name: where the user names no channels, each channel is identified by its place.
        let wanted: Vec<usize> = if chosen {
            options.channels.iter().map(|name| place("channel", name)).collect::<Result<_, _>>()?
        } else {
            (0..names.len()).filter(|k| time != Time::Channel(*k)).collect()
        };
        let (mut axis, mut warnings) = (None, Vec::new());
        for &k in &wanted {
            let mut noticed = Vec::new();
            let found = self.axis(source, options, (k, time), &mut noticed)?;
            if let Some(unlike) = axis.as_ref().and_then(|axis| unlike(axis, &found)) {
                return Err(unlike.refusal(source, names[k].clone(), names[wanted[0]].clone()));
            }
            if axis.is_none() {
                (axis, warnings) = (Some(found), noticed);
            }
        }
        let channel = |k: usize| {
            let (name, unit) = (names[k].clone(), self.units.get(k).cloned().unwrap_or_default());
            let mut quantity = units::quantity_of_unit(&unit);
            if quantity == Quantity::Unknown && unit.is_empty() {
                quantity = units::quantity_of_name(&name);
            }
            Channel { name, unit, quantity, values: self.y[k].clone() }
        };
        let channels = wanted.iter().map(|&k| channel(k)).collect();
        Ok(Raw { axis: axis.unwrap_or(Axis::None), channels, chosen, warnings })
    }

    /// The times of the samples of channel `k`; warnings go to `noticed`.
    fn axis(
        &self,
        source: &FileBytes,
        options: &ReadOptions,
        (k, time): (usize, Time),
        noticed: &mut Vec<Warning>,
    ) -> Result<Axis, ReadError> {
        let x = || of_channel(&self.x, k);
        let (name, unit, stored) = match time {
            Time::Channel(at) => (self.names.get(at), self.units.get(at).cloned(), self.y.get(at).cloned()),
            Time::X => (options.time.as_ref(), of_channel(&self.x_units, k), x()),
            Time::Header => (None, of_channel(&self.x_units, k), x().filter(|_| self.interval(k).is_none())),
        };
        let (name, unit) = (name.map_or("X", String::as_str), unit.unwrap_or_default());
        let (factor, unit_known) = source.seconds(name, &unit, options)?;
        if factor != 1.0 {
            noticed.push(Warning::TimeScaled { unit, factor });
        }
        if let Some(times) = stored {
            // A row has one time for all channels: times behind the end of this channel belong to other channels.
            let values = times.iter().take(self.y[k].len()).map(|t| factor * t).collect();
            return Ok(Axis::Times { name: name.into(), values, unit_known });
        }
        let Some(header) = self.interval(k) else { return Ok(Axis::None) };
        let judged = if options.rate.is_some() { Ok(header) } else { self.judged(k, header) };
        let Interval { step, digit } = judged.map_err(|contradiction| {
            let expected =
                "one interval in both; give the rate with --rate HZ, or name X_Value with --time NAME";
            source.malformed("X_Value and Delta_X", contradiction, expected)
        })?;
        if step != header.step {
            noticed.push(Warning::RoundedTime { quantum: factor * digit, dt: factor * step });
        }
        Ok(Axis::Even { start: factor * self.start(k), step: factor * step })
    }
}
