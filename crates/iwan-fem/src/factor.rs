//! Sparse Cholesky and LDLᵀ factors, with a probe of each.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::{ldlt, llt};
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};

use crate::dofs::Place;
use crate::error::Error;
use crate::ordering::nested_dissection;
use crate::sparse::{Symmetric, largest};

/// Largest backward error ‖A z - b‖ / (‖A‖ ‖z‖) that a sound factorisation leaves; usual is 1e-16.
const SOUND: f64 = 1e-10;

/// Order of elimination and the pattern of the factor: one for all matrices of a structure.
#[derive(Debug, Clone)]
pub(crate) struct Analysis {
    symbolic: Arc<SymbolicCholesky<u32>>,
}

impl Analysis {
    /// For matrices whose pattern is that of `matrix`, or part of it.
    pub(crate) fn new(matrix: &Symmetric, places: &[Place]) -> Result<Self, Error> {
        let forward = nested_dissection(matrix, places);
        let mut inverse = vec![0; forward.len()];
        forward.iter().enumerate().for_each(|(k, &j)| inverse[j as usize] = k as u32);
        let permutation = PermRef::new_checked(&forward, &inverse, forward.len());
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..CholeskySymbolicParams::default()
        };
        let (order, ordering) = (pattern(matrix), SymmetricOrdering::Custom(permutation));
        let symbolic = factorize_symbolic_cholesky(order, Side::Lower, ordering, parameters)
            .map_err(|e| failed(format!("the pattern of the factor does not fit into memory ({e:?})")))?;
        Ok(Self { symbolic: Arc::new(symbolic) })
    }
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

/// A = L Lᵀ of a positive definite matrix.
#[derive(Debug)]
pub(crate) struct Cholesky {
    symbolic: Arc<SymbolicCholesky<u32>>,
    values: Vec<f64>,
}

impl Cholesky {
    /// Factors and probes.
    pub(crate) fn new(analysis: &Analysis, matrix: &Symmetric) -> Result<Self, Error> {
        let symbolic = Arc::clone(&analysis.symbolic);
        let mut values = vec![0.0; symbolic.len_val()];
        let mut buffer = memory(symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default()))?;
        let stack = MemStack::new(&mut buffer);
        let none = llt::factor::LltRegularization::default();
        symbolic
            .factorize_numeric_llt(
                &mut values,
                view(matrix),
                Side::Lower,
                none,
                Par::Seq,
                stack,
                Spec::default(),
            )
            .map_err(|e| failed(format!("the matrix is not positive definite ({e:?})")))?;
        let factor = Self { symbolic, values };
        probe(matrix, |x| factor.solve(x))?;
        Ok(factor)
    }

    fn supernodal(&self) -> SupernodalLltRef<'_, u32, f64> {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.symbolic.raw() else {
            unreachable!("a supernodal factorisation was asked for")
        };
        SupernodalLltRef::new(symbolic, &self.values)
    }

    /// x = A⁻¹ x for several columns at once.
    pub(crate) fn solve_columns(&self, x: MatMut<'_, f64>) {
        let need = self.symbolic.solve_in_place_scratch::<f64>(x.ncols(), Par::Seq);
        let mut buffer = MemBuffer::new(need);
        LltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            x,
            Par::Seq,
            MemStack::new(&mut buffer),
        );
    }

    /// x = A⁻¹ x.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        self.solve_with(x, &mut Vec::new(), &mut Vec::new());
    }

    /// [`Self::solve`] with memory that is there already: what a time step needs.
    ///
    /// faer's own solve is written for many columns; a single one is bound by reading the factor twice.
    pub(crate) fn solve_with(&self, x: &mut [f64], permuted: &mut Vec<f64>, gathered: &mut Vec<f64>) {
        let (forward, inverse) = self.symbolic.perm().expect("an order was given").arrays();
        permuted.clear();
        permuted.extend(forward.iter().map(|&j| x[j as usize]));
        let factor = self.supernodal();
        let count = factor.symbolic().n_supernodes();
        for s in 0..count {
            forward_step(&factor, s, permuted, gathered);
        }
        for s in (0..count).rev() {
            backward_step(&factor, s, permuted, gathered);
        }
        x.iter_mut().zip(inverse).for_each(|(x, &k)| *x = permuted[k as usize]);
    }
}

/// The columns of a supernode one after the other: those on the diagonal block, then those below.
fn columns<'a>(
    factor: &SupernodalLltRef<'a, u32, f64>,
    s: usize,
) -> (usize, &'a [u32], usize, impl Fn(usize) -> &'a [f64] + use<'a>) {
    let node = factor.supernode(s);
    let block = node.val();
    let column =
        move |k: usize| block.col(k).try_as_col_major().expect("factors lie column by column").as_slice();
    (node.start(), node.pattern(), block.ncols(), column)
}

/// Solves with the diagonal block of L and takes its columns off what comes later.
fn forward_step(factor: &SupernodalLltRef<'_, u32, f64>, s: usize, x: &mut [f64], gathered: &mut Vec<f64>) {
    let (start, pattern, width, column) = columns(factor, s);
    gathered.clear();
    gathered.resize(pattern.len(), 0.0);
    for k in 0..width {
        let (top, below) = column(k).split_at(width);
        let value = x[start + k] / top[k];
        x[start + k] = value;
        let rest = &mut x[start + k + 1..start + width];
        rest.iter_mut().zip(&top[k + 1..]).for_each(|(x, l)| *x -= value * l);
        gathered.iter_mut().zip(below).for_each(|(g, l)| *g += value * l);
    }
    pattern.iter().zip(gathered.iter()).for_each(|(&i, g)| x[i as usize] -= g);
}

/// Solves with the transposed columns.
fn backward_step(factor: &SupernodalLltRef<'_, u32, f64>, s: usize, x: &mut [f64], gathered: &mut Vec<f64>) {
    let (start, pattern, width, column) = columns(factor, s);
    gathered.clear();
    gathered.extend(pattern.iter().map(|&i| x[i as usize]));
    for k in (0..width).rev() {
        let (top, below) = column(k).split_at(width);
        let own = &x[start + k + 1..start + width];
        let known = crate::sparse::dot(below, gathered) + crate::sparse::dot(&top[k + 1..], own);
        x[start + k] = (x[start + k] - known) / top[k];
    }
}

/// Number of negative eigenvalues of a symmetric matrix, by the signs of D in A = L D Lᵀ (Sylvester's law of inertia).
///
/// There is no pivoting: the probe refuses a factor that lost its digits, and the caller moves its shift.
pub(crate) fn negative_eigenvalues(analysis: &Analysis, matrix: &Symmetric) -> Result<usize, Error> {
    let symbolic = &analysis.symbolic;
    let mut values = vec![0.0; symbolic.len_val()];
    let mut buffer = memory(symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Spec::default()))?;
    let none = ldlt::factor::LdltRegularization::default();
    let stack = MemStack::new(&mut buffer);
    symbolic
        .factorize_numeric_ldlt(
            &mut values,
            view(matrix),
            Side::Lower,
            none,
            Par::Seq,
            stack,
            Spec::default(),
        )
        .map_err(|e| failed(format!("the shifted matrix has no LDL' factors ({e:?})")))?;
    probe(matrix, |x| {
        let mut buffer = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let columns = MatMut::from_column_major_slice_mut(x, matrix.order(), 1);
        let stack = MemStack::new(&mut buffer);
        LdltRef::new(symbolic, &values).solve_in_place_with_conj(Conj::No, columns, Par::Seq, stack);
    })?;
    let SymbolicCholeskyRaw::Supernodal(raw) = symbolic.raw() else {
        unreachable!("a supernodal factorisation was asked for")
    };
    // The diagonal of each supernode's block holds D.
    let pivots = SupernodalLltRef::new(raw, &values);
    let negative = |s: usize| {
        let block = pivots.supernode(s).val();
        (0..block.ncols()).filter(|&k| block[(k, k)] < 0.0).count()
    };
    Ok((0..raw.n_supernodes()).map(negative).sum())
}

/// Solves for a random right-hand side and compares.
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

/// Numbers in [-1, 1) from a seed, the same everywhere (SplitMix64; G. L. Steele et al., OOPSLA 2014,
/// doi:10.1145/2660193.2660195).
pub(crate) fn random(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let next = |()| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * (2.0 / (1_u64 << 53) as f64) - 1.0
    };
    std::iter::repeat_n((), count).map(next).collect()
}
