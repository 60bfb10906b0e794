//! Names of columns, and the reasons why columns make no table.

use iwan_machine::is_harmful;
use std::collections::HashSet;

/// Why columns do not make a [`Table`](super::Table).
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum TableError {
    /// No column at all.
    #[error("the table has no column; it needs at least one")]
    Empty,
    /// Columns of different lengths.
    #[error("column '{name}' has {rows} rows, the first column has {expected}; all must be equally long")]
    Lengths {
        /// Name of the column.
        name: String,
        /// Its number of rows.
        rows: usize,
        /// Number of rows of the first column.
        expected: usize,
    },
    /// The same name twice, an empty name, or one with control characters.
    #[error(
        "column {index} (counted from 0) is called '{name}'; names must be unique, not empty, and without control characters"
    )]
    Name {
        /// Index of the column, counted from 0.
        index: usize,
        /// Its name.
        name: String,
    },
}

/// Refuses names that a table may not have.
pub(super) fn check_names<'a>(all: impl IntoIterator<Item = &'a String>) -> Result<(), TableError> {
    let mut names = HashSet::new();
    for (index, name) in all.into_iter().enumerate() {
        let twice = !names.insert(name);
        if twice || name.is_empty() || name.contains(is_harmful) {
            return Err(TableError::Name { index, name: name.clone() });
        }
    }
    if names.is_empty() { Err(TableError::Empty) } else { Ok(()) }
}
