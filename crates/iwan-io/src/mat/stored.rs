//! A matrix as a MAT-file stores it: full or sparse, real or complex.

/// Numbers of a matrix of a MAT-file.
#[derive(Debug, Clone, PartialEq)]
pub enum StoredNumbers {
    /// All numbers, column after column.
    Full(Vec<f64>),
    /// The numbers that are stored as not zero, column after column, as the file has them: they are not checked against the sizes of the
    /// matrix.
    Sparse {
        /// Row of each number, counted from 0.
        rows: Vec<f64>,
        /// For each column the index of its first number, and last the number of numbers.
        starts: Vec<f64>,
        /// The numbers themselves.
        values: Vec<f64>,
    },
}

/// A matrix of a MAT-file.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredMatrix {
    /// The matrix's path: `K`, or `model.K` in a struct.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Numbers; of a complex matrix only the real parts.
    pub numbers: StoredNumbers,
    /// Whether the file holds complex numbers.
    pub complex: bool,
}
