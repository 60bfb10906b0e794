//! Lowest eigenpairs of K φ = λ M φ: block Lanczos on (K + σM)⁻¹ M, guarded by a Sturm count.
//!
//! R. G. Grimes, J. G. Lewis and H. D. Simon, SIAM J. Matrix Anal. Appl. 15:228, 1994, doi:10.1137/S0895479888151111;
//! here with full reorthogonalisation and without restarts. K may be singular (free structures): the shift σ > 0 makes
//! K + σM positive definite. Blocks find repeated eigenvalues; the number of negative pivots of K - μM counts all
//! eigenvalues below μ, and as long as it exceeds the number found, new random directions join the search. M times the
//! basis is kept beside the basis: a column costs one product with M.

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

/// Columns per block: a solve takes a group of them. Of an eigenvalue that is repeated more often the first block finds no more than
/// this many; the Sturm count sees that and random columns join the search.
const BLOCK: usize = LANES;
/// Residual of (K + σM)⁻¹M φ - θ φ relative to θ at which a pair counts as converged; eigenvalues are better by its square. Of 20 modes of
/// the paper's beam the last then solves K φ = ω² M φ to 3e-6; at 1e-5 a fifth fewer columns leave 3e-3, at 1e-11 a fifth more leave 5e-9.
const CONVERGED: f64 = 1e-8;
/// Neighbouring eigenvalues further apart than this, relatively, can be told apart by a shift between them: far above their errors, far
/// below the distance of modes that are not repeated (1e-10 to 1e-3 lead to the same searches). Else the shift goes behind the next.
const GAP: f64 = 1e-6;
/// A column of which no more than this part remains depends on the basis but for rounding, and a random one takes its place. What is
/// left out here is missing in the residuals of all pairs, and the columns of rigid motions are longer than those of high modes by many
/// decades: the limit stands at rounding. Beams and cubes do not come near it; at least 2e-4 remains of their columns.
const DEPENDENT: f64 = 1e-15;
/// A column of which no more than this part remains is made orthogonal to the basis once more, as what rounding left has grown with it;
/// when less than half is left then, it was rounding. In beams and cubes no column is so weak, but with a hundredth of the shift eight are.
const WEAK: f64 = 1e-4;
/// Part of a column's length below which M times what remains is computed anew: the difference of longer products has lost three digits.
const CANCELLED: f64 = 1e-3;
/// Most passes over the whole basis. One was enough in all beams and cubes that were tried; a fourth would take off rounding alone.
const PASSES: usize = 3;
/// A pass that takes no more than this part off a column's length leaves it orthogonal to rounding. The first one takes 1e-12 to 1e-10; a
/// limit below 1e-15 would force all passes, and a search for 400 modes would take more than twice the time.
const ORTHOGONAL: f64 = 1e-6;
/// Operations for all eigenpairs of a dense symmetric matrix, over the cube of its order, by which another look is weighed against more
/// columns. Only the time depends on it: from 0 to 300 a search for 400 modes of the paper's beam takes 848 to 912 columns.
const DENSE: f64 = 30.0;
/// Part of the columns expected that are added before the next look, as pairs converge faster towards the end. Only the time depends on
/// it: at 0.4 and at 1.2 searches take up to a sixth fewer columns or up to a sixth more, in no order.
const MOST_OF: f64 = 0.8;
/// Part of a vector's largest component from which on one decides on its sign. Components that are equal by symmetry differ by rounding
/// and all pass, and the last of them decides: rounding does not.
const LARGE: f64 = 0.9;
/// Columns that the search usually takes, per mode, by which its progress is measured: 4.4 for 20 modes of the paper's beam, 2.3 for 400.
/// Where more are needed the progress waits at its end.
const USUAL: f64 = 4.5;

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

    /// How many leading pairs have converged up to a gap, and a shift in that gap; no shift when the basis is complete.
    fn bound(&self, ritz: &Ritz, count: usize, complete: bool) -> Option<(usize, Option<f64>)> {
        let value = |i: usize| 1.0 / ritz.values[i] - self.shift;
        if complete {
            return Some((count, None));
        }
        (count..ritz.converged())
            .find(|&i| value(i) - value(i - 1) > GAP * (value(i).abs() + self.shift))
            .map(|i| (i, Some(0.5 * (value(i) + value(i - 1)))))
    }

    /// Sturm count; a shift that meets an eigenvalue of a leading part is moved a little.
    fn count_below(&self, above: f64) -> Result<usize, Error> {
        let mut last = None;
        // A hundredth of the gap that the shift stands in: no eigenvalue of the whole matrix comes near it.
        for nudge in [0.0, 1e-8, -1e-8] {
            let shifted = self.stiffness.plus(-(above + nudge * (above.abs() + self.shift)), self.mass);
            match negative_eigenvalues(self.analysis, &shifted) {
                Ok(number) => return Ok(number),
                Err(error) => last = Some(error),
            }
        }
        Err(last.expect("three attempts were made"))
    }

    /// The first `count` pairs, each vector with the sign that makes the last of its largest components positive: rounding does not
    /// turn it.
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

/// Ritz values θ descending, the combinations of the basis, relative residuals.
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

/// The basis and the projection of the operator on it.
struct Search<'a> {
    mass: &'a Symmetric,
    factor: &'a Cholesky,
    workers: Workers,
    n: usize,
    /// M-orthonormal columns V one after the other; the projection is known on the first `columns` of them.
    basis: Vec<f64>,
    /// M V.
    weighted: Vec<f64>,
    columns: usize,
    /// First column of the block expanded last.
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

    /// Columns of the basis, those not yet expanded included.
    fn held(&self) -> usize {
        self.basis.len() / self.n
    }

    /// Columns to add before the projection's eigenproblem is worth another look: most of what is missing to the `wanted`
    /// pairs at the rate at which they converged between the last two looks (columns, pairs), and not so few that
    /// looking costs more than searching.
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

    /// Appends random columns, orthonormal to the basis.
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

    /// Takes the part of the basis from its column `first` on off the columns; returns the coefficients on the whole basis.
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

    /// Takes the basis' part off what the operator made of the pending columns; returns the coefficients.
    ///
    /// But for rounding that part is in the last two blocks: they go first, and one pass over all takes the rest.
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

    /// Applies the operator to the pending columns, extends the projection and appends what is new as pending columns.
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
        // Coefficients of the remainder on the new columns: the residual of every Ritz pair follows from them.
        let added = self.view(&self.weighted[to * self.n..]);
        let mut pending = Mat::zeros(added.ncols(), width);
        let remainder = self.view(&remainder);
        self.workers.run(|par| {
            matmul(&mut pending, Accum::Replace, added.transpose(), remainder, 1.0, par);
        });
        self.pending = pending;
    }

    /// Orthonormalises columns among themselves, after the basis' part, of squared length `removed`, was taken off them, and
    /// appends them; those that depend on what is there give way to random ones.
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

    /// The first `count` combinations of the basis.
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

    /// An eigenvalue twelve times over: a block of eight finds eight at first, the Sturm count knows of the others.
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
