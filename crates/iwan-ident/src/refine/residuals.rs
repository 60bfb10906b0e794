//! What searches compare: residuals of the records, the derivatives of the residuals, and searches over them.
//!
//! Derivatives are finite differences. An unknown that belongs to one record changes the residuals of that record only, so that a joint fit of many
//! records costs little more for such unknowns than for the parameters that all records share.

use std::f64::consts::TAU;
use std::ops::Range;
use std::sync::atomic::Ordering;

use iwan_machine::threads::both_where_idle;
use nalgebra::DMatrix;
use rustfft::num_complex::Complex64;

use super::amplitudes::days;
use super::record::{Windowed, unwrapped};
use super::release::TurningPoint;
use super::task::{Effort, Task, Workspace, record_of};
use crate::parameters::Parameters;
use crate::search::{Minimum, Problem, Search};

/// The form in which record and model are compared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// Whitened amplitudes, divided by their standard deviations.
    Whitened,
    /// Log amplitudes and unwrapped phases, weighted by amplitude: for first searches, which must not lose a cycle.
    Logarithms,
}

/// The residuals of the records as a least-squares problem.
pub(crate) struct OfRecords<'a> {
    task: &'a Task,
    kind: Kind,
    /// Whether differences are central.
    central: bool,
    work: &'a mut Workspace,
}

impl Problem for OfRecords<'_> {
    fn residuals(&mut self, x: &[f64], out: &mut [f64]) -> bool {
        match self.kind {
            Kind::Whitened => self.task.residuals(x, out, self.work),
            Kind::Logarithms => self.task.all_records(self.kind, x, out, self.work),
        }
    }

    fn derivatives(&mut self, x: &[f64], free: &[usize]) -> Option<DMatrix<f64>> {
        let (task, count) = (self.task, self.task.count());
        let mut base = vec![0.0; count];
        task.all_records(self.kind, x, &mut base, self.work).then_some(())?;
        let mut out = DMatrix::zeros(count, free.len());
        let columns = free.iter().copied().zip(out.as_mut_slice().chunks_mut(count));
        let (own, shared): (Vec<_>, Vec<_>) = columns.partition(|(j, _)| record_of(*j).is_some());
        let differences =
            Differences { task, kind: self.kind, central: self.central, x, base: &base, rows: &task.rows() };
        // Own unknowns leave the mode as it is, so that all of their models come from one table; each unknown that the records share has a mode and a table of its own.
        let mut aside = self.work.aside.take().unwrap_or_default();
        let (own, shared) =
            both_where_idle(|| differences.put(own, &mut *self.work), || differences.put(shared, &mut aside));
        self.work.aside = Some(aside);
        (own.is_some() && shared.is_some()).then_some(())?;
        if let (Some(discount), Kind::Whitened) = (&task.discount, self.kind) {
            discount.apply_to_columns(&mut out);
        }
        out.iter().all(|d| d.is_finite()).then_some(out)
    }
}

/// Derivatives of the residuals at a point, without a discount.
struct Differences<'a> {
    task: &'a Task,
    kind: Kind,
    /// Whether differences are central.
    central: bool,
    /// The point, and the residuals there.
    x: &'a [f64],
    base: &'a [f64],
    /// Rows of each record.
    rows: &'a [Range<usize>],
}

impl Differences<'_> {
    /// Puts derivatives into columns of zeros, each given with its coordinate; none where there are none.
    fn put(&self, columns: Vec<(usize, &mut [f64])>, work: &mut Workspace) -> Option<()> {
        let Self { task, kind, central, x, base, rows } = *self;
        let bounds = task.bounds();
        let (mut above, mut below) = (base.to_vec(), base.to_vec());
        let mut moved = x.to_vec();
        for (j, column) in columns {
            let own = record_of(j);
            let mut at = |place: f64, out: &mut [f64]| {
                moved[j] = place;
                let known = match own {
                    Some(own) => task.one_record(kind, &moved, own, (&rows[own], out), work),
                    None => task.all_records(kind, &moved, out, work),
                };
                moved[j] = x[j];
                known.then_some(())
            };
            let [mut from, mut to] = Search::apart(x[j], bounds[j], central);
            if at(to, &mut above).is_none() {
                // Next to the edge of what a model can be there is one on the other side only.
                above.copy_from_slice(base);
                [from, to] = Search::apart(x[j], (bounds[j].0, x[j]), central);
                at(to, &mut above)?;
            } else if from != x[j] && at(from, &mut below).is_none() {
                below.copy_from_slice(base);
                from = x[j];
            }
            let mut differ = |rows: Range<usize>| {
                for i in rows {
                    column[i] = (above[i] - below[i]) / (to - from);
                    (above[i], below[i]) = (base[i], base[i]);
                }
            };
            match own {
                Some(own) => {
                    differ(rows[own].clone());
                    differ(task.row_of_day(own));
                }
                None => differ(0..base.len()),
            }
        }
        Some(())
    }
}

impl Task {
    /// The residuals as a least-squares problem, with the derivatives that the search wants.
    pub(super) fn problem<'a>(
        &'a self,
        kind: Kind,
        search: &Search,
        work: &'a mut Workspace,
    ) -> OfRecords<'a> {
        OfRecords { task: self, kind, central: search.is_central(), work }
    }

    /// Whitened residuals over their standard deviations, with the discount for what the model is known to miss; false where there is no model.
    pub(crate) fn residuals(&self, x: &[f64], out: &mut [f64], work: &mut Workspace) -> bool {
        let starts = self.starts_at(x);
        self.chart.leaves_residual_stiffness(x)
            && self.residuals_of(&self.chart.parameters(x), &starts, out, work)
    }

    /// Whitened residuals over their standard deviations, with the discount, for given parameters and turning points of the records.
    pub(crate) fn residuals_of(
        &self,
        parameters: &Parameters,
        starts: &[TurningPoint],
        out: &mut [f64],
        work: &mut Workspace,
    ) -> bool {
        let known = self.plain_residuals(parameters, starts, out, work);
        if let Some(discount) = self.discount.as_ref().filter(|_| known) {
            discount.apply(out);
        }
        known
    }

    /// Whitened residuals over their standard deviations, without a discount.
    pub(super) fn plain_residuals(
        &self,
        parameters: &Parameters,
        starts: &[TurningPoint],
        out: &mut [f64],
        work: &mut Workspace,
    ) -> bool {
        let one = |(place, rows): (usize, &Range<usize>)| {
            let known = self.model_of(place, parameters, starts[place], work);
            known && {
                self.compare(Kind::Whitened, place, &mut work.model, &mut out[rows.clone()]);
                self.of_day(place, starts[place], out);
                true
            }
        };
        self.rows().iter().enumerate().all(one)
    }

    /// Residuals of all records at the coordinates `x`, without a discount.
    fn all_records(&self, kind: Kind, x: &[f64], out: &mut [f64], work: &mut Workspace) -> bool {
        out.fill(0.0);
        (kind == Kind::Logarithms || self.chart.leaves_residual_stiffness(x))
            && self
                .rows()
                .iter()
                .enumerate()
                .all(|(place, rows)| self.one_record(kind, x, place, (rows, out), work))
    }

    /// Residuals of record number `place`, into its rows and the row of its day.
    fn one_record(
        &self,
        kind: Kind,
        x: &[f64],
        place: usize,
        (rows, out): (&Range<usize>, &mut [f64]),
        work: &mut Workspace,
    ) -> bool {
        let (parameters, start) = (self.chart.parameters(x), self.start_at(x, place));
        let known = self.model_of(place, &parameters, start, work);
        if known {
            self.compare(kind, place, &mut work.model, &mut out[rows.clone()]);
            self.of_day(place, start, out);
        }
        known
    }

    /// Rows of each record's residuals in windows, two per window.
    pub(super) fn rows(&self) -> Vec<Range<usize>> {
        let mut from = 0;
        let one = |record: &Windowed| {
            let rows = from..from + 2 * record.windows.count;
            from = rows.end;
            rows
        };
        self.records.iter().map(one).collect()
    }

    /// The row, after the residuals in windows, of the residual that holds a record's day to the scatter taken for granted; empty where records do
    /// not differ by the day.
    pub(super) fn row_of_day(&self, place: usize) -> Range<usize> {
        let row = self.in_windows() + place;
        if self.has_days() { row..row + 1 } else { 0..0 }
    }

    fn of_day(&self, place: usize, start: TurningPoint, out: &mut [f64]) {
        out[self.row_of_day(place)].fill(start.day / self.day_deviation);
    }

    /// Residuals of record number `place` against the amplitudes of a model, which serve as a buffer.
    fn compare(&self, kind: Kind, place: usize, model: &mut [Complex64], out: &mut [f64]) {
        let record = &self.records[place];
        match kind {
            Kind::Whitened => {
                if self.by_logarithms {
                    record.ratios(model);
                } else {
                    record.amplitudes.iter().zip(model.iter_mut()).for_each(|(z, m)| *m = z - *m);
                }
                record.whitening.apply(model);
                let left = model.iter().zip(&record.deviations).map(|(r, deviation)| r / deviation);
                out.chunks_exact_mut(2).zip(left).for_each(|(o, r)| (o[0], o[1]) = (r.re, r.im));
            }
            Kind::Logarithms => {
                out.fill(0.0);
                let loudest = record.amplitudes.iter().map(|z| z.norm()).fold(0.0, f64::max);
                let loud =
                    record.amplitudes.iter().zip(unwrapped(&record.amplitudes, model)).take(record.loud());
                for ((z, log), o) in loud.zip(out.chunks_exact_mut(2)) {
                    let weight = z.norm() / loudest;
                    (o[0], o[1]) = (weight * log.re, weight * log.im);
                }
            }
        }
    }

    /// Puts the model's amplitudes in the windows of record number `place` into the workspace; false where there is no model, or the search was
    /// stopped.
    fn model_of(
        &self,
        place: usize,
        parameters: &Parameters,
        start: TurningPoint,
        work: &mut Workspace,
    ) -> bool {
        if self.stopped.load(Ordering::Relaxed) {
            return false;
        }
        let record = &self.records[place];
        // A day only turns the phases of amplitudes that are known, so that it needs no ring-down of its own.
        let found = work.compute(place, parameters, start.on_mean_day(), record);
        if found {
            let model = &mut work.model;
            model.iter_mut().zip(&record.sampling).for_each(|(m, s)| *m += s);
            days::turn(model, &record.windows, TAU * parameters.frequency, start.day);
        }
        found
    }

    /// The model's amplitudes in the windows, one vector per record; none where there is no model.
    pub(super) fn models(&self, x: &[f64], work: &mut Workspace) -> Option<Vec<Vec<Complex64>>> {
        let parameters = self.chart.parameters(x);
        let mut one = |(place, start): (usize, &TurningPoint)| {
            self.model_of(place, &parameters, *start, work).then(|| work.model.clone())
        };
        self.starts_at(x).iter().enumerate().map(&mut one).collect()
    }

    /// Sum of squares of the whitened residuals, with the discount; none where there is no model.
    pub(crate) fn cost(&self, x: &[f64], work: &mut Workspace) -> Option<f64> {
        let mut out = vec![0.0; self.count()];
        let cost = self.residuals(x, &mut out, work).then(|| out.iter().map(|r| r * r).sum::<f64>());
        cost.filter(|c| c.is_finite())
    }

    /// Residuals at a point, and their derivatives with respect to the coordinates in `free`, one column each; none where there is no model.
    pub(crate) fn linearised(
        &self,
        x: &[f64],
        free: Vec<usize>,
        work: &mut Workspace,
    ) -> Option<(Vec<f64>, DMatrix<f64>)> {
        let mut r = vec![0.0; self.count()];
        self.residuals(x, &mut r, work).then_some(())?;
        let search = self.search(free, Effort::NONE);
        let slopes = self.problem(Kind::Whitened, &search, work).derivatives(x, &search.free)?;
        Some((r, slopes))
    }

    /// The least whitened sum of squares from `x` over the coordinates in `free`. The search ends when an iteration brings less than the relative
    /// `tolerance`.
    pub(crate) fn minimise(
        &self,
        x: &[f64],
        free: Vec<usize>,
        tolerance: f64,
        work: &mut Workspace,
    ) -> Option<Minimum> {
        self.minimise_with(x, free, Effort::until(tolerance), work)
    }

    /// The least whitened sum of squares over the coordinates in `free` that a search of this effort finds from `x`.
    pub(crate) fn minimise_with(
        &self,
        x: &[f64],
        free: Vec<usize>,
        effort: Effort,
        work: &mut Workspace,
    ) -> Option<Minimum> {
        self.seek(Kind::Whitened, x, &self.search(free, effort), work)
    }

    /// Where a search over residuals of a kind ends.
    pub(super) fn seek(
        &self,
        kind: Kind,
        x: &[f64],
        search: &Search,
        work: &mut Workspace,
    ) -> Option<Minimum> {
        search.run(&mut self.problem(kind, search, work), x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curves::Quantity;
    use crate::refine::RingDown;
    use crate::search::SOFTENING;

    #[test]
    fn next_to_the_edge_of_what_a_model_can_be_there_are_derivatives() {
        let (dt, frequency) = (2e-4, 124.0);
        let decay = |n: usize| {
            let t = n as f64 * dt;
            (-3.0 * t).exp() * (TAU * frequency * t).cos()
        };
        let samples: Vec<f64> = (0..4000).map(decay).collect();
        let record =
            RingDown { samples: &samples, dt, quantity: Quantity::Displacement, band: None, beside: None };
        let first =
            Parameters { frequency, damping_ratio: 1e-3, k_t: 4.45e5, f_s: 1e6, chi: -0.2, beta: 0.3 };
        let task = Task::new(&[record], &first, &[]).unwrap();
        let mut x = task.coordinates(&first).unwrap();
        let work = &mut Workspace::default();
        let below = |x: &[f64], part: f64| {
            let mut x = x.to_vec();
            x[SOFTENING] += task.chart.stiffness_up_to(&x, part).ln();
            x
        };
        // A step of the differences away there is no residual stiffness any more.
        x = below(&x, 0.999 - 1e-6);
        assert!(task.cost(&x, work).is_some() && task.cost(&below(&x, 0.999 + 1e-6), work).is_none());
        let central = Search { central: true, ..task.search(task.free(), Effort::ROUGH) };
        for search in [task.search(task.free(), Effort::ROUGH), central] {
            let slopes = task.problem(Kind::Whitened, &search, work).derivatives(&x, &search.free).unwrap();
            let away = 1e-3;
            let mut inside = x.clone();
            inside[SOFTENING] -= away;
            let mut r = [(); 2].map(|()| vec![0.0; task.count()]);
            assert!(task.residuals(&x, &mut r[0], work) && task.residuals(&inside, &mut r[1], work));
            let place = search.free.iter().position(|j| *j == SOFTENING).unwrap();
            let secant = r[0].iter().zip(&r[1]).map(|(a, b)| (a - b) / away);
            let column = slopes.column(place);
            let off = secant.zip(&column).map(|(s, c)| (s - c).powi(2)).sum::<f64>().sqrt();
            assert!(off < 0.05 * column.norm(), "{off} {}", column.norm());
        }
    }
}
