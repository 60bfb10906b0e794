//! What all targets ask of a reader.

use iwan_exchange::{Format, read_bytes};

/// Reads any bytes as a file of the format: an error or sound matrices, never a panic.
///
/// # Panics
/// Where a matrix has entries outside itself, or labels for other rows than its own.
pub fn read(name: &str, format: Format, bytes: &[u8]) {
    let Ok(matrices) = read_bytes(name.as_ref(), bytes, Some(format)) else { return };
    for matrix in matrices {
        let inside = |e: &(u32, u32, f64)| (e.0 as usize) < matrix.rows && (e.1 as usize) < matrix.columns;
        assert!(matrix.entries.iter().all(inside));
        assert!(matrix.labels.as_ref().is_none_or(|labels| labels.len() == matrix.rows));
        if matrix.rows == matrix.columns && matrix.rows < 1 << 16 {
            let _ = matrix.lower_triangle(1e-6);
        }
    }
}
