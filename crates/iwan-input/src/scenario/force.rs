//! `[force]`: the force history.

use std::path::Path;

use iwan_core::Pulse;
use iwan_machine::Kind;
use iwan_machine::memory::{Short, ask};

use crate::error::InputError;
use crate::section::{Section, TableKind};
use crate::text::InputText;

/// The force histories and their keys.
pub(crate) const KINDS: &[TableKind] = &[
    TableKind { name: "haversine", keys: &["amplitude", "duration"] },
    TableKind { name: "half-sine", keys: &["amplitude", "duration"] },
    TableKind { name: "step", keys: &["amplitude", "duration"] },
    TableKind { name: "sine", keys: &["amplitude", "frequency", "duration"] },
    TableKind { name: "file", keys: &["path"] },
    TableKind { name: "none", keys: &[] },
];

/// A force history.
#[derive(Debug, Clone, PartialEq)]
pub enum Force {
    /// A formula of the library, with its name in the scenario.
    Formula(&'static str, Pulse<'static>),
    /// Samples from a file.
    File(ForceFile),
}

/// A force history from a file.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceFile {
    /// The file's bytes, which are written beside the results so that the run can be repeated.
    pub bytes: Vec<u8>,
    /// Time between the samples, s.
    pub dt: f64,
    /// The samples, the first at t = 0.
    pub samples: Vec<f64>,
    /// Remarks on how the file was read.
    pub notes: Vec<String>,
}

impl Force {
    /// The force for the simulation.
    #[must_use]
    pub fn pulse(&self) -> Pulse<'_> {
        match self {
            Self::Formula(_, pulse) => *pulse,
            Self::File(file) => Pulse::Sampled { dt: file.dt, samples: &file.samples },
        }
    }

    /// Reads and checks the table; `step` is the time step in s, at which uneven samples are interpolated.
    pub(super) fn read(
        source: &InputText,
        section: &Section<'_>,
        kind: &'static TableKind,
        step: f64,
    ) -> Result<Self, InputError> {
        let number = |key| section.number(key);
        let endless = |key| section.number_or(key, f64::INFINITY);
        let pulse = match kind.name {
            "haversine" => {
                Pulse::Haversine { amplitude: number("amplitude")?, duration: number("duration")? }
            }
            "half-sine" => Pulse::HalfSine { amplitude: number("amplitude")?, duration: number("duration")? },
            "step" => Pulse::Step { amplitude: number("amplitude")?, duration: endless("duration")? },
            "sine" => Pulse::Sine {
                amplitude: number("amplitude")?,
                frequency: number("frequency")?,
                duration: endless("duration")?,
            },
            "none" => Pulse::None,
            _ => {
                let path = source.folder.join(section.text("path")?);
                return read_file(&path, step).map(Self::File).map_err(|refusal| {
                    section.failure("path", &refusal.message, &refusal.remedy).of(refusal.kind)
                });
            }
        };
        let key_of = |name: &str| name.trim_start_matches("force ").to_string();
        let pulse = pulse.checked().map_err(|error| section.out_of_range(error, key_of))?;
        Ok(Self::Formula(kind.name, pulse))
    }

    /// The same history with another amplitude; none where the kind of force has no amplitude.
    pub(super) fn with_amplitude(self, value: f64) -> Option<Self> {
        let Self::Formula(name, mut pulse) = self else { return None };
        match &mut pulse {
            Pulse::Haversine { amplitude, .. }
            | Pulse::HalfSine { amplitude, .. }
            | Pulse::Step { amplitude, .. }
            | Pulse::Sine { amplitude, .. } => *amplitude = value,
            Pulse::None | Pulse::Sampled { .. } => return None,
        }
        Some(Self::Formula(name, pulse))
    }
}

fn read_file(path: &Path, step: f64) -> Result<ForceFile, InputError> {
    let two = "give a text file of two columns, time in s and force, the time ascending from t >= 0";
    let problem = |what: String| InputError::new(format!("{}: {what}", path.display()), two);
    let bytes = iwan_machine::read_file(path).map_err(|e| {
        let remedy = "check `path`: it is relative to the scenario file";
        InputError::new(format!("{}: cannot be read: {e}", path.display()), remedy).of(Kind::Unreadable)
    })?;
    let columns =
        iwan_io::parse_table(path, &bytes).map_err(|e| InputError::new(e.to_string(), two).of(e.kind()))?;
    let mut notes: Vec<String> = columns.warnings().iter().map(ToString::to_string).collect();
    let [time, force] = columns.columns() else {
        return Err(problem(format!("has {} columns, not 2", columns.columns().len())));
    };
    if time.len() < 2 {
        return Err(problem("has fewer than two samples".into()));
    }
    if let Some(row) = (0..time.len()).find(|&i| !(time[i].is_finite() && force[i].is_finite())) {
        return Err(problem(format!("sample {} is not finite: {}, {}", row + 1, time[row], force[row])));
    }
    if let Some(row) = (1..time.len()).find(|&i| time[i] <= time[i - 1]) {
        return Err(problem(format!(
            "the time does not ascend at sample {}: {} after {}",
            row + 1,
            time[row],
            time[row - 1]
        )));
    }
    if time[0] < 0.0 {
        return Err(problem(format!("the time starts at {} s, before t = 0", time[0])));
    }
    let dt = time[time.len() - 1] / (time.len() - 1) as f64;
    let (dt, samples) = if is_uniform(time, dt) {
        (dt, force.clone())
    } else {
        let last = time[time.len() - 1];
        ask_for_steps(last / step).map_err(|short| {
            let InputError { message, remedy, kind } = short.into();
            let message = format!("{}: the time ends at {last} s: {message}", path.display());
            InputError::new(message, remedy).of(kind)
        })?;
        notes.push(format!(
            "{}: the samples are uneven or do not start at t = 0: interpolated linearly at the time step",
            path.display()
        ));
        (step, resample(time, force, step))
    };
    Ok(ForceFile { bytes, dt, samples, notes })
}

/// Largest distance of a time from n·dt, as a share of the step dt, at which the time counts as n·dt. Times printed with few digits are
/// rounded, and such a small shift changes the force by less than a thousandth of its change within a step. The reader of records allows as
/// much.
const ROUNDING: f64 = 1e-3;

/// Whether the times are n·dt.
fn is_uniform(time: &[f64], dt: f64) -> bool {
    time.iter().enumerate().all(|(n, t)| (t - n as f64 * dt).abs() <= ROUNDING * dt)
}

/// Asks for the memory of the force at `steps` steps: times of day, or times in another unit than s, would give more steps than any memory
/// holds.
fn ask_for_steps(steps: f64) -> Result<(), Short> {
    let remedy = "let the time count in s from the beginning of the run, or lengthen the step";
    ask(format!("the force at {steps:.3e} steps"), (8.0 * steps) as u64, remedy)
}

/// The force at times n·step by linear interpolation; zero before the first sample and after the last.
fn resample(time: &[f64], force: &[f64], step: f64) -> Vec<f64> {
    let last = time[time.len() - 1];
    let count = (last / step).floor() as usize + 2;
    let at = |t: f64| {
        let next = time.partition_point(|&x| x <= t);
        match next {
            0 => 0.0,
            _ if next == time.len() => {
                if t == last {
                    force[next - 1]
                } else {
                    0.0
                }
            }
            _ => {
                let share = (t - time[next - 1]) / (time[next] - time[next - 1]);
                force[next - 1] + share * (force[next] - force[next - 1])
            }
        }
    };
    (0..count).map(|n| at(n as f64 * step)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uneven_samples_are_interpolated() {
        let samples = resample(&[1.0, 2.0, 4.0], &[0.0, 10.0, 30.0], 0.5);
        assert_eq!(samples, [0.0, 0.0, 0.0, 5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 0.0]);
    }

    /// A force file with times of day, at steps of 10 microseconds, once ended the program for lack of memory.
    #[test]
    fn a_force_of_more_steps_than_fit_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("force.csv");
        std::fs::write(&path, "1700000000.0,0\n1700000000.5,1\n1700000002.5,0\n").unwrap();
        for step in [1e-5, 1e-300] {
            let refused = read_file(&path, step).unwrap_err();
            assert!(refused.message.contains("force.csv: the time ends at 1700000002.5 s"), "{refused}");
            assert!(refused.remedy.contains("count in s from the beginning of the run"), "{refused}");
            assert_eq!(refused.kind, Kind::Memory);
        }
        assert!(read_file(&path, 1e6).is_ok());
    }
}
