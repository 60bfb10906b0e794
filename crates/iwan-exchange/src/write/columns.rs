//! Both triangles of a matrix, column by column: the form that MATLAB and SciPy store.

use crate::matrix::{Matrix, Stored};

/// Compressed columns.
pub(super) struct Columns {
    /// For each column the index of its first entry, and last the number of entries.
    pub(super) starts: Vec<u32>,
    pub(super) rows: Vec<u32>,
    pub(super) values: Vec<f64>,
}

impl Columns {
    /// The columns of a matrix, with entries at one place added up; none for 2^31 entries and more.
    pub(super) fn of(matrix: &Matrix) -> Option<Self> {
        let mirrored = matrix.stored == Stored::Triangle;
        let both = |&(i, j, v): &(u32, u32, f64)| {
            let second = (mirrored && i != j).then_some((i, j, v));
            std::iter::once((j, i, v)).chain(second)
        };
        let mut entries: Vec<(u32, u32, f64)> = matrix.entries.iter().flat_map(both).collect();
        entries.sort_by_key(|entry| (entry.0, entry.1));
        entries.dedup_by(|next, kept| {
            let same = (next.0, next.1) == (kept.0, kept.1);
            if same {
                kept.2 += next.2;
            }
            same
        });
        if entries.len() > i32::MAX as usize {
            return None;
        }
        let mut starts = vec![0_u32; matrix.columns + 1];
        for (column, ..) in &entries {
            starts[*column as usize + 1] += 1;
        }
        for column in 0..matrix.columns {
            starts[column + 1] += starts[column];
        }
        let (rows, values) = entries.iter().map(|entry| (entry.1, entry.2)).unzip();
        Some(Self { starts, rows, values })
    }
}
