//! A sparse matrix as a file stores it: triplets, and what the file says about the rows.

/// The degree of freedom of a node that a row stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Component {
    /// Displacement along x, y or z (0, 1, 2).
    Displacement(u8),
    /// Rotation about x, y or z (0, 1, 2).
    Rotation(u8),
    /// No motion of a node: a generalised coordinate, such as that of a fixed-interface mode.
    Scalar,
}

impl Component {
    /// The component with the number that finite-element programs use: 1 to 3 displacements, 4 to 6 rotations, 0 a scalar.
    ///
    /// ```
    /// use iwan_exchange::Component;
    /// assert_eq!(Component::numbered(5), Some(Component::Rotation(1)));
    /// assert_eq!(Component::numbered(8), None);
    /// ```
    #[must_use]
    pub fn numbered(number: u64) -> Option<Self> {
        match number {
            0 => Some(Self::Scalar),
            1..=3 => Some(Self::Displacement(number as u8 - 1)),
            4..=6 => Some(Self::Rotation(number as u8 - 4)),
            _ => None,
        }
    }

    /// The number that finite-element programs use.
    #[must_use]
    pub fn number(self) -> u8 {
        match self {
            Self::Scalar => 0,
            Self::Displacement(axis) => axis + 1,
            Self::Rotation(axis) => axis + 4,
        }
    }
}

/// The meaning of a row: a component of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Label {
    /// Number of the node in the program that wrote the file.
    pub node: u64,
    /// Component.
    pub component: Component,
}

impl std::fmt::Display for Label {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "node {} component {}", self.node, self.component.number())
    }
}

/// Which entries of a symmetric matrix a file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stored {
    /// All entries.
    All,
    /// One triangle: an entry off the diagonal stands for itself and its mirror image.
    Triangle,
}

/// Row, column (from 0) and value.
pub type Entry = (u32, u32, f64);

/// A matrix of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// The matrix's name in the file; empty where the format has no names.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Entries in the order of the file; entries at one place add up.
    pub entries: Vec<Entry>,
    /// Which entries of a symmetric matrix `entries` holds.
    pub stored: Stored,
    /// The meaning of each row, where the file states it.
    pub labels: Option<Vec<Label>>,
    /// Whether the file holds complex numbers; `entries` then holds their real parts.
    pub complex: bool,
}

/// Two entries of a matrix that should be equal by symmetry, but are not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asymmetry {
    /// Row, from 0; always greater than the column.
    pub row: usize,
    /// Column, from 0.
    pub column: usize,
    /// Entry (row, column).
    pub value: f64,
    /// Entry (column, row).
    pub mirrored: f64,
}

impl Matrix {
    /// The lower triangle, column by column with rows ascending, each place once. Where the file holds both triangles, each value is the
    /// mean of the two entries.
    ///
    /// # Errors
    /// The [`Asymmetry`] with the largest excess over `tolerance` times the geometric mean of the two diagonal entries (or, where one of
    /// these is zero, times the larger of the two entries).
    ///
    /// # Panics
    /// When the matrix is not square.
    ///
    /// ```
    /// use iwan_exchange::{Matrix, Stored};
    /// let entries = vec![(0, 0, 2.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0)];
    /// let matrix = Matrix { name: "K".into(), rows: 2, columns: 2, entries, stored: Stored::All, labels: None, complex: false };
    /// assert_eq!(matrix.lower_triangle(1e-9).unwrap(), [(0, 0, 2.0), (1, 0, -1.0), (1, 1, 2.0)]);
    /// ```
    pub fn lower_triangle(&self, tolerance: f64) -> Result<Vec<Entry>, Asymmetry> {
        assert_eq!(self.rows, self.columns, "a square matrix");
        let (mut lower, mut upper) = (Vec::with_capacity(self.entries.len()), Vec::new());
        for &(i, j, value) in &self.entries {
            match self.stored {
                Stored::Triangle => lower.push((i.max(j), i.min(j), value)),
                Stored::All if i >= j => lower.push((i, j, value)),
                Stored::All => upper.push((j, i, value)),
            }
        }
        merge(&mut lower);
        if self.stored == Stored::All {
            merge(&mut upper);
            lower = mean(self.rows, lower, &upper, tolerance)?;
        }
        Ok(lower)
    }
}

/// Sorts entries by column, then row, and adds up entries at the same place.
fn merge(entries: &mut Vec<Entry>) {
    let key = |e: &Entry| (e.1, e.0);
    if !entries.is_sorted_by_key(key) {
        entries.sort_by_key(key);
    }
    entries.dedup_by(|next, kept| {
        let same = key(next) == key(kept);
        if same {
            kept.2 += next.2;
        }
        same
    });
}

/// The mean of both triangles; `upper` is mirrored, so that its rows and columns are those of the lower triangle.
fn mean(n: usize, lower: Vec<Entry>, upper: &[Entry], tolerance: f64) -> Result<Vec<Entry>, Asymmetry> {
    let mut diagonal = vec![0.0; n];
    lower.iter().filter(|e| e.0 == e.1).for_each(|e| diagonal[e.0 as usize] = e.2);
    let mut worst: Option<(f64, Asymmetry)> = None;
    let mut note = |(i, j): (u32, u32), value: f64, mirrored: f64| {
        let (row, column) = (i as usize, j as usize);
        let geometric = (diagonal[row] * diagonal[column]).abs().sqrt();
        let size = if geometric > 0.0 { geometric } else { value.abs().max(mirrored.abs()) };
        let off = (value - mirrored).abs() / size;
        if off > tolerance && worst.is_none_or(|(known, _)| off > known) {
            worst = Some((off, Asymmetry { row, column, value, mirrored }));
        }
    };
    let (mut out, mut at) = (Vec::with_capacity(lower.len()), 0);
    let key = |e: &Entry| (e.1, e.0);
    for entry in lower {
        while at < upper.len() && key(&upper[at]) < key(&entry) {
            let (i, j, mirrored) = upper[at];
            note((i, j), 0.0, mirrored);
            out.push((i, j, 0.5 * mirrored));
            at += 1;
        }
        let (i, j, value) = entry;
        if i == j {
            out.push(entry);
            continue;
        }
        let mut mirrored = 0.0;
        if at < upper.len() && key(&upper[at]) == key(&entry) {
            mirrored = upper[at].2;
            at += 1;
        }
        note((i, j), value, mirrored);
        out.push((i, j, 0.5 * (value + mirrored)));
    }
    for &(i, j, mirrored) in &upper[at..] {
        note((i, j), 0.0, mirrored);
        out.push((i, j, 0.5 * mirrored));
    }
    worst.map_or(Ok(out), |(_, asymmetry)| Err(asymmetry))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests may panic")]
    use super::*;

    fn square(entries: Vec<Entry>, stored: Stored) -> Matrix {
        Matrix { name: String::new(), rows: 3, columns: 3, entries, stored, labels: None, complex: false }
    }

    #[test]
    fn triangles_of_any_order_are_one_matrix() {
        let expected = [(0, 0, 4.0), (2, 0, -1.0), (1, 1, 5.0), (2, 2, 6.0)];
        let lower =
            square(vec![(2, 2, 6.0), (2, 0, -1.0), (0, 0, 3.0), (1, 1, 5.0), (0, 0, 1.0)], Stored::Triangle);
        assert_eq!(lower.lower_triangle(0.0).unwrap(), expected);
        let upper = square(vec![(0, 2, -1.0), (0, 0, 4.0), (2, 2, 6.0), (1, 1, 5.0)], Stored::Triangle);
        assert_eq!(upper.lower_triangle(0.0).unwrap(), expected);
        let all =
            square(vec![(0, 2, -1.1), (0, 0, 4.0), (2, 0, -0.9), (2, 2, 6.0), (1, 1, 5.0)], Stored::All);
        assert_eq!(all.lower_triangle(0.1).unwrap(), expected);
    }

    #[test]
    fn the_largest_asymmetry_is_named() {
        let entries = vec![(0, 0, 4.0), (1, 1, 1.0), (2, 2, 1.0), (0, 1, 0.1), (1, 0, 0.2), (1, 2, 0.5)];
        let found = square(entries, Stored::All).lower_triangle(1e-3).unwrap_err();
        assert_eq!(found, Asymmetry { row: 2, column: 1, value: 0.0, mirrored: 0.5 });
        let only_lower = square(vec![(0, 0, 4.0), (1, 1, 1.0), (1, 0, 0.2)], Stored::All);
        assert_eq!(only_lower.lower_triangle(1e-3).unwrap_err().value, 0.2);
    }
}
