//! Lowest eigenpairs of K φ = λ M φ: block Lanczos on (K + σM)⁻¹ M, with a Sturm count that proves that none is missing.
//!
//! R. G. Grimes, J. G. Lewis and H. D. Simon, SIAM J. Matrix Anal. Appl. 15:228, 1994, doi:10.1137/S0895479888151111; here with full
//! reorthogonalisation and without restarts. K may be singular (free structures): the shift σ > 0 makes K + σM positive definite. Blocks
//! find repeated eigenvalues. The number of negative pivots of K - μM is the number of all eigenvalues below μ; as long as it exceeds the
//! number found, new random columns join the search. M times the basis is stored beside the basis, so that a new column takes one product
//! with M.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef};

use super::dense::{product, symmetric_eigen};
use super::factor::{Analysis, Cholesky, negative_eigenvalues};
use super::lanes::LANES;
use super::random::random;
use super::sparse::{Symmetric, add_scaled, dot, largest, scale};
use super::workers::Workers;
use crate::error::{Error, singular_mass};
use iwan_core::Progress;

/// Number of columns per block, as many as one group of a solve holds. Of an eigenvalue that is repeated more often, the first block finds
/// no more than this many; the Sturm count reveals that, and random columns join the search.
const BLOCK: usize = LANES;
/// Residual of (K + σM)⁻¹M φ - θ φ relative to θ at which a pair counts as converged; the relative error of its eigenvalue is about the
/// square. Of 20 modes of the paper's beam the last then satisfies K φ = ω² M φ to 3e-6. With 1e-5 a fifth fewer columns leave 3e-3, with
/// 1e-11 a fifth more leave 5e-9.
const CONVERGED: f64 = 1e-8;
/// Relative distance of neighbouring eigenvalues above which a shift between them separates them; otherwise the shift is placed beyond the
/// next eigenvalue. The value is far above the errors of eigenvalues and far below the distance of modes that are not repeated; 1e-10 to
/// 1e-3 lead to the same searches.
const GAP: f64 = 1e-6;
/// Remaining part of a column's length, after the basis is removed from it, up to which the column counts as dependent on the basis; a
/// random column replaces it. The part left out is missing in the residuals of all pairs, and columns of rigid motions are longer than
/// those of high modes by many decades, so the limit lies at rounding. Beams and cubes do not come near it: at least 2e-4 of their columns
/// remains.
const DEPENDENT: f64 = 1e-15;
/// Remaining part of a column's length below which the column is made orthogonal to the basis once more, because its rounding errors have
/// grown in proportion. If less than half remains then, it was rounding, and a random column replaces it. No column of beams and cubes is
/// so weak, but with a hundredth of the shift eight are.
const WEAK: f64 = 1e-4;
/// Remaining part of a column's length below which its product with M is computed anew, because three digits were lost in the difference of
/// longer products.
const CANCELLED: f64 = 1e-3;
/// Largest number of passes over the whole basis. One was enough in all beams and cubes that were tried; a fourth would remove rounding
/// alone.
const PASSES: usize = 3;
/// Part of a column's length up to which a pass counts as having removed rounding only, so that no further pass is made. The first pass
/// removes 1e-12 to 1e-10; a limit below 1e-15 would force all passes, and a search for 400 modes would take more than twice the time.
const ORTHOGONAL: f64 = 1e-6;
/// Operations for all eigenpairs of a dense symmetric matrix, over the cube of its order. With it the cost of solving the projected problem
/// is compared with that of more columns. It affects only the time: from 0 to 300 a search for 400 modes of the paper's beam takes 848 to
/// 912 columns.
const DENSE: f64 = 30.0;
/// Part of the expected number of missing columns that is added before the projected problem is solved again, because pairs converge faster
/// towards the end. It affects only the time: at 0.4 and at 1.2 searches take up to a sixth fewer or more columns, without a trend.
const MOST_OF: f64 = 0.8;
/// Part of a vector's largest component above which components count as large. The last large component determines the vector's sign.
/// Components that are equal by symmetry differ by rounding and are all large, so rounding does not affect the choice.
const LARGE: f64 = 0.9;
/// Number of columns per mode that the search usually takes, for the progress report: 4.4 for 20 modes of the paper's beam, 2.3 for 400. If
/// a search needs more, the reported progress stays at its end.
const USUAL: f64 = 4.5;

/// The eigenvalue problem, its shift, and the analysis of the factor's pattern.
pub(crate) struct Problem<'a> {
    pub(crate) stiffness: &'a Symmetric,
    pub(crate) mass: &'a Symmetric,
    pub(crate) shift: f64,
    pub(crate) analysis: &'a Analysis,
}

/// Eigenvalues in ascending order, and M-orthonormal eigenvectors, one after another.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pairs {
    pub(crate) values: Vec<f64>,
    pub(crate) vectors: Vec<f64>,
}

impl Problem<'_> {
    /// The Cholesky factor of K + σM.
    pub(crate) fn factor(&self) -> Result<Cholesky, Error> {
        Cholesky::new(self.analysis, &self.stiffness.plus(self.shift, self.mass))
    }

    /// The lowest `count` pairs, with none missing.
    pub(crate) fn lowest(
        &self,
        count: usize,
        factor: &Cholesky,
        progress: Progress<'_>,
    ) -> Result<Pairs, Error> {
        let n = self.mass.order();
        if count == 0 || count > n {
            let finding = format!("{count} modes were asked for, the structure has {n} unknowns");
            return Err(Error::Analysis {
                analysis: "modes",
                finding,
                remedy: "ask for at least 1 and at most as many as there are unknowns",
            });
        }
        let mut search = Search::new(self.mass, factor)?;
        let (mut check_at, mut looked) = (count + BLOCK.min(count), (0, 0));
        loop {
            let usual = (USUAL * count as f64).min(n as f64);
            if progress((search.columns as f64 / usual).min(1.0)).is_break() {
                return Err(Error::Interrupted);
            }
            search.expand();
            let complete = search.columns == n;
            if search.columns < check_at && !complete {
                continue;
            }
            let ritz = search.ritz()?;
            let here = (search.columns, ritz.converged());
            check_at = search.columns + search.until_next_look(looked, here, count + 1);
            looked = here;
            let Some((found, above)) = self.bound(&ritz, count, complete) else { continue };
            let Some(above) = above else { return Ok(self.pairs(&search, &ritz, count)) };
            let there = self.count_below(above)?;
            if there <= found {
                return Ok(self.pairs(&search, &ritz, count));
            }
            search.widen(there - found);
            check_at = search.columns + BLOCK;
        }
    }

    /// The number of leading pairs that have converged up to a gap, and a shift in that gap; no shift if the basis is complete.
    fn bound(&self, ritz: &Ritz, count: usize, complete: bool) -> Option<(usize, Option<f64>)> {
        let value = |i: usize| 1.0 / ritz.values[i] - self.shift;
        if complete {
            return Some((count, None));
        }
        (count..ritz.converged())
            .find(|&i| value(i) - value(i - 1) > GAP * (value(i).abs() + self.shift))
            .map(|i| (i, Some(0.5 * (value(i) + value(i - 1)))))
    }

    /// Number of eigenvalues below `above`, by a Sturm count. If the shift coincides with an eigenvalue of a leading part of the matrix, it
    /// is moved slightly.
    fn count_below(&self, above: f64) -> Result<usize, Error> {
        let mut last = None;
        // The movement is a hundredth of the smallest gap ([`GAP`]) in which the shift lies, so no eigenvalue of the whole matrix comes
        // near it.
        for nudge in [0.0, 1e-8, -1e-8] {
            let shifted = self.stiffness.plus(-(above + nudge * (above.abs() + self.shift)), self.mass);
            match negative_eigenvalues(self.analysis, &shifted) {
                Ok(number) => return Ok(number),
                Err(error) => last = Some(error),
            }
        }
        Err(last.expect("three attempts were made"))
    }

    /// The first `count` pairs. Each vector gets the sign that makes the last of its large components positive, so that rounding does not
    /// change the sign.
    fn pairs(&self, search: &Search<'_>, ritz: &Ritz, count: usize) -> Pairs {
        let values = ritz.values[..count].iter().map(|theta| 1.0 / theta - self.shift).collect();
        let mut vectors = search.combine(&ritz.combinations, count);
        for vector in vectors.chunks_exact_mut(search.n) {
            let large = LARGE * largest(vector);
            if vector.iter().rfind(|x| x.abs() >= large).is_some_and(|x| *x < 0.0) {
                scale(vector, -1.0);
            }
        }
        Pairs { values, vectors }
    }
}

/// Ritz values θ in descending order, the combinations of the basis, and relative residuals.
struct Ritz {
    values: Vec<f64>,
    combinations: Mat<f64>,
    residuals: Vec<f64>,
}

impl Ritz {
    /// Number of leading pairs that have converged.
    fn converged(&self) -> usize {
        self.residuals.iter().take_while(|r| **r <= CONVERGED).count()
    }
}

/// The basis, and the projection of the operator on it.
struct Search<'a> {
    mass: &'a Symmetric,
    factor: &'a Cholesky,
    workers: Workers,
    n: usize,
    /// M-orthonormal columns V, one after another; the projection is known for the first `columns` of them.
    basis: Vec<f64>,
    /// M V.
    weighted: Vec<f64>,
    columns: usize,
    /// First column of the block that was expanded last.
    previous: usize,
    /// Projection H = Vᵀ M (K + σM)⁻¹ M V, column by column: entries from the top to at least the diagonal.
    projection: Vec<Vec<f64>>,
    /// Coefficients of the last block's residual on the pending columns (pending x last block).
    pending: Mat<f64>,
    seed: u64,
}

impl<'a> Search<'a> {
    fn new(mass: &'a Symmetric, factor: &'a Cholesky) -> Result<Self, Error> {
        let mut search = Self {
            mass,
            factor,
            workers: Workers::for_entries(factor.entries())?,
            n: mass.order(),
            basis: Vec::new(),
            weighted: Vec::new(),
            columns: 0,
            previous: 0,
            projection: Vec::new(),
            pending: Mat::zeros(0, 0),
            seed: 0,
        };
        search.widen(BLOCK);
        Ok(search)
    }

    /// Number of columns of the basis, including those not yet expanded.
    fn held(&self) -> usize {
        self.basis.len() / self.n
    }

    /// Number of columns to add before the projected eigenproblem is solved again. It is most of the number that is missing for the
    /// `wanted` pairs, at the rate at which pairs converged between the last two solutions (columns, pairs), but not so few that the
    /// solutions cost more than the search.
    fn until_next_look(&self, last: (usize, usize), here: (usize, usize), wanted: usize) -> usize {
        let k = here.0 as f64;
        let a_column = 4.0 * self.factor.entries() as f64 + 8.0 * self.n as f64 * k;
        let worth = (DENSE * k.powi(3) / a_column).min(0.2 * k);
        let rate = here.1.saturating_sub(last.1) as f64 / (here.0 - last.0).max(1) as f64;
        let missing = wanted.saturating_sub(here.1) as f64;
        let expected = if rate > 0.0 { MOST_OF * missing / rate } else { 0.5 * k };
        (worth.max(expected).min(0.5 * k) as usize).max(BLOCK)
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

    /// Appends random columns that are orthonormal to the basis.
    fn widen(&mut self, columns: usize) {
        for _ in 0..columns.min(self.n - self.held()) {
            self.push_random();
        }
        let (rows, width) = (self.held() - self.columns, self.pending.ncols());
        let old = std::mem::replace(&mut self.pending, Mat::zeros(rows, width));
        self.pending.as_mut().submatrix_mut(0, 0, old.nrows(), width).copy_from(&old);
    }

    fn push_random(&mut self) {
        self.seed += 1;
        let mut column = random(self.n, self.seed);
        let mut weighted = Vec::new();
        for _ in 0..3 {
            self.remove(0, &mut column);
            weighted = self.mass.times(&column);
            let length = dot(&column, &weighted).sqrt();
            scale(&mut column, 1.0 / length);
            scale(&mut weighted, 1.0 / length);
        }
        self.basis.extend(column);
        self.weighted.extend(weighted);
    }

    /// Subtracts from the columns their part in the basis, from its column `first` on; returns the coefficients with respect to the whole
    /// basis.
    fn remove(&self, first: usize, columns: &mut [f64]) -> Mat<f64> {
        let width = columns.len() / self.n;
        let mut coefficients = Mat::zeros(self.held(), width);
        let (basis, weighted) =
            (self.view(&self.basis[first * self.n..]), self.view(&self.weighted[first * self.n..]));
        let mut part = coefficients.as_mut().subrows_mut(first, basis.ncols());
        self.workers.run(|par| {
            let target = MatMut::from_column_major_slice_mut(columns, self.n, width);
            matmul(&mut part, Accum::Replace, weighted.transpose(), target.as_ref(), 1.0, par);
            matmul(target, Accum::Add, basis, &part, -1.0, par);
        });
        coefficients
    }

    /// Subtracts the basis from the result of the operator on the pending columns; returns the coefficients.
    ///
    /// Except for rounding, the result lies in the last two blocks. So these are subtracted first, and one pass over the whole basis
    /// removes the rest.
    fn remove_basis(&self, columns: &mut [f64]) -> Mat<f64> {
        let mut coefficients = self.remove(self.previous, columns);
        for _ in 0..PASSES {
            let more = self.remove(0, columns);
            coefficients += &more;
            if more.squared_norm_l2() <= ORTHOGONAL.powi(2) * coefficients.squared_norm_l2() {
                break;
            }
        }
        coefficients
    }

    /// Applies the operator to the pending columns, extends the projection, and appends the new directions as pending columns.
    fn expand(&mut self) {
        let (from, to) = (self.columns, self.held());
        let mut next = self.weighted[from * self.n..to * self.n].to_vec();
        let width = to - from;
        self.factor.solve_columns(&mut next, &self.workers);
        let coefficients = self.remove_basis(&mut next);
        for k in 0..width {
            self.projection.push((0..=from + k).map(|i| coefficients[(i, k)]).collect());
        }
        (self.previous, self.columns) = (from, to);
        let removed: Vec<f64> = (0..width).map(|k| coefficients.col(k).squared_norm_l2()).collect();
        let remainder = next.clone();
        self.append(next, &removed);
        // Coefficients of the remainder in the new columns; the residual of every Ritz pair follows from them.
        let added = self.view(&self.weighted[to * self.n..]);
        let mut pending = Mat::zeros(added.ncols(), width);
        let remainder = self.view(&remainder);
        self.workers.run(|par| {
            matmul(&mut pending, Accum::Replace, added.transpose(), remainder, 1.0, par);
        });
        self.pending = pending;
    }

    /// Orthonormalises columns among themselves and appends them; the basis, with a part of the squared length `removed`, was subtracted
    /// from them before. Columns that depend on the basis are replaced by random ones.
    fn append(&mut self, mut columns: Vec<f64>, removed: &[f64]) {
        let first = self.held() * self.n;
        let mut weighted = self.mass_times(&columns);
        let pairs = columns.chunks_exact_mut(self.n).zip(weighted.chunks_exact_mut(self.n));
        for ((column, weighted), removed) in pairs.zip(removed) {
            if self.held() == self.n {
                return;
            }
            let square = dot(column, weighted).max(0.0);
            for _ in 0..2 {
                let new =
                    self.basis[first..].chunks_exact(self.n).zip(self.weighted[first..].chunks_exact(self.n));
                for (v, w) in new {
                    let part = dot(w, column);
                    add_scaled(column, -part, v);
                    add_scaled(weighted, -part, w);
                }
            }
            let mut rest = dot(column, weighted).max(0.0).sqrt();
            if rest < CANCELLED * square.sqrt() {
                self.mass.multiply(column, weighted);
                rest = dot(column, weighted).max(0.0).sqrt();
            }
            let length = (removed + square).sqrt();
            if rest > DEPENDENT * length {
                scale(column, 1.0 / rest);
                scale(weighted, 1.0 / rest);
                if rest < WEAK * length {
                    self.remove(0, column);
                    self.mass.multiply(column, weighted);
                    rest = dot(column, weighted).max(0.0).sqrt();
                    if rest < 0.5 {
                        self.push_random();
                        continue;
                    }
                    scale(column, 1.0 / rest);
                    scale(weighted, 1.0 / rest);
                }
                self.basis.extend_from_slice(column);
                self.weighted.extend_from_slice(weighted);
            } else {
                self.push_random();
            }
        }
    }

    fn ritz(&self) -> Result<Ritz, Error> {
        let k = self.columns;
        let projection = Mat::from_fn(k, k, |i, j| {
            let (low, high) = (i.min(j), i.max(j));
            self.projection[high][low]
        });
        let finite = symmetric_eigen(&projection).filter(|e| e.values.iter().all(|v| v.is_finite()));
        let eigen = finite.ok_or_else(singular_mass)?;
        let values: Vec<f64> = eigen.values.iter().rev().copied().collect();
        let combinations = Mat::from_fn(k, k, |i, j| eigen.vectors[(i, k - 1 - j)]);
        let last = self.pending.ncols();
        let tail = product(self.pending.as_ref(), combinations.submatrix(k - last, 0, last, k));
        let residuals = (0..k).map(|j| tail.col(j).norm_l2() / values[j].abs()).collect();
        Ok(Ritz { values, combinations, residuals })
    }

    /// The vectors of the first `count` combinations of the basis.
    fn combine(&self, combinations: &Mat<f64>, count: usize) -> Vec<f64> {
        let mut vectors = vec![0.0; self.n * count];
        let basis = self.view(&self.basis[..self.columns * self.n]);
        self.workers.run(|par| {
            let target = MatMut::from_column_major_slice_mut(&mut vectors, self.n, count);
            matmul(target, Accum::Replace, basis, combinations.subcols(0, count), 1.0, par);
        });
        vectors
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::algebra::Site;

    /// An eigenvalue that occurs twelve times: a block of eight first finds eight, and the Sturm count reveals the others.
    #[test]
    fn eigenvalues_repeated_more_often_than_a_block_is_wide() {
        let n = 400;
        let expected: Vec<f64> =
            (0..n).map(|i| if i < 3 { i as f64 } else { (i.max(14) - 11) as f64 }).collect();
        let (stiffness, mass) = (Symmetric::diagonal(expected.clone()), Symmetric::diagonal(vec![1.0; n]));
        let site = |node: usize| Site { position: [node as f64, 0.0, 0.0], group: node as u32 };
        let sites: Vec<Site> = (0..n).map(site).collect();
        let analysis = Analysis::new(&stiffness, &sites).unwrap();
        let problem = Problem { stiffness: &stiffness, mass: &mass, shift: 0.5, analysis: &analysis };
        let factor = problem.factor().unwrap();
        for count in [5, 15, 20, 60] {
            let pairs = problem.lowest(count, &factor, iwan_core::progress::UNWATCHED).unwrap();
            for (value, expected) in pairs.values.iter().zip(&expected) {
                assert!((value - expected).abs() < 1e-10 * (1.0 + expected), "{count}: {value} {expected}");
            }
        }
    }
}
