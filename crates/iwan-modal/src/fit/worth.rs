//! Which modes the responses need: a mode that explains no more than noise would, or that doubles another, is left out.

use std::f64::consts::TAU;

use super::band::Band;
use super::linear::Linear;
use super::search::Fitted;
use crate::error::Error;
use crate::number::{Complex, assurance};

/// Least worth of a mode: how many times as much it takes off the responses' sum of squares as fitting its residues to white noise does on average. A judgement above what the
/// best of all lines of noise reaches on many responses; on one or two, chance asks for more.
const WORTH: f64 = 10.0;
/// Largest probability with which noise alone makes a mode in a band. A judgement: a thousandth of it asks for a third more worth on one response.
const BY_CHANCE: f64 = 0.01;
/// Number of decays, between a line's width and the band's, that chance can try independently at each line. A judgement; ten times as many ask for an eighth more worth on one
/// response.
const DECAYS: f64 = 3.0;
/// Largest damping ratio of a mode: beyond it, what was fitted is no peak but a slope of the background.
const HIGHEST_DAMPING: f64 = 0.2;
/// Two poles may be halves of one peak where they are less than this many sums of their decays apart.
const NEAR: f64 = 2.0;
/// They are halves of one peak that is not quite linear where their shapes also have more than this modal assurance criterion. Modes so close and so alike cannot be told
/// apart by any measurement at these points.
const ALIKE: f64 = 0.95;
/// Least number of responses for shapes to be compared: with fewer the criterion is high by chance.
const ENOUGH: usize = 4;

/// Worth of a mode: by how much more is left without it than with it, over what fitting a mode to noise takes off on average. `noise` is the variance of each response's entries.
pub(crate) fn worth(without: &Linear, with: &Linear, noise: &[f64]) -> f64 {
    let gain = |c: usize| (without.left[c] - with.left[c]) / noise[c];
    (0..noise.len()).map(gain).sum::<f64>() / (2 * noise.len()) as f64
}

/// Least worth of a mode in a band.
pub(crate) fn least_worth(band: &Band) -> f64 {
    WORTH.max(by_chance(band.squares.len(), band.s.len()))
}

/// Worth that the best line and decay of a band of noise does not reach. What a pole and its residues take off noise of variance 1 is χ² distributed, with two degrees of
/// freedom for the pole and two for each response. With l the logarithm of the number of trials over BY_CHANCE, it exceeds the bound below with a probability of e^-l at most
/// (B. Laurent, P. Massart, Ann. Statist. 28:1302, 2000, Lemma 1, doi:10.1214/aos/1015957395).
fn by_chance(responses: usize, lines: usize) -> f64 {
    let residues = 2.0 * responses as f64;
    let (values, log) = (residues + 2.0, (DECAYS * lines as f64 / BY_CHANCE).ln());
    (values + 2.0 * (values * log).sqrt() + 2.0 * log) / residues
}

/// Of each pair of poles that share one peak and one shape, the index of the weaker one.
pub(crate) fn twins(poles: &[Complex], residues: &[Vec<Complex>]) -> Vec<usize> {
    let strength = |p: usize| residues[p].iter().map(Complex::norm_sqr).sum::<f64>() / poles[p].re.powi(2);
    let mut weaker = Vec::new();
    for p in 0..poles.len() {
        for q in 0..p {
            let near = (poles[p] - poles[q]).norm() < NEAR * (poles[p].re + poles[q].re).abs();
            if residues[p].len() >= ENOUGH && near && assurance(&residues[p], &residues[q]) > ALIKE {
                weaker.push(if strength(p) < strength(q) { p } else { q });
            }
        }
    }
    weaker.sort_unstable();
    weaker.dedup();
    weaker
}

/// Fits, and leaves out needless modes one after another, the least needed first. The fit has no curves yet; the least squares that it ends with come with it.
pub(crate) fn pruned(band: &Band, start: &[Complex]) -> Result<(Fitted, Linear), Error> {
    let mut poles: Vec<Complex> = start.iter().copied().filter(|p| !is_outside(band, p)).collect();
    loop {
        let (fitted, linear) = Fitted::with_products(band, &poles)?;
        let Some(needless) = needless(band, &fitted, &linear) else { return Ok((fitted, linear)) };
        poles.clone_from(&fitted.poles);
        poles.remove(needless);
    }
}

/// Whether a pole lies outside the band by more than its own decay.
fn is_outside(band: &Band, p: &Complex) -> bool {
    let (low, high) = band.edges();
    let (f, margin) = (p.im / TAU, p.re.abs() / TAU);
    f < low - margin || f > high + margin
}

fn needless(band: &Band, fitted: &Fitted, with: &Linear) -> Option<usize> {
    let poles = &fitted.poles;
    if let Some(p) = poles.iter().position(|p| is_outside(band, p) || -p.re > HIGHEST_DAMPING * p.norm()) {
        return Some(p);
    }
    if let Some(p) = twins(poles, &fitted.residues).first() {
        return Some(*p);
    }
    let mut least = (None, least_worth(band));
    for p in 0..poles.len() {
        let gains = fitted.noise.iter().enumerate().map(|(c, noise)| with.loss(p, c) / noise);
        let worth = gains.sum::<f64>() / (2 * fitted.noise.len()) as f64;
        if worth < least.1 {
            least = (Some(p), worth);
        }
    }
    least.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::{Channel, Freedom, Motion};
    use crate::responses::free_responses;

    /// The best of 3,600 lines of noise: a worth of ten is too little on one response, and enough on three.
    #[test]
    fn few_responses_ask_for_more() {
        let worth = [1, 2, 3, 54].map(|responses| by_chance(responses, 3600));
        assert!((23.0..24.0).contains(&worth[0]) && (12.5..13.5).contains(&worth[1]), "{worth:?}");
        assert!(worth[2] < WORTH && worth[3] < 2.1, "{worth:?}");
    }

    #[test]
    fn what_a_mode_takes_off_is_what_a_fit_without_it_leaves() {
        let value = |n: usize, a: f64| {
            let t = n as f64;
            (-1e-3 * t).exp() * (0.3 * t).cos()
                + a * (-2e-3 * t).exp() * (0.5 * t).sin()
                + 0.01 * (1.7 * t * t).sin()
        };
        let channel = |name: &str, a: f64| Channel {
            name: name.into(),
            freedom: Freedom::point(name),
            samples: (0..1024).map(|n| value(n, a)).collect(),
        };
        let responses =
            free_responses(&[vec![channel("a", 0.3), channel("b", -0.7)]], 1e-3, Motion::Acceleration)
                .unwrap();
        let band = Band::new(&responses, (20.0, 120.0)).unwrap();
        let poles = [Complex::new(-1.0, 300.0), Complex::new(-2.0, 500.0)];
        let with = Linear::new(&band, &poles, false).unwrap();
        for p in 0..2 {
            let without = Linear::new(&band, &poles[1 - p..2 - p], false).unwrap();
            for c in 0..2 {
                let plain = without.left[c] - with.left[c];
                assert!((with.loss(p, c) / plain - 1.0).abs() < 1e-8, "{p} {c}: {} {plain}", with.loss(p, c));
            }
        }
    }
}
