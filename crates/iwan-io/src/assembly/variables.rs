//! Named arrays (columns, NumPy arrays, MATLAB variables): which of them is the time, and which are channels.

use super::assemble::{Axis, Channel, Raw};
use super::clocks::{self, Clocks};
use super::sampling;
use super::units;
use super::variable::Variable;
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::options::ReadOptions;
use crate::quantity::Quantity;
use crate::warning::Warning;
use iwan_machine::listed;

/// Named arrays of one file with what the user says about them.
pub(crate) struct Chooser<'a> {
    pub(crate) source: FileBytes<'a>,
    pub(crate) options: &'a ReadOptions,
    /// Whether the arrays are columns of one table, whose first column may be a time without a name.
    pub(crate) tabular: bool,
}

impl Chooser<'_> {
    /// Finds time and channels.
    pub(crate) fn choose(
        &self,
        mut variables: Vec<Variable>,
        mut warnings: Vec<Warning>,
    ) -> Result<Raw, ReadError> {
        let names = listed(variables.iter().map(|v| v.name.as_str()));
        let mut axis = self.stored_time(&mut variables, &names, &mut warnings)?;
        let mut length = length_of(&axis);
        if self.tabular && length.is_none() {
            variables = variables.into_iter().flat_map(|v| v.split(None)).collect();
            axis = self.unnamed_time(&mut variables, &mut warnings)?;
            length = length_of(&axis);
        }
        if matches!(axis, Axis::None) {
            self.ask_about_first(&variables, &names)?;
            axis = self.step_from_scalars(&variables)?;
        }
        let chosen = !self.options.channels.is_empty();
        let channels = if chosen {
            self.named_channels(&variables, length, &names)?
        } else {
            self.all_channels(variables, length, &names, &mut warnings)?
        };
        Ok(Raw { axis, channels: channels.into_iter().map(into_channel).collect(), chosen, warnings })
    }

    /// The time that the user named, or the time to which the named channels belong, or else the only time of the file.
    fn stored_time(
        &self,
        variables: &mut Vec<Variable>,
        names: &str,
        warnings: &mut Vec<Warning>,
    ) -> Result<Axis, ReadError> {
        let clocks = Clocks::of(variables);
        let apart = clocks.apart();
        let wanted = match (&self.options.time, &apart) {
            (Some(name), _) => Some(name.clone()),
            (None, Some(times)) => match clocks.of_channels(&self.options.channels) {
                Some(time) if !self.options.channels.is_empty() => Some(time.into()),
                _ if self.options.rate.is_some() => None,
                _ => {
                    let (file, times) = (self.source.file.into(), listed(times.iter().copied()));
                    return Err(ReadError::SeveralTimes { file, times, names: names.into() });
                }
            },
            (None, None) => None,
        };
        let Some(name) = wanted else { return self.first_time(variables, warnings) };
        if apart.is_some() {
            let elsewhere = |v: &Variable| clocks.is_elsewhere(v, &name);
            let left: Vec<String> = variables
                .iter()
                .filter(|v| elsewhere(v) && !self.is_channel(&v.name))
                .map(|v| v.name.clone())
                .collect();
            variables.retain(|v| !left.contains(&v.name));
            warnings.extend(left.into_iter().map(|name| Warning::LeftOut {
                name,
                reason: "it goes with another time by its name".into(),
            }));
        }
        match variables.iter().position(|v| v.name == name) {
            Some(at) => self.as_time(variables.remove(at), warnings),
            None => self.time_inside_array(variables, &name, names, warnings),
        }
    }

    /// The first vector whose name means time.
    fn first_time(
        &self,
        variables: &mut Vec<Variable>,
        warnings: &mut Vec<Warning>,
    ) -> Result<Axis, ReadError> {
        let free = |v: &Variable| v.is_vector() && !self.is_channel(&v.name);
        let plain = variables.iter().position(|v| free(v) && units::is_time_name(&v.name));
        let at = plain.or_else(|| variables.iter().position(|v| free(v) && clocks::is_time(v)));
        at.map_or(Ok(Axis::None), |at| self.as_time(variables.remove(at), warnings))
    }

    fn as_time(&self, time: Variable, warnings: &mut Vec<Warning>) -> Result<Axis, ReadError> {
        if !time.is_vector() {
            let found = format!("an array of {} x {} values", time.rows, time.columns);
            return Err(self.source.malformed(format!("time '{}'", time.name), found, "a vector of times"));
        }
        self.in_seconds(time, warnings)
    }

    /// The times in seconds: the user's unit of time, or else the file's.
    fn in_seconds(&self, time: Variable, warnings: &mut Vec<Warning>) -> Result<Axis, ReadError> {
        let Variable { name, unit, mut values, .. } = time;
        let unit = if unit.is_empty() { units::unit_of_times(&name) } else { unit };
        let (factor, unit_known) = self.source.seconds(&name, &unit, self.options)?;
        if factor != 1.0 {
            for t in &mut values {
                *t *= factor;
            }
            let unit = self.options.time_unit.map_or(unit, |u| u.to_string());
            warnings.push(Warning::TimeScaled { unit, factor });
        }
        Ok(Axis::Times { name, values, unit_known })
    }

    /// A time such as `data[0]`: one column or row of an array.
    fn time_inside_array(
        &self,
        variables: &mut Vec<Variable>,
        name: &str,
        names: &str,
        warnings: &mut Vec<Warning>,
    ) -> Result<Axis, ReadError> {
        let owner = variables.iter().position(|v| is_part(name, &v.name));
        let parts = owner.map(|at| variables.remove(at).split(None)).unwrap_or_default();
        let mut axis = None;
        for part in parts {
            if part.name == name {
                axis = Some(self.in_seconds(part, warnings)?);
            } else {
                variables.push(part);
            }
        }
        axis.ok_or_else(|| self.unknown("time", name, names))
    }

    /// The first column as time, when it increases uniformly and is not the only column.
    fn unnamed_time(
        &self,
        variables: &mut Vec<Variable>,
        warnings: &mut Vec<Warning>,
    ) -> Result<Axis, ReadError> {
        let first = variables.first().filter(|_| variables.len() > 1);
        let is_time = first.is_some_and(|v| !self.is_channel(&v.name) && sampling::is_clock(&v.values));
        if !is_time {
            return Ok(Axis::None);
        }
        let time = variables.remove(0);
        warnings.push(Warning::TimeAssumed { name: time.name.clone() });
        self.in_seconds(time, warnings)
    }

    /// A first column that rises from row to row, but unevenly, may be the time. The error returned then asks the user; the column is not
    /// taken as time by a guess.
    fn ask_about_first(&self, variables: &[Variable], names: &str) -> Result<(), ReadError> {
        let asked = self.tabular && self.options.rate.is_none() && variables.len() > 1;
        let Some(first) = variables.first().filter(|v| asked && !self.is_channel(&v.name)) else {
            return Ok(());
        };
        let (name, v) = (&first.name, &first.values);
        if v.len() < 3 || !v.windows(2).all(|w| w[1] > w[0]) {
            return Ok(());
        }
        let mean = (v[v.len() - 1] - v[0]) / (v.len() - 1) as f64;
        let found = format!(
            "no column is called time, but '{name}' rises from row to row, unevenly, by {mean:.4e} on average, and may be it (--time '{name}' --resample)"
        );
        Err(ReadError::NoTime { file: self.source.file.into(), found, names: names.into() })
    }

    /// A uniform axis from a single number called `dt` (seconds), or `fs`, `rate` and the like (Hz), or in the unit that its name states; no
    /// axis where there is none.
    fn step_from_scalars(&self, variables: &[Variable]) -> Result<Axis, ReadError> {
        const STEPS: [&str; 4] = ["dt", "delta_t", "time_step", "sampling_interval"];
        const RATES: [&str; 7] =
            ["fs", "rate", "sample_rate", "samplerate", "sampling_rate", "fsample", "sampling_frequency"];
        let scalar = |names: &[&str]| {
            let named = |v: &Variable| units::base(&units::split_unit(&v.name).name);
            variables.iter().find(|v| v.values.len() == 1 && names.contains(&named(v).as_str()))
        };
        let time = |v: &Variable| {
            let (factor, _) = self.source.seconds(&v.name, &units::unit_of_times(&v.name), self.options)?;
            Ok(v.values[0] * factor)
        };
        let start = scalar(&["t0", "start"]).map_or(Ok(0.0), time)?;
        let interval = |v: &Variable| {
            // Small and capital letters tell milli from mega.
            let hertz = match units::unit_of_times(&v.name).as_str() {
                "" | "Hz" | "hz" | "HZ" | "1/s" => 1.0,
                "kHz" | "khz" | "KHz" | "KHZ" => 1e3,
                "MHz" | "MHZ" => 1e6,
                // The rate that the user gave goes before this one.
                _ if self.options.rate.is_some() => 1.0,
                unit => {
                    let (place, found) = (format!("rate '{}'", v.name), format!("the unit '{unit}'"));
                    return Err(self.source.malformed(place, found, "Hz, kHz or MHz"));
                }
            };
            Ok(1.0 / (v.values[0] * hertz))
        };
        let step = match scalar(&STEPS) {
            Some(step) => Some(time(step)?),
            None => scalar(&RATES).map(interval).transpose()?,
        };
        Ok(step.map_or(Axis::None, |step| Axis::Even { start, step }))
    }

    fn is_channel(&self, name: &str) -> bool {
        self.options.channels.iter().any(|c| c == name)
    }

    fn named_channels(
        &self,
        variables: &[Variable],
        length: Option<usize>,
        names: &str,
    ) -> Result<Vec<Variable>, ReadError> {
        let mut found = Vec::new();
        for name in &self.options.channels {
            let Some(owner) = variables.iter().find(|v| v.name == *name || is_part(name, &v.name)) else {
                return Err(self.unknown("channel", name, names));
            };
            let parts = owner.clone().split(length);
            let before = found.len();
            found.extend(parts.into_iter().filter(|p| owner.name == *name || p.name == *name));
            if found.len() == before {
                return Err(self.unknown("channel", name, names));
            }
        }
        Ok(found)
    }

    /// Every vector as long as the time. Without a time, all vectors, which then must be equally long.
    fn all_channels(
        &self,
        variables: Vec<Variable>,
        length: Option<usize>,
        names: &str,
        warnings: &mut Vec<Warning>,
    ) -> Result<Vec<Variable>, ReadError> {
        let vectors = variables.into_iter().filter(|v| v.values.len() > 1);
        let vectors: Vec<Variable> = vectors.flat_map(|v| v.split(length)).collect();
        let Some(first) = vectors.first() else {
            return Err(self.ambiguous("there is no channel of at least 2 samples", names));
        };
        let Some(length) = length else {
            let (name, n) = (&first.name, first.values.len());
            return match vectors.iter().find(|v| v.values.len() != n) {
                None => Ok(vectors),
                Some(v) => {
                    let found = format!("'{name}' has {n} samples, '{}' {}", v.name, v.values.len());
                    Err(self.ambiguous(&found, names))
                }
            };
        };
        let fits = |v: &Variable| v.values.len() == length && !clocks::is_time(v);
        let (fitting, others): (Vec<_>, Vec<_>) = vectors.into_iter().partition(fits);
        if fitting.is_empty() {
            return Err(self.ambiguous(&format!("no channel has {length} samples as the time has"), names));
        }
        warnings.extend(others.into_iter().map(|v| {
            let reason = match v.values.len() {
                n if n == length => "it is a second time by its name".into(),
                n => format!("it has {n} values, the time has {length}"),
            };
            Warning::LeftOut { name: v.name, reason }
        }));
        Ok(fitting)
    }

    fn unknown(&self, role: &'static str, name: &str, names: &str) -> ReadError {
        let (file, name, names) = (self.source.file.into(), name.into(), names.into());
        ReadError::UnknownName { file, role, name, names }
    }

    fn ambiguous(&self, found: &str, names: &str) -> ReadError {
        let file = self.source.file.into();
        ReadError::Ambiguous { file, found: found.into(), names: names.into() }
    }
}

/// Whether `name` is `owner[k]`.
fn is_part(name: &str, owner: &str) -> bool {
    name.strip_prefix(owner).is_some_and(|rest| rest.starts_with('[') && rest.ends_with(']'))
}

fn length_of(axis: &Axis) -> Option<usize> {
    if let Axis::Times { values, .. } = axis { Some(values.len()) } else { None }
}

fn into_channel(v: Variable) -> Channel {
    let unit = if v.unit.is_empty() { units::unit_in(&v.name) } else { v.unit };
    let mut quantity = units::quantity_of_unit(&unit);
    if quantity == Quantity::Unknown && unit.is_empty() {
        quantity = units::quantity_of_name(&v.name);
    }
    Channel { name: v.name, unit, quantity, values: v.values }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn array(name: &str, rows: usize, columns: usize) -> Variable {
        let values = (0..rows * columns).map(|i| i as f64).collect();
        Variable { name: name.into(), unit: String::new(), rows, columns, values }
    }

    fn choose(variables: Vec<Variable>, options: &ReadOptions) -> Result<Raw, ReadError> {
        let source = FileBytes { file: Path::new("a.npz"), bytes: &[] };
        Chooser { source, options, tabular: false }.choose(variables, Vec::new())
    }

    #[test]
    fn arrays_are_split_along_the_length_of_the_time() {
        let raw = choose(vec![array("t", 3, 1), array("acc", 4, 3)], &ReadOptions::default()).unwrap();
        let names: Vec<_> = raw.channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["acc[0]", "acc[1]", "acc[2]", "acc[3]"]);
        assert_eq!(raw.channels[1].values, [1.0, 5.0, 9.0]);
        assert_eq!(raw.channels[1].quantity, Quantity::Acceleration);
    }

    #[test]
    fn a_second_time_is_no_channel() {
        let variables = vec![array("a.t", 3, 1), array("a.x", 3, 1), array("b.t", 3, 1), array("y", 2, 1)];
        let raw = choose(variables, &ReadOptions::default()).unwrap();
        assert_eq!(raw.channels.len(), 1);
        assert!(matches!(&raw.warnings[..], [Warning::LeftOut { name, .. }, _] if name == "b.t"));
    }

    #[test]
    fn a_part_of_an_array_can_be_chosen() {
        let options =
            ReadOptions { time: Some("d[0]".into()), channels: vec!["d[1]".into()], ..Default::default() };
        let raw = choose(vec![array("d", 5, 2)], &options).unwrap();
        assert!(matches!(raw.axis, Axis::Times { values, .. } if values == [0.0, 1.0, 2.0, 3.0, 4.0]));
        assert_eq!(raw.channels[0].values, [5.0, 6.0, 7.0, 8.0, 9.0]);
    }

    /// An array called `Time [ms]` was once read as seconds.
    #[test]
    fn units_in_names_of_arrays_are_obeyed() {
        let raw = choose(vec![array("Time [ms]", 3, 1), array("x (mm/s^2)", 3, 1)], &ReadOptions::default());
        let raw = raw.unwrap();
        assert!(matches!(raw.axis, Axis::Times { values, .. } if values == [0.0, 1e-3, 2e-3]));
        assert_eq!(
            (raw.channels[0].unit.as_str(), raw.channels[0].quantity),
            ("mm/s^2", Quantity::Acceleration)
        );
        let mut dt = array("dt [us]", 1, 1);
        dt.values[0] = 50.0;
        let raw = choose(vec![dt, array("a[2]", 1, 9)], &ReadOptions::default()).unwrap();
        assert!(matches!(raw.axis, Axis::Even { step, .. } if (step - 50e-6).abs() < 1e-18));
        assert_eq!(raw.channels[0].unit, "");
    }

    /// Times in furlongs, an interval in fortnights and a rate in kHz were read as seconds and Hz.
    #[test]
    fn what_is_no_unit_of_time_is_refused() {
        for name in ["Time [furlong]", "Time (furlong)", "dt [fortnight]", "fs [rpm]", "fs [mHz]"] {
            let mut variable = array(name, if name.starts_with('T') { 9 } else { 1 }, 1);
            variable.values[0] = if name.starts_with('T') { 0.0 } else { 2.0 };
            let read = choose(vec![variable, array("a", 1, 9)], &ReadOptions::default());
            let error = read.err().map(|error| error.to_string()).unwrap_or_default();
            assert!(
                ["furlong", "fortnight", "rpm", "mHz"].iter().any(|unit| error.contains(unit)),
                "{name}: {error}"
            );
        }
        let mut rate = array("fs [kHz]", 1, 1);
        rate.values[0] = 2.0;
        let raw = choose(vec![rate, array("a", 1, 9)], &ReadOptions::default()).unwrap();
        assert!(matches!(raw.axis, Axis::Even { step, .. } if (step - 5e-4).abs() < 1e-15));
    }

    #[test]
    fn a_scalar_interval_or_rate_serves_as_time() {
        let mut fs = array("fs", 1, 1);
        fs.values[0] = 4.0;
        let raw = choose(vec![fs, array("a", 1, 9)], &ReadOptions::default()).unwrap();
        assert!(matches!(raw.axis, Axis::Even { step: 0.25, .. }));
    }

    #[test]
    fn names_that_are_not_there_are_named_with_those_that_are() {
        let options = ReadOptions { channels: vec!["b".into()], ..Default::default() };
        let Err(error) = choose(vec![array("a", 5, 1)], &options) else { panic!("accepted") };
        assert_eq!(error.to_string(), "a.npz: there is no channel 'b'; there are: a");
    }
}
