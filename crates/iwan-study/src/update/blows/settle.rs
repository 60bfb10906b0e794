//! The search for joints from blows: windows that grow, weights from the residuals, intervals, and which of their ends the blows support.

use iwan_ident::estimate::{About, Found, Interval, Model, Told, Weights, intervals, near, silent};

use super::rings::{Rings, root_mean_square};
use super::straight::Straight;
use crate::error::Error;
use crate::update::fitted::{ENDS, NORMAL, holding};

/// Stages of the search: share of each blow that is used, effort of the search (iterations, relative reduction) from each point, and number of points
/// kept for the next stage. A mode that is slightly off in frequency runs out of phase within a long record, where every start would end at a minimum
/// of its own.
const WINDOWS: [(f64, (usize, f64), usize); 3] =
    [(0.1, (12, 1e-3), 2), (0.3, (12, 1e-3), 1), (1.0, (30, 1e-3), 1)];
/// Number of starts from which a search begins: those with the smallest residuals in the first stage. Not varied.
const SEARCHED: usize = 3;
/// Iterations and relative reduction of the search whose residuals give the weight of each gate; weights need an accuracy of a per cent.
const FOR_WEIGHTS: (usize, f64) = (12, 1e-3);
/// Iterations and relative reduction of the last search. A reduction of 1e-5 of the sum of squares of some hundred residuals is a thousandth of the
/// deviance at which a 95 % interval ends, and so a fifteenth of a standard deviation.
const LAST: (usize, f64) = (40, 1e-5);
/// Residuals whose correlation between neighbours inflates variances by less than this count as noise; Hann windows that overlap by half inflate by
/// 1.4.
const WHITE: f64 = 2.0;
/// Factor on the change that finer steps make: this much counts as the steps' remaining error elsewhere, so that intervals do not shrink to nothing
/// in records without noise. A judgement.
const STILL_STEPPING: f64 = 1.0;
/// Standard deviation of an unknown by the computation itself, in its coordinate (for K_T and F_S the logarithm). The reduced model, steps and
/// sliders differ from those of the record; they put K_T, F_S and χ of configuration A off by 5e-4 to 1.3e-3, where noise alone would make 2e-4. No
/// interval is narrower than this allows.
const OWN: f64 = 1e-3;
/// Largest slip over φ_max from which the knee (the onset of macro-slip) counts as determined, as in fits of modes that share joints.
const PASSED: f64 = 1.5;
/// A joint has a Dirac part, β > 0, where the best fit without it has a deviance higher by more than this, as in fits of modes that share joints.
const DIRAC_SEEN: f64 = 25.0;
/// An end of a linearised interval is checked by a run of the blows at this many times its distance from the best value. Linear residuals reach there
/// four times the deviance of the end, which leaves room for the nonlinearity that they ignore.
const AS_FAR: f64 = 2.0;
/// An end farther than this from the best value in its coordinate, a factor of 7 on K_T and F_S, is dropped: residuals are not linear over so wide a
/// range.
const FARTHEST: f64 = 2.0;
/// Iterations and relative reduction of the search without a Dirac part. A judgement.
const WITHOUT: (usize, f64) = (15, 1e-4);
/// A gate whose relative misfit exceeds this, and exceeds noise, is no match. A damping ratio wrong by 3 %, as it differs between repeated hits,
/// makes 6 % of the motion by the time the energy has halved twice. A judgement.
pub(super) const MISSED: f64 = 0.06;
/// Largest relative misfit that noise excuses: with more than 30 % the blows say nothing on a tenth of the energy. A search that ended at a wrong
/// place may leave residuals that look like noise.
pub(super) const MOST_EXCUSED: f64 = 0.3;

/// The search for the unknowns, on the blows of `rings`.
pub(super) struct Fitting<'a> {
    pub(super) rings: Rings<'a>,
}

/// The best unknowns with intervals, determined combinations and slip ratios.
pub(super) struct Certain {
    pub(super) found: Found,
    pub(super) free: Vec<usize>,
    pub(super) intervals: Vec<Interval>,
    pub(super) told: Told,
    pub(super) slip_ratios: Vec<f64>,
    pub(super) is_noise: bool,
}

/// Receives the share done, and returns an error where the work is to stop.
type GoOn<'a> = &'a dyn Fn(f64) -> Result<(), Error>;

impl<'a> Fitting<'a> {
    pub(super) const fn new(rings: Rings<'a>) -> Self {
        Self { rings }
    }

    fn free(&self) -> Vec<usize> {
        (0..self.rings.beside.bounds.len()).filter(|j| !self.rings.unfelt.contains(j)).collect()
    }

    /// Searches in the stages of [`WINDOWS`], from all starts.
    pub(super) fn grown(&mut self, all: &[Vec<f64>], go_on: GoOn<'_>) -> Result<Found, Error> {
        let failed = Error::identification("update");
        self.rings.take(WINDOWS[0].0);
        self.rings.unfelt = silent(&self.rings, &all[0], 1.0).map_err(&failed)?;
        let starts: Vec<Vec<f64>> = all.iter().map(|x| holding(x, &all[0], &self.rings.unfelt)).collect();
        let mut kept = self.nearest(starts);
        let mut found: Vec<Found> = Vec::new();
        for (n, (share, effort, keep)) in WINDOWS.into_iter().enumerate() {
            let before = self.rings.samples.clone();
            self.rings.take(share);
            // Blows may be so short that this stage uses the same samples as the last one; only as many points are then searched again as this stage
            // keeps.
            if n > 0 && self.rings.samples == before {
                kept.truncate(keep);
            }
            let free = self.free();
            found = kept.iter().filter_map(|x| near(&self.rings, x, &free, effort)).collect();
            go_on((n + 1) as f64 / (WINDOWS.len() + 1) as f64)?;
            found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            found.truncate(keep);
            kept = found.iter().map(|found| found.x.clone()).collect();
            // Unknowns to which the blows are sensitive at the point found are sought from now on.
            if let Some(x) = kept.first() {
                let before = std::mem::take(&mut self.rings.unfelt);
                let still = silent(&self.rings, x, 1.0).map_err(&failed)?;
                self.rings.unfelt = before.into_iter().filter(|j| still.contains(j)).collect();
            }
        }
        found.into_iter().next().ok_or_else(|| Error::Update {
            place: "update".into(),
            finding: "no start has a motion".into(),
            remedy: "check the units of force and records, or start nearer to the joints",
        })
    }

    /// The starts with the smallest residuals in the first stage: a run of each costs a tenth of one step of a search.
    fn nearest(&self, mut starts: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let mut residuals = vec![0.0; self.rings.count()];
        let mut left = |x: &Vec<f64>| {
            let known = self.rings.evaluate(x, &mut residuals, None);
            if known { residuals.iter().map(|r| r * r).sum::<f64>() } else { f64::INFINITY }
        };
        starts.sort_by_cached_key(|x| left(x).to_bits());
        starts.truncate(SEARCHED);
        starts
    }

    fn settled(&self, found: Found, effort: (usize, f64)) -> Found {
        near(&self.rings, &found.x, &self.free(), effort).unwrap_or(found)
    }

    /// Standard deviation that unknowns have at least: [`OWN`], and, where what is left is not noise, the largest part of a motion that is missed.
    /// Records that `iwan simulate` made with a hundred sliders leave 1.5 % of a motion; they put K_T off by 0.8 % and F_S by 1.5 %, always the same way,
    /// so that neither the residuals' size nor how differently they pull shows it.
    fn own(&self, x: &[f64], is_noise: bool) -> f64 {
        let missed = || self.rings.misfits(x).into_iter().flatten().flatten().fold(0.0, f64::max);
        if is_noise { OWN } else { OWN.max(missed()) }
    }

    fn weights(&self, found: &Found) -> Weights {
        let mut residuals = vec![0.0; self.rings.count()];
        self.rings.evaluate(&found.x, &mut residuals, None);
        Weights::of(&residuals, &self.rings.series(), self.free().len())
    }

    /// Sets the standard deviation of each gate from its residuals; relative to the measured amplitudes none becomes smaller than half the median of
    /// all gates.
    fn reweight(&mut self, weights: &Weights) {
        let mut own = weights.deviations.chunks_exact(2);
        let sizes: Vec<Vec<f64>> = self
            .rings
            .blows
            .iter()
            .map(|blow| blow.gates.iter().map(|g| root_mean_square(g.measured.iter().copied())).collect())
            .collect();
        let mut relative = Vec::new();
        for (deviations, sizes) in self.rings.deviations.iter_mut().zip(&sizes) {
            for (deviation, size) in deviations.iter_mut().zip(sizes) {
                let [a, b] = own.next().map_or([1.0; 2], |pair| [pair[0], pair[1]]);
                *deviation *= (0.5 * (a * a + b * b)).sqrt();
                relative.push(*deviation / size.max(f64::MIN_POSITIVE));
            }
        }
        relative.sort_by(f64::total_cmp);
        let floor = 0.5 * relative[relative.len() / 2];
        for (deviations, sizes) in self.rings.deviations.iter_mut().zip(&sizes) {
            for (deviation, size) in deviations.iter_mut().zip(sizes) {
                *deviation = deviation.max(floor * size).max(f64::MIN_POSITIVE);
            }
        }
    }

    /// Remaining error of the steps, as a variance in units of the residuals.
    fn still_stepping(&self) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for (blow, deviations) in self.rings.blows.iter().zip(&self.rings.deviations) {
            for (gate, deviation) in blow.gates.iter().zip(deviations) {
                let n = gate.measured.len() as f64;
                sum += n * (STILL_STEPPING * gate.stepping / deviation).powi(2);
                count += n;
            }
        }
        sum / f64::max(count, 1.0)
    }

    pub(super) fn certain(&mut self, found: Found, go_on: GoOn<'_>) -> Result<Certain, Error> {
        let mut found = found;
        if self.rings.correct(&found.x) {
            found = self.settled(found, FOR_WEIGHTS);
        }
        go_on(0.2)?;
        let weights = self.weights(&found);
        let is_noise = weights.inflation <= WHITE;
        if is_noise {
            self.reweight(&weights);
        }
        found = self.settled(found, LAST);
        go_on(0.3)?;
        let free = self.free();
        let freedom = (self.rings.count() as f64 - free.len() as f64).max(1.0);
        let inflation = self.weights(&found).inflation;
        let variance = (inflation * found.cost / freedom).max(self.still_stepping());
        let failed = Error::identification("update");
        let straight = Straight::at(&self.rings, &found.x).map_err(&failed)?;
        // Walk: one unknown is moved step by step while the others are fitted. A linearised model has no better point than the best; where a walk
        // still gains, the search had not quite ended.
        let about = About { found: &found, free: &free, variance, settled: true };
        let mut all = vec![Interval::default(); self.rings.beside.bounds.len()];
        // Unknowns that the blows do not feel are open: a walk along them has nowhere to end.
        if let Ok(walked) = intervals(&straight, about, &free, self.rings.threads) {
            let own = self.own(&found.x, is_noise);
            free.iter().zip(walked).for_each(|(j, interval)| all[*j] = widened(found.x[*j], interval, own));
        }
        self.without_ends(about, &mut all);
        let told = Told::about(&straight, &found, &free, variance).map_err(&failed)?;
        go_on(0.6)?;
        let slip_ratios = self.rings.slip_ratios(&found.x);
        self.without_knees(about, (&slip_ratios, is_noise), &mut all);
        Ok(Certain { found, free, intervals: all, told, slip_ratios, is_noise })
    }

    /// Opens intervals of joint parameters whose ends hold only for linearised residuals. Where the blows themselves accept a value well beyond an
    /// end, or the end lies too far away to be believed, the search stood in a valley (a direction along which the sum of squares hardly changes)
    /// that the blows do not bound.
    fn without_ends(&self, about: About<'_>, intervals: &mut [Interval]) {
        let mut residuals = vec![0.0; self.rings.count()];
        let mut accepts = |j: usize, end: f64| {
            let (best, (low, high)) = (about.found.x[j], self.rings.beside.bounds[j]);
            let mut x = about.found.x.clone();
            x[j] = (best + AS_FAR * (end - best)).clamp(low, high);
            let known = self.rings.evaluate(&x, &mut residuals, None);
            let cost: f64 = residuals.iter().map(|r| r * r).sum();
            known && cost - about.found.cost < ENDS * about.variance
        };
        for (j, interval) in intervals.iter_mut().enumerate().take(self.rings.beside.first_factor()) {
            let ends = [interval.low, interval.high];
            let untold = |end: f64| (end - about.found.x[j]).abs() > FARTHEST || accepts(j, end);
            if ends.into_iter().flatten().any(untold) {
                *interval = Interval::default();
            }
        }
    }

    /// Opens the ends that depend on a knee (the onset of macro-slip). Where no blow has clearly passed the knee, or the misfit is too large to show
    /// it, the joint may be arbitrarily strong and stiff. Where χ lies at the end of its range or its interval is open, the shape of the law explains
    /// nothing in the blows, and only the stiffness keeps its ends.
    fn without_knees(
        &self,
        about: About<'_>,
        (slip_ratios, is_noise): (&[f64], bool),
        intervals: &mut [Interval],
    ) {
        let misses = root_mean_square(self.rings.misfits(&about.found.x).into_iter().flatten().flatten());
        for (group, ratio) in slip_ratios.iter().enumerate() {
            let (low, high) = self.rings.beside.bounds[4 * group + 2];
            let chi = about.found.x[4 * group + 2];
            let of = &mut intervals[4 * group..4 * group + 4];
            if chi <= low || chi >= high || of[2].low.is_none() || of[2].high.is_none() {
                of[1..].fill(Interval::default());
            }
            if *ratio < PASSED || misses > if is_noise { MOST_EXCUSED } else { MISSED } {
                (of[0].high, of[1].high) = (None, None);
                of[3] = Interval::default();
            } else if of[3] != Interval::default() && !self.has_dirac(about, 4 * group + 3) {
                of[3] = Interval::default();
            }
        }
    }

    fn has_dirac(&self, about: About<'_>, beta: usize) -> bool {
        let mut start = about.found.x.clone();
        start[beta] = 0.0;
        let others: Vec<usize> = about.free.iter().copied().filter(|j| *j != beta).collect();
        let without = near(&self.rings, &start, &others, WITHOUT);
        without.is_none_or(|without| without.cost - about.found.cost > DIRAC_SEEN * about.variance)
    }
}

/// An interval about `x`, widened by an error with the standard deviation `own`.
fn widened(x: f64, Interval { low, high }: Interval, own: f64) -> Interval {
    let reach = |end: f64| (x - end).abs().hypot(NORMAL * own);
    Interval { low: low.map(|low| x - reach(low)), high: high.map(|high| x + reach(high)) }
}
