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
use crate::lanes::{Group, LANES, total};
use crate::sparse::{Symmetric, largest};

/// Largest backward error ‖A z - b‖ / (‖A‖ ‖z‖) that a sound factorisation leaves; usual is 1e-16.
const SOUND: f64 = 1e-10;
/// Up to so many unknowns minimum degree is tried beside nested dissection: it leaves less fill in slender structures, but
/// far more in large solid ones.
const SLENDER: usize = 20_000;
/// Columns handled at once in a solve: so often less is what they share read and written.
const TOGETHER: usize = 4;

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
        let dissected = PermRef::new_checked(&forward, &inverse, forward.len());
        let mut symbolic = symbolic(matrix, SymmetricOrdering::Custom(dissected))?;
        if matrix.order() <= SLENDER {
            let of_least_degree = self::symbolic(matrix, SymmetricOrdering::Amd)?;
            if of_least_degree.len_val() < symbolic.len_val() {
                symbolic = of_least_degree;
            }
        }
        Ok(Self { symbolic: Arc::new(symbolic) })
    }
}

/// Pattern of the factor in an order of elimination.
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
    pub(crate) fn solve_with(&self, x: &mut [f64], permuted: &mut Vec<f64>, local: &mut Vec<f64>) {
        let (forward, inverse) = self.symbolic.perm().expect("an order was given").arrays();
        permuted.clear();
        permuted.extend(forward.iter().map(|&j| x[j as usize]));
        // The widest registers at hand; nothing is contracted, so the bits are the same in all of them.
        pulp::Arch::new().dispatch(Solve { factor: self, x: permuted, local });
        x.iter_mut().zip(inverse).for_each(|(x, &k)| *x = permuted[k as usize]);
    }
}

/// x = (L Lᵀ)⁻¹ x in the order of elimination, with memory for one supernode.
struct Solve<'a> {
    factor: &'a Cholesky,
    x: &'a mut [f64],
    local: &'a mut Vec<f64>,
}

impl pulp::NullaryFnOnce for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let factor = self.factor.supernodal();
        let count = factor.symbolic().n_supernodes();
        // Loops, not closures: what is not inlined here would not get the registers.
        for s in 0..count {
            Columns::of(&factor, &self.factor.values, s).forward(self.x, self.local);
        }
        for s in (0..count).rev() {
            Columns::of(&factor, &self.factor.values, s).backward(self.x, self.local);
        }
    }
}

/// The columns of a supernode, one after the other: a lower triangle, and the rows below it.
struct Columns<'a> {
    /// First unknown of the triangle, and its order.
    start: usize,
    width: usize,
    /// Unknowns of the rows below.
    pattern: &'a [u32],
    entries: &'a [f64],
}

impl<'a> Columns<'a> {
    #[inline(always)]
    fn of(factor: &SupernodalLltRef<'a, u32, f64>, values: &'a [f64], s: usize) -> Self {
        let (node, starts) = (factor.supernode(s), factor.symbolic().col_ptr_for_val());
        let entries = &values[starts[s] as usize..starts[s + 1] as usize];
        Self { start: node.start(), width: node.val().ncols(), pattern: node.pattern(), entries }
    }

    /// Diagonal entry of column `k`, and what lies below it.
    #[inline(always)]
    fn column(&self, k: usize) -> (f64, &'a [f64]) {
        let height = self.width + self.pattern.len();
        (self.entries[k * height + k], &self.entries[k * height + k + 1..(k + 1) * height])
    }

    /// Solves with the triangle and takes the columns off what comes later.
    #[inline(always)]
    fn forward(&self, x: &mut [f64], local: &mut Vec<f64>) {
        local.clear();
        local.extend_from_slice(&x[self.start..self.start + self.width]);
        local.resize(self.width + self.pattern.len(), 0.0);
        let whole = self.width - self.width % TOGETHER;
        for k in (0..whole).step_by(TOGETHER) {
            self.eliminate::<TOGETHER>(k, local);
        }
        for k in whole..self.width {
            self.eliminate::<1>(k, local);
        }
        let (solved, below) = local.split_at(self.width);
        x[self.start..self.start + self.width].copy_from_slice(solved);
        for (&i, b) in self.pattern.iter().zip(below) {
            x[i as usize] += b;
        }
    }

    /// N columns from `k` on.
    #[inline(always)]
    fn eliminate<const N: usize>(&self, k: usize, local: &mut [f64]) {
        let (top, rest) = local.split_at_mut(k + N);
        let top: &mut [f64; N] = top.last_chunk_mut().expect("N columns");
        for m in 0..N {
            let (pivot, below) = self.column(k + m);
            top[m] /= pivot;
            let value = top[m];
            for (x, l) in top[m + 1..].iter_mut().zip(below) {
                *x -= value * l;
            }
        }
        let columns: [&[f64]; N] = std::array::from_fn(|m| &self.column(k + m).1[N - 1 - m..][..rest.len()]);
        let whole = rest.len() - rest.len() % LANES;
        for i in (0..whole).step_by(LANES) {
            let mut sums: [f64; LANES] = *rest[i..].first_chunk().expect("whole groups");
            for m in 0..N {
                let column: &[f64; LANES] = columns[m][i..].first_chunk().expect("whole groups");
                for l in 0..LANES {
                    sums[l] -= top[m] * column[l];
                }
            }
            rest[i..i + LANES].copy_from_slice(&sums);
        }
        for i in whole..rest.len() {
            for m in 0..N {
                rest[i] -= top[m] * columns[m][i];
            }
        }
    }

    /// Solves with the transposed columns.
    #[inline(always)]
    fn backward(&self, x: &mut [f64], local: &mut Vec<f64>) {
        local.clear();
        local.extend_from_slice(&x[self.start..self.start + self.width]);
        for &i in self.pattern {
            local.push(x[i as usize]);
        }
        let mut k = self.width;
        if k % 2 == 1 {
            k -= 1;
            let known = self.products(k, local)[0];
            local[k] = (local[k] - known) / self.column(k).0;
        }
        while k > 0 {
            k -= 2;
            let known = self.products(k, local);
            let ((pivot, below), next) = (self.column(k), self.column(k + 1).0);
            local[k + 1] = (local[k + 1] - known[1]) / next;
            local[k] = (local[k] - (known[0] + below[0] * local[k + 1])) / pivot;
        }
        x[self.start..self.start + self.width].copy_from_slice(&local[..self.width]);
    }

    /// Products of column `k`, and of the next one if there is one, with what is known behind both.
    #[inline(always)]
    fn products(&self, k: usize, local: &[f64]) -> [f64; 2] {
        let other = (k + 1).min(self.width - 1);
        let known = &local[other + 1..];
        let columns = [&self.column(k).1[other - k..], self.column(other).1];
        let [a, b] = columns.map(|column| &column[..known.len()]);
        let whole = known.len() - known.len() % LANES;
        let (mut s, mut t) = ([0.0; LANES], [0.0; LANES]);
        for i in (0..whole).step_by(LANES) {
            let x: &Group = known[i..].first_chunk().expect("whole groups");
            let (a, b): (&Group, &Group) = (a[i..].first_chunk().expect("as many"), b[i..].first_chunk().expect("as many"));
            for l in 0..LANES {
                s[l] += a[l] * x[l];
            }
            for l in 0..LANES {
                t[l] += b[l] * x[l];
            }
        }
        let mut sums = [total(&s), total(&t)];
        for i in whole..known.len() {
            sums[0] += a[i] * known[i];
            sums[1] += b[i] * known[i];
        }
        sums
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
