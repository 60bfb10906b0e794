//! The searches: with the knee φ_max beyond all amplitudes, along all knees, from the best of these to the minimum itself, and without a joint.
//!
//! A valley is a local minimum of the sum of squares along the knee; `knees` says more.

use std::f64::consts::TAU;

use iwan_machine::threads::{both, in_parallel};

use super::knees::{STEP, close_to, valleys};
use super::record::Windowed;
use super::release::TurningPoint;
use super::residuals::Kind;
use super::task::{Effort, FINE, ROUGH, Task, Workspace, no_ring_down};
use crate::curve_fit::predict;
use crate::error::Error;
use crate::parameters::{COUNT, Parameter, Parameters};
use crate::search::{CHI, Chart, DAMPING, DIRAC, FREQUENCY, KNEE, Minimum, TOLERANCE};

/// Powers χ of further start values at the same softening: those that measured joints have. A slope that is read off a short or noisy curve can be
/// wrong by half.
const CHIS: [f64; 3] = [-0.75, -0.45, -0.15];
/// Part of ω0² that K_T has in the start with next to no joint: it shifts the frequency by 5e-5, so that derivatives with respect to the joint are
/// still seen.
const LITTLE_JOINT: f64 = 1e-4;
/// Hops of ln φ_max over creases (bends of the sum of squares): half a step of the scan and less. Longer ones would repeat the scan.
const HOPS: [f64; 6] = [0.5 * STEP, 0.25 * STEP, 0.1 * STEP, 0.05 * STEP, 0.03 * STEP, 0.01 * STEP];
/// Relative residual above which no hops are tried where the samples show noise: it then hides the creases, and hops cost time only.
const CREASE: f64 = 5e-4;
/// Relative residual below which half cycles are computed one by one in place of tables, several times the error of tables. Records whose samples show no noise are fitted without
/// tables whatever is left: one of two hundred ended in a wrong valley with them (149 of `softening`).
const EXACT: f64 = 1e-4;
/// Most valleys of a scan from which searches on the records themselves go on. A judgement, not varied: the sweep along all knees that follows looks
/// at the other valleys once more.
const KEPT: usize = 4;

/// Part of the first samples that a model of a record without noise must miss for another knee to be looked for: the law's own parameters miss 1e-8
/// to 1e-7 of two records, a wrong knee 2e-3.
const TOLD: f64 = 1e-6;
/// Part of that miss which the model with the other knee may have at most for it to be taken.
const FAR_BETTER: f64 = 0.1;

/// Most rounds in which what sampling adds and the minimum are brought into agreement without noise; each round brings them nearer by the part that
/// sampling adds to the record, a thousandth and less. Where the rounds are spent the last one is taken.
const SETTLING: usize = 6;
/// Reduction of the sum of squares, in units of the variance, that a round must bring for another one to follow.
const SETTLED: f64 = 0.01;

/// What the searches found before any interval is sought.
pub(crate) struct Solved {
    pub(crate) best: Minimum,
    /// The best minimum without macro-slip; none where given parameters decide about macro-slip.
    pub(crate) micro_slip: Option<Minimum>,
}

impl Task {
    /// Start values of the searches: `first`, the same softening with other powers χ, and next to no joint.
    fn bases(&self, first: &Parameters) -> Result<Vec<Vec<f64>>, Error> {
        let x = self.coordinates(first)?;
        let mut bases = vec![x.clone()];
        bases.extend(self.other_powers(&x));
        if self.held.is_empty() {
            let loudest = self.loudest();
            let model = predict(first, loudest)?;
            let omega_squared = (TAU * model.frequency).powi(2);
            let k_t = LITTLE_JOINT * omega_squared;
            let damping_ratio = model.dissipation / (TAU * omega_squared * loudest * loudest);
            let (frequency, f_s) = (model.frequency, k_t * loudest);
            let little = Parameters { frequency, damping_ratio, k_t, f_s, ..*first };
            bases.push(self.coordinates(&little)?);
        }
        Ok(bases)
    }

    /// Copies of `x` with other powers χ at the same softening, where χ is sought. Frequency and dissipation at the largest amplitude stay as they
    /// were, because a start that is off by a cycle finds no way back.
    pub(crate) fn other_powers(&self, x: &[f64]) -> Vec<Vec<f64>> {
        let free = self.free();
        let loudest = self.loudest();
        let at_loudest = |x: &[f64]| predict(&self.chart.parameters(x), loudest).ok();
        let with = |chi| {
            let mut other = x.to_vec();
            other[CHI] = chi;
            if let (Some(was), Some(is)) = (at_loudest(x), at_loudest(&other)) {
                let mut p = self.chart.parameters(&other);
                let omega_squared = (TAU * was.frequency).powi(2);
                p.frequency *= was.frequency / is.frequency;
                let lost = (was.dissipation - is.dissipation) / (TAU * omega_squared * loudest * loudest);
                p.damping_ratio = (p.damping_ratio + lost).max(0.0);
                let moved = self.coordinates(&p).unwrap_or_else(|_| other.clone());
                for j in [FREQUENCY, DAMPING].into_iter().filter(|j| free.contains(j)) {
                    other[j] = moved[j];
                }
                Self::keep_days(x, &mut other);
            }
            other
        };
        if free.contains(&CHI) { CHIS.map(with).to_vec() } else { vec![] }
    }

    /// The unknowns that are sought where no record reaches the knee: without the knee and the Dirac, unless the knee is given.
    fn without_knee(&self) -> Vec<usize> {
        let unseen = |j: usize| j == DIRAC && self.knee().is_some();
        self.smooth().into_iter().filter(|j| !unseen(*j)).collect()
    }

    /// Where the first searches, which compare logarithms, end without macro-slip from each of `bases`, by ascending sum of squares.
    fn logarithmic(&self, bases: &[Vec<f64>]) -> Vec<Minimum> {
        let search = self.search(self.without_knee(), Effort::ROUGH);
        let from = |x: &Vec<f64>| {
            let mut work = Workspace::default();
            self.seek(Kind::Logarithms, &self.unseen(x), &search, &mut work)
        };
        let mut found: Vec<Minimum> = in_parallel(bases, bases.len(), &from).into_iter().flatten().collect();
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        found
    }

    /// The valleys of the scans from two points, the deepest first.
    fn deepest(&self, from: [&[f64]; 2]) -> Vec<Minimum> {
        let scan = |x: &[f64]| self.scan(x, &mut Workspace::default());
        let (first, second) = both(&|| scan(from[0]), &|| scan(from[1]));
        let scans = [first, second];
        let mut found: Vec<Minimum> = scans.iter().flat_map(|scan| valleys(scan)).collect();
        found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        found
    }

    /// The best of all searches, to a rough tolerance.
    pub(crate) fn solve(&mut self, first: &Parameters) -> Result<Solved, Error> {
        let mut work = Workspace::default();
        let bases = self.bases(first)?;
        let unseen = self.logarithmic(&bases);
        let start = unseen.first().map_or_else(|| bases[0].clone(), |m| m.x.clone());
        let mut valleys =
            if self.knee().is_some() { self.deepest([&start, &bases[0]]) } else { unseen.clone() };
        valleys.truncate(KEPT);
        let nearest = valleys.iter().chain(unseen.first()).min_by(|a, b| a.cost.total_cmp(&b.cost));
        let Some(nearest) = nearest else { return Err(no_ring_down()) };
        self.weigh(&nearest.x, &mut work);
        let micro_slip = self.micro_slip(&[&start]);
        let bottom = |valley: &Minimum| {
            let mut work = Workspace::default();
            let held = self.minimise(&valley.x, self.smooth(), ROUGH, &mut work)?;
            self.minimise(&held.x, self.free(), ROUGH, &mut work)
        };
        let bottoms = in_parallel(&valleys, valleys.len(), &bottom).into_iter().flatten();
        let best = micro_slip.clone().into_iter().chain(bottoms).min_by(|a, b| a.cost.total_cmp(&b.cost));
        let best = best.ok_or_else(no_ring_down)?;
        self.weigh(&best.x, &mut work);
        let best = self.priced(best, &mut work)?;
        let micro_slip = micro_slip.map(|m| self.priced(m, &mut work)).transpose()?;
        Ok(Solved { best, micro_slip })
    }

    /// Whether so little is left at a minimum that its valley is narrower than any step of a scan, and other valleys lie far outside the limit.
    pub(crate) fn is_free_of_noise(&self, minimum: &Minimum) -> bool {
        self.refined(minimum).relative_residual < CREASE
    }

    /// Whether a minimum may lie beside a narrow valley that is far deeper: little is left there, or the samples show no noise and something is left all
    /// the same.
    pub(super) fn may_lie_beside_a_narrow_valley(&self, minimum: &Minimum) -> bool {
        self.is_free_of_noise(minimum) || self.shows_no_noise()
    }

    /// A minimum with its sum of squares by the present weights.
    fn priced(&self, minimum: Minimum, work: &mut Workspace) -> Result<Minimum, Error> {
        let cost = self.cost(&minimum.x, work).ok_or_else(no_ring_down)?;
        Ok(Minimum { cost, ..minimum })
    }

    /// The minimum itself, sought from a rough one; weights and what sampling adds are taken anew there.
    pub(crate) fn finish(&mut self, rough: &Minimum) -> Result<Minimum, Error> {
        let mut work = Workspace::default();
        let mut best = self.minimise(&rough.x, self.free(), FINE, &mut work).ok_or_else(no_ring_down)?;
        if self.shows_no_noise() || self.refined(&best).relative_residual < EXACT {
            // Tables are off where the joint goes over from macro-slip to micro-slip: they put K_T of one record off by a thousandth.
            self.records.iter_mut().for_each(|record| record.windows.leave_tables());
            best = self.minimise(&best.x, self.free(), FINE, &mut work).ok_or_else(no_ring_down)?;
        }
        self.take_samples(&best.x, &mut work);
        self.weigh(&best.x, &mut work);
        best = self.minimise(&best.x, self.free(), FINE, &mut work).ok_or_else(no_ring_down)?;
        if self.may_lie_beside_a_narrow_valley(&best) {
            best = self.hop(best, &HOPS, &mut work);
            for _ in 0..SETTLING {
                self.take_samples(&best.x, &mut work);
                self.weigh(&best.x, &mut work);
                let before = self.cost(&best.x, &mut work).ok_or_else(no_ring_down)?;
                best = self.minimise(&best.x, self.free(), TOLERANCE, &mut work).ok_or_else(no_ring_down)?;
                if before - best.cost < SETTLED {
                    break;
                }
            }
        }
        Ok(best)
    }

    /// The deepest valley along all knees, of which there are many for a record without noise.
    pub(super) fn deepest_of_all(&mut self, mut best: Minimum) -> Result<Minimum, Error> {
        for _ in 0..SETTLING {
            if self.knee().is_none() || !self.may_lie_beside_a_narrow_valley(&best) {
                break;
            }
            let sweep = self.sweep(&best, best.cost + self.count() as f64, FINE);
            let found =
                self.polished(&sweep, f64::INFINITY).into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
            match found.filter(|m| m.cost < best.cost - SETTLED) {
                Some(deeper) => best = self.finish(&deeper)?,
                None => break,
            }
        }
        Ok(best)
    }

    /// Largest part of a record's first samples that a model misses, over all records; none where a record has noise.
    fn misses_of_heads(&self, x: &[f64]) -> Option<f64> {
        let parameters = self.chart.parameters(x);
        let one = |(start, record): (TurningPoint, &Windowed)| record.misses_of_head(&parameters, start);
        self.starts_at(x)
            .into_iter()
            .zip(&self.records)
            .map(one)
            .try_fold(0.0, |most, part| Some(part?.max(most)))
    }

    /// The minimum again, or one with another knee that matches the first samples of records without noise far better. Windows keep two numbers a
    /// cycle: where the joint slips as a whole in the first half cycle only, two different knees, each with its own Dirac, release and time of
    /// release, can match all windows to the last digit.
    pub(super) fn by_first_samples(&mut self, mut minimum: Minimum) -> Result<Minimum, Error> {
        for _ in 0..SETTLING {
            match self.other_by_first_samples(&minimum)? {
                Some((task, other)) => (*self, minimum) = (task, other),
                None => break,
            }
        }
        Ok(minimum)
    }

    fn other_by_first_samples(&self, minimum: &Minimum) -> Result<Option<(Self, Minimum)>, Error> {
        let Some(missed) = self.misses_of_heads(&minimum.x).filter(|missed| *missed > TOLD) else {
            return Ok(None);
        };
        if self.knee().is_none() || self.is_micro_slip(&minimum.x) || !self.is_free_of_noise(minimum) {
            return Ok(None);
        }
        let near = |at: &f64| {
            let mut work = Workspace::default();
            let held = self.at_knee(&[&self.start_at_knee(&minimum.x, *at)], *at, ROUGH, &mut work)?;
            Some((self.misses_of_heads(&held.x)?, held))
        };
        let knees = close_to(minimum.x[KNEE]);
        let found = in_parallel(&knees, knees.len(), &near).into_iter().flatten();
        let Some((_, held)) = found.min_by(|a, b| a.0.total_cmp(&b.0)) else { return Ok(None) };
        let mut task = self.clone();
        let other = task.finish(&held)?;
        let better = task.misses_of_heads(&other.x).is_some_and(|part| part <= FAR_BETTER * missed);
        Ok(better.then_some((task, other)))
    }

    /// The least sum of squares without macro-slip (the joint never slips as a whole), among searches from several points. None where a given K_T,
    /// F_S or χ, or the stiffness of the mode, decides about macro-slip.
    pub(crate) fn micro_slip(&self, from: &[&[f64]]) -> Option<Minimum> {
        if !self.is_open() {
            return None;
        }
        let end = |x: &&[f64]| {
            let mut work = Workspace::default();
            let near = self.minimise(&self.unseen(x), self.without_knee(), FINE, &mut work)?;
            self.minimise(&self.unseen(&near.x), self.without_knee(), FINE, &mut work)
        };
        let ends = in_parallel(from, from.len(), &end).into_iter().flatten();
        ends.min_by(|a, b| a.cost.total_cmp(&b.cost)).filter(|found| self.is_micro_slip(&found.x))
    }

    /// Goes on from a better point; none when the minimum found there is not lower than `than`.
    pub(crate) fn resume(&self, better: &Minimum, than: &Minimum) -> Option<Minimum> {
        let found = self.minimise(&better.x, self.free(), FINE, &mut Workspace::default())?;
        (found.cost < than.cost).then_some(found)
    }

    /// The records fitted without a joint: `linear` holds parameters whose joint is as good as none.
    pub(crate) fn without_joint(
        &self,
        linear: &Parameters,
        minimum: &Minimum,
    ) -> Result<(Self, Minimum), Error> {
        let joint = [Parameter::KT, Parameter::FS, Parameter::Chi, Parameter::Beta];
        let mut task = self.clone();
        task.held.extend(joint.iter().filter(|p| !self.held.contains(p)));
        task.chart = Chart::holding(&task.held, self.chart.amplitude);
        let mut x = task.coordinates(linear)?;
        x[COUNT..].copy_from_slice(&minimum.x[COUNT..]);
        let mut work = Workspace::default();
        let search = task.search(task.free(), Effort::ROUGH);
        let near = task.seek(Kind::Logarithms, &x, &search, &mut work).ok_or_else(no_ring_down)?;
        let found = task.minimise(&near.x, task.free(), TOLERANCE, &mut work).ok_or_else(no_ring_down)?;
        Ok((task, found))
    }
}
