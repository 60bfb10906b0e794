//! What the model misses is estimated, and the residuals are discounted for it.

use std::ops::Range;

use iwan_machine::threads::in_parallel;
use nalgebra::{DMatrix, DVector};

use super::amplitudes::days;
use super::discount::{Block, Discount};
use super::fields::{Component, FINEST, Kind, SPACING};
use super::nested::OfRecord;
use super::record::{CLEAN, Noise, Windowed};
use super::ring_down::Discrepancy;
use super::sizes::{Likeliest, Sizing};
use super::task::{DAY, FINE, OWN, Task, Workspace, no_ring_down, record_of};
use crate::error::Error;
use crate::parameters::COUNT;
use crate::search::{DIRAC, FREQUENCY, Minimum};

/// Most rounds in which the discrepancies' sizes, the noise and the best fit are brought into agreement. With three, ends of searches on measured
/// records were still apart by hundreds in ln likelihood; most agree after four to ten. The best round is taken, also where all rounds are spent.
const ROUNDS: usize = 12;
/// Change of the log likelihood from one round to the next below which the rounds agree.
const AGREED: f64 = 0.1;
/// Size of a discrepancy, as a standard deviation of ln D, that is expected before a record is seen and that searches begin with: dissipation of
/// repeated hits differs by some per cent. Larger sizes count as less likely, by a factor of e for each multiple of this.
const TYPICAL: f64 = 0.03;
/// Part of dissipation by which a law without macro-slip may be off in a clean record. Joints of twenty sliders released at 0.1 to 0.8 times φ_max
/// look like macro-slip, with gains in deviance of up to 26 where 5 % are allowed and half of that with 7 %. Records released at 2.3 times φ_max keep
/// no larger gain; records released at eight times φ_max keep a gain of 14 in 24 cycles and some 250 in 240 cycles. Where a gain of 25 is asked for,
/// only the last ones tell of macro-slip.
const NO_SLIP: f64 = 0.07;
/// Ratio of two discrepancies from which on the larger one is far larger. Of fifteen hits of the paper's beam, five at each level, one end of the
/// search needed a discrepancy of 0.42 and missed 45 % of dissipation, the other needed 0.055 and missed 8 %. Of nine measured records one changes
/// between ratios of 1.2 and 1.5: the double beam's sixth hit, which misses 7 % with 1.2 and 10 % with 1.5.
const FAR_MORE: f64 = 1.2;
/// Part of a sum of squares below which another one counts as deeper: a difference of less than half a per cent is a tolerance of the searches.
const DEEPER: f64 = 0.995;
/// Least part of the residuals that counts as degrees of freedom: no variance can be estimated from fewer.
const LEAST_FREEDOM: f64 = 0.1;

/// Number of ratios that are tried of the noise that grows with the amplitude to the common noise, at the largest amplitude; the first ratio is one.
const RATIOS: i32 = 16;
/// Factor from one of these ratios to the next. The last one is 30,000, which is more than any record's range.
const RATIO_STEP: f64 = 2.0;
/// Gain of the log likelihood below which noise counts as the same at all amplitudes: noise alone reaches it in 2 records of 100.
const GAIN: f64 = 2.0;

/// The kind of records that only a simulation makes: they show no noise, or the minimum leaves none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Clean {
    /// The law itself made them.
    OfTheLaw,
    /// Something that is nearly the law made them: sliders in place of the continuum, another program, time steps.
    Nearly,
}

/// What the residuals at a point say about the discrepancy processes.
struct Found {
    components: Vec<Component>,
    jacobian: DMatrix<f64>,
    sizing: Sizing,
    likeliest: Likeliest,
}

/// A fit, and the discrepancies found with it.
struct Settled {
    task: Task,
    minimum: Minimum,
    /// ln of the restricted likelihood of fit and discrepancies, up to a constant.
    likelihood: f64,
    /// Size of the discrepancies of ln D that are found at the minimum, all together.
    missed: f64,
}

impl Settled {
    /// The likelier of two ends of searches. But an end that needs a far larger discrepancy than the other one is not taken, whatever its likelihood:
    /// what all repeats of a hit have in common beside slow bends, such as traces of other modes, counts once for each repeat, so that parameters
    /// which follow these traces and leave the rest to the discrepancy look likely.
    fn or_better(self, other: Self) -> Self {
        let far = |more: &Self, less: &Self| more.missed > TYPICAL && more.missed > FAR_MORE * less.missed;
        let other_wins = far(&self, &other) || (!far(&other, &self) && other.likelihood > self.likelihood);
        if other_wins { other } else { self }
    }
}

/// The likeliest noise of a record. `squares` are the sums of squares of each window's residual (real and imaginary part), of which the `part` is
/// degrees of freedom.
fn likeliest_noise(record: &Windowed, squares: &[f64], part: f64) -> Noise {
    let freedom = 2.0 * squares.len() as f64 * part;
    let of = |ratio: f64| {
        let variances = || record.white.iter().map(|z| 1.0 + (ratio * z.norm()).powi(2));
        let mean = squares.iter().zip(variances()).map(|(s, v)| s / v).sum::<f64>() / freedom;
        let likelihood = -0.5 * freedom * mean.ln() - variances().map(f64::ln).sum::<f64>();
        (likelihood, mean.sqrt())
    };
    let loudest = record.white.iter().map(|z| z.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let plain = of(0.0);
    let ratios = (0..RATIOS).map(|i| RATIO_STEP.powi(i) / loudest);
    let best = ratios.map(|ratio| (of(ratio), ratio)).max_by(|a, b| a.0.0.total_cmp(&b.0.0));
    let (floor, ratio) = match best {
        Some(((likelihood, floor), ratio)) if likelihood > plain.0 + GAIN => (floor, ratio),
        _ => (plain.1, 0.0),
    };
    Noise { floor: floor.max(record.floor()), part: ratio * floor }
}

/// The processes' sizes as a discrepancy.
fn named(components: &[Component], sizes: &[f64]) -> Discrepancy {
    let mut all = Discrepancy::default();
    for (Component { kind, shift, .. }, size) in components.iter().zip(sizes) {
        match kind {
            Kind::Shared => (all.dissipation, all.frequency) = (*size, shift * size),
            Kind::OfLevel => (all.dissipation_of_level, all.frequency_of_level) = (*size, shift * size),
            Kind::OfRecord | Kind::Even => {
                all.dissipation_of_record = all.dissipation_of_record.hypot(*size);
                all.frequency_of_record = all.frequency_of_record.hypot(shift * size);
            }
        }
    }
    all
}

impl Task {
    /// The minimum next to a rough one, with a discount for what the model is found to miss there. `first` are the coordinates of the parameters that
    /// the curves give.
    pub(crate) fn finished(&mut self, rough: &Minimum, first: &[f64]) -> Result<Minimum, Error> {
        (self.discount, self.by_logarithms) = (None, false);
        self.forget_parts();
        let minimum = self.finish(rough)?;
        let minimum = self.by_other_powers(minimum)?;
        let minimum = self.by_first_samples(minimum)?;
        self.discounted(minimum, &[first])
    }

    /// The minimum again, or a deeper one that searches from other powers χ find: over a few cycles a small power with a higher frequency looks much
    /// the same, and what such a fit misses would be taken for a discrepancy.
    fn by_other_powers(&mut self, minimum: Minimum) -> Result<Minimum, Error> {
        let seen = self.seen_at(&minimum.x);
        let others = self.other_powers(&minimum.x);
        let end = |x: &Vec<f64>| self.minimise(x, seen.clone(), FINE, &mut Workspace::default());
        let found = in_parallel(&others, others.len(), &end).into_iter().flatten();
        match found.min_by(|a, b| a.cost.total_cmp(&b.cost)).filter(|m| m.cost < DEEPER * minimum.cost) {
            Some(deeper) => self.finish(&deeper),
            None => Ok(minimum),
        }
    }

    /// Estimates at a minimum what the model misses, discounts the residuals for it, and goes on to the minimum of what is left. Where the model
    /// misses anything the search begins at `others` as well (the curves' parameters, and where the search has ended before): least squares that know
    /// of no discrepancy buy phase at the price of damping. The best end is taken.
    pub(crate) fn discounted(&mut self, best: Minimum, others: &[&[f64]]) -> Result<Minimum, Error> {
        let mut work = Workspace::default();
        let known = self.by_logarithms;
        (self.discount, self.discrepancy, self.by_logarithms) = (None, Discrepancy::default(), false);
        self.forget_parts();
        let mut best = best;
        if known {
            // This point was found with another discount, so that its sum of squares is not that of the residuals as they are.
            self.weigh(&best.x, &mut work);
            best = self.minimise(&best.x, self.seen_at(&best.x), FINE, &mut work).ok_or_else(no_ring_down)?;
        }
        let nothing = |found: &Found| found.likeliest.sizes.iter().all(|s| *s == 0.0);
        let found = self.look(&best.x, &mut work);
        if found.as_ref().is_none_or(nothing) {
            return self.with_days(best, found.as_ref(), &mut work).ok_or_else(no_ring_down);
        }
        let settle = |x: &&[f64]| self.clone().settled(x, &mut Workspace::default());
        let starts: Vec<&[f64]> = [best.x.as_slice()].into_iter().chain(others.iter().copied()).collect();
        let ends = in_parallel(&starts, starts.len(), &settle).into_iter().flatten();
        let Settled { task, minimum, .. } = ends.reduce(Settled::or_better).ok_or_else(no_ring_down)?;
        *self = task;
        Ok(minimum)
    }

    /// The minimum next to `best`, with the scatter of days that is found there; `best` itself where records have no days.
    fn with_days(&mut self, best: Minimum, found: Option<&Found>, work: &mut Workspace) -> Option<Minimum> {
        if !self.has_days() {
            return Some(best);
        }
        let x = self.on_mean_day(&best.x);
        if let Some(found) = found {
            self.take_days(&x, &found.jacobian);
        }
        self.minimise(&x, self.seen_at(&x), FINE, work)
    }

    /// A point for a search to begin with: `x` with the mode's frequency moved so that the mean of the days is zero; records keep their own
    /// frequencies. The sum of squares hardly tells the mean of two or three days from their scatter, so that without this step the frequency stays
    /// near where the search began: two hits at 439.16 Hz had a mode of 437.9 Hz, and half of the dissipation was missed.
    fn on_mean_day(&self, x: &[f64]) -> Vec<f64> {
        let days: Vec<f64> = self.starts_at(x).iter().map(|start| start.day).collect();
        let mut x = x.to_vec();
        if self.free().contains(&FREQUENCY) {
            x[FREQUENCY] += days.iter().sum::<f64>() / days.len() as f64;
        }
        x
    }

    /// Takes over the scatter of the days at the point `x`, where the residuals have the derivatives `jacobian`.
    fn take_days(&mut self, x: &[f64], jacobian: &DMatrix<f64>) {
        let days: Vec<f64> = self.starts_at(x).iter().map(|start| start.day).collect();
        if !self.has_days() {
            return;
        }
        // The deviation taken for granted was the scatter, widened for few records; the estimate goes on from the scatter itself.
        let (mut jacobian, unknowns) = (jacobian.clone(), self.seen_at(x));
        let inflated = days::of_few(1.0, days.len());
        jacobian.rows_mut(self.in_windows(), days.len()).scale_mut(inflated);
        let Some(spread) = jacobian.qr().r().try_inverse() else { return };
        let row = |j: usize| unknowns.iter().position(|u| *u == j).map(|k| spread.row(k));
        let mean = row(FREQUENCY);
        let uncertain = |record: usize| {
            let own = row(COUNT + OWN * record + DAY)?;
            Some(mean.map_or_else(|| own.norm_squared(), |mean| (own - mean).norm_squared()))
        };
        let known = days.iter().map(|day| day * day).sum::<f64>();
        let unknown = (0..days.len()).filter_map(uncertain).sum::<f64>();
        // A step of expectation and maximisation: the mean of the days is among the unknowns, so that the division is by the number of all days.
        let scatter = ((known + unknown) / days.len() as f64).sqrt();
        self.day_deviation = days::of_few(scatter.max(days::LEAST), days.len());
    }

    /// Whether the samples of all records show so little noise that they can only come from simulations.
    pub(super) fn shows_no_noise(&self) -> bool {
        self.records.iter().all(Windowed::is_without_noise)
    }

    /// The kind of clean records that these are; none where samples show noise and the minimum leaves it.
    pub(crate) fn clean(&self, minimum: &Minimum) -> Option<Clean> {
        let refined = self.refined(minimum);
        let clean = refined.relative_residual < CLEAN || self.shows_no_noise();
        clean.then_some(if refined.is_of_the_law() { Clean::OfTheLaw } else { Clean::Nearly })
    }

    /// The task for intervals of clean records, and its minimum next to `minimum`: what clean records cannot show widens their intervals all the
    /// same. Where the law itself did not make them, it may be off by what is expected of laws; and changes from window to window that no process
    /// follows, such as those of a joint of few sliders, are not in the windows' noise, which is therefore raised. Best fits are not sought with this
    /// allowance: in a record of a few cycles next to nothing would be left that tells χ.
    pub(crate) fn widened(&self, minimum: &Minimum, clean: Clean) -> Result<(Self, Minimum), Error> {
        let (mut task, minimum) = self.allowing(minimum, clean, |found| {
            let (expected, likeliest) = (found.sizing.expected_sizes()?, &found.likeliest.sizes);
            let one = |((c, e), l): ((&Component, f64), &f64)| match c.kind {
                Kind::Even => *l,
                Kind::Shared if clean == Clean::Nearly => e.max(*l).max(TYPICAL),
                Kind::Shared | Kind::OfLevel | Kind::OfRecord => e,
            };
            Some(found.components.iter().zip(expected).zip(likeliest).map(one).collect())
        })?;
        if clean == Clean::OfTheLaw {
            task.discrepancy.allowed = 0.0;
        }
        Ok((task, minimum))
    }

    /// The task and its minimum with processes of the given `sizes`, by what is found at the minimum; both stay as they are where nothing is found.
    fn allowing(
        &self,
        minimum: &Minimum,
        clean: Clean,
        sizes: impl FnOnce(&Found) -> Option<Vec<f64>>,
    ) -> Result<(Self, Minimum), Error> {
        let (spacing, least) = match clean {
            Clean::OfTheLaw => (SPACING, 0.0),
            Clean::Nearly => ((FINEST * self.records.len() as f64).min(SPACING), CLEAN),
        };
        let (mut task, mut work) = (self.clone(), Workspace::default());
        (task.discount, task.by_logarithms) = (None, false);
        task.forget_parts();
        let found = task.look_at(&minimum.x, spacing, &mut work);
        let Some((found, sizes)) = found.and_then(|found| sizes(&found).map(|sizes| (found, sizes))) else {
            return Ok((self.clone(), minimum.clone()));
        };
        let no_less = |noise: Noise| Noise { part: noise.part.max(least), ..noise };
        let scales: Vec<Noise> = task.noise(&found).into_iter().map(no_less).collect();
        task.take(&found.components, &sizes, &scales);
        let shared = found.components.iter().zip(&sizes).find(|(c, _)| c.kind == Kind::Shared);
        let allowed = shared.map_or(0.0, |(_, size)| *size);
        (task.discrepancy, task.widened) = (Discrepancy { allowed, ..self.discrepancy }, true);
        let seen = task.seen_at(&minimum.x);
        let minimum = task.minimise(&minimum.x, seen, FINE, &mut work).ok_or_else(no_ring_down)?;
        Ok((task, minimum))
    }

    /// By how much the deviance of a fit without macro-slip falls with macro-slip, where the law without it may miss a little (`NO_SLIP`) of records
    /// that are nearly the law's own; none where no search ends. Without this allowance a joint of few sliders looks like macro-slip wherever one of
    /// the sliders begins to slip.
    pub(crate) fn slip_gains(&self, without: &Minimum, with: &Minimum) -> Result<Option<f64>, Error> {
        // Sizes that are found without macro-slip would explain all of the gain.
        let sizes = |found: &Found| Some(vec![NO_SLIP; found.components.len()]);
        // The second round takes the allowance at the end of the first, which lies far from the best fit without any allowance.
        let near = self.allowing(without, Clean::Nearly, sizes)?.1;
        let (allowing, without) = self.allowing(&near, Clean::Nearly, sizes)?;
        let with = allowing.minimise(&with.x, allowing.free(), FINE, &mut Workspace::default());
        Ok(with.map(|with| without.cost - with.cost))
    }

    /// The unknowns that the records see at a point: without macro-slip neither the knee nor the Dirac.
    fn seen_at(&self, x: &[f64]) -> Vec<usize> {
        if self.is_open() && self.is_micro_slip(x) {
            self.smooth().into_iter().filter(|j| *j != DIRAC).collect()
        } else {
            self.free()
        }
    }

    /// Estimates the sizes of the discrepancies and the fit that goes with them in turn, beginning at a point.
    fn settled(mut self, from: &[f64], work: &mut Workspace) -> Option<Settled> {
        self.by_logarithms = true;
        let scales = self.wandering(from, work)?;
        let components = self.components(from, SPACING, work)?;
        let typical = vec![TYPICAL; components.len()];
        self.take(&components, &typical, &scales);
        // Only the records' own unknowns are sought here: sizes and noise are those at the parameters that the search begins with.
        let own = self.free().into_iter().filter(|j| *j >= COUNT).collect();
        let mut minimum = self.minimise(from, own, FINE, work)?;
        let (mut best, mut before) = (None::<Settled>, f64::NEG_INFINITY);
        for round in 0..=ROUNDS {
            let taken = self.clone();
            self.discount = None;
            // Where nothing can be looked at any more, the best of the rounds before stands.
            let Some(found) = self.look(&minimum.x, work) else { break };
            if round > 0 {
                let unit = |r: &Windowed| 2.0 * r.deviations.iter().map(|d| d.ln()).sum::<f64>();
                let likelihood = found.likeliest.likelihood - self.records.iter().map(unit).sum::<f64>();
                let missed = named(&found.components, &found.likeliest.sizes).of_dissipation();
                let this = Settled { task: taken, minimum: minimum.clone(), likelihood, missed };
                best = Some(match best {
                    Some(best) => best.or_better(this),
                    None => this,
                });
                if (likelihood - before).abs() < AGREED {
                    break;
                }
                before = likelihood;
            }
            let scales = self.noise(&found);
            self.take(&found.components, &found.likeliest.sizes, &scales);
            let x = self.on_mean_day(&minimum.x);
            self.take_days(&x, &found.jacobian);
            let Some(next) = self.minimise(&x, self.seen_at(&x), FINE, work) else { break };
            minimum = next;
        }
        best
    }

    /// What the residuals at a point, as they are without a discount, say about the processes.
    fn look(&self, x: &[f64], work: &mut Workspace) -> Option<Found> {
        self.look_at(x, SPACING, work)
    }

    /// What the residuals at a point say about processes with nodes `spacing` apart in ln amplitude.
    fn look_at(&self, x: &[f64], spacing: f64, work: &mut Workspace) -> Option<Found> {
        let components = self.components(x, spacing, work)?;
        let unknowns = self.seen_at(x);
        let (r, jacobian) = self.linearised(x, unknowns.clone(), work)?;
        let records = self.by_record(&unknowns, &jacobian, &r);
        let freedom = (r.len() - jacobian.ncols()) as f64;
        let sizing = Sizing::new(&records, &components, freedom, TYPICAL);
        let likeliest = sizing.sizes()?;
        Some(Found { components, jacobian, sizing, likeliest })
    }

    /// Residuals and their derivatives with respect to some unknowns, record by record: those in windows, then that of the day.
    fn by_record(&self, unknowns: &[usize], jacobian: &DMatrix<f64>, r: &[f64]) -> Vec<OfRecord> {
        let one = |(place, windows): (usize, Range<usize>)| {
            let rows: Vec<usize> = windows.chain(self.row_of_day(place)).collect();
            let columns = |own: Option<usize>| -> Vec<usize> {
                (0..unknowns.len()).filter(|k| record_of(unknowns[*k]) == own).collect()
            };
            let part = |own| jacobian.select_columns(&columns(own)).select_rows(&rows);
            OfRecord {
                r: DVector::from_iterator(rows.len(), rows.iter().map(|row| r[*row])),
                own: part(Some(place)),
                shared: part(None),
            }
        };
        self.rows().into_iter().enumerate().map(one).collect()
    }

    /// Takes over each record's noise, and the discount for processes of the given sizes.
    fn take(&mut self, components: &[Component], sizes: &[f64], noise: &[Noise]) {
        // By how much residuals change with the noise that they are divided by, two rows a window.
        let mut scales: Vec<Vec<f64>> = vec![];
        for (record, noise) in self.records.iter_mut().zip(noise) {
            let before = record.deviations.clone();
            record.take_noise(*noise);
            let both = before.iter().zip(&record.deviations).flat_map(|(b, a)| [b / a; 2]);
            scales.push(both.collect());
        }
        let (rows, mut blocks) = (self.rows(), vec![]);
        // From the processes of single records to those that all share.
        for (component, size) in components.iter().zip(sizes).rev() {
            let even = component.kind == Kind::Even;
            let size = if even { days::of_few(*size, self.records.len()) } else { *size };
            for process in &component.processes {
                let count: usize = process.columns.iter().map(DMatrix::nrows).sum();
                let mut columns = DMatrix::zeros(count, process.width);
                let mut from = 0;
                for (record, own) in process.records.iter().zip(&process.columns) {
                    for (row, scale) in scales[*record].iter().enumerate() {
                        columns.set_row(from + row, &(own.row(row) * (size * scale)));
                    }
                    from += own.nrows();
                }
                let rows = process.records.iter().map(|record| rows[*record].clone()).collect();
                blocks.push(Block { rows, columns });
            }
        }
        self.discount = Discount::new(self.count(), blocks);
        self.discrepancy = named(components, sizes);
    }

    /// The noise of each record, estimated from what neither parameters nor processes explain.
    fn noise(&self, found: &Found) -> Vec<Noise> {
        let Likeliest { unexplained, explained, .. } = &found.likeliest;
        let (count, unknowns) = (self.count() as f64, found.jacobian.ncols() as f64);
        let part = (count - unknowns - explained) / count;
        let of = |(record, left): (&Windowed, &DVector<f64>)| {
            let squares: Vec<f64> = (0..record.windows.count)
                .map(|k| record.deviations[k].powi(2) * left.rows(2 * k, 2).norm_squared())
                .collect();
            likeliest_noise(record, &squares, part.max(LEAST_FREEDOM))
        };
        self.records.iter().zip(unexplained).map(of).collect()
    }

    /// The noise of each record before any size is known, estimated from second differences of the residuals from window to window, in which a slow
    /// course is left out.
    fn wandering(&self, x: &[f64], work: &mut Workspace) -> Option<Vec<Noise>> {
        let mut r = vec![0.0; self.count()];
        if !self.residuals(x, &mut r, work) {
            return None;
        }
        let mut row = 0;
        let of = |record: &Windowed| {
            let part = &r[row..row + 2 * record.windows.count];
            row += part.len();
            let bends: Vec<f64> = (0..part.len().saturating_sub(4))
                .map(|i| part[i] - 2.0 * part[i + 2] + part[i + 4])
                .collect();
            // A second difference of white noise has six times the variance of the noise.
            let square = bends.iter().map(|b| b * b).sum::<f64>() / (6.0 * bends.len().max(1) as f64);
            Noise { floor: (record.noise.floor * square.sqrt()).max(record.floor()), part: 0.0 }
        };
        Some(self.records.iter().map(of).collect())
    }
}
