//! Sparse matrices as a MATLAB level 5 MAT-file ("MAT-File Format", The MathWorks), not compressed.

use std::io;

use super::columns::Columns;
use crate::matrix::Matrix;

/// Type codes of data elements.
const INT8: u32 = 1;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
/// Class code of sparse arrays.
const SPARSE: u32 = 5;

/// Matrices as one file for MATLAB's `load`: each is a sparse variable with the matrix's name, and holds both triangles.
///
/// # Errors
/// For a matrix of 4 GB and more, which the format cannot hold.
///
/// ```
/// use iwan_exchange::{Matrix, Stored, read_bytes, to_mat};
/// let entries = vec![(0, 0, 2.0), (1, 0, -0.1), (1, 1, 2.0)];
/// let matrix = Matrix { name: "K".into(), rows: 2, columns: 2, entries, stored: Stored::Triangle, labels: None, complex: false };
/// let read = &read_bytes("model.mat".as_ref(), &to_mat(&[matrix])?, None)?[0];
/// assert_eq!(read.name, "K");
/// assert_eq!(read.entries, [(0, 0, 2.0), (1, 0, -0.1), (0, 1, -0.1), (1, 1, 2.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn to_mat(matrices: &[Matrix]) -> io::Result<Vec<u8>> {
    let mut file = format!("{:<116}", "MATLAB 5.0 MAT-file, written by iwan").into_bytes();
    file.extend([0; 8]);
    file.extend(0x0100_u16.to_le_bytes());
    file.extend(b"IM");
    for matrix in matrices {
        let too_large = || io::Error::other(format!("matrix {}: 4 GB and more", matrix.name));
        let columns = Columns::of(matrix).ok_or_else(too_large)?;
        let count = columns.values.len();
        // A matrix without entries still reserves room for one, as MATLAB itself writes it.
        let room = u32::try_from(count.max(1)).map_err(|_| too_large())?;
        let mut body = Vec::new();
        element(&mut body, UINT32, [SPARSE, room].iter().flat_map(|w| w.to_le_bytes()));
        let sizes = [matrix.rows as u32, matrix.columns as u32];
        element(&mut body, INT32, sizes.iter().flat_map(|w| w.to_le_bytes()));
        element(&mut body, INT8, matrix.name.bytes());
        element(&mut body, INT32, columns.rows.iter().flat_map(|w| w.to_le_bytes()));
        element(&mut body, INT32, columns.starts.iter().flat_map(|w| w.to_le_bytes()));
        element(&mut body, DOUBLE, columns.values.iter().flat_map(|v| v.to_le_bytes()));
        let length = u32::try_from(body.len()).map_err(|_| too_large())?;
        file.extend(MATRIX.to_le_bytes());
        file.extend(length.to_le_bytes());
        file.extend(body);
    }
    Ok(file)
}

/// Appends a data element, filled up to a multiple of eight bytes.
fn element(into: &mut Vec<u8>, kind: u32, data: impl Iterator<Item = u8>) {
    into.extend(kind.to_le_bytes());
    let at = into.len();
    into.extend([0; 4]);
    into.extend(data);
    // Lengths beyond 32 bits are detected later, from the length of the whole body.
    let length = (into.len() - at - 4) as u32;
    into[at..at + 4].copy_from_slice(&length.to_le_bytes());
    into.resize(into.len().next_multiple_of(8), 0);
}
