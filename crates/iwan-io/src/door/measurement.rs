//! All channels of a file, whatever each of them measures: force and motions of a modal test.

use super::read::{format_of, parse};
use crate::assembly;
use crate::error::ReadError;
use crate::file_bytes::FileBytes;
use crate::options::{Format, ReadOptions};
use crate::quantity::Quantity;
use crate::uff::{self, NodalDirection, UffFunction};
use crate::warning::Warning;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// One channel with its name, unit, quantity and place.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredChannel {
    /// Name; node and direction are added where several channels of a record have the same name.
    pub name: String,
    /// Unit as the file writes it; empty when the file states none.
    pub unit: String,
    /// What the channel measures.
    pub quantity: Quantity,
    /// Samples.
    pub samples: Vec<f64>,
    /// Node and direction, where the format has them.
    pub at: Option<NodalDirection>,
}

/// Channels that were sampled together.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement {
    /// Sampling interval, s.
    pub dt: f64,
    /// Channels of equal length.
    pub channels: Vec<MeasuredChannel>,
}

/// What a file of a modal test holds.
#[derive(Debug, Clone, PartialEq)]
pub struct ModalTest {
    /// Records in time. A new record begins whenever name, place (node and direction) and quantity of a channel repeat.
    pub measurements: Vec<Measurement>,
    /// Frequency responses (universal files).
    pub responses: Vec<UffFunction>,
    /// What the reader noticed.
    pub warnings: Vec<Warning>,
}

/// Reads all channels of a file, whatever they measure.
///
/// # Errors
/// [`ReadError`] as [`read`](crate::read); [`ReadError::Mismatch`] where channels of a record differ in their sampling.
///
/// ```no_run
/// let test = iwan_io::read_modal_test("hits.uff".as_ref(), &iwan_io::ReadOptions::default())?;
/// let names: Vec<&str> = test.measurements[0].channels.iter().map(|c| c.name.as_str()).collect();
/// # Ok::<(), iwan_io::ReadError>(())
/// ```
pub fn read_modal_test(path: &Path, options: &ReadOptions) -> Result<ModalTest, ReadError> {
    let bytes =
        iwan_machine::read_file(path).map_err(|source| ReadError::Io { file: path.into(), source })?;
    let source = FileBytes { file: path, bytes: &bytes };
    if format_of(&source, options) == Some(Format::Uff) {
        return universal(&source);
    }
    let raw = parse(FileBytes { file: path, bytes: &bytes }, options)?;
    let (dt, channels, warnings) = assembly::all_channels(&source, raw, options)?;
    let channel = |c: assembly::Channel| MeasuredChannel {
        name: c.name,
        unit: c.unit,
        quantity: c.quantity,
        samples: c.values,
        at: None,
    };
    let channels = channels.into_iter().map(channel).collect();
    Ok(ModalTest { measurements: vec![Measurement { dt, channels }], responses: Vec::new(), warnings })
}

fn universal(source: &FileBytes) -> Result<ModalTest, ReadError> {
    let (functions, warnings) = uff::functions(source.file, source.bytes)?;
    let mut test = ModalTest { measurements: Vec::new(), responses: Vec::new(), warnings };
    let mut last = HashSet::new();
    for f in functions {
        match (f.kind, f.im.is_empty()) {
            (4, false) => test.responses.push(f),
            (0 | 1, true) => add(source, (&mut test.measurements, &mut last), f)?,
            (kind, _) => {
                let reason = format!(
                    "a function of type {kind}, neither a time response (1) nor a frequency response (4)"
                );
                test.warnings.push(Warning::LeftOut { name: f.name, reason });
            }
        }
    }
    if test.measurements.is_empty() && test.responses.is_empty() {
        let remedy = "export time responses (type 1) of force and motions, or frequency responses (type 4), as dataset 58";
        return Err(source.unsupported("the whole file", "a file without either", remedy));
    }
    test.measurements.iter_mut().for_each(tell_apart);
    Ok(test)
}

/// Adds node and direction to the names of channels that share one name: some programs write the same identification for all channels.
fn tell_apart(measurement: &mut Measurement) {
    let mut counts: HashMap<String, usize> = HashMap::new();
    measurement.channels.iter().for_each(|c| *counts.entry(c.name.clone()).or_default() += 1);
    for channel in &mut measurement.channels {
        if counts[&channel.name] > 1 {
            channel.name = placed(channel);
        }
    }
}

fn placed(channel: &MeasuredChannel) -> String {
    channel.at.map_or_else(|| channel.name.clone(), |at| format!("{} at {at}", channel.name))
}

/// What identifies a channel of a measurement: name, place and quantity.
type Identity = (String, Option<NodalDirection>, Quantity);

/// Adds a function to the last measurement, whose channels are `known`; where that measurement holds such a channel already, the function
/// begins a new one.
fn add(
    source: &FileBytes,
    (all, known): (&mut Vec<Measurement>, &mut HashSet<Identity>),
    f: UffFunction,
) -> Result<(), ReadError> {
    let at = (f.response.node != 0).then_some(f.response);
    let channel = MeasuredChannel { name: f.name, unit: f.unit, quantity: f.quantity, samples: f.re, at };
    let identity = (channel.name.clone(), channel.at, channel.quantity);
    match all.last_mut() {
        Some(last) if known.insert(identity.clone()) => {
            let (dt, n, first) = (last.dt, last.channels[0].samples.len(), &last.channels[0]);
            if (f.step / dt - 1.0).abs() > assembly::SAME_INTERVAL || channel.samples.len() != n {
                return Err(ReadError::Mismatch {
                    file: source.file.into(),
                    found: format!("{} samples at {:.6} Hz", channel.samples.len(), 1.0 / f.step),
                    expected: format!("{n} at {:.6} Hz", 1.0 / dt),
                    reference: placed(first),
                    name: placed(&channel),
                });
            }
            last.channels.push(channel);
        }
        _ => {
            *known = HashSet::from([identity]);
            all.push(Measurement { dt: f.step, channels: vec![channel] });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uff::write;

    /// A force at node 1 and two motions, all with the same identification.
    fn functions(last: (f64, usize)) -> Vec<UffFunction> {
        let function = |node, quantity, (step, samples): (f64, usize)| UffFunction {
            name: "Record 1".into(),
            kind: 1,
            response: NodalDirection { node, direction: -3 },
            reference: NodalDirection { node: 0, direction: 0 },
            quantity,
            unit: String::new(),
            start: 0.0,
            step,
            re: (0..samples).map(|n| n as f64).collect(),
            im: Vec::new(),
        };
        let all = (1e-3, 8);
        let motion = |node, own| function(node, Quantity::Acceleration, own);
        vec![function(1, Quantity::Force, all), motion(1, all), motion(2, last)]
    }

    fn read(functions: &[UffFunction]) -> Result<ModalTest, ReadError> {
        let text = write::functions(functions);
        universal(&FileBytes { file: Path::new("hits.unv"), bytes: text.as_bytes() })
    }

    #[test]
    fn channels_of_one_name_are_told_apart_by_their_places() {
        let test = read(&functions((1e-3, 8))).unwrap();
        let names: Vec<&str> = test.measurements[0].channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!(names, ["Record 1 at 1:-z", "Record 1 at 1:-z", "Record 1 at 2:-z"]);
        let alone = read(&functions((1e-3, 8))[..1]).unwrap();
        assert_eq!(alone.measurements[0].channels[0].name, "Record 1");
    }

    #[test]
    fn rates_and_lengths_that_differ_are_named_with_file_and_channel() {
        for (own, found) in [((2e-3, 8), "8 samples at 500"), ((1e-3, 7), "7 samples at 1000")] {
            let said = read(&functions(own)).unwrap_err().to_string();
            for word in ["hits.unv", "'Record 1 at 2:-z'", found, "expected 8 at 1000", "'Record 1 at 1:-z'"]
            {
                assert!(said.contains(word), "no {word} in {said}");
            }
        }
    }
}
