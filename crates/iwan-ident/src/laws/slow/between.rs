//! How far the curves of frequency and damping of one hit on a specimen stray from those of the next.
//!
//! A bolted structure does not repeat itself: joints settle, and temperatures differ from hit to hit. The curves of each hit are taken for those of
//! the specimen plus an offset and a process of ln a that belong to the hit. Offset and process have one size each for damping and for frequency. The
//! four sizes make all hits together likeliest, with the specimen's curves integrated out (restricted maximum likelihood: D. A. Harville, J. Am.
//! Statist. Assoc. 72:320, 1977).

use std::collections::HashMap;

use iwan_machine::threads::{at_once, in_parallel};
use nalgebra::{DMatrix, DVector};

use super::linear::Information;
use super::process::Covariances;
use crate::student::student;

/// Relative sizes of the decay rate that are tried, as the least size and a number: zero, then from the least on each twice the one below, up to a
/// half.
const DECAY: (f64, i32) = (1e-3, 10);
/// Relative sizes of the frequency that are tried, in the same form: up to a half per cent.
const OMEGA: (f64, i32) = (3e-7, 15);

/// Standard deviations of one hit from the specimen's mean.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Scatter {
    /// Standard deviation of the decay rate, relative.
    pub decay: f64,
    /// Standard deviation of the frequency, relative.
    pub frequency: f64,
    /// Number of hits that the scatter was estimated from; below two it is not known, and taken as zero.
    pub hits: usize,
}

impl Scatter {
    /// Half width of the band that holds 95 % of further hits, in standard deviations of the scatter: each hit is one more draw of its offset, so
    /// that this is Student's quantile with one degree of freedom less than hits.
    pub(crate) fn half_width(&self) -> f64 {
        if self.hits < 2 { 0.0 } else { student((self.hits - 1) as f64) }
    }
}

fn sizes((least, count): (f64, i32)) -> Vec<f64> {
    std::iter::once(0.0).chain((0..count).map(|i| least * 2.0_f64.powi(i))).collect()
}

/// Covariances of what one hit strays by, each of unit size: offsets of decay rates and of frequencies, then the processes of both.
struct Straying {
    parts: [DMatrix<f64>; 4],
}

impl Straying {
    /// `ratio` is the circular frequency over its range: how many shifts a relative change of one makes.
    fn new(covariances: &Covariances, ratio: f64) -> Self {
        let offset = |process: &DMatrix<f64>| {
            let sd = process.diagonal().map(f64::sqrt);
            &sd * sd.transpose()
        };
        let (decay, omega) = (&covariances.decay, &covariances.omega * (ratio * ratio));
        Self { parts: [offset(decay), offset(&omega), decay.clone(), omega] }
    }

    fn of(&self, sizes: [f64; 4]) -> DMatrix<f64> {
        let [a, b, c, d] = &self.parts;
        let [p, q, r, s] = sizes.map(|size| size * size);
        a * p + b * q + c * r + d * s
    }
}

/// All hits together, with given sizes of the straying.
struct Trial {
    information: Information,
    /// Twice the negative logarithm of the likelihood.
    deviance: f64,
}

/// What several hits tell about the specimen's curves, given the scatter among them; that scatter; and its covariance. `mean` is the mean of the
/// curves' prior; `omega` and `shift` are the circular frequency and its range, 1/s.
pub(crate) fn specimen(
    hits: &[Information],
    covariances: &Covariances,
    mean: &DVector<f64>,
    (omega, shift): (f64, f64),
) -> Option<(Information, Scatter, DMatrix<f64>)> {
    let straying = Straying::new(covariances, omega / shift);
    if hits.len() < 2 {
        let scatter = Scatter { hits: hits.len(), ..Scatter::default() };
        return Some((Information::sum(hits), scatter, straying.of([0.0; 4])));
    }
    let ladders = [DECAY, OMEGA, DECAY, OMEGA].map(sizes);
    let at = |place: [usize; 4]| std::array::from_fn::<f64, 4, _>(|k| ladders[k][place[k]]);
    let mut known: HashMap<[usize; 4], f64> = HashMap::new();
    let deviance = |place: &[usize; 4]| {
        let one = trial(hits, &straying.of(at(*place)), covariances, mean);
        one.map_or(f64::INFINITY, |t| t.deviance)
    };
    // One size after the other is moved along its values, until none gains.
    let mut place = ladders.each_ref().map(|ladder| ladder.len() / 2);
    loop {
        let before = place;
        for (k, ladder) in ladders.iter().enumerate() {
            let moved = |i: usize| std::array::from_fn(|j| if j == k { i } else { place[j] });
            let along: Vec<[usize; 4]> = (0..ladder.len()).map(moved).collect();
            let new: Vec<[usize; 4]> = along.iter().copied().filter(|p| !known.contains_key(p)).collect();
            known.extend(new.iter().copied().zip(in_parallel(&new, at_once(), &deviance)));
            place = along.into_iter().min_by(|a, b| known[a].total_cmp(&known[b]))?;
        }
        if place == before {
            break;
        }
    }
    let found = at(place);
    let covariance = straying.of(found);
    let Trial { information, .. } = trial(hits, &covariance, covariances, mean)?;
    let scatter =
        Scatter { decay: found[0].hypot(found[2]), frequency: found[1].hypot(found[3]), hits: hits.len() };
    Some((information, scatter, covariance))
}

/// The hits together, where the curves of each hit stray with the covariance `straying`.
fn trial(
    hits: &[Information],
    straying: &DMatrix<f64>,
    covariances: &Covariances,
    mean: &DVector<f64>,
) -> Option<Trial> {
    let (mut deviance, mut all) = (0.0, Vec::with_capacity(hits.len()));
    for Information { factor, target } in hits {
        let rank = target.len();
        let whole = DMatrix::identity(rank, rank) + factor * straying * factor.transpose();
        let lower = whole.cholesky()?.l();
        deviance += 2.0 * lower.diagonal().iter().map(|d| d.ln()).sum::<f64>();
        // Taken about the mean, so that no digits cancel.
        let target = lower.solve_lower_triangular(&(target - factor * mean))?;
        let factor = lower.solve_lower_triangular(factor)?;
        deviance += target.norm_squared();
        all.push(Information { factor, target });
    }
    let together = Information::sum(&all);
    deviance -= together.target.norm_squared();
    let seen = covariances.each(|m| &together.factor * m * together.factor.transpose());
    deviance -= 2.0 * seen.likeliest(&together.target, 1.0)?.log_likelihood;
    let target = &together.target + &together.factor * mean;
    Some(Trial { information: Information { target, ..together }, deviance })
}
