//! Relative displacements, or any other linear combinations of the rows of `[matrices]`, from the rows of a further matrix.

use std::path::Path;

use iwan_exchange::{Matrix, Stored};

use super::matrix_file::chosen;
use crate::error::InputError;
use crate::section::Section;

/// Linear combinations of the rows of stiffness and mass: one for each row of a matrix that has as many columns as these have rows. Each is
/// a list of rows (from 0) and coefficients.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::structure) struct Combinations(Vec<Vec<(usize, f64)>>);

impl Combinations {
    /// The matrix that the key `key` of a table names; the matrices of the structure have `rows` rows, none where the structure has
    /// elements.
    pub(in crate::structure) fn read(
        section: &Section<'_>,
        folder: &Path,
        key: &str,
        rows: Option<usize>,
    ) -> Result<Self, InputError> {
        let Some(rows) = rows else {
            let message = format!(
                "{key}: a matrix whose columns are rows of [matrices], and this structure has a [mesh]"
            );
            return Err(section.failure(key, &message, "name node sets"));
        };
        let (path, matrix) = chosen(section, folder, key, &[])?;
        if matrix.columns != rows || matrix.rows == 0 {
            let message = format!(
                "{}: {} rows and {} columns, but stiffness and mass have {rows} rows",
                path.display(),
                matrix.rows,
                matrix.columns
            );
            let remedy = if matrix.rows == rows { "transpose it: " } else { "" };
            let remedy = format!("{remedy}give a column for each row of the stiffness, in its order");
            return Err(section.failure(key, &message, &remedy));
        }
        Ok(Self(by_rows(&matrix)))
    }

    /// Number of combinations.
    pub(in crate::structure) fn len(&self) -> usize {
        self.0.len()
    }

    /// Numbers of combinations, counted from 1, that a key of a table lists.
    pub(in crate::structure) fn numbers(
        &self,
        section: &Section<'_>,
        key: &str,
    ) -> Result<Vec<usize>, InputError> {
        section.numbers(key)?.into_iter().map(|number| self.checked(section, key, number)).collect()
    }

    /// The combination whose number, counted from 1, a key of a table gives; the only one where the key is missing.
    pub(in crate::structure) fn one(
        &self,
        section: &Section<'_>,
        key: &str,
    ) -> Result<Vec<(usize, f64)>, InputError> {
        let row = match section.optional_number(key)? {
            Some(number) => self.checked(section, key, number)?,
            None if self.len() == 1 => 1,
            None => {
                let message = format!("the matrix has {} rows", self.len());
                return Err(section.failure(
                    key,
                    &message,
                    &format!("choose one with {key} = N, counted from 1"),
                ));
            }
        };
        self.row(section, key, row)
    }

    /// The combination with the number `row`, counted from 1; an error where there is none, or where all its coefficients are zero.
    pub(in crate::structure) fn row(
        &self,
        section: &Section<'_>,
        key: &str,
        row: usize,
    ) -> Result<Vec<(usize, f64)>, InputError> {
        let terms = &self.0[row - 1];
        if terms.is_empty() {
            let message = format!("row {row} of the matrix is all 0");
            return Err(section.failure(key, &message, "leave that row out"));
        }
        Ok(terms.clone())
    }

    fn checked(&self, section: &Section<'_>, key: &str, number: f64) -> Result<usize, InputError> {
        if number.fract() == 0.0 && (1.0..=self.len() as f64).contains(&number) {
            return Ok(number as usize);
        }
        let message = format!("{key} = {number}: the matrix has the rows 1 to {}", self.len());
        Err(section.failure(key, &message, "give a row of the matrix, counted from 1"))
    }
}

/// The entries of each row, by column, each place once; where the file holds one triangle, both triangles are given.
pub(super) fn by_rows(matrix: &Matrix) -> Vec<Vec<(usize, f64)>> {
    let mut rows = vec![Vec::new(); matrix.rows];
    for &(i, j, value) in &matrix.entries {
        rows[i as usize].push((j as usize, value));
        if matrix.stored == Stored::Triangle && i != j {
            rows[j as usize].push((i as usize, value));
        }
    }
    for row in &mut rows {
        row.sort_by_key(|term| term.0);
        row.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
        row.retain(|term| term.1 != 0.0);
    }
    rows
}
