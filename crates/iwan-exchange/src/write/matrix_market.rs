//! Matrix Market, coordinate format (R. F. Boisvert, R. Pozo, K. A. Remington, NISTIR 5935, 1996).

use std::fmt::Write;

use crate::matrix::{Matrix, Stored};

/// A matrix as Matrix Market text, each number with enough digits to restore its bits; `comment` stands in the lines below the first.
///
/// ```
/// use iwan_exchange::{Matrix, Stored, read_bytes, to_matrix_market};
/// let entries = vec![(0, 0, 2.0), (1, 0, -0.1), (1, 1, 2.0)];
/// let matrix = Matrix { name: "K".into(), rows: 2, columns: 2, entries, stored: Stored::Triangle, labels: None, complex: false };
/// let text = to_matrix_market(&matrix, "stiffness");
/// assert!(text.starts_with("%%MatrixMarket matrix coordinate real symmetric\n% stiffness\n2 2 3\n"));
/// assert_eq!(read_bytes("k.mtx".as_ref(), text.as_bytes(), None)?[0].entries, matrix.entries);
/// # Ok::<(), iwan_exchange::ExchangeError>(())
/// ```
#[must_use]
pub fn to_matrix_market(matrix: &Matrix, comment: &str) -> String {
    let kind = if matrix.stored == Stored::Triangle { "symmetric" } else { "general" };
    let mut text = format!("%%MatrixMarket matrix coordinate real {kind}\n");
    for line in comment.lines() {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "% {line}");
    }
    let _ = writeln!(text, "{} {} {}", matrix.rows, matrix.columns, matrix.entries.len());
    for &(i, j, value) in &matrix.entries {
        // Symmetric matrices of this format hold the lower triangle.
        let (i, j) = if matrix.stored == Stored::Triangle { (i.max(j), i.min(j)) } else { (i, j) };
        let _ = writeln!(text, "{} {} {value:e}", i + 1, j + 1);
    }
    text
}
