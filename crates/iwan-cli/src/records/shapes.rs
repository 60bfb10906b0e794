//! Mode shapes from a table or a universal file.

use iwan_machine::listed;
use std::path::Path;

use iwan_ident::signal::Options;
use iwan_io::write_uff::NodalValues;
use iwan_modal::measure::Freedom;

use crate::failure::Failure;
use crate::shown;

/// Name of the column with the frequencies of the modes.
const FREQUENCY: &str = "frequency";

/// Mass-normalised mode shapes: one row for each mode, one value for each channel of the record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shapes {
    /// Path as the user wrote it.
    pub(super) name: String,
    /// `values[mode][channel]`.
    pub(super) values: Vec<Vec<f64>>,
    /// Frequency of each mode, Hz; none where the file does not say.
    frequencies: Option<Vec<f64>>,
}

impl Shapes {
    /// Shapes given as rows, with the frequencies of the modes (Hz) where they are known.
    pub(crate) fn given(values: Vec<Vec<f64>>, frequencies: Option<Vec<f64>>) -> Self {
        Self { name: "shapes".into(), values, frequencies }
    }

    /// Reads the columns that are called as the channels; in a file without names, the columns stand in the order of the channels.
    pub(super) fn read(path: &Path, channels: &[String]) -> Result<Self, Failure> {
        let name = shown::path(path);
        if let Some(bytes) =
            iwan_machine::read_file(path).ok().filter(|bytes| bytes.trim_ascii_start().starts_with(b"-1"))
        {
            return Self::universal(path, &bytes, channels);
        }
        let table = iwan_io::read_table(path).map_err(|e| Failure::read(&name, &e))?;
        let unnamed =
            table.names().iter().all(|n| n.starts_with("column ")) && table.names().len() == channels.len();
        let column = |(i, channel): (usize, &String)| {
            let found =
                if unnamed { table.columns().get(i).map(Vec::as_slice) } else { table.column(channel) };
            found.ok_or_else(|| {
                let message = format!(
                    "{name}: there is no column \"{channel}\" (there are: {})",
                    listed(table.names())
                );
                Failure::input(
                    message,
                    "name the columns as the channels of the record, or choose channels with --channel",
                )
            })
        };
        let columns = channels.iter().enumerate().map(column).collect::<Result<Vec<_>, _>>()?;
        let rows = table.rows();
        let values = (0..rows).map(|row| columns.iter().map(|c| c[row]).collect()).collect();
        let frequencies = table.column(FREQUENCY).map(<[f64]>::to_vec);
        for (row, f) in frequencies.iter().flatten().enumerate() {
            if !(f.is_finite() && *f > 0.0) {
                let message = format!("{name}: {FREQUENCY} of mode {} is {f}", row + 1);
                return Err(Failure::input(message, "give it in Hz, finite and > 0"));
            }
        }
        Ok(Self { name, values, frequencies })
    }

    /// Shapes from the datasets 55 of a universal file: the real part of each mass-normalised shape at the nodes of the channels.
    fn universal(path: &Path, bytes: &[u8], channels: &[String]) -> Result<Self, Failure> {
        let name = shown::path(path);
        let model = iwan_io::uff_model(path, bytes).map_err(|e| Failure::said(&name, &e))?;
        let mut values = Vec::new();
        for (n, mode) in model.modes.iter().enumerate() {
            let shape = mode.mass_normalised().ok_or_else(|| {
                let message = format!("{name}: mode {} has no modal mass and no modal A", n + 1);
                Failure::input(message, "export shapes with their modal mass (dataset 55, record 8)")
            })?;
            let at = |channel: &String| {
                value_at(&shape, channel).map_err(|wrong| {
                    let remedy = "call channels by node and direction as in 12:+z, or give shapes as a table with their names";
                    Failure::input(format!("{name}: mode {}: {wrong}", n + 1), remedy)
                })
            };
            values.push(channels.iter().map(at).collect::<Result<Vec<f64>, _>>()?);
        }
        if values.is_empty() {
            let left: Vec<String> = model.warnings.iter().map(ToString::to_string).collect();
            let message = format!("{name}: no mode shape (dataset 55) that can be used {}", left.join("; "));
            return Err(Failure::input(message, "export normal or complex modes at nodes as dataset 55"));
        }
        let frequencies = Some(model.modes.iter().map(|m| m.frequency).collect());
        Ok(Self { name, values, frequencies })
    }

    /// The index of each mode that is wanted, and the options that isolate it by frequency.
    pub(super) fn select(&self, bands: &[(f64, f64)]) -> Result<Vec<(usize, Options)>, Failure> {
        let at = |band, near| Options { band, near, ..Options::default() };
        match (bands, &self.frequencies) {
            ([], Some(all)) => Ok(all.iter().map(|f| at(None, Some(*f))).enumerate().collect()),
            ([], None) if self.values.len() == 1 => Ok(vec![(0, Options::default())]),
            (bands, Some(all)) => {
                bands.iter().map(|b| Ok((self.row(all, *b)?, at(Some(*b), None)))).collect()
            }
            (bands, None) if bands.len() == self.values.len() => {
                Ok(bands.iter().map(|b| at(Some(*b), None)).enumerate().collect())
            }
            (bands, None) => {
                let message = format!(
                    "{}: {} mode shapes and {} bands: which mode is in which band is not clear",
                    self.name,
                    self.values.len(),
                    bands.len()
                );
                let remedy = "give one --band for each row, or a column `frequency` (Hz) in the file";
                Err(Failure::input(message, remedy))
            }
        }
    }

    /// Index of the one mode whose frequency lies in a band.
    fn row(&self, frequencies: &[f64], (low, high): (f64, f64)) -> Result<usize, Failure> {
        let inside: Vec<usize> =
            (0..frequencies.len()).filter(|&i| (low..=high).contains(&frequencies[i])).collect();
        match inside.as_slice() {
            [one] => Ok(*one),
            found => {
                let message = format!("{}: {} modes between {low} and {high} Hz", self.name, found.len());
                Err(Failure::input(message, "move or narrow the band to one mode of the file"))
            }
        }
    }
}

/// Value of a shape at a channel that is named by its node: `12:+z`, `node 12 direction 3`, or `12` where the shape has one direction at this node.
fn value_at(shape: &[(i64, NodalValues)], channel: &str) -> Result<f64, String> {
    let words: Vec<&str> = channel.split_whitespace().collect();
    let (point, direction) = match words.as_slice() {
        ["node", node, "direction", direction] => ((*node).to_string(), direction.parse::<i64>().ok()),
        _ => match Freedom::parse(channel) {
            Some(f) => (f.point, Some(i64::from(f.direction.code())).filter(|code| *code != 0)),
            None => (channel.to_string(), None),
        },
    };
    let node: i64 = point.parse().map_err(|_| format!("channel \"{channel}\" names no node"))?;
    let (_, own) =
        shape.iter().find(|(n, _)| *n == node).ok_or_else(|| format!("no value at node {node}"))?;
    let axis = if let Some(code) = direction {
        usize::try_from(code.abs() - 1).ok().filter(|axis| *axis < 3)
    } else {
        let mut moving = (0..3).filter(|axis| own[*axis] != [0.0; 2]);
        moving.next().filter(|_| moving.next().is_none())
    };
    let axis =
        axis.ok_or_else(|| format!("channel \"{channel}\" does not say along which axis of node {node}"))?;
    Ok(own[axis][0] * if direction.is_some_and(|code| code < 0) { -1.0 } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_are_nodes_with_directions_in_universal_files() {
        let shape = [(12, [[0.5, 0.0], [0.0; 2], [-2.0, 0.1]]), (7, [[0.0; 2], [0.0; 2], [3.0, 0.0]])];
        let at = |channel: &str| value_at(&shape, channel);
        assert_eq!((at("12:-z"), at("node 12 direction 1"), at("7")), (Ok(2.0), Ok(0.5), Ok(3.0)));
        assert!(at("12").unwrap_err().contains("along which axis"));
        assert!(
            at("tip").unwrap_err().contains("names no node") && at("9:+z").unwrap_err().contains("node 9")
        );
    }

    fn shapes(frequencies: Option<Vec<f64>>) -> Shapes {
        Shapes { name: "s.csv".into(), values: vec![vec![1.0, 1.0], vec![1.0, -1.0]], frequencies }
    }

    #[test]
    fn bands_and_frequencies_say_which_mode_is_meant() {
        let known = shapes(Some(vec![80.0, 220.0]));
        let both = known.select(&[]).unwrap();
        assert_eq!(
            both.iter().map(|(row, o)| (*row, o.near)).collect::<Vec<_>>(),
            [(0, Some(80.0)), (1, Some(220.0))]
        );
        assert_eq!(known.select(&[(200.0, 300.0)]).unwrap()[0].0, 1);
        assert!(known.select(&[(50.0, 300.0)]).is_err() && known.select(&[(1.0, 2.0)]).is_err());
        let unknown = shapes(None);
        assert!(unknown.select(&[]).is_err() && unknown.select(&[(1.0, 2.0)]).is_err());
        assert_eq!(unknown.select(&[(1.0, 2.0), (3.0, 4.0)]).unwrap().len(), 2);
    }
}
