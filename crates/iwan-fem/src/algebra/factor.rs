//! Sparse Cholesky and LDLᵀ factors; each is tested by a solve (probe) before it is used.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::{ldlt, llt};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};

use super::lanes::{Group, LANES};
use super::ordering::{Site, nested_dissection};
use super::random::random;
use super::sparse::{Symmetric, largest};
use super::triangular::{Branches, Factor};
use super::workers::Workers;
use crate::error::Error;
use iwan_machine::memory::ask;

/// Largest backward error ‖A z - b‖ / (‖A‖ ‖z‖) of an acceptable factorisation. Usual values are 1e-16 to 1e-15 for K + σM and up to 1e-12
/// for shifted, indefinite matrices, which are factored without pivoting. A factor with a larger error is refused: the eigensolver moves
/// its shift slightly and tries again, every other analysis ends with an error.
const SOUND: f64 = 1e-10;
/// Largest number of unknowns for which minimum degree is tried beside nested dissection; the order with fewer entries in the factor is
/// used. Minimum degree gives a fifth fewer in the paper's beam of 4,514 unknowns and a tenth fewer with the mesh twice as fine (25,418),
/// but 40 % more when it is three times as fine, and 25 to 70 % more in cubes. The second order takes 4 ms for 4,514 unknowns and 0.3 s for
/// 75,000.
const SLENDER: usize = 20_000;

/// Order of elimination and pattern of the factor, shared by all matrices of a structure.
#[derive(Debug, Clone)]
pub(crate) struct Analysis {
    symbolic: Arc<SymbolicCholesky<u32>>,
    branches: Branches,
}

impl Analysis {
    /// The analysis for matrices whose pattern is that of `matrix` or a part of it.
    pub(crate) fn new(matrix: &Symmetric, sites: &[Site]) -> Result<Self, Error> {
        let forward = nested_dissection(matrix, sites);
        let mut inverse = vec![0; forward.len()];
        forward.iter().enumerate().for_each(|(k, &j)| inverse[j as usize] = k as u32);
        let dissected = PermRef::new_checked(&forward, &inverse, forward.len());
        let mut symbolic = symbolic(matrix, SymmetricOrdering::Custom(dissected))?;
        // Without different positions there is nothing to cut, and nested dissection gives no useful order.
        let placed = sites.windows(2).any(|pair| pair[0].position != pair[1].position);
        if matrix.order() <= SLENDER || !placed {
            let of_least_degree = self::symbolic(matrix, SymmetricOrdering::Amd)?;
            if of_least_degree.len_val() < symbolic.len_val() {
                symbolic = of_least_degree;
            }
        }
        let branches = Branches::of(supernodes(&symbolic));
        Ok(Self { symbolic: Arc::new(symbolic), branches })
    }

    /// Number of entries of a factor.
    pub(crate) fn entries(&self) -> usize {
        self.symbolic.len_val()
    }
}

/// Pattern of the factor for a given order of elimination.
fn symbolic(
    matrix: &Symmetric,
    ordering: SymmetricOrdering<'_, u32>,
) -> Result<SymbolicCholesky<u32>, Error> {
    let parameters = CholeskySymbolicParams {
        supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
        ..CholeskySymbolicParams::default()
    };
    factorize_symbolic_cholesky(pattern(matrix), Side::Lower, ordering, parameters)
        .map_err(|e| failed(format!("the pattern of the factor does not fit into memory ({e:?})")))
}

fn failed(finding: String) -> Error {
    let remedy = "check that the structure's parts are connected and its numbers are of one set of units";
    Error::Analysis { analysis: "factorisation", finding, remedy }
}

fn pattern(matrix: &Symmetric) -> SymbolicSparseColMatRef<'_, u32> {
    let (starts, rows, _) = matrix.parts();
    SymbolicSparseColMatRef::new_checked(matrix.order(), matrix.order(), starts, None, rows)
}

fn view(matrix: &Symmetric) -> SparseColMatRef<'_, u32, f64> {
    SparseColMatRef::new(pattern(matrix), matrix.parts().2)
}

fn memory(need: StackReq) -> Result<MemBuffer, Error> {
    MemBuffer::try_new(need).map_err(|_| failed("the factor's workspace does not fit into memory".into()))
}

fn supernodes(symbolic: &SymbolicCholesky<u32>) -> &SymbolicSupernodalCholesky<u32> {
    let SymbolicCholeskyRaw::Supernodal(supernodes) = symbolic.raw() else {
        unreachable!("a supernodal factorisation was asked for")
    };
    supernodes
}

/// Room for the entries of a factor.
fn zeros(symbolic: &SymbolicCholesky<u32>) -> Result<Vec<f64>, Error> {
    let (what, remedy) = ("the factor of a matrix", "take a coarser mesh, or a machine with more memory");
    ask(what, size_of::<f64>() as u64 * symbolic.len_val() as u64, remedy)?;
    Ok(vec![0.0; symbolic.len_val()])
}

/// A = L Lᵀ of a positive definite matrix.
#[derive(Debug)]
pub(crate) struct Cholesky {
    symbolic: Arc<SymbolicCholesky<u32>>,
    branches: Branches,
    values: Vec<f64>,
}

impl Cholesky {
    /// Factors the matrix and tests the factor.
    pub(crate) fn new(analysis: &Analysis, matrix: &Symmetric) -> Result<Self, Error> {
        Self::with(analysis, matrix, &Workers::for_entries(analysis.symbolic.len_val())?)
    }

    fn with(analysis: &Analysis, matrix: &Symmetric, workers: &Workers) -> Result<Self, Error> {
        let symbolic = Arc::clone(&analysis.symbolic);
        let mut values = zeros(&symbolic)?;
        let none = llt::factor::LltRegularization::default();
        let spec = Spec::default();
        workers.run(|par| {
            let mut buffer = memory(symbolic.factorize_numeric_llt_scratch::<f64>(par, spec))?;
            let stack = MemStack::new(&mut buffer);
            symbolic
                .factorize_numeric_llt(&mut values, view(matrix), Side::Lower, none, par, stack, spec)
                .map_err(|e| failed(format!("the matrix is not positive definite ({e:?})")))
                .map(|_| ())
        })?;
        let factor = Self { symbolic, branches: analysis.branches, values };
        probe(matrix, |x| factor.solve(x))?;
        Ok(factor)
    }

    fn factor(&self) -> Factor<'_> {
        Factor { supernodes: supernodes(&self.symbolic), values: &self.values }
    }

    /// Number of entries of the factor.
    pub(crate) fn entries(&self) -> usize {
        self.values.len()
    }

    /// Replaces x by A⁻¹ x, for columns of n entries one after another; a group of columns is solved at a time.
    pub(crate) fn solve_columns(&self, x: &mut [f64], workers: &Workers) {
        let (forward, inverse) = self.symbolic.perm().expect("an order was given").arrays();
        let n = forward.len();
        for x in x.chunks_mut(LANES * n) {
            let width = x.len() / n;
            let row = |&j: &u32| std::array::from_fn(|c| if c < width { x[c * n + j as usize] } else { 0.0 });
            let mut rows: Vec<Group> = forward.iter().map(row).collect();
            self.factor().solve_group(self.branches, &mut rows, workers);
            for (c, column) in x.chunks_exact_mut(n).enumerate() {
                column.iter_mut().zip(inverse).for_each(|(x, &k)| *x = rows[k as usize][c]);
            }
        }
    }

    /// Replaces x by A⁻¹ x.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        self.solve_with(x, &mut Vec::new(), &mut Vec::new());
    }

    /// [`Self::solve`] with working memory that the caller reuses, as a time step needs it.
    ///
    /// faer's own solve is written for many columns; the time of a single column is that of reading the factor twice.
    pub(crate) fn solve_with(&self, x: &mut [f64], permuted: &mut Vec<f64>, local: &mut Vec<f64>) {
        let (forward, inverse) = self.symbolic.perm().expect("an order was given").arrays();
        permuted.clear();
        permuted.extend(forward.iter().map(|&j| x[j as usize]));
        self.factor().solve_one(permuted, local);
        x.iter_mut().zip(inverse).for_each(|(x, &k)| *x = permuted[k as usize]);
    }
}

/// Number of negative eigenvalues of a symmetric matrix, from the signs of D in A = L D Lᵀ (Sylvester's law of inertia).
///
/// The factorisation does not pivot. The probe refuses a factor that has lost its digits, and the caller then moves its shift.
pub(crate) fn negative_eigenvalues(analysis: &Analysis, matrix: &Symmetric) -> Result<usize, Error> {
    let symbolic = &analysis.symbolic;
    let workers = Workers::for_entries(symbolic.len_val())?;
    let mut values = zeros(symbolic)?;
    let none = ldlt::factor::LdltRegularization::default();
    let spec = Spec::default();
    workers.run(|par| {
        let mut buffer = memory(symbolic.factorize_numeric_ldlt_scratch::<f64>(par, spec))?;
        let stack = MemStack::new(&mut buffer);
        symbolic
            .factorize_numeric_ldlt(&mut values, view(matrix), Side::Lower, none, par, stack, spec)
            .map_err(|e| failed(format!("the shifted matrix has no LDL' factors ({e:?})")))
            .map(|_| ())
    })?;
    probe(matrix, |x| {
        let mut buffer = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let columns = MatMut::from_column_major_slice_mut(x, matrix.order(), 1);
        let stack = MemStack::new(&mut buffer);
        LdltRef::new(symbolic, &values).solve_in_place_with_conj(Conj::No, columns, Par::Seq, stack);
    })?;
    // The diagonal of each supernode's block is D.
    let factor = Factor { supernodes: supernodes(symbolic), values: &values };
    Ok(factor.diagonal().filter(|d| *d < 0.0).count())
}

/// Tests a factor: solves for a random right-hand side and checks the backward error.
fn probe(matrix: &Symmetric, solve: impl Fn(&mut [f64])) -> Result<(), Error> {
    let right = random(matrix.order(), 1);
    let mut solution = right.clone();
    solve(&mut solution);
    let mut residual = matrix.times(&solution);
    residual.iter_mut().zip(&right).for_each(|(r, b)| *r -= b);
    let scale = matrix.largest() * largest(&solution);
    let error = largest(&residual) / scale;
    if error <= SOUND {
        return Ok(());
    }
    Err(failed(format!(
        "a probe solved with the factor leaves a backward error of {error:.1e}, allowed {SOUND:.0e}"
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::beam::Configuration;
    use crate::mesh::block::{block, uniform};
    use crate::paper;
    use crate::{Material, Structure};

    fn solves(matrix: &Symmetric, analysis: &Analysis, workers: &Workers) -> Vec<f64> {
        let factor = Cholesky::with(analysis, matrix, workers).unwrap();
        let mut x = random((LANES + 3) * matrix.order(), 5);
        let right = x.clone();
        factor.solve_columns(&mut x, workers);
        for (x, right) in x.chunks_exact(matrix.order()).zip(right.chunks_exact(matrix.order())) {
            // The same as for one right-hand side alone, except for rounding.
            let mut alone = right.to_vec();
            factor.solve(&mut alone);
            let error: Vec<f64> = alone.iter().zip(x).map(|(a, b)| a - b).collect();
            assert!(largest(&error) < 1e-8 * largest(&alone), "{:e}", largest(&error) / largest(&alone));
            let mut residual = matrix.times(x);
            residual.iter_mut().zip(right).for_each(|(r, b)| *r -= b);
            assert!(largest(&residual) < 1e-13 * matrix.largest() * largest(x));
        }
        x
    }

    /// The factor of a block is large enough for threads. Their number must leave no trace in the results, neither in the branches nor in
    /// the trunk.
    #[test]
    fn threads_change_no_bit() {
        let lines = uniform(-0.5, 0.5, 15);
        let mesh = block(&[lines.clone(), lines.clone(), lines]);
        let assembled = Structure::new(mesh, Material::new(1.0, 0.3, 1.0).unwrap()).assemble().unwrap();
        let matrix = assembled.slipping_stiffness().plus(1.0, assembled.mass());
        let analysis = assembled.analysis().unwrap();
        assert!(Workers::for_entries(analysis.symbolic.len_val()).unwrap().are_threads());
        assert!(analysis.branches != Branches::NONE, "a block falls into two branches");
        let alone = solves(&matrix, analysis, &Workers::none());
        for threads in [1, 2, 3] {
            assert_eq!(alone, solves(&matrix, analysis, &Workers::of(threads)), "{threads} threads");
        }
    }

    #[test]
    fn small_factors_solve_as_well() {
        let assembled = paper::structure(Configuration::A, 1).unwrap().assemble().unwrap();
        let matrix = assembled.slipping_stiffness().plus(1e4, assembled.mass());
        assert!(
            !Workers::for_entries(assembled.analysis().unwrap().symbolic.len_val()).unwrap().are_threads()
        );
        solves(&matrix, assembled.analysis().unwrap(), &Workers::none());
    }
}
