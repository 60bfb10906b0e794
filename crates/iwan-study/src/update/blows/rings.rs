//! Residuals between the computed and the measured ring-downs. Gate, in this folder: the complex amplitudes of one mode at one point, in windows
//! along the record.

use std::ops::Range;

use iwan_fem::{Blow, InCoordinates};
use iwan_ident::coupled::between_samples;
use iwan_ident::estimate::Model;
use iwan_machine::threads::in_parallel;

use super::struck::Timed;
use crate::update::model::{Beside, DAMPING_UNIT, law};

/// Step of one-sided differences of whole runs, in coordinates of order one, as in fits of modes that share joints. A run is smooth except for
/// creases of the size of one slider's share, and the step must be wider than these.
const STEP: f64 = 3e-4;
/// Relative standard deviation of the amplitudes that the first search assumes.
const FIRST: f64 = 0.02;
/// A point near a node of a mode shows little of the mode: its amplitudes count as if they were at least this part of the largest of the blow.
const LEAST: f64 = 0.02;
/// Number of sliders of each joint: 100 hold the dissipation within 0.5 %.
const BINS: usize = 100;
/// Factor by which steps and sliders are refined in the runs that check the coarse ones, at the point where a search ended.
const FINER: usize = 4;

/// Structure, unknowns and blows; the unknowns are those of the fit of curves.
#[derive(Debug, Clone)]
pub(super) struct Rings<'a> {
    pub(super) beside: Beside<'a>,
    /// Whether each compared mode has an unknown viscous damping of its own.
    pub(super) viscous: bool,
    pub(super) blows: Vec<Timed>,
    pub(super) load: InCoordinates,
    pub(super) outputs: Vec<Vec<InCoordinates>>,
    /// Frequencies of the compared modes in the structure as given, Hz.
    pub(super) frequencies: Vec<f64>,
    /// Standard deviation of the amplitudes of each gate, by blow.
    pub(super) deviations: Vec<Vec<f64>>,
    pub(super) threads: usize,
    /// Number of samples of each blow that are used.
    pub(super) samples: Vec<usize>,
    /// Unknowns to which the blows are insensitive; derivatives with respect to them are taken as zero.
    pub(super) unfelt: Vec<usize>,
}

/// The computed response to a blow: amplitudes by gate, and the largest value of each slip.
pub(super) struct Rung {
    pub(super) amplitudes: Vec<Vec<f64>>,
    pub(super) slips: Vec<f64>,
}

impl<'a> Rings<'a> {
    /// All blows, in full length.
    pub(super) fn new(
        beside: Beside<'a>,
        viscous: bool,
        (blows, load, outputs): (Vec<Timed>, InCoordinates, Vec<Vec<InCoordinates>>),
        frequencies: Vec<f64>,
        threads: usize,
    ) -> Self {
        let deviations = blows.iter().map(first_deviations).collect();
        let samples = blows.iter().map(|blow| blow.samples).collect();
        let unfelt = Vec::new();
        Self { beside, viscous, blows, load, outputs, frequencies, deviations, threads, samples, unfelt }
    }

    /// Limits each blow to the given share of its samples from the beginning, but to no less than two windows of its slowest mode.
    pub(super) fn take(&mut self, share: f64) {
        let taken = |blow: &Timed| {
            let longest = blow.gates.iter().map(|gate| gate.sums.length()).max().unwrap_or(1);
            ((share * blow.samples as f64) as usize).clamp((2 * longest).min(blow.samples), blow.samples)
        };
        self.samples = self.blows.iter().map(taken).collect();
    }

    /// Number of amplitudes in a gate within the samples used, real and imaginary parts counted apart.
    fn length(&self, k: usize, gate: usize) -> usize {
        self.blows[k].gates[gate].sums.count(self.samples[k])
    }

    /// Index ranges of the residuals: for each gate the real parts, then the imaginary parts.
    pub(super) fn series(&self) -> Vec<Range<usize>> {
        let (mut from, mut all) = (0, Vec::new());
        for (k, blow) in self.blows.iter().enumerate() {
            for gate in 0..blow.gates.len() {
                let half = self.length(k, gate) / 2;
                all.extend([from..from + half, from + half..from + 2 * half]);
                from += 2 * half;
            }
        }
        all
    }

    /// Response of the structure with the unknowns `x` to blow `k`; none where it cannot be computed.
    pub(super) fn rung(&self, x: &[f64], k: usize) -> Option<Rung> {
        self.rung_finer(x, k, 1)
    }

    /// The same response with `times` as many steps and sliders.
    fn rung_finer(&self, x: &[f64], k: usize, times: usize) -> Option<Rung> {
        let (timed, adjusted) = (&self.blows[k], self.beside.adjusted(x)?);
        let finer = (times > 1).then(|| between_samples(&timed.force, times));
        let ratios: Vec<f64> = if self.viscous {
            x[self.beside.first_viscous()..].iter().map(|x| DAMPING_UNIT * x).collect()
        } else {
            Vec::new()
        };
        // A mode that is not compared gets the damping ratio of the compared mode nearest in frequency.
        let damping = |frequency: f64| {
            let near = |r: &usize| (self.frequencies[*r] / frequency).ln().abs();
            let nearest = (0..ratios.len()).min_by(|a, b| near(a).total_cmp(&near(b)));
            nearest.map_or(0.0, |r| ratios[r])
        };
        let blow = Blow {
            step: timed.step / times as f64,
            force: finer.as_deref().unwrap_or(&timed.force),
            load: &self.load,
            outputs: &self.outputs[k],
            kinematic: timed.kinematic,
            every: times * timed.every,
            samples: self.samples[k],
            bins: times * BINS,
        };
        let struck = adjusted.struck(&blow, damping).ok()?;
        let amplitudes = timed.gates.iter().map(|gate| gate.of(&struck.motion[gate.point])).collect();
        Some(Rung { amplitudes, slips: struck.slips })
    }

    /// Measured amplitudes of a gate within the samples used.
    pub(super) fn measured(&self, k: usize, gate: usize) -> Vec<f64> {
        let all = &self.blows[k].gates[gate].measured;
        let (half, whole) = (self.length(k, gate) / 2, all.len() / 2);
        [&all[..half], &all[whole..whole + half]].concat()
    }

    /// Subtracts from the measured amplitudes the change that finer steps make in the computed ones at `x`. A search with coarse steps then ends
    /// where one with finer steps would (deferred correction). To be called once, with all samples in use. Returns false where no motion can be
    /// computed.
    pub(super) fn correct(&mut self, x: &[f64]) -> bool {
        let jobs: Vec<(usize, usize)> = (0..self.blows.len()).flat_map(|k| [(k, FINER), (k, 1)]).collect();
        let found =
            in_parallel(&jobs, self.threads, &|(k, times): &(usize, usize)| self.rung_finer(x, *k, *times));
        let Some(found) = found.into_iter().collect::<Option<Vec<Rung>>>() else { return false };
        for (blow, pair) in self.blows.iter_mut().zip(found.chunks_exact(2)) {
            let changes = pair[0].amplitudes.iter().zip(&pair[1].amplitudes);
            for (gate, (fine, own)) in blow.gates.iter_mut().zip(changes) {
                let change = fine.iter().zip(own).map(|(fine, own)| fine - own);
                gate.stepping = root_mean_square(change.clone());
                gate.measured.iter_mut().zip(change).for_each(|(measured, change)| *measured -= change);
            }
        }
        true
    }

    /// Residuals of blow `k`: computed minus measured amplitudes, over their standard deviations.
    fn residuals(&self, x: &[f64], k: usize) -> Option<Vec<f64>> {
        let rung = self.rung(x, k)?;
        let of = |(gate, amplitudes): (usize, &Vec<f64>)| -> Vec<f64> {
            let measured = self.measured(k, gate);
            let deviation = self.deviations[k][gate];
            amplitudes.iter().zip(measured).map(|(a, m)| (a - m) / deviation).collect()
        };
        Some(rung.amplitudes.iter().enumerate().flat_map(of).collect())
    }

    /// Largest slip of each group over φ_max, in all blows.
    pub(super) fn slip_ratios(&self, x: &[f64]) -> Vec<f64> {
        let slips: Vec<Vec<f64>> =
            (0..self.blows.len()).filter_map(|k| self.rung(x, k)).map(|rung| rung.slips).collect();
        let ratio = |(group, x): (&Vec<usize>, &[f64])| {
            let end = law(x).map_or(f64::NAN, |law| law.phi_max());
            slips.iter().flat_map(|all| group.iter().map(|s| all[*s] / end)).fold(0.0, f64::max)
        };
        self.beside.groups.iter().zip(x.chunks_exact(4)).map(ratio).collect()
    }

    /// Relative misfit of each gate of each blow: root mean square of the residual amplitudes over that of the measured ones, which count as no less
    /// than [`LEAST`] times those of the largest gate.
    pub(super) fn misfits(&self, x: &[f64]) -> Option<Vec<Vec<f64>>> {
        let of = |k: usize| {
            let rung = self.rung(x, k)?;
            let size = |gate| root_mean_square(self.measured(k, gate).into_iter());
            let largest = (0..rung.amplitudes.len()).map(size).fold(f64::MIN_POSITIVE, f64::max);
            let one = |(gate, amplitudes): (usize, &Vec<f64>)| {
                let measured = self.measured(k, gate);
                let difference = amplitudes.iter().zip(&measured).map(|(a, m)| a - m);
                root_mean_square(difference) / root_mean_square(measured.iter().copied()).max(LEAST * largest)
            };
            Some(rung.amplitudes.iter().enumerate().map(one).collect())
        };
        (0..self.blows.len()).map(of).collect()
    }

    fn moved(&self, x: &[f64], j: usize) -> (Vec<f64>, f64) {
        let step = if x[j] + STEP > self.beside.bounds[j].1 { -STEP } else { STEP };
        let mut moved = x.to_vec();
        moved[j] += step;
        (moved, step)
    }
}

fn first_deviations(blow: &Timed) -> Vec<f64> {
    let sizes: Vec<f64> =
        blow.gates.iter().map(|gate| root_mean_square(gate.measured.iter().copied())).collect();
    let largest = sizes.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    sizes.into_iter().map(|size| FIRST * size.max(LEAST * largest)).collect()
}

pub(super) fn root_mean_square(x: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = x.fold((0.0, 0.0_f64), |(sum, count), x| (sum + x * x, count + 1.0));
    (sum / count.max(1.0)).sqrt()
}

impl Model for Rings<'_> {
    fn bounds(&self) -> &[(f64, f64)] {
        &self.beside.bounds
    }

    fn count(&self) -> usize {
        self.series().last().map_or(0, |range| range.end) + self.beside.priors.iter().flatten().count()
    }

    fn evaluate(&self, x: &[f64], residuals: &mut [f64], derivatives: Option<&mut [Vec<f64>]>) -> bool {
        let blows = self.blows.len();
        let mut jobs: Vec<(usize, Option<usize>)> = (0..blows).map(|k| (k, None)).collect();
        if let Some(derivatives) = &derivatives {
            let felt = (0..x.len()).filter(|j| !derivatives[*j].is_empty() && !self.unfelt.contains(j));
            jobs.extend(felt.flat_map(|j| (0..blows).map(move |k| (k, Some(j)))));
        }
        let work = |(k, unknown): &(usize, Option<usize>)| {
            let at = unknown.map_or_else(|| x.to_vec(), |j| self.moved(x, j).0);
            self.residuals(&at, *k)
        };
        let found = in_parallel(&jobs, self.threads, &work);
        let (mut from, mut first) = (0, Vec::new());
        for own in &found[..blows] {
            let Some(own) = own else { return false };
            residuals[from..from + own.len()].copy_from_slice(own);
            first.push(from);
            from += own.len();
        }
        let mut derivatives = derivatives;
        if let Some(derivatives) = &mut derivatives {
            self.unfelt.iter().for_each(|j| derivatives[*j].fill(0.0));
            for ((k, unknown), moved) in jobs.iter().zip(&found).skip(blows) {
                let (Some(j), Some(moved)) = (*unknown, moved) else { return false };
                let (step, begin) = (self.moved(x, j).1, first[*k]);
                let out = &mut derivatives[j][begin..begin + moved.len()];
                let own = &residuals[begin..begin + moved.len()];
                out.iter_mut().zip(moved.iter().zip(own)).for_each(|(out, (a, b))| *out = (a - b) / step);
            }
        }
        self.beside.known_before(x, from, residuals, derivatives);
        true
    }
}
