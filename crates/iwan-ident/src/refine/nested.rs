//! The restricted likelihood of processes that nest: some belong to one record, some to the records of a level, some to all.
//!
//! Residuals are r = J dx + Σ s_i Z_i u_i + e, with u and e of variance one. The covariance C = 1 + Σ s_i² Z_i Z_iᵀ couples records only by what they share. So the products of
//! all columns are made for each record by itself; the values u of its own processes are eliminated there, and what remains of its products is added to those of its level, from
//! there to those of all (block elimination from the leaves of a tree; J. C. Pinheiro, D. M. Bates, *Mixed-Effects Models in S and S-PLUS*, Springer 2000, Sec. 2.2). For fifteen
//! records with four hundred columns a trial of sizes takes two fifths of the time that one large matrix takes.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor as llt;
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{MatRef, Par, Spec};
use iwan_machine::memory::is_address_space_bounded;
use nalgebra::{DMatrix, DVector};

use super::fields::Component;
use crate::search::blocked;

/// Step of ln t in which the growth of a determinant with t is taken: the difference is right to a millionth.
const DIFFERENCE: f64 = 1e-3;

/// Number of columns from which on factors are made by blocks: for the few dozens of one record among several, blocks take longer than they save.
/// A judgement between these and the hundreds of a single record without noise.
const BLOCKED: usize = 64;

/// Number of eliminations of the finest tier that are kept: those of the two sizes to either side of the best ones so far for each of two components, those of the best ones, and one to spare.
const KNOWN: usize = 6;

/// Residuals of one record and their derivatives, in the same rows.
pub(super) struct OfRecord {
    /// Residuals.
    pub(super) r: DVector<f64>,
    /// With respect to unknowns that change this record only.
    pub(super) own: DMatrix<f64>,
    /// With respect to unknowns that change other records, too: the same columns for every record.
    pub(super) shared: DMatrix<f64>,
}

/// Lower triangular factor of a symmetric positive definite matrix.
struct Factors(DMatrix<f64>);

impl Factors {
    /// None where the matrix is not positive definite.
    fn new(mut matrix: DMatrix<f64>) -> Option<Self> {
        if Self::is_plain(matrix.nrows()) {
            return matrix.cholesky().map(|factors| Self(factors.unpack()));
        }
        let (n, spec) = (matrix.nrows(), Spec::default());
        let mut buffer = MemBuffer::new(llt::cholesky_in_place_scratch::<f64>(n, Par::Seq, spec));
        let (none, stack) = (llt::LltRegularization::default(), MemStack::new(&mut buffer));
        llt::cholesky_in_place(blocked(&mut matrix), none, Par::Seq, stack, spec).ok()?;
        matrix.fill_upper_triangle(0.0, 1);
        Some(Self(matrix))
    }

    /// Whether a matrix of so many columns goes without blocks.
    fn is_plain(columns: usize) -> bool {
        columns < BLOCKED || is_address_space_bounded()
    }

    /// Solves for each column of a matrix, in its place, with the factor itself.
    fn solve(&self, right: &mut DMatrix<f64>) {
        if Self::is_plain(self.0.nrows()) {
            self.0.solve_lower_triangular_unchecked_mut(right);
            return;
        }
        let n = self.0.nrows();
        let factor = MatRef::from_column_major_slice(self.0.as_slice(), n, n);
        solve_lower_triangular_in_place(factor, blocked(right), Par::Seq);
    }

    fn ln_determinant(&self) -> f64 {
        self.0.diagonal().iter().map(|d| 2.0 * d.ln()).sum()
    }
}

/// The records that share the processes of a tier.
struct Group {
    records: Vec<usize>,
    /// Index of the component, and number of columns, of each process of the group.
    processes: Vec<(usize, usize)>,
}

impl Group {
    /// The size of each column, which is that of its component.
    fn spread(&self, sizes: &[f64]) -> DVector<f64> {
        let all = self.processes.iter().flat_map(|(component, n)| std::iter::repeat_n(sizes[*component], *n));
        DVector::from_iterator(self.processes.iter().map(|p| p.1).sum(), all)
    }
}

/// Values u of processes that are eliminated: the factor of 1 + S G S, with the columns' sizes S on a diagonal and the products G of the columns, and the products with all
/// other columns.
struct Eliminated {
    factors: Factors,
    border: DMatrix<f64>,
}

/// Products of columns in which the values of the first ones, of sizes `s`, are eliminated; and what remains of the products of the other columns.
fn eliminated(gram: &DMatrix<f64>, s: &DVector<f64>) -> Option<(Eliminated, DMatrix<f64>)> {
    let (k, others) = (s.len(), gram.ncols() - s.len());
    let mut own = part(gram, 0, 0, (k, k));
    for (j, mut column) in own.column_iter_mut().enumerate() {
        column.component_mul_assign(s);
        column *= s[j];
        column[j] += 1.0;
    }
    let factors = Factors::new(own)?;
    let mut border = part(gram, 0, k, (k, others));
    border.column_iter_mut().for_each(|mut column| column.component_mul_assign(s));
    factors.solve(&mut border);
    let mut rest = part(gram, k, k, (others, others));
    rest.gemm(-1.0, &border.transpose(), &border, 1.0);
    Some((Eliminated { factors, border }, rest))
}

/// The sum of some matrices; none where there are none.
fn sum<'a>(mut all: impl Iterator<Item = &'a DMatrix<f64>>) -> Option<DMatrix<f64>> {
    let first = all.next()?.clone();
    Some(all.fold(first, |sum, one| sum + one))
}

/// The part of a matrix that begins at a row and a column, copied column by column: a view is copied entry by entry, which took 4 % of a fit of fifteen records.
fn part(matrix: &DMatrix<f64>, row: usize, column: usize, (rows, columns): (usize, usize)) -> DMatrix<f64> {
    let mut out = Vec::with_capacity(rows * columns);
    let whole = matrix.as_slice().chunks_exact(matrix.nrows().max(1));
    whole.skip(column).take(columns).for_each(|whole| out.extend_from_slice(&whole[row..row + rows]));
    DMatrix::from_vec(rows, columns, out)
}

/// Processes of the finest tier that are eliminated, with what remains of each group's products and one of the group's records.
struct Finest {
    /// The sizes of the tier's components.
    sizes: Vec<f64>,
    eliminated: Vec<Eliminated>,
    rest: Vec<(usize, DMatrix<f64>)>,
}

/// All processes eliminated, with the products that remain: those of the shared unknowns and of the residuals.
struct Reduced {
    finest: Rc<Finest>,
    /// The coarser tiers.
    coarser: Vec<Vec<Eliminated>>,
    /// ln of the determinant of 1 + S Zᵀ P Z S, where P takes off what the unknowns explain.
    ln_determinant: f64,
    /// Values of the shared unknowns, in an orthonormal basis.
    shared: DVector<f64>,
    /// Sum of squares of the residuals, weighted by the inverse of their covariance.
    square: f64,
}

/// Residuals, derivatives and processes, record by record.
pub(super) struct Nested {
    /// The groups of each tier, from the finest one, where each record makes a group, to the coarsest.
    tiers: Vec<Vec<Group>>,
    /// Columns of each record, without what its own unknowns explain: its processes from the finest tier on, an orthonormal basis of the shared unknowns, and the residuals.
    columns: Vec<DMatrix<f64>>,
    /// Products of these columns.
    grams: Vec<DMatrix<f64>>,
    /// Sum of squares of the residuals, without what the unknowns explain.
    square: f64,
    /// The finest tier at the sizes that were tried last: most of a trial's time goes into it, and trials of other components leave it as it is.
    finest: RefCell<VecDeque<Rc<Finest>>>,
}

impl Nested {
    pub(super) fn new(records: &[OfRecord], components: &[Component]) -> Self {
        let tiers = tiers(components);
        let own: Vec<DMatrix<f64>> = records.iter().map(|record| basis(&record.own)).collect();
        let without = |i: usize, x: &DMatrix<f64>| x - &own[i] * own[i].tr_mul(x);
        // A basis of what the shared unknowns change beside the records' own.
        let shared: Vec<_> = records.iter().enumerate().map(|(i, r)| without(i, &r.shared)).collect();
        let rows: Vec<usize> = shared.iter().map(DMatrix::nrows).collect();
        let mut stacked = DMatrix::zeros(rows.iter().sum(), shared.first().map_or(0, DMatrix::ncols));
        let mut residuals = DMatrix::zeros(stacked.nrows(), 1);
        let first = |i: usize| rows[..i].iter().sum::<usize>();
        for (i, (part, record)) in shared.iter().zip(records).enumerate() {
            stacked.rows_mut(first(i), rows[i]).copy_from(part);
            let r = DMatrix::from_column_slice(rows[i], 1, record.r.as_slice());
            residuals.rows_mut(first(i), rows[i]).copy_from(&without(i, &r));
        }
        let basis = basis(&stacked);
        residuals -= &basis * basis.tr_mul(&residuals);
        let square = residuals.norm_squared();
        let one = |i: usize| {
            // From the finest tier on: the components in the reverse of their order, as in the groups.
            let all = components.iter().rev().flat_map(|component| &component.processes);
            let processes: Vec<&DMatrix<f64>> = all.filter_map(|process| process.of(i)).collect();
            let width: usize = processes.iter().map(|p| p.ncols()).sum();
            let mut all = DMatrix::zeros(rows[i], width + basis.ncols() + 1);
            let mut from = 0;
            for process in processes {
                all.view_mut((0, from), process.shape()).copy_from(process);
                from += process.ncols();
            }
            let explained = without(i, &all.columns(0, from).into_owned());
            all.columns_mut(0, from).copy_from(&explained);
            all.columns_mut(from, basis.ncols()).copy_from(&basis.rows(first(i), rows[i]));
            all.column_mut(from + basis.ncols()).copy_from(&residuals.rows(first(i), rows[i]));
            all
        };
        let columns: Vec<DMatrix<f64>> = (0..records.len()).map(one).collect();
        let grams = columns.iter().map(|all| all.transpose() * all).collect();
        Self { tiers, columns, grams, square, finest: RefCell::default() }
    }

    /// ln of the determinant of 1 + S Zᵀ P Z S, and the residuals' sum of squares weighted by the inverse of their covariance; none where rounding leaves no positive matrix.
    pub(super) fn ln_determinant_and_square(&self, sizes: &[f64]) -> Option<(f64, f64)> {
        self.reduced(sizes).map(|reduced| (reduced.ln_determinant, reduced.square))
    }

    /// The finest tier eliminated; none where there are no processes, and where rounding leaves no positive matrix.
    fn finest(&self, sizes: &[f64]) -> Option<Rc<Finest>> {
        let groups = self.tiers.first()?;
        let own: Vec<f64> = groups[0].processes.iter().map(|(component, _)| sizes[*component]).collect();
        let mut known = self.finest.borrow_mut();
        if let Some(found) = known.iter().find(|finest| finest.sizes == own) {
            return Some(found.clone());
        }
        let (mut all, mut rest) = (vec![], vec![]);
        for group in groups {
            let record = group.records[0];
            let (one, left) = eliminated(&self.grams[record], &group.spread(sizes))?;
            all.push(one);
            rest.push((record, left));
        }
        if known.len() >= KNOWN {
            known.pop_front();
        }
        known.push_back(Rc::new(Finest { sizes: own, eliminated: all, rest }));
        known.back().cloned()
    }

    fn reduced(&self, sizes: &[f64]) -> Option<Reduced> {
        let finest = self.finest(sizes)?;
        let of = |all: &[Eliminated]| all.iter().map(|one| one.factors.ln_determinant()).sum::<f64>();
        let mut ln_determinant = of(&finest.eliminated);
        let mut coarser = vec![];
        // What remains of the products of each group, with one of the group's records.
        let mut remaining: Option<Vec<(usize, DMatrix<f64>)>> = None;
        for groups in self.tiers.iter().skip(1) {
            let finer = remaining.as_deref().unwrap_or(&finest.rest);
            let (mut out, mut rest) = (vec![], vec![]);
            for group in groups {
                let parts = finer.iter().filter(|(record, _)| group.records.contains(record));
                let (one, left) = eliminated(&sum(parts.map(|(_, gram)| gram))?, &group.spread(sizes))?;
                out.push(one);
                rest.push((group.records[0], left));
            }
            ln_determinant += of(&out);
            coarser.push(out);
            remaining = Some(rest);
        }
        let finer = remaining.as_deref().unwrap_or(&finest.rest);
        let rest = sum(finer.iter().map(|(_, gram)| gram))?;
        let unknowns = rest.ncols() - 1;
        let factors = Factors::new(part(&rest, 0, 0, (unknowns, unknowns)))?;
        ln_determinant += factors.ln_determinant();
        let mut shared = part(&rest, 0, unknowns, (unknowns, 1));
        factors.solve(&mut shared);
        let square = rest[(unknowns, unknowns)] - shared.norm_squared();
        let square = square.max(f64::EPSILON * self.square);
        factors.0.tr_solve_lower_triangular_unchecked_mut(&mut shared);
        let shared = shared.column(0).into_owned();
        Some(Reduced { finest, coarser, ln_determinant, shared, square })
    }

    /// What neither unknowns nor processes of these sizes explain of each record's residuals.
    pub(super) fn unexplained(&self, sizes: &[f64]) -> Option<Vec<DVector<f64>>> {
        let reduced = self.reduced(sizes)?;
        let of = |(i, columns): (usize, &DMatrix<f64>)| {
            let mut values = reduced.shared.clone();
            let all: Vec<_> = std::iter::once(&reduced.finest.eliminated).chain(&reduced.coarser).collect();
            for (groups, eliminated) in self.tiers.iter().zip(all).rev() {
                let group = groups.iter().position(|group| group.records.contains(&i))?;
                let Eliminated { factors, border } = &eliminated[group];
                let mut own = border.column(values.len()) - border.columns(0, values.len()) * &values;
                factors.0.tr_solve_lower_triangular_unchecked_mut(&mut own);
                own.component_mul_assign(&groups[group].spread(sizes));
                values = DVector::from_iterator(
                    own.len() + values.len(),
                    own.iter().chain(values.iter()).copied(),
                );
            }
            Some(columns.column(values.len()) - columns.columns(0, values.len()) * values)
        };
        self.columns.iter().enumerate().map(of).collect()
    }

    /// How many values of processes of these sizes the residuals determine, as degrees of freedom: the trace of (1 + G)⁻¹ G with G = S Zᵀ P Z S, which is the growth of the
    /// logarithm of the determinant of 1 + t G with t.
    pub(super) fn explained(&self, sizes: &[f64]) -> Option<f64> {
        let at = |ln_t: f64| {
            let scaled: Vec<f64> = sizes.iter().map(|s| s * (0.5 * ln_t).exp()).collect();
            self.reduced(&scaled).map(|reduced| reduced.ln_determinant)
        };
        Some((at(DIFFERENCE)? - at(-DIFFERENCE)?) / (2.0 * DIFFERENCE))
    }
}

/// The groups of each tier, from the finest one on: components whose processes belong to the same records make one tier.
fn tiers(components: &[Component]) -> Vec<Vec<Group>> {
    let mut tiers: Vec<Vec<Group>> = vec![];
    for (index, component) in components.iter().enumerate().rev() {
        let processes = &component.processes;
        let is_same =
            |tier: &Vec<Group>| tier.iter().map(|g| &g.records).eq(processes.iter().map(|p| &p.records));
        match tiers.last_mut().filter(|tier| is_same(tier)) {
            Some(tier) => {
                let groups = tier.iter_mut().zip(processes);
                groups.for_each(|(group, process)| group.processes.push((index, process.width)));
            }
            None => tiers.push(
                processes
                    .iter()
                    .map(|p| Group { records: p.records.clone(), processes: vec![(index, p.width)] })
                    .collect(),
            ),
        }
    }
    tiers
}

/// An orthonormal basis of the space of some columns; columns without effect have no part in it.
fn basis(columns: &DMatrix<f64>) -> DMatrix<f64> {
    let seen: Vec<usize> = (0..columns.ncols()).filter(|j| columns.column(*j).amax() > 0.0).collect();
    columns.select_columns(&seen).qr().q()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::refine::fields::{Kind, Process};

    /// Numbers without order, but the same each time.
    fn matrix(rows: usize, columns: usize, seed: usize) -> DMatrix<f64> {
        DMatrix::from_fn(rows, columns, |i, j| {
            ((i + 2) as f64 * ((j * j + 3 * seed) as f64 + 0.7 * i as f64)).sin()
        })
    }

    /// Three records, the second and the third on one level.
    fn records() -> (Vec<OfRecord>, Vec<Component>) {
        let one = |i: usize| OfRecord {
            r: DVector::from_column_slice(matrix(12 + i, 1, 50 + i).as_slice()),
            // The last column is without effect.
            own: matrix(12 + i, 2, 60 + i).insert_column(2, 0.0),
            shared: matrix(12 + i, 3, 70 + i).insert_column(1, 0.0),
        };
        let process = |records: &[usize], width: usize, seed: usize| Process {
            width,
            records: records.to_vec(),
            // The last row is that of the day.
            columns: records
                .iter()
                .map(|i| matrix(11 + i, width, seed + i).insert_row(11 + i, 0.0))
                .collect(),
        };
        let component = |kind, processes| Component { kind, shift: 0.0, processes };
        let all = vec![
            component(Kind::Shared, vec![process(&[0, 1, 2], 4, 1)]),
            component(Kind::OfLevel, vec![process(&[2, 1], 3, 5), process(&[0], 2, 9)]),
            component(Kind::OfRecord, (0..3).map(|i| process(&[i], 2 + i, 11)).collect()),
            component(Kind::Even, (0..3).map(|i| process(&[i], 1, 17)).collect()),
        ];
        ((0..3).map(one).collect(), all)
    }

    #[test]
    fn records_one_by_one_are_as_one_large_matrix() {
        let (records, components) = records();
        let sizes = [0.7, 0.4, 1.3, 0.2];
        let first = |i: usize| records[..i].iter().map(|r| r.r.len()).sum::<usize>();
        let rows = first(3);
        // Unknowns: those of each record, and the shared ones that have an effect.
        let (mut jacobian, mut r) = (DMatrix::zeros(rows, 9), DVector::zeros(rows));
        let mut covariance = DMatrix::identity(rows, rows);
        for (i, record) in records.iter().enumerate() {
            jacobian.view_mut((first(i), 2 * i), (record.r.len(), 2)).copy_from(&record.own.columns(0, 2));
            let shared = record.shared.clone().remove_column(1);
            jacobian.view_mut((first(i), 6), shared.shape()).copy_from(&shared);
            r.rows_mut(first(i), record.r.len()).copy_from(&record.r);
        }
        let mut columns = DMatrix::zeros(rows, 0);
        for (component, size) in components.iter().zip(sizes) {
            for process in &component.processes {
                let mut whole = DMatrix::zeros(rows, process.width);
                for (i, own) in process.records.iter().zip(&process.columns) {
                    whole.view_mut((first(*i), 0), own.shape()).copy_from(&(own * size));
                }
                covariance += &whole * whole.transpose();
                let before = columns.ncols();
                columns = columns.resize_horizontally(before + process.width, 0.0);
                columns.columns_mut(before, process.width).copy_from(&whole);
            }
        }
        let q = jacobian.clone().qr().q();
        let project = DMatrix::identity(rows, rows) - &q * q.transpose();
        let gram = columns.transpose() * &project * &columns;
        let (n, inverse) = (gram.nrows(), covariance.try_inverse().unwrap());
        let whole = DMatrix::identity(n, n) + &gram;
        let normal = (jacobian.transpose() * &inverse * &jacobian).try_inverse().unwrap();
        let weighted = &inverse - &inverse * &jacobian * normal * jacobian.transpose() * &inverse;

        let nested = Nested::new(&records, &components);
        let (ln_determinant, square) = nested.ln_determinant_and_square(&sizes).unwrap();
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-10, "{a} {b}");
        close(ln_determinant, whole.determinant().ln());
        close(square, (r.transpose() * &weighted * &r)[0]);
        let left = weighted * &r;
        for (i, own) in nested.unexplained(&sizes).unwrap().iter().enumerate() {
            assert!((own - left.rows(first(i), own.len())).norm() < 1e-10, "record {i}");
        }
        // What is kept of earlier trials changes nothing.
        let again = |sizes: &[f64]| {
            let (known, anew) = (nested.ln_determinant_and_square(sizes), Nested::new(&records, &components));
            assert_eq!(known, anew.ln_determinant_and_square(sizes));
        };
        for sizes in [[0.7, 0.4, 1.3, 0.3], [0.7, 0.1, 1.3, 0.2], [0.2, 0.4, 1.3, 0.2], [0.7, 0.4, 1.3, 0.2]]
        {
            again(&sizes);
        }
        let explained = (whole.try_inverse().unwrap() * gram).trace();
        assert!((nested.explained(&sizes).unwrap() / explained - 1.0).abs() < 1e-6);
        // Without processes the residuals are those that the unknowns leave.
        let (nothing, square) = nested.ln_determinant_and_square(&[0.0; 4]).unwrap();
        assert!(nothing.abs() < 1e-12);
        close(square, (&project * &r).norm_squared());
        assert!(nested.explained(&[0.0; 4]).unwrap().abs() < 1e-9);
    }

    #[test]
    fn what_is_not_positive_definite_has_no_factors() {
        let root = matrix(5, 5, 3);
        let matrix = DMatrix::identity(5, 5) + &root * root.transpose();
        let factors = Factors::new(matrix.clone()).unwrap();
        assert!((&factors.0 * factors.0.transpose() - &matrix).norm() < 1e-12 * matrix.norm());
        assert!((factors.ln_determinant() - matrix.determinant().ln()).abs() < 1e-12);
        assert!(Factors::new(-matrix).is_none());
    }
}
