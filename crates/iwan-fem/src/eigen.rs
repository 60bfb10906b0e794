//! Lowest eigenpairs of K φ = λ M φ: block Lanczos on (K + σM)⁻¹ M, guarded by a Sturm count.
//!
//! R. G. Grimes, J. G. Lewis and H. D. Simon, SIAM J. Matrix Anal. Appl. 15:228, 1994, doi:10.1137/S0895479888151111;
//! here with full reorthogonalisation and without restarts. K may be singular (free structures): the shift σ > 0 makes
//! K + σM positive definite. Blocks find repeated eigenvalues; the number of negative pivots of K - μM counts all
//! eigenvalues below μ, and as long as it exceeds the number found, new random directions join the search.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par, Side};

use crate::error::Error;
use crate::factor::{Analysis, Cholesky, negative_eigenvalues, random};
use crate::sparse::{Symmetric, add_scaled, dot, scale};

/// Columns per block.
const BLOCK: usize = 8;
/// Residual of (K + σM)⁻¹M φ - θ φ relative to θ at which a pair counts as converged; eigenvalues are better by its square.
const CONVERGED: f64 = 1e-10;
/// Neighbouring eigenvalues further apart than this, relatively, can be told apart by a shift between them.
const GAP: f64 = 1e-6;
/// Part of a column's length that may remain before it counts as dependent on the basis.
const DEPENDENT: f64 = 1e-10;

/// The pencil, what is wanted of it, and how.
pub(crate) struct Problem<'a> {
    pub(crate) stiffness: &'a Symmetric,
    pub(crate) mass: &'a Symmetric,
    pub(crate) shift: f64,
    pub(crate) analysis: &'a Analysis,
}

/// Eigenvalues ascending and M-orthonormal eigenvectors, one after the other.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pairs {
    pub(crate) values: Vec<f64>,
    pub(crate) vectors: Vec<f64>,
}

impl Problem<'_> {
    /// K + σM, factored.
    pub(crate) fn factor(&self) -> Result<Cholesky, Error> {
        Cholesky::new(self.analysis, &self.stiffness.plus(self.shift, self.mass))
    }

    /// The lowest `count` pairs, none missed.
    pub(crate) fn lowest(&self, count: usize, factor: &Cholesky) -> Result<Pairs, Error> {
        let n = self.mass.order();
        if count == 0 || count > n {
            let finding = format!("{count} modes were asked for, the structure has {n} unknowns");
            return Err(Error::Analysis {
                analysis: "modes",
                finding,
                remedy: "ask for at least 1 and at most as many as there are unknowns",
            });
        }
        let mut search = Search::new(self.mass, factor);
        let mut check_at = count + BLOCK.min(count);
        loop {
            search.expand();
            let complete = search.columns == n;
            if search.columns < check_at && !complete {
                continue;
            }
            // The projection's eigenproblem grows with the cube of its size: a fifth more columns before the next look.
            check_at = search.columns + (2 * BLOCK).max(search.columns / 5);
            let ritz = search.ritz();
            let Some((found, above)) = self.bound(&ritz, count, complete) else { continue };
            let Some(above) = above else { return Ok(search.pairs(&ritz, count, self.shift)) };
            let there = self.count_below(above)?;
            if there <= found {
                return Ok(search.pairs(&ritz, count, self.shift));
            }
            search.widen(there - found);
            check_at = search.columns + BLOCK;
        }
    }

    /// How many leading pairs have converged up to a gap, and a shift in that gap; no shift when the basis is complete.
    fn bound(&self, ritz: &Ritz, count: usize, complete: bool) -> Option<(usize, Option<f64>)> {
        let converged = ritz.residuals.iter().take_while(|r| **r <= CONVERGED).count();
        let value = |i: usize| 1.0 / ritz.values[i] - self.shift;
        if complete {
            return Some((count, None));
        }
        (count..converged)
            .find(|&i| value(i) - value(i - 1) > GAP * (value(i).abs() + self.shift))
            .map(|i| (i, Some(0.5 * (value(i) + value(i - 1)))))
    }

    /// Sturm count; a shift that meets an eigenvalue of a leading part is moved a little.
    fn count_below(&self, above: f64) -> Result<usize, Error> {
        let mut last = None;
        for nudge in [0.0, 1e-8, -1e-8] {
            let shifted = self.stiffness.plus(-(above + nudge * (above.abs() + self.shift)), self.mass);
            match negative_eigenvalues(self.analysis, &shifted) {
                Ok(number) => return Ok(number),
                Err(error) => last = Some(error),
            }
        }
        Err(last.expect("three attempts were made"))
    }
}

/// Ritz values θ descending, the combinations of the basis, relative residuals.
struct Ritz {
    values: Vec<f64>,
    combinations: Mat<f64>,
    residuals: Vec<f64>,
}

/// The basis and the projection of the operator on it.
struct Search<'a> {
    mass: &'a Symmetric,
    factor: &'a Cholesky,
    n: usize,
    /// M-orthonormal columns one after the other; the projection is known on the first `columns` of them.
    basis: Vec<f64>,
    columns: usize,
    /// Projection H = Vᵀ M (K + σM)⁻¹ M V, column by column: entries from the top to at least the diagonal.
    projection: Vec<Vec<f64>>,
    /// Coefficients of the last block's residual on the pending columns (pending x last block).
    pending: Mat<f64>,
    seed: u64,
}

impl<'a> Search<'a> {
    fn new(mass: &'a Symmetric, factor: &'a Cholesky) -> Self {
        let n = mass.order();
        let mut search = Self {
            mass,
            factor,
            n,
            basis: Vec::new(),
            columns: 0,
            projection: Vec::new(),
            pending: Mat::zeros(0, 0),
            seed: 0,
        };
        search.widen(BLOCK);
        search
    }

    /// Columns of the basis, those not yet expanded included.
    fn held(&self) -> usize {
        self.basis.len() / self.n
    }

    fn view<'b>(&self, columns: &'b [f64]) -> MatRef<'b, f64> {
        MatRef::from_column_major_slice(columns, self.n, columns.len() / self.n)
    }

    fn mass_times(&self, columns: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; columns.len()];
        for (x, y) in columns.chunks_exact(self.n).zip(out.chunks_exact_mut(self.n)) {
            self.mass.multiply(x, y);
        }
        out
    }

    /// Appends random columns, orthonormal to the basis.
    fn widen(&mut self, columns: usize) {
        for _ in 0..columns.min(self.n - self.held()) {
            let column = self.random_column();
            self.basis.extend(column);
        }
        let (rows, width) = (self.held() - self.columns, self.pending.ncols());
        let old = std::mem::replace(&mut self.pending, Mat::zeros(rows, width));
        self.pending.as_mut().submatrix_mut(0, 0, old.nrows(), width).copy_from(&old);
    }

    fn random_column(&mut self) -> Vec<f64> {
        self.seed += 1;
        let mut column = random(self.n, self.seed);
        for _ in 0..3 {
            self.remove_basis(&mut column);
            let length = self.mass.form(&column, &column).sqrt();
            scale(&mut column, 1.0 / length);
        }
        column
    }

    /// Takes the basis' part off the columns; returns the coefficients.
    fn remove_basis(&self, columns: &mut [f64]) -> Mat<f64> {
        let weighted = self.mass_times(columns);
        let width = columns.len() / self.n;
        let mut coefficients = Mat::zeros(self.held(), width);
        let basis = self.view(&self.basis);
        matmul(&mut coefficients, Accum::Replace, basis.transpose(), self.view(&weighted), 1.0, Par::Seq);
        let target = MatMut::from_column_major_slice_mut(columns, self.n, width);
        matmul(target, Accum::Add, basis, &coefficients, -1.0, Par::Seq);
        coefficients
    }

    /// Applies the operator to the pending columns, extends the projection and appends what is new as pending columns.
    fn expand(&mut self) {
        let (from, to) = (self.columns, self.held());
        let mut next = self.mass_times(&self.basis[from * self.n..to * self.n]);
        let width = to - from;
        self.factor.solve_columns(MatMut::from_column_major_slice_mut(&mut next, self.n, width));
        let lengths: Vec<f64> = self.lengths(&next);
        let mut coefficients = self.remove_basis(&mut next);
        coefficients += self.remove_basis(&mut next);
        for k in 0..width {
            self.projection.push((0..=from + k).map(|i| coefficients[(i, k)]).collect());
        }
        self.columns = to;
        let before = self.held();
        let remainder = next.clone();
        self.append(next, &lengths);
        // Coefficients of the remainder on the new columns: the residual of every Ritz pair follows from them.
        let mut pending = Mat::zeros(self.held() - before, width);
        let added = self.mass_times(&self.basis[before * self.n..]);
        matmul(
            &mut pending,
            Accum::Replace,
            self.view(&added).transpose(),
            self.view(&remainder),
            1.0,
            Par::Seq,
        );
        self.pending = pending;
    }

    fn lengths(&self, columns: &[f64]) -> Vec<f64> {
        columns.chunks_exact(self.n).map(|x| self.mass.form(x, x).max(0.0).sqrt()).collect()
    }

    /// Orthonormalises columns among themselves and against the basis and appends them; those that depend on what is
    /// there give way to random ones.
    fn append(&mut self, mut columns: Vec<f64>, lengths: &[f64]) {
        let first = self.held();
        for (column, length) in columns.chunks_exact_mut(self.n).zip(lengths) {
            if self.held() == self.n {
                return;
            }
            for _ in 0..2 {
                let weighted = self.mass.times(column);
                let own: Vec<f64> =
                    self.basis[first * self.n..].chunks_exact(self.n).map(|v| dot(v, &weighted)).collect();
                for (v, c) in self.basis[first * self.n..].chunks_exact(self.n).zip(&own) {
                    add_scaled(column, -c, v);
                }
            }
            let rest = self.mass.form(column, column).max(0.0).sqrt();
            if rest > DEPENDENT * length {
                scale(column, 1.0 / rest);
                self.basis.extend_from_slice(column);
            } else {
                let fresh = self.random_column();
                self.basis.extend(fresh);
            }
        }
    }

    fn ritz(&self) -> Ritz {
        let k = self.columns;
        let projection = Mat::from_fn(k, k, |i, j| {
            let (low, high) = (i.min(j), i.max(j));
            self.projection[high][low]
        });
        let eigen =
            projection.self_adjoint_eigen(Side::Lower).expect("a finite symmetric matrix has eigenvalues");
        let values: Vec<f64> = (0..k).rev().map(|i| eigen.S()[i]).collect();
        let combinations = Mat::from_fn(k, k, |i, j| eigen.U()[(i, k - 1 - j)]);
        let last = self.pending.ncols();
        let tail = &self.pending * combinations.submatrix(k - last, 0, last, k);
        let residuals = (0..k).map(|j| tail.col(j).norm_l2() / values[j].abs()).collect();
        Ritz { values, combinations, residuals }
    }

    fn pairs(&self, ritz: &Ritz, count: usize, shift: f64) -> Pairs {
        let mut vectors = vec![0.0; self.n * count];
        let target = MatMut::from_column_major_slice_mut(&mut vectors, self.n, count);
        let chosen = ritz.combinations.subcols(0, count);
        matmul(
            target,
            Accum::Replace,
            self.view(&self.basis[..self.columns * self.n]),
            chosen,
            1.0,
            Par::Seq,
        );
        Pairs { values: ritz.values[..count].iter().map(|theta| 1.0 / theta - shift).collect(), vectors }
    }
}
