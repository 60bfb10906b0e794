//! Mode shapes from a text file.

use std::path::Path;

use iwan_ident::signal::Options;

use crate::failure::Failure;

/// Column with the modes' frequencies.
const FREQUENCY: &str = "frequency";

/// Mass-normalised mode shapes: one row for each mode, one value for each channel of the record.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shapes {
    /// Path as the user wrote it.
    pub(super) name: String,
    /// `values[mode][channel]`.
    pub(super) values: Vec<Vec<f64>>,
    /// Hz, where the file says so.
    frequencies: Option<Vec<f64>>,
}

impl Shapes {
    /// Reads the columns called as the channels; in a file without names they stand in the order of the channels.
    pub(super) fn read(path: &Path, channels: &[String]) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let table = iwan_io::read_table(path).map_err(|e| Failure::said(&name, &e))?;
        let unnamed =
            table.names().iter().all(|n| n.starts_with("column ")) && table.names().len() == channels.len();
        let column = |(i, channel): (usize, &String)| {
            let found =
                if unnamed { table.columns().get(i).map(Vec::as_slice) } else { table.column(channel) };
            found.ok_or_else(|| {
                let message = format!(
                    "{name}: there is no column \"{channel}\" (there are: {})",
                    table.names().join(", ")
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

    /// Which rows are wanted, and where in frequency each of them is.
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

    /// The mode whose frequency lies in a band.
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

#[cfg(test)]
mod tests {
    use super::*;

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
