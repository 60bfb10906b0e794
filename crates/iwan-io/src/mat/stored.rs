//! A matrix as a MAT-file has it: full or sparse, real or complex.

/// Numbers of a matrix of a MAT-file.
#[derive(Debug, Clone, PartialEq)]
pub enum StoredNumbers {
    /// All of them, column after column.
    Full(Vec<f64>),
    /// Those that are not zero, column after column, as the file has them: nothing here is checked against the sizes.
    Sparse {
        /// Row of each, from 0.
        rows: Vec<f64>,
        /// For each column where it begins, and the end of the last one.
        starts: Vec<f64>,
        /// Values.
        values: Vec<f64>,
    },
}

/// A matrix of a MAT-file.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredMatrix {
    /// Its path: `K`, or `model.K` in a struct.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Numbers; of a complex matrix their real parts.
    pub numbers: StoredNumbers,
    /// Whether the file holds complex numbers.
    pub complex: bool,
}
