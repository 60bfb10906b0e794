//! Sparse matrices as `scipy.sparse.save_npz` writes them.

use std::io::{self, Write};

use super::arrays::{in_memory, start};
use super::columns::Columns;
use crate::matrix::Matrix;

/// A matrix as `scipy.sparse.load_npz` reads it: compressed columns of both triangles.
///
/// # Errors
/// For more than 2^31 - 1 entries.
///
/// ```
/// use iwan_exchange::{Matrix, Stored, read_bytes, to_npz};
/// let entries = vec![(0, 0, 2.0), (1, 0, -0.1), (1, 1, 2.0)];
/// let matrix = Matrix { name: "K".into(), rows: 2, columns: 2, entries, stored: Stored::Triangle, labels: None, complex: false };
/// let read = &read_bytes("k.npz".as_ref(), &to_npz(&matrix)?, None)?[0];
/// assert_eq!(read.entries, [(0, 0, 2.0), (1, 0, -0.1), (0, 1, -0.1), (1, 1, 2.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn to_npz(matrix: &Matrix) -> io::Result<Vec<u8>> {
    let columns = Columns::of(matrix).ok_or_else(|| io::Error::other("more than 2^31 - 1 entries"))?;
    let index = |values: &[u32]| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
    let count = columns.values.len();
    in_memory(|archive| {
        start(archive, "indices", "<i4", &[count], false)?;
        archive.write_all(&index(&columns.rows))?;
        start(archive, "indptr", "<i4", &[columns.starts.len()], false)?;
        archive.write_all(&index(&columns.starts))?;
        start(archive, "format", "|S3", &[], false)?;
        archive.write_all(b"csc")?;
        start(archive, "shape", "<i8", &[2], false)?;
        for size in [matrix.rows as u64, matrix.columns as u64] {
            archive.write_all(&size.to_le_bytes())?;
        }
        start(archive, "data", "<f8", &[count], count > i32::MAX as usize / 16)?;
        columns.values.iter().try_for_each(|value| archive.write_all(&value.to_le_bytes()))
    })
}
