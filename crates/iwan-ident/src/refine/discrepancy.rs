//! What the model misses is found out, and what it explains is discounted.

use iwan_machine::threads::in_parallel;
use nalgebra::{DMatrix, DVector};

use super::amplitudes::days;
use super::discount::Discount;
use super::fields::{Component, FINEST, Kind, SPACING};
use super::record::{CLEAN, Noise, Windowed};
use super::ring_down::Discrepancy;
use super::sizes::{Likeliest, Projected};
use super::task::{DAY, FINE, OWN, Task, Workspace, no_ring_down};
use crate::error::Error;
use crate::parameters::{COUNT, Parameter};
use crate::search::{DIRAC, Minimum};

/// Rounds in which the discrepancies' sizes, the noise and the best fit are brought into agreement. With three, ends of searches on measured records were still apart by
/// hundreds in ln likelihood; most agree after four to ten. The best round is taken, also where they are spent.
const ROUNDS: usize = 12;
/// Change of the log likelihood from one round to the next at which they agree.
const AGREED: f64 = 0.1;
/// Size of a discrepancy that is expected before a record is seen, and that searches begin with: dissipation of repeated hits differs by some
/// per cent. Larger ones count as less likely by a factor of e for each time this.
const TYPICAL: f64 = 0.03;
/// Relative residual below which a record is the law's own: what exact steps of the law make leaves 1e-11 and less, twenty sliders in 24 cycles 2e-6, and Newmark's steps of a thousandth
/// of a cycle 6e-8.
const OF_THE_LAW: f64 = 1e-8;
/// Part of dissipation by which a law without macro-slip may be off in a clean record. Joints of twenty sliders released at 0.1 to 0.8 times φ_max look like macro-slip with
/// gains in deviance of up to 26 where 5 % are allowed, half of that with 7 %. Records from 2.3 times φ_max keep no more, those from eight times a gain of 14 in 24 cycles and some 250 in
/// 240: where 25 are asked for these alone tell of macro-slip.
const NO_SLIP: f64 = 0.07;
/// Times by which a discrepancy is far larger than another. Of fifteen hits of the paper's beam, five of each level, one end needed 0.42 and missed 45 % of dissipation, the
/// other needed 0.055 and missed 8 %. Of nine measured records one changes between 1.2 and 1.5: the double beam's sixth hit, which misses 7 % with 1.2 and 10 % with 1.5.
const FAR_MORE: f64 = 1.2;
/// Part of a sum of squares below which another counts as deeper: what is less than half a per cent is a tolerance of the searches.
const DEEPER: f64 = 0.995;
/// Part of the residuals that is taken to be free at least: of fewer no variance can be had.
const LEAST_FREEDOM: f64 = 0.1;

/// Ratios of the noise that goes with the amplitude to the common one that are tried, at the largest amplitude: from one, …
const RATIOS: i32 = 16;
/// … each so many times the one before, to 30,000, which is more than any record's range.
const RATIO_STEP: f64 = 2.0;
/// Gain of the log likelihood below which noise goes not with the amplitude: noise alone reaches it in 2 records of 100.
const GAIN: f64 = 2.0;

/// Records that nothing but a simulation makes: they show no noise, or the minimum leaves none of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Clean {
    /// The law itself made them.
    OfTheLaw,
    /// Something that is nearly the law: sliders in place of the continuum, another program, time steps.
    Nearly,
}

/// What the residuals at a point say about the processes.
struct Found {
    components: Vec<Component>,
    jacobian: DMatrix<f64>,
    residuals: Vec<f64>,
    projected: Projected,
    likeliest: Likeliest,
}

/// A fit with the discrepancies that go with it.
struct Settled {
    task: Task,
    minimum: Minimum,
    /// ln of the restricted likelihood of both, up to a constant.
    likelihood: f64,
    /// The largest discrepancy of dissipation that is found there.
    missed: f64,
}

impl Settled {
    /// The likelier of two ends. But one that needs far more of a discrepancy than the other is none, whatever its likelihood: what all repeats of a hit have in common
    /// beside slow bends, such as the other modes' traces, counts once for each of them, and parameters that follow it leave
    /// the rest to the discrepancy.
    fn or_better(self, other: Self) -> Self {
        let far = |more: &Self, less: &Self| more.missed > TYPICAL && more.missed > FAR_MORE * less.missed;
        let other_wins = far(&self, &other) || (!far(&other, &self) && other.likelihood > self.likelihood);
        if other_wins { other } else { self }
    }
}

/// The likeliest noise of a record whose windows' residuals have such sums of squares (real and imaginary part), of which only a `part` is free.
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

/// The sizes by their names.
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
    /// The minimum next to a rough one, without what the model is found to miss there. `first` is what the curves say.
    pub(crate) fn finished(&mut self, rough: &Minimum, first: &[f64]) -> Result<Minimum, Error> {
        (self.discount, self.by_logarithms) = (None, false);
        self.forget_parts();
        let minimum = self.finish(rough)?;
        let minimum = self.by_other_powers(minimum)?;
        let minimum = self.by_first_samples(minimum)?;
        self.discounted(minimum, &[first])
    }

    /// The minimum again, or a deeper one that searches from other powers find: over a few cycles a small power with a higher frequency looks much the same, and
    /// what it misses would be taken for a discrepancy.
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

    /// Finds out at a minimum what the model misses, discounts it, and goes on to the minimum of what is left. Where it misses anything
    /// the search begins at `others` as well, the curves' parameters and where it has ended before: least squares that know of no discrepancy buy phase at the
    /// price of damping. The best end is taken.
    pub(crate) fn discounted(&mut self, best: Minimum, others: &[&[f64]]) -> Result<Minimum, Error> {
        let mut work = Workspace::default();
        let known = self.by_logarithms;
        (self.discount, self.discrepancy, self.by_logarithms) = (None, Discrepancy::default(), false);
        self.forget_parts();
        let mut best = best;
        if known {
            // Found with another discount: its sum of squares is not that of the residuals as they are.
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

    /// The minimum next to one with the scatter of days that is found there.
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

    /// A point with the mode's frequency where the days' mean is zero, for a search to begin with. Records keep their own frequencies. The sum of squares tells the mean of two or three
    /// days from their scatter by next to nothing, so that without this step the frequency stays near where the search began: two hits at 439.16 Hz had a mode of 437.9 Hz, and half of the dissipation was missed.
    fn on_mean_day(&self, x: &[f64]) -> Vec<f64> {
        let days: Vec<f64> = self.starts_at(x).iter().map(|start| start.day).collect();
        let mut x = x.to_vec();
        if let Some(j) = self.chart.index(Parameter::Frequency).filter(|j| self.free().contains(j)) {
            x[j] += days.iter().sum::<f64>() / days.len() as f64;
        }
        x
    }

    /// Takes over the scatter of the days at a point where the residuals have such derivatives.
    fn take_days(&mut self, x: &[f64], jacobian: &DMatrix<f64>) {
        let days: Vec<f64> = self.starts_at(x).iter().map(|start| start.day).collect();
        if !self.has_days() {
            return;
        }
        // What was taken for granted is the scatter and what is not known of it; the estimate goes on from the scatter.
        let (mut jacobian, unknowns) = (jacobian.clone(), self.seen_at(x));
        let inflated = days::of_few(1.0, days.len());
        jacobian.rows_mut(self.in_windows(), days.len()).scale_mut(inflated);
        let Some(spread) = jacobian.qr().r().try_inverse() else { return };
        let row = |j: usize| unknowns.iter().position(|u| *u == j).map(|k| spread.row(k));
        let mean = self.chart.index(Parameter::Frequency).and_then(row);
        let uncertain = |record: usize| {
            let own = row(COUNT + OWN * record + DAY)?;
            Some(mean.map_or_else(|| own.norm_squared(), |mean| (own - mean).norm_squared()))
        };
        let known = days.iter().map(|day| day * day).sum::<f64>();
        let unknown = (0..days.len()).filter_map(uncertain).sum::<f64>();
        // A step of expectation and maximisation: the mean day is among what is not known, so that the division is by all days.
        let scatter = ((known + unknown) / days.len() as f64).sqrt();
        self.day_deviation = days::of_few(scatter.max(days::LEAST), days.len());
    }

    /// What clean records are; none where samples show noise and the minimum leaves it.
    pub(crate) fn clean(&self, minimum: &Minimum) -> Option<Clean> {
        let residual = self.refined(minimum).relative_residual;
        let clean = residual < CLEAN || self.records.iter().all(Windowed::is_without_noise);
        clean.then_some(if residual < OF_THE_LAW { Clean::OfTheLaw } else { Clean::Nearly })
    }

    /// The task for intervals of clean records, and its minimum next to one: what they cannot show widens the intervals all the same. Where they are not the law's own it may
    /// be off by what is expected of laws, and changes from window to window that no process follows, such as those of a joint of few sliders, are in none of their
    /// windows' noise. Minima are not sought so: what a record of a few cycles tells of the power is next to nothing then.
    pub(crate) fn widened(&self, minimum: &Minimum, clean: Clean) -> Result<(Self, Minimum), Error> {
        let (mut task, minimum) = self.allowing(minimum, clean, |found| {
            let (expected, likeliest) = (found.projected.expected_sizes()?, &found.likeliest.sizes);
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

    /// The same with sizes of the processes by what is found at the minimum; where there are none task and minimum stay as they are.
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

    /// By how much the deviance of a fit without macro-slip falls with macro-slip, where a law without it may miss a little of records that are nearly the law's own; none
    /// where no search ends. A joint of few sliders looks like macro-slip wherever one of them begins to slip.
    pub(crate) fn slip_gains(&self, without: &Minimum, with: &Minimum) -> Result<Option<f64>, Error> {
        // Sizes that are found without macro-slip would explain all of it.
        let sizes = |found: &Found| Some(vec![NO_SLIP; found.components.len()]);
        // The second time what the law may miss is that at the first end, which lies far from the best fit that allows for nothing.
        let near = self.allowing(without, Clean::Nearly, sizes)?.1;
        let (allowing, without) = self.allowing(&near, Clean::Nearly, sizes)?;
        let with = allowing.minimise(&with.x, allowing.free(), FINE, &mut Workspace::default());
        Ok(with.map(|with| without.cost - with.cost))
    }

    /// The unknowns that the records see at a point.
    fn seen_at(&self, x: &[f64]) -> Vec<usize> {
        if self.is_open() && self.is_micro_slip(x) {
            self.smooth().into_iter().filter(|j| *j != DIRAC).collect()
        } else {
            self.free()
        }
    }

    /// Sizes and the fit that goes with them, in turn, from a point on.
    fn settled(mut self, from: &[f64], work: &mut Workspace) -> Option<Settled> {
        self.by_logarithms = true;
        let scales = self.wandering(from, work)?;
        let components = self.components(from, SPACING, work)?;
        let typical = vec![TYPICAL; components.len()];
        self.take(&components, &typical, &scales);
        // The starts of the records alone: sizes and noise are those at the parameters that the search begins with.
        let own = self.free().into_iter().filter(|j| *j >= COUNT).collect();
        let mut minimum = self.minimise(from, own, FINE, work)?;
        let (mut best, mut before) = (None::<Settled>, f64::NEG_INFINITY);
        for round in 0..=ROUNDS {
            let taken = self.clone();
            self.discount = None;
            let found = self.look(&minimum.x, work)?;
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
            minimum = self.minimise(&x, self.seen_at(&x), FINE, work)?;
        }
        best
    }

    /// What the residuals as they are say about the processes.
    fn look(&self, x: &[f64], work: &mut Workspace) -> Option<Found> {
        self.look_at(x, SPACING, work)
    }

    /// The same with nodes so far apart in ln amplitude.
    fn look_at(&self, x: &[f64], spacing: f64, work: &mut Workspace) -> Option<Found> {
        let components = self.components(x, spacing, work)?;
        let (r, jacobian) = self.linearised(x, self.seen_at(x), work)?;
        let processes: Vec<&DMatrix<f64>> = components.iter().map(|c| &c.columns).collect();
        let projected = Projected::new(&jacobian, &r, &processes, TYPICAL);
        let likeliest = projected.sizes()?;
        Some(Found { components, jacobian, residuals: r, projected, likeliest })
    }

    /// Takes over each record's noise, and the discount of processes of such sizes.
    fn take(&mut self, components: &[Component], sizes: &[f64], noise: &[Noise]) {
        let mut columns = DMatrix::zeros(self.count(), components.iter().map(|c| c.columns.ncols()).sum());
        let (mut from, mut row) = (0, 0);
        for (component, size) in components.iter().zip(sizes) {
            let n = component.columns.ncols();
            let even = component.kind == Kind::Even;
            let size = if even { days::of_few(*size, self.records.len()) } else { *size };
            columns.columns_mut(from, n).copy_from(&(&component.columns * size));
            from += n;
        }
        for (record, noise) in self.records.iter_mut().zip(noise) {
            let before = record.deviations.clone();
            record.take_noise(*noise);
            for (before, after) in before.iter().zip(&record.deviations) {
                columns.rows_mut(row, 2).scale_mut(before / after);
                row += 2;
            }
        }
        self.discount = Discount::new(&columns);
        self.discrepancy = named(components, sizes);
    }

    /// Noise of each record: of what neither parameters nor processes explain.
    fn noise(&self, found: &Found) -> Vec<Noise> {
        let mut left = DVector::from_column_slice(&found.residuals);
        let mut from = 0;
        for component in &found.components {
            let n = component.columns.ncols();
            left -= &component.columns * found.likeliest.expected.rows(from, n);
            from += n;
        }
        let unknowns = found.jacobian.ncols() as f64;
        let explained = found.jacobian.clone().qr().q();
        left -= &explained * explained.tr_mul(&left);
        let part = (left.len() as f64 - unknowns - found.likeliest.explained) / left.len() as f64;
        let mut row = 0;
        let of = |record: &Windowed| {
            let squares: Vec<f64> = (0..record.windows.count)
                .map(|k| record.deviations[k].powi(2) * left.rows(row + 2 * k, 2).norm_squared())
                .collect();
            row += 2 * record.windows.count;
            likeliest_noise(record, &squares, part.max(LEAST_FREEDOM))
        };
        self.records.iter().map(of).collect()
    }

    /// The same before anything is known: what the residuals change by from window to window beside an even course.
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
            // A second difference of white noise has six times its variance.
            let square = bends.iter().map(|b| b * b).sum::<f64>() / (6.0 * bends.len().max(1) as f64);
            Noise { floor: (record.noise.floor * square.sqrt()).max(record.floor()), part: 0.0 }
        };
        Some(self.records.iter().map(of).collect())
    }
}
