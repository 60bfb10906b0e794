//! Tables that are written while their rows are computed; the memory needed does not grow with the number of rows.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use parquet::file::writer::SerializedFileWriter;

use super::archive::{bytes, entry};
use super::lines::{csv_header, csv_rows};
use super::names::{TableError, check_names};
use super::parquet_file;

/// Values of a Parquet row group, all columns together: 8 MiB, which are held in memory until the group is written. Readers accept groups
/// of any size.
const GROUP: usize = 1 << 20;

/// A table that keeps no rows in memory. If it is dropped without [`finish`](Self::finish), its file is incomplete.
///
/// ```
/// use iwan_io::Growing;
/// let mut file = std::io::Cursor::new(Vec::new());
/// let mut table = Growing::csv(vec!["t".into(), "q".into()], &mut file)?;
/// table.push(&[&[0.0, 0.5], &[1.0, 2.0]])?;
/// table.push(&[&[1.0], &[-3.0]])?;
/// table.finish()?;
/// assert_eq!(file.into_inner(), b"t,q\n0.0,1.0\n0.5,2.0\n1.0,-3.0\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Growing<W: Write + Send> {
    names: Vec<String>,
    form: Form<W>,
}

#[derive(Debug)]
enum Form<W: Write + Send> {
    Csv { sink: W },
    Npz { sink: W, spool: Spool },
    Parquet { file: Box<SerializedFileWriter<W>>, group: Vec<Vec<f64>> },
}

/// Rows on the disk until their number is known: stretches of rows, each stored one column after the other.
#[derive(Debug)]
struct Spool {
    file: File,
    /// Number of rows of each stretch.
    stretches: Vec<usize>,
}

impl<W: Write + Seek + Send> Growing<W> {
    /// A table that is written as CSV.
    ///
    /// # Errors
    /// [`TableError`] for the names, and what the sink reports.
    pub fn csv(names: Vec<String>, mut sink: W) -> Result<Self, GrowingError> {
        check_names(&names)?;
        sink.write_all(&csv_header(&names)?)?;
        Ok(Self { names, form: Form::Csv { sink } })
    }

    /// A table that is written as NPZ. Until the end its rows are kept in a file without a name in `folder`, as large as the archive.
    ///
    /// # Errors
    /// [`TableError`] for the names, and what the folder reports.
    pub fn npz(names: Vec<String>, sink: W, folder: &Path) -> Result<Self, GrowingError> {
        check_names(&names)?;
        let spool = Spool { file: tempfile::tempfile_in(folder)?, stretches: Vec::new() };
        Ok(Self { names, form: Form::Npz { sink, spool } })
    }

    /// A table that is written as Parquet, in row groups.
    ///
    /// # Errors
    /// [`TableError`] for the names, and what the sink or the Parquet library reports.
    pub fn parquet(names: Vec<String>, sink: W) -> Result<Self, GrowingError> {
        check_names(&names)?;
        let file = Box::new(parquet_file::open(&names, sink).map_err(io::Error::other)?);
        let group = vec![Vec::new(); names.len()];
        Ok(Self { names, form: Form::Parquet { file, group } })
    }

    /// Adds rows: a slice for each column, all of the same length.
    ///
    /// # Errors
    /// [`TableError::Lengths`], and what the sink reports.
    pub fn push(&mut self, columns: &[&[f64]]) -> Result<(), GrowingError> {
        let expected = columns.first().map_or(0, |values| values.len());
        if columns.len() != self.names.len() {
            return Err(io::Error::other("a slice for each column is needed").into());
        }
        if let Some((name, values)) = self.names.iter().zip(columns).find(|(_, v)| v.len() != expected) {
            return Err(TableError::Lengths { name: name.clone(), rows: values.len(), expected }.into());
        }
        match &mut self.form {
            Form::Csv { sink } => csv_rows(columns, sink)?,
            Form::Npz { spool, .. } => {
                columns.iter().try_for_each(|values| spool.file.write_all(&bytes(values)))?;
                spool.stretches.push(expected);
            }
            Form::Parquet { file, group } => {
                group.iter_mut().zip(columns).for_each(|(kept, values)| kept.extend_from_slice(values));
                if group.len() * group[0].len() >= GROUP {
                    write_group(file, group)?;
                }
            }
        }
        Ok(())
    }

    /// Writes the rows that are still held, and the table's end.
    ///
    /// # Errors
    /// What the sink reports.
    pub fn finish(self) -> Result<(), GrowingError> {
        match self.form {
            Form::Csv { mut sink } => sink.flush()?,
            Form::Npz { sink, mut spool } => {
                let mut archive = zip::ZipWriter::new(sink);
                let rows = spool.stretches.iter().sum();
                for (column, name) in self.names.iter().enumerate() {
                    entry(&mut archive, name, rows)?;
                    spool.each(column, self.names.len(), |part| archive.write_all(part))?;
                }
                archive.finish().map_err(io::Error::other)?;
            }
            Form::Parquet { mut file, mut group } => {
                if !group[0].is_empty() {
                    write_group(&mut file, &mut group)?;
                }
                file.close().map_err(io::Error::other)?;
            }
        }
        Ok(())
    }
}

impl Spool {
    /// Calls `take` with the bytes of a column, stretch by stretch.
    fn each(
        &mut self,
        column: usize,
        columns: usize,
        mut take: impl FnMut(&[u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        let (mut begin, mut part) = (0_u64, Vec::new());
        for rows in &self.stretches {
            let length = rows * size_of::<f64>();
            part.resize(length, 0);
            self.file.seek(SeekFrom::Start(begin + (column * length) as u64))?;
            self.file.read_exact(&mut part)?;
            take(&part)?;
            begin += (columns * length) as u64;
        }
        Ok(())
    }
}

fn write_group<W: Write + Send>(
    file: &mut SerializedFileWriter<W>,
    group: &mut [Vec<f64>],
) -> io::Result<()> {
    let columns: Vec<&[f64]> = group.iter().map(Vec::as_slice).collect();
    parquet_file::group(file, &columns).map_err(io::Error::other)?;
    group.iter_mut().for_each(Vec::clear);
    Ok(())
}

/// Why a growing table cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GrowingError {
    /// The columns make no table.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The sink or the folder reports an error.
    #[error(transparent)]
    Io(#[from] io::Error),
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::Table;

    type Columns = [(String, Vec<f64>); 3];

    fn columns() -> Columns {
        let values = |f: fn(f64) -> f64| (0..1000).map(|n| f(f64::from(n))).collect();
        [
            ("t".into(), values(|n| 1e-3 * n)),
            ("=q".into(), values(f64::sin)),
            ("v".into(), values(|n| -1.0 / n)),
        ]
    }

    /// Writes the columns in pieces of uneven lengths, one of which is empty.
    fn grown(columns: &Columns, mut table: Growing<&mut Cursor<Vec<u8>>>) {
        for range in [0..1, 1..1, 1..700, 700..1000] {
            let part: Vec<&[f64]> = columns.iter().map(|(_, v)| &v[range.clone()]).collect();
            table.push(&part).unwrap();
        }
        table.finish().unwrap();
    }

    #[test]
    fn a_table_in_pieces_is_the_table_at_once() {
        let columns = columns();
        let names = || columns.iter().map(|(name, _)| name.clone()).collect();
        let whole = Table::new(columns.iter().map(|(n, v)| (n.clone(), v.as_slice())).collect()).unwrap();
        let place = tempfile::tempdir().unwrap();
        let [mut at_once, mut in_pieces] = [(); 2].map(|()| Cursor::new(Vec::new()));
        whole.csv_to(&mut at_once).unwrap();
        grown(&columns, Growing::csv(names(), &mut in_pieces).unwrap());
        assert!(at_once.get_ref() == in_pieces.get_ref());
        let [mut at_once, mut in_pieces] = [(); 2].map(|()| Cursor::new(Vec::new()));
        whole.npz_to(&mut at_once).unwrap();
        grown(&columns, Growing::npz(names(), &mut in_pieces, place.path()).unwrap());
        assert!(at_once.get_ref() == in_pieces.get_ref());
        assert_eq!(std::fs::read_dir(place.path()).unwrap().count(), 0);
        let [mut at_once, mut in_pieces] = [(); 2].map(|()| Cursor::new(Vec::new()));
        whole.parquet_to(&mut at_once).unwrap();
        grown(&columns, Growing::parquet(names(), &mut in_pieces).unwrap());
        assert!(at_once.get_ref() == in_pieces.get_ref());
    }

    #[test]
    fn what_is_no_table_is_refused() {
        let mut sink = Cursor::new(Vec::new());
        let twice = Growing::csv(vec!["a".into(), "a".into()], &mut sink).unwrap_err();
        assert!(twice.to_string().contains("unique"), "{twice}");
        let mut table = Growing::csv(vec!["a".into(), "b".into()], &mut sink).unwrap();
        assert!(
            table.push(&[&[1.0], &[1.0, 2.0]]).unwrap_err().to_string().contains("column 'b' has 2 rows")
        );
        assert!(table.push(&[&[1.0]]).is_err());
    }
}
