//! The stabilisation chart, and the poles that stay in it.

use super::polynomial::Denominator;
use crate::error::{Error, check};
use crate::fit::Band;
use crate::measure::Freedom;
use crate::number::Complex;
use crate::responses::FrequencyResponses;

/// A pole stays from one order to the next where its frequency moves by less than the sum of three terms. The first is this fraction of the frequency.
const FREQUENCY: f64 = 1e-3;
/// The second term is this fraction of the decay.
const DECAY: f64 = 0.4;
/// The third term is this fraction of the distance of lines.
const LINE: f64 = 0.2;
/// The damping of a pole that stays changes by less than this fraction. Common charts allow 5 %; but the polynomials find light damping between the lines less well than that,
/// and the fit that follows finds it much better.
const DAMPING: f64 = 0.5;
/// Largest damping ratio of a mode: beyond it there is no peak.
const HIGHEST_DAMPING: f64 = 0.2;
/// A candidate stays over at least this fraction of the upper half of the orders. A smaller value lets in poles of noise, which the fit then has to throw out; a larger one loses
/// weak modes, which have to be found again in what the fit leaves.
const STAYS: f64 = 0.6;

/// A pole of one order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChartPole {
    /// Order of the polynomials.
    pub order: usize,
    /// Hz.
    pub frequency: f64,
    /// Ratio of critical damping.
    pub damping_ratio: f64,
    /// Whether frequency and damping stay as they were at the order before.
    pub stable: bool,
}

/// A pole that stays over most orders.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// Pole, 1/s.
    pub pole: nalgebra::Complex<f64>,
    /// Fraction of the upper half of the orders at which the pole is found.
    pub stays: f64,
}

/// The poles of all orders, and those that stay.
#[derive(Debug, Clone, PartialEq)]
pub struct Stabilisation {
    /// Every pole that decays and has a damping ratio of at most 0.2, order by order.
    pub poles: Vec<ChartPole>,
    /// The poles that stay, by ascending frequency.
    pub candidates: Vec<Candidate>,
}

/// The stabilisation chart of responses between the edges (Hz), up to polynomials of the order `highest`.
///
/// # Errors
/// [`Error::OutOfRange`] for the order (4 to 200) and the band; [`Error::Refused`] where the lines do not carry the order.
pub fn stabilisation(
    responses: &FrequencyResponses,
    edges: (f64, f64),
    highest: usize,
) -> Result<Stabilisation, Error> {
    chart(&Band::new(responses, edges)?, highest)
}

pub(crate) fn chart(band: &Band, highest: usize) -> Result<Stabilisation, Error> {
    let remedy = "twice the number of modes at least, three times is a good choice";
    let ok = (4..=200).contains(&highest) && 2 * highest < band.lines();
    let allowed = format!("4 to {}, below half the number of lines", (band.lines() / 2).min(200));
    check("order", highest as f64, ok, allowed, remedy)?;
    let matrix = matrix(band.responses);
    let orders: Vec<usize> = (2..=highest).step_by(2).collect();
    let found = Denominator::new(band, &matrix, &orders)?.poles();
    // With an exponential window the responses are those at iω + decay, and so are the poles found.
    let true_poles = |all: &Vec<Complex>| all.iter().map(|p| *p + band.responses.decay).collect();
    Ok(charted(&orders, &found.iter().map(true_poles).collect::<Vec<_>>(), band.responses.step))
}

/// The chart of the poles found at each order; `step` is the distance of lines that the records' length allows, Hz.
pub(super) fn charted(orders: &[usize], found: &[Vec<Complex>], step: f64) -> Stabilisation {
    let reach = LINE * std::f64::consts::TAU * step;
    let usable = |p: &&Complex| p.re < 0.0 && -p.re <= HIGHEST_DAMPING * p.norm();
    let found: Vec<Vec<Complex>> =
        found.iter().map(|all| all.iter().filter(usable).copied().collect()).collect();
    let mut poles = Vec::new();
    for (i, (order, own)) in orders.iter().zip(&found).enumerate() {
        for p in own {
            let stable = i > 0 && found[i - 1].iter().any(|q| same(*p, *q, reach));
            let (frequency, damping_ratio) = (p.norm() / std::f64::consts::TAU, -p.re / p.norm());
            poles.push(ChartPole { order: *order, frequency, damping_ratio, stable });
        }
    }
    Stabilisation { poles, candidates: candidates(&found, reach) }
}

/// For each output the indices of its responses to all references; where pairs are missing, each response by itself, with one denominator for all.
fn matrix(responses: &FrequencyResponses) -> Vec<Vec<usize>> {
    let f = &responses.functions;
    let mut forces: Vec<_> = f.iter().map(|f| &f.force).collect();
    let mut outputs: Vec<_> = f.iter().map(|f| &f.response).collect();
    for list in [&mut forces, &mut outputs] {
        list.sort();
        list.dedup();
    }
    // The references are the fewer of the two, forces or sensors.
    let roving_hammer = forces.len() > outputs.len();
    if roving_hammer {
        std::mem::swap(&mut forces, &mut outputs);
    }
    let place = |a: &Freedom, b: &Freedom| {
        let (response, force) = if roving_hammer { (b, a) } else { (a, b) };
        f.iter().position(|f| f.response == *response && f.force == *force)
    };
    let row = |a: &&Freedom| forces.iter().map(|b| place(a, b)).collect::<Option<Vec<usize>>>();
    let complete: Option<Vec<Vec<usize>>> = outputs.iter().map(row).collect();
    complete
        .filter(|rows| rows.len() > rows[0].len())
        .unwrap_or_else(|| (0..f.len()).map(|i| vec![i]).collect())
}

fn same(p: Complex, q: Complex, reach: f64) -> bool {
    let near = FREQUENCY * p.im + DECAY * p.re.abs() + reach;
    (p.im - q.im).abs() < near && (p.re / q.re).max(q.re / p.re) < 1.0 + DAMPING
}

/// Poles of the higher orders that are also found at most orders below, down to half the highest.
fn candidates(found: &[Vec<Complex>], reach: f64) -> Vec<Candidate> {
    let upper = &found[found.len() / 2..];
    let mut candidates: Vec<Candidate> = Vec::new();
    for start in upper.iter().rev().flatten() {
        // Along the orders downwards, from pole to nearest pole.
        let (mut last, mut members) = (*start, Vec::new());
        for own in upper.iter().rev() {
            let distance = |q: &&Complex| (*q - last).norm();
            if let Some(q) = own
                .iter()
                .filter(|q| same(last, **q, reach))
                .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            {
                members.push(*q);
                last = *q;
            }
        }
        let stays = members.len() as f64 / upper.len() as f64;
        let pole = middle(&members);
        let known =
            candidates.iter().any(|c| (c.pole - pole).norm() < 0.2 * pole.re.abs() + 1e-5 * pole.norm());
        if stays >= STAYS && !known {
            candidates.push(Candidate { pole, stays });
        }
    }
    candidates.sort_by(|a, b| a.pole.im.total_cmp(&b.pole.im));
    candidates
}

/// A pole with the median frequency and the median decay.
fn middle(members: &[Complex]) -> Complex {
    let part = |f: fn(&Complex) -> f64| crate::number::median(&members.iter().map(f).collect::<Vec<_>>());
    crate::number::complex(part(|p| p.re), part(|p| p.im))
}
