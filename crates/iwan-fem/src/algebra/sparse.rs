//! Symmetric sparse matrices, stored as their lower triangle, with sums of matrices.

use super::lanes::{LANES, total};

/// A symmetric matrix. The lower triangle is stored column by column with ascending rows; each column begins with its diagonal entry, which
/// is always stored.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetric {
    starts: Vec<u32>,
    rows: Vec<u32>,
    values: Vec<f64>,
}

impl Symmetric {
    /// A matrix with all values zero and the given pattern: for each column the rows on and below the diagonal, ascending.
    pub(crate) fn with_pattern(columns: impl Iterator<Item = Vec<u32>>) -> Self {
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for column in columns {
            rows.extend_from_slice(&column);
            starts.push(rows.len() as u32);
        }
        let values = vec![0.0; rows.len()];
        Self { starts, rows, values }
    }

    /// A diagonal matrix.
    #[must_use]
    pub fn diagonal(values: Vec<f64>) -> Self {
        let n = values.len() as u32;
        Self { starts: (0..=n).collect(), rows: (0..n).collect(), values }
    }

    /// From the entries at (column, row) with column <= row; entries that are not given are zero.
    pub(crate) fn from_entries(order: usize, entries: &std::collections::BTreeMap<(u32, u32), f64>) -> Self {
        let mut matrix = Self::with_pattern((0..order as u32).map(|j| {
            let below = entries.range((j, j + 1)..(j + 1, 0)).map(|(&(_, i), _)| i);
            std::iter::once(j).chain(below).collect()
        }));
        for (&(j, i), &value) in entries {
            matrix.add(i as usize, j as usize, value);
        }
        matrix
    }

    /// From entries (row, column, value) of the lower triangle, row >= column, in any order; entries at one place are added in the order
    /// given.
    ///
    /// # Panics
    /// When an entry lies above the diagonal or outside `order` rows.
    ///
    /// ```
    /// use iwan_fem::Symmetric;
    /// let k = Symmetric::from_lower(2, vec![(1, 0, -1.0), (0, 0, 2.0), (1, 1, 1.0), (1, 1, 1.0)]);
    /// assert_eq!(k.times(&[1.0, 2.0]), [0.0, 3.0]);
    /// ```
    #[must_use]
    pub fn from_lower(order: usize, mut entries: Vec<(u32, u32, f64)>) -> Self {
        let key = |e: &(u32, u32, f64)| (e.1, e.0);
        assert!(
            entries.iter().all(|e| e.1 <= e.0 && (e.0 as usize) < order),
            "entries of the lower triangle"
        );
        if !entries.is_sorted_by_key(key) {
            entries.sort_by_key(key);
        }
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::<f64>::new());
        let mut rest = entries.iter().peekable();
        for column in 0..order as u32 {
            rows.push(column);
            values.push(0.0);
            while let Some(&(row, _, value)) = rest.next_if(|e| e.1 == column) {
                if rows.last() == Some(&row) {
                    *values.last_mut().expect("as many values as rows") += value;
                } else {
                    rows.push(row);
                    values.push(value);
                }
            }
            starts.push(rows.len() as u32);
        }
        Self { starts, rows, values }
    }

    /// Entries (row, column, value) on and below the diagonal, column by column.
    pub fn lower(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..self.order()).flat_map(|j| {
            let (rows, values) = self.column(j);
            rows.iter().zip(values).map(move |(&i, &value)| (i as usize, j, value))
        })
    }

    /// Order n of the matrix.
    #[must_use]
    pub fn order(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of stored entries: those on and below the diagonal.
    #[must_use]
    pub fn stored(&self) -> usize {
        self.values.len()
    }

    /// Column starts, rows and values of the lower triangle.
    pub(crate) fn parts(&self) -> (&[u32], &[u32], &[f64]) {
        (&self.starts, &self.rows, &self.values)
    }

    /// Rows and values of column `j` of the lower triangle.
    pub(crate) fn column(&self, j: usize) -> (&[u32], &[f64]) {
        let range = self.starts[j] as usize..self.starts[j + 1] as usize;
        (&self.rows[range.clone()], &self.values[range])
    }

    /// Entry on the diagonal.
    #[must_use]
    pub fn diagonal_entry(&self, j: usize) -> f64 {
        self.values[self.starts[j] as usize]
    }

    /// Largest |entry|.
    pub(crate) fn largest(&self) -> f64 {
        largest(&self.values)
    }

    /// Adds `value` at (`i`, `j`) and, implicitly, at (`j`, `i`). The entry must be in the pattern.
    pub(crate) fn add(&mut self, i: usize, j: usize, value: f64) {
        let (row, column) = (i.max(j) as u32, i.min(j));
        let first = self.starts[column] as usize;
        let rows = &self.rows[first..self.starts[column + 1] as usize];
        let at = rows.binary_search(&row).expect("entries are assembled into the pattern made for them");
        self.values[first + at] += value;
    }

    /// This matrix plus `factor` times another matrix of the same order, on the union of the patterns.
    ///
    /// # Panics
    /// When the orders differ.
    #[must_use]
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        assert_eq!(self.order(), other.order(), "matrices of different order do not add");
        let room = self.stored().max(other.stored());
        let (mut starts, mut rows, mut values) =
            (vec![0], Vec::with_capacity(room), Vec::with_capacity(room));
        for j in 0..self.order() {
            let ((r, a), (s, b)) = (self.column(j), other.column(j));
            let (mut p, mut q) = (0, 0);
            while p < r.len() || q < s.len() {
                let (i, k) = (r.get(p).copied().unwrap_or(u32::MAX), s.get(q).copied().unwrap_or(u32::MAX));
                rows.push(i.min(k));
                let mut value = 0.0;
                if i <= k {
                    value += a[p];
                    p += 1;
                }
                if k <= i {
                    value += factor * b[q];
                    q += 1;
                }
                values.push(value);
            }
            starts.push(rows.len() as u32);
        }
        Self { starts, rows, values }
    }

    /// The matrix without entries that are exactly zero; diagonal entries stay.
    pub(crate) fn without_zeros(&self) -> Self {
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..self.order() {
            let (r, v) = self.column(j);
            let kept = r.iter().zip(v).filter(|&(&i, &x)| x != 0.0 || i as usize == j);
            for (&i, &x) in kept {
                rows.push(i);
                values.push(x);
            }
            starts.push(rows.len() as u32);
        }
        Self { starts, rows, values }
    }

    /// `y` = A `x`.
    ///
    /// # Panics
    /// When a length differs from the order.
    pub fn multiply(&self, x: &[f64], y: &mut [f64]) {
        assert!(x.len() == self.order() && y.len() == self.order(), "vectors have the matrix' order");
        y.fill(0.0);
        for (j, &xj) in x.iter().enumerate() {
            let (rows, values) = self.column(j);
            let mut sum = values[0] * xj;
            for (&i, &v) in rows[1..].iter().zip(&values[1..]) {
                let i = i as usize;
                y[i] += v * xj;
                sum += v * x[i];
            }
            y[j] += sum;
        }
    }

    /// A `x`.
    #[must_use]
    pub fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        self.multiply(x, &mut y);
        y
    }

    /// Bilinear form `x`ᵀ A `y`.
    #[must_use]
    pub fn form(&self, x: &[f64], y: &[f64]) -> f64 {
        dot(x, &self.times(y))
    }
}

impl Symmetric {
    /// `x`ᵀ A `x` in twice the working precision, because its terms cancel where stiffness is large and strain small.
    ///
    /// T. Ogita, S. M. Rump and S. Oishi, SIAM J. Sci. Comput. 26:1955, 2005, doi:10.1137/030601818.
    pub(crate) fn square(&self, x: &[f64]) -> f64 {
        let (mut sum, mut rest) = (0.0_f64, 0.0);
        for (j, &xj) in x.iter().enumerate() {
            let (rows, values) = self.column(j);
            for (k, (&i, &value)) in rows.iter().zip(values).enumerate() {
                let xi = x[i as usize];
                // An entry off the diagonal counts twice.
                let weight = if k == 0 { value } else { 2.0 * value };
                let product = xi * xj;
                let lost = xi.mul_add(xj, -product);
                let term = product * weight;
                let total = sum + term;
                let carried = total - sum;
                rest += (sum - (total - carried)) + (term - carried);
                rest += product.mul_add(weight, -term) + lost * weight;
                sum = total;
            }
        }
        sum + rest
    }
}

/// Inner product, in as many partial sums as a group has lanes, so that the compiler uses vector registers and the order of summation is
/// fixed.
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    assert_eq!(x.len(), y.len(), "vectors of one length");
    let (a, b) = (x.chunks_exact(LANES), y.chunks_exact(LANES));
    let tail: f64 = a.remainder().iter().zip(b.remainder()).map(|(x, y)| x * y).sum();
    let mut sums = [0.0; LANES];
    for (a, b) in a.zip(b) {
        (0..LANES).for_each(|lane| sums[lane] += a[lane] * b[lane]);
    }
    tail + total(&sums)
}

/// `x` *= `factor`.
pub(crate) fn scale(x: &mut [f64], factor: f64) {
    for x in x {
        *x *= factor;
    }
}

/// Largest |x|; NaN if one of the values is NaN.
pub(crate) fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |m, x| if x.is_nan() || x.abs() > m { x.abs() } else { m })
}

/// `y` += `factor` `x`.
pub(crate) fn add_scaled(y: &mut [f64], factor: f64, x: &[f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += factor * x);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_products_agree_with_dense_ones() {
        let mut a = Symmetric::with_pattern([vec![0, 2], vec![1], vec![2]].into_iter());
        a.add(0, 0, 2.0);
        a.add(0, 2, -1.0);
        a.add(2, 2, 3.0);
        let b = Symmetric::diagonal(vec![1.0, 4.0, 0.0]);
        let sum = a.plus(0.5, &b);
        assert_eq!(sum.times(&[1.0, 2.0, 3.0]), [2.5 - 3.0, 4.0, -1.0 + 9.0]);
        assert_eq!(sum.form(&[0.0, 0.0, 1.0], &[1.0, 0.0, 0.0]), -1.0);
        assert_eq!(a.without_zeros(), a);
    }
}
