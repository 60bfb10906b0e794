//! Solves with the factor of a sparse matrix, for one right-hand side, or for a group of them on two threads.
//!
//! faer's own solves are written for many columns. The time of a single column depends on how often the factor is read; the columns of a
//! group take one lane each. Below the last separator of a nested dissection the elimination falls into two branches that are not coupled,
//! and each thread works on one branch. The contributions of the two branches to the unknowns of the separator are summed separately and
//! joined in a fixed order, so the bits do not depend on the number of threads.
#![expect(clippy::inline_always, reason = "what is not inlined does not get the wide registers")]

use std::ops::Range;

use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;

use super::lanes::{Group, LANES, total};
use super::workers::Workers;

/// Number of columns eliminated together, so that the entries that they share are read and written once for four columns.
const TOGETHER: usize = 4;
/// Smallest share of the factor in the smaller branch, so that two threads share at least half of the work; otherwise the whole factor is
/// trunk.
const BALANCED: f64 = 0.25;

/// The entries of a factor L or of L and D, supernode by supernode.
#[derive(Clone, Copy)]
pub(crate) struct Factor<'a> {
    pub(crate) supernodes: &'a SymbolicSupernodalCholesky<u32>,
    pub(crate) values: &'a [f64],
}

impl<'a> Factor<'a> {
    #[inline(always)]
    fn columns(&self, s: usize) -> Columns<'a> {
        let (node, starts) = (self.supernodes.supernode(s), self.supernodes.col_ptr_for_val());
        let (start, end) = (node.start(), self.supernodes.supernode_end()[s] as usize);
        let entries = &self.values[starts[s] as usize..starts[s + 1] as usize];
        Columns { start, width: end - start, pattern: node.pattern(), entries }
    }

    /// The diagonal entries.
    pub(crate) fn diagonal(&self) -> impl Iterator<Item = f64> + '_ {
        let columns = (0..self.supernodes.n_supernodes()).map(|s| self.columns(s));
        columns.flat_map(|columns| (0..columns.width).map(move |k| columns.column(k).0))
    }

    /// Replaces x by (L Lᵀ)⁻¹ x, in the order of elimination; `local` is working memory for one supernode.
    pub(crate) fn solve_one(&self, x: &mut [f64], local: &mut Vec<f64>) {
        // The widest vector registers of the processor. No product is fused with a sum, so the bits are the same with any width.
        pulp::Arch::new().dispatch(One { factor: *self, x, local });
    }

    /// The same solve for a group of right-hand sides.
    pub(crate) fn solve_group(&self, branches: Branches, x: &mut [Group], workers: &Workers) {
        let Branches { middle, trunk } = branches;
        let begin = |s: usize| self.supernodes.supernode_begin().get(s).map_or(x.len(), |&b| b as usize);
        let (cut, root) = (begin(middle), begin(trunk));
        let (below, above) = x.split_at_mut(root);
        let (first, second) = below.split_at_mut(cut);
        let (mut left, mut right) = (vec![[0.0; LANES]; above.len()], vec![[0.0; LANES]; above.len()]);
        let arch = pulp::Arch::new();
        let one = Forward(self.branch(0..middle, 0, first, &mut left));
        let other = Forward(self.branch(middle..trunk, cut, second, &mut right));
        workers.both(|| arch.dispatch(one), || arch.dispatch(other));
        for (x, (left, right)) in above.iter_mut().zip(left.iter().zip(&right)) {
            (0..LANES).for_each(|l| x[l] += left[l] + right[l]);
        }
        let top = trunk..self.supernodes.n_supernodes();
        arch.dispatch(Forward(self.branch(top.clone(), root, above, &mut [])));
        arch.dispatch(Backward(self.branch(top, root, above, &mut [])));
        left.copy_from_slice(above);
        right.copy_from_slice(above);
        let one = Backward(self.branch(0..middle, 0, first, &mut left));
        let other = Backward(self.branch(middle..trunk, cut, second, &mut right));
        workers.both(|| arch.dispatch(one), || arch.dispatch(other));
    }

    fn branch<'b>(
        self,
        supernodes: Range<usize>,
        offset: usize,
        own: &'b mut [Group],
        above: &'b mut [Group],
    ) -> Branch<'b>
    where
        'a: 'b,
    {
        Branch { factor: self, supernodes, offset, own, above }
    }
}

/// Two ranges of supernodes that are not coupled, [0, middle) and [middle, trunk), and the trunk, which is coupled to both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Branches {
    middle: usize,
    trunk: usize,
}

impl Branches {
    /// No branches: the whole factor is trunk.
    pub(crate) const NONE: Self = Self { middle: 0, trunk: 0 };

    /// The branches of a factor's pattern; the whole factor is trunk if there are no two branches of sufficient size.
    pub(crate) fn of(supernodes: &SymbolicSupernodalCholesky<u32>) -> Self {
        let (count, starts) = (supernodes.n_supernodes(), supernodes.col_ptr_for_val());
        let ends = supernodes.supernode_end();
        let parent = |s: usize| {
            let next = supernodes.supernode(s).pattern().first();
            next.map_or(usize::MAX, |&row| ends.partition_point(|&end| end <= row))
        };
        let parents: Vec<usize> = (0..count).map(parent).collect();
        let weight = f64::from(starts[count]);
        for trunk in (0..count).rev() {
            let below = f64::from(starts[trunk]);
            if below < 2.0 * BALANCED * weight {
                break;
            }
            // The parent of each supernode before `middle` lies before `middle` or in the trunk.
            let mut reached = 0;
            let mut best = (0.0, 0);
            for (s, &parent) in parents[..trunk].iter().enumerate() {
                reached = reached.max(if parent < trunk { parent + 1 } else { s + 1 });
                let lighter = f64::from(starts[s + 1]).min(below - f64::from(starts[s + 1]));
                if reached == s + 1 && lighter > best.0 {
                    best = (lighter, s + 1);
                }
            }
            if best.0 >= BALANCED * weight {
                return Self { middle: best.1, trunk };
            }
        }
        Self::NONE
    }
}

/// Arguments of [`Factor::solve_one`].
struct One<'a> {
    factor: Factor<'a>,
    x: &'a mut [f64],
    local: &'a mut Vec<f64>,
}

impl pulp::NullaryFnOnce for One<'_> {
    type Output = ();

    // Here and in all called functions there are loops, not closures: code that is not inlined does not use the wide registers.
    #[inline(always)]
    fn call(self) {
        let count = self.factor.supernodes.n_supernodes();
        for s in 0..count {
            self.factor.columns(s).forward(self.x, self.local);
        }
        for s in (0..count).rev() {
            self.factor.columns(s).backward(self.x, self.local);
        }
    }
}

/// A range of supernodes with its own unknowns, which begin at `offset`, and the unknowns of the trunk.
struct Branch<'a> {
    factor: Factor<'a>,
    supernodes: Range<usize>,
    offset: usize,
    own: &'a mut [Group],
    /// In the forward solve the contributions to the trunk's unknowns; in the backward solve the values of these.
    above: &'a mut [Group],
}

struct Forward<'a>(Branch<'a>);

impl pulp::NullaryFnOnce for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Branch { factor, supernodes, offset, own, above } = self.0;
        let behind = factor.supernodes.nrows() - above.len();
        let mut local: Vec<Group> = Vec::new();
        for s in supernodes {
            let columns = factor.columns(s);
            let at = columns.start - offset;
            local.clear();
            local.extend_from_slice(&own[at..at + columns.width]);
            local.resize(columns.width + columns.pattern.len(), [0.0; LANES]);
            columns.forward_group(&mut local);
            let (solved, below) = local.split_at(columns.width);
            own[at..at + columns.width].copy_from_slice(solved);
            for (&i, b) in columns.pattern.iter().zip(below) {
                let i = i as usize;
                let x = if i < behind { &mut own[i - offset] } else { &mut above[i - behind] };
                for l in 0..LANES {
                    x[l] += b[l];
                }
            }
        }
    }
}

struct Backward<'a>(Branch<'a>);

impl pulp::NullaryFnOnce for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Branch { factor, supernodes, offset, own, above } = self.0;
        let behind = factor.supernodes.nrows() - above.len();
        let mut local: Vec<Group> = Vec::new();
        for s in supernodes.rev() {
            let columns = factor.columns(s);
            let at = columns.start - offset;
            local.clear();
            local.extend_from_slice(&own[at..at + columns.width]);
            for &i in columns.pattern {
                let i = i as usize;
                local.push(if i < behind { own[i - offset] } else { above[i - behind] });
            }
            columns.backward_group(&mut local);
            own[at..at + columns.width].copy_from_slice(&local[..columns.width]);
        }
    }
}

/// The columns of a supernode, one after another: a lower triangle, and the rows below it.
struct Columns<'a> {
    /// First unknown of the triangle, and the triangle's order.
    start: usize,
    width: usize,
    /// Unknowns of the rows below the triangle.
    pattern: &'a [u32],
    entries: &'a [f64],
}

impl<'a> Columns<'a> {
    /// Diagonal entry of column `k`, and the entries below it.
    #[inline(always)]
    fn column(&self, k: usize) -> (f64, &'a [f64]) {
        let height = self.width + self.pattern.len();
        (self.entries[k * height + k], &self.entries[k * height + k + 1..(k + 1) * height])
    }

    /// Solves with the triangle, and subtracts the columns' contributions from the later unknowns.
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

    /// Eliminates N columns from `k` on.
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

    /// Products of column `k`, and of the next one if there is one, with the known unknowns after both.
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
            let (a, b): (&Group, &Group) =
                (a[i..].first_chunk().expect("as many"), b[i..].first_chunk().expect("as many"));
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

    /// [`forward`](Self::forward) for a group, working in `local` alone.
    #[inline(always)]
    fn forward_group(&self, local: &mut [Group]) {
        let whole = self.width - self.width % TOGETHER;
        for k in (0..whole).step_by(TOGETHER) {
            self.eliminate_group::<TOGETHER>(k, local);
        }
        for k in whole..self.width {
            self.eliminate_group::<1>(k, local);
        }
    }

    #[inline(always)]
    fn eliminate_group<const N: usize>(&self, k: usize, local: &mut [Group]) {
        let (top, rest) = local.split_at_mut(k + N);
        let top: &mut [Group; N] = top.last_chunk_mut().expect("N columns");
        for m in 0..N {
            let (pivot, below) = self.column(k + m);
            for x in &mut top[m] {
                *x /= pivot;
            }
            let value = top[m];
            for (x, entry) in top[m + 1..].iter_mut().zip(below) {
                for l in 0..LANES {
                    x[l] -= value[l] * entry;
                }
            }
        }
        let columns: [&[f64]; N] = std::array::from_fn(|m| &self.column(k + m).1[N - 1 - m..][..rest.len()]);
        let top = *top;
        for (i, x) in rest.iter_mut().enumerate() {
            let mut sums = *x;
            for m in 0..N {
                let entry = columns[m][i];
                for l in 0..LANES {
                    sums[l] -= top[m][l] * entry;
                }
            }
            *x = sums;
        }
    }

    /// [`backward`](Self::backward) for a group, working in `local` alone.
    #[inline(always)]
    fn backward_group(&self, local: &mut [Group]) {
        let whole = self.width - self.width % TOGETHER;
        for k in (whole..self.width).rev() {
            self.substitute_group::<1>(k, local);
        }
        for k in (0..whole).step_by(TOGETHER).rev() {
            self.substitute_group::<TOGETHER>(k, local);
        }
    }

    #[inline(always)]
    fn substitute_group<const N: usize>(&self, k: usize, local: &mut [Group]) {
        let (top, rest) = local.split_at_mut(k + N);
        let columns: [&[f64]; N] = std::array::from_fn(|m| &self.column(k + m).1[N - 1 - m..][..rest.len()]);
        let mut sums = [[0.0; LANES]; N];
        for (i, x) in rest.iter().enumerate() {
            let known = *x;
            for m in 0..N {
                let entry = columns[m][i];
                for l in 0..LANES {
                    sums[m][l] += known[l] * entry;
                }
            }
        }
        let top: &mut [Group; N] = top.last_chunk_mut().expect("N columns");
        for m in (0..N).rev() {
            let (pivot, below) = self.column(k + m);
            let mut known = sums[m];
            for (x, entry) in top[m + 1..].iter().zip(below) {
                for l in 0..LANES {
                    known[l] += x[l] * entry;
                }
            }
            for l in 0..LANES {
                top[m][l] = (top[m][l] - known[l]) / pivot;
            }
        }
    }
}
