//! What all laws are fitted to together: the curves that all records of a mode tell, and each law's fit to them.

use std::f64::consts::TAU;

use iwan_machine::threads::{at_once, in_parallel};
use nalgebra::DMatrix;

use super::candidates::{CANDIDATES, Candidate};
use super::discrepancy::Ladder;
use super::estimates::{Estimate, estimates};
use super::fit::{Fitted, Problem};
use super::held_out::{HeldOut, stretches};
use super::mode::LawMode;
use super::slow::{Covariances, Grid, Information, Measured, Scatter, Smooth, Source, guess, specimen};
use super::terms::{Scales, Term, coordinates};
use crate::curve_fit::{Compared, Grade, Verdict};
use crate::curves::Curves;
use crate::parameters::Parameters;

/// Factor by which the grid of amplitudes reaches beyond those of the envelopes: a ring-down begins before its envelope is trusted.
const BEYOND: f64 = 1.1;

/// A law, and what the records say about it.
#[derive(Debug, Clone)]
pub struct FittedLaw {
    /// The law.
    pub law: Candidate,
    /// Criterion: twice the negative logarithm of the law's evidence, with the discrepancy that the law needs, less that of the best law: 0 is the
    /// best.
    pub criterion: f64,
    /// Root-mean-square misfit of ln D (D: dissipation per cycle) against the smooth curves, over the cycles of the records.
    pub dissipation_misfit: f64,
    /// Root-mean-square misfit of the frequency against the smooth curves, Hz.
    pub frequency_misfit: f64,
    /// Size of the slow discrepancy that is estimated with the law: of the decay rate, relative, and of the frequency, Hz.
    pub discrepancy: (f64, f64),
    /// Misfit in thirds of the amplitudes (in ln a) to which the law was not fitted; none where the records saw too few amplitudes.
    pub held_out: Option<HeldOut>,
    /// How well the law describes the records.
    pub grade: Grade,
    /// The law's parameters with intervals.
    pub parameters: Vec<Estimate>,
    /// The mode with this law.
    pub mode: LawMode,
}

/// What all laws are fitted to, and compared with.
pub(super) struct Together {
    pub(super) grid: Grid,
    information: Information,
    pub(super) smooth: Smooth,
    /// Decay rates of the smooth curves (1/s), raised where they are next to zero or negative.
    near: Vec<f64>,
    ladder: Ladder,
    scales: Scales,
    /// ln of the smallest and of the largest amplitude that the records saw.
    pub(super) span: (f64, f64),
    /// Indices of the grid's amplitudes that the records saw.
    seen: Vec<usize>,
    /// For each cycle of the records' curves: index of the seen amplitude next to that of the cycle.
    cycles: Vec<usize>,
    /// How far hits stray from each other, with the covariance of the straying.
    pub(super) scatter: (Scatter, DMatrix<f64>),
}

/// The grid of amplitudes, from the smallest to the largest that any record holds.
pub(super) fn grid(sources: &[Source<'_>]) -> Grid {
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    for Source { curves, first, .. } in sources {
        let all = || curves.displacement.iter().copied().filter(|a| *a > 0.0);
        low = all().fold(low, f64::min);
        // From the envelope's first value back to the first sample.
        let omega = TAU * curves.frequency.first().copied().unwrap_or(0.0);
        let rate = curves.damping_ratio.first().copied().unwrap_or(0.0).max(0.0) * omega;
        let early = (curves.t.first().copied().unwrap_or(0.0) - first).max(0.0);
        high = all()
            .fold(high, f64::max)
            .max(curves.displacement.first().copied().unwrap_or(0.0) * (rate * early).min(2.0).exp());
    }
    Grid::over(low / BEYOND, high * BEYOND)
}

pub(super) fn together(grid: Grid, measured: &[Measured], sources: &[Source<'_>]) -> Option<Together> {
    let all: Vec<Information> = measured.iter().map(|m| m.information.clone()).collect();
    let curves: Vec<&Curves> = sources.iter().map(|s| s.curves).collect();
    let near = guess(&grid, &curves);
    let ends = |m: &dyn Fn(&Measured) -> f64, pick: fn(f64, f64) -> f64| measured.iter().map(m).reduce(pick);
    let (low, high) = (ends(&|m| m.span.0, f64::min)?, ends(&|m| m.span.1, f64::max)?);
    let half = 0.5 * (grid.log(1) - grid.log(0));
    let seen: Vec<usize> =
        (0..grid.count()).filter(|&i| (low - half..=high + half).contains(&grid.log(i))).collect();
    let rate = near.decay.iter().sum::<f64>() / near.decay.len() as f64;
    let shift = range(&near.omega).max(0.1 * rate);
    let covariances = Covariances::new(&grid, &near, shift);
    let mean = Smooth::mean(&near);
    let (information, scatter, straying) =
        specimen(&all, &covariances, &mean, (mean[mean.len() - 1], shift))?;
    let smooth = Smooth::new(&information, &covariances, &near)?;
    // The covariances are made once more, relative to the curves that were found.
    let mut found = smooth.rates.clone();
    found.decay.iter_mut().for_each(|d| *d = d.max(0.05 * rate));
    let shift = range(&seen.iter().map(|&i| found.omega[i]).collect::<Vec<_>>())
        .max(0.1 * rate)
        .max(scatter.frequency * mean[mean.len() - 1]);
    let covariances = Covariances::new(&grid, &found, shift);
    let middle = seen[seen.len() / 2];
    let scales = Scales {
        amplitude: grid.amplitude(middle),
        omega: found.omega[middle],
        rate: found.decay[middle],
        shift,
    };
    let always = covariances.of_averaging(&found, shift);
    let ladder = Ladder::new(&information, &covariances, (shift, scales.omega), &always)?;
    let next = |a: &f64| {
        seen.iter().copied().min_by(|&i, &j| {
            let away = |i: usize| (grid.log(i) - a.ln()).abs();
            away(i).total_cmp(&away(j))
        })
    };
    let cycles = curves.iter().flat_map(|c| c.displacement.iter().filter_map(next)).collect();
    let near = found.decay;
    let scatter = (scatter, straying);
    let span = (low, high);
    Some(Together { grid, information, smooth, near, ladder, scales, span, seen, cycles, scatter })
}

/// Coordinates of a law with a joint and further parts, where the further parts are zero.
fn beside_a_joint(law: &Candidate, mut joint: Vec<f64>) -> Vec<f64> {
    joint.resize(coordinates(law.terms).len(), 0.0);
    joint
}

fn range(y: &[f64]) -> f64 {
    let ends = y.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |r, y| (r.0.min(*y), r.1.max(*y)));
    ends.1 - ends.0
}

impl Together {
    /// All laws, each with the discrepancy that it needs.
    pub(super) fn laws(&self, iwan: Option<&Parameters>) -> Vec<FittedLaw> {
        let (amplitudes, smooth) = (self.grid.amplitudes(), self.seen_curves());
        // Coordinates where the joint is known to lie: by the fit on the records, and by the fit of the joint alone once that is done.
        let mut joints: Vec<Vec<f64>> = iwan.and_then(|p| self.scales.of_iwan(p)).into_iter().collect();
        let fit = |law: &Candidate, joints: &[Vec<f64>]| {
            let problem =
                Problem::new(law.terms, self.scales, &amplitudes, &self.information, &self.near, &smooth);
            let known = joints.iter().filter(|_| law.has_iwan());
            let more: Vec<_> = known.map(|x| beside_a_joint(law, x.clone())).collect();
            let fitted = problem.fit(&self.ladder, &more)?;
            Some((*law, problem, fitted))
        };
        let alone = CANDIDATES.iter().position(|law| matches!(law.terms, [Term::Iwan]));
        let (first, beside) = CANDIDATES.split_at(alone.map_or(0, |alone| alone + 1));
        let mut fits: Vec<_> =
            in_parallel(first, at_once(), &|law| fit(law, &joints)).into_iter().flatten().collect();
        let joint = fits.iter().find(|(law, ..)| matches!(law.terms, [Term::Iwan]));
        joints.extend(joint.map(|(_, _, fitted)| fitted.at.x.clone()));
        fits.extend(in_parallel(beside, at_once(), &|law| fit(law, &joints)).into_iter().flatten());
        self.exchange(&mut fits);
        let fitted = |(law, problem, fitted): &(Candidate, Problem<'_>, Fitted<'_>)| {
            self.fitted_law(*law, problem, fitted)
        };
        in_parallel(&fits, at_once(), &fitted).into_iter().flatten().collect()
    }

    /// Lets the joint alone go on from where it was found beside a further part that describes the records better, and the joints with further parts
    /// from there: a law with more parts is no less likely than one with fewer, but for the price of its parameters.
    fn exchange<'a>(&'a self, fits: &mut [(Candidate, Problem<'_>, Fitted<'a>)]) {
        let Some(alone) = fits.iter().position(|(law, ..)| matches!(law.terms, [Term::Iwan])) else { return };
        let (_, problem, first) = fits[alone].clone();
        let beside = |law: &Candidate| matches!(law.terms, [Term::Iwan, _, ..]);
        let better = fits.iter().filter(|(law, _, fitted)| beside(law) && fitted.criterion < first.criterion);
        let joints = better.map(|(_, _, fitted)| fitted.at.x[..first.at.x.len()].to_vec());
        let best = joints.fold(first.clone(), |best, x| best.or_better(problem.fit_from(&self.ladder, &x)));
        if best.criterion < first.criterion {
            for (law, problem, fitted) in fits.iter_mut().filter(|(law, ..)| beside(law)) {
                let x = beside_a_joint(law, best.at.x.clone());
                *fitted = fitted.clone().or_better(problem.fit_from(&self.ladder, &x));
            }
            fits[alone].2 = best;
        }
    }

    /// Index, ln λ (decay rate) and ω of the smooth curves at the amplitudes that the records saw, where damping is positive.
    fn seen_curves(&self) -> Vec<(usize, f64, f64)> {
        let curve = |&i: &usize| (i, self.smooth.rates.decay[i].ln(), self.smooth.rates.omega[i]);
        self.seen.iter().map(curve).filter(|c| c.1.is_finite()).collect()
    }

    fn fitted_law(&self, law: Candidate, problem: &Problem<'_>, fitted: &Fitted<'_>) -> Option<FittedLaw> {
        let verdict = self.verdict(&fitted.at.mode)?;
        let size = fitted.whitener.size;
        Some(FittedLaw {
            law,
            criterion: fitted.criterion,
            dissipation_misfit: verdict.dissipation_misfit,
            frequency_misfit: verdict.frequency_misfit,
            discrepancy: (size.decay, size.omega * self.scales.shift / TAU),
            held_out: problem.held_out(fitted, &stretches(&self.seen), &self.smooth.rates, &self.cycles),
            grade: verdict.grade,
            // A law that does not describe the records tells nothing about the structure.
            parameters: match verdict.grade {
                Grade::No => estimates(problem, fitted).into_iter().map(Estimate::untold).collect(),
                Grade::Matches | Grade::Usable => estimates(problem, fitted),
            },
            mode: fitted.at.mode.clone(),
        })
    }

    /// The law's curves against the smooth ones, cycle by cycle, by the same limits as in every fit.
    fn verdict(&self, mode: &LawMode) -> Option<Verdict> {
        let rates = mode.rates(&self.grid.amplitudes()).ok()?;
        let (mut dissipation, mut frequency) = (vec![], vec![]);
        for &i in &self.cycles {
            let law = rates[i];
            let (decay, omega) = (self.smooth.rates.decay[i], self.smooth.rates.omega[i]);
            // D = 2π a² ω λ: at the same amplitude ω λ is compared.
            if decay > 0.0 && law.decay > 0.0 {
                dissipation.push(Compared {
                    measured: (decay * omega).ln(),
                    deviation: self.smooth.decay_sd(i) / decay,
                    model: (law.decay * law.omega).ln(),
                });
            }
            frequency.push(Compared {
                measured: omega / TAU,
                deviation: self.smooth.omega_sd(i) / TAU,
                model: law.omega / TAU,
            });
        }
        Some(Verdict::new(&dissipation, &frequency))
    }
}
