//! Mode isolation: M. S. Allen, J. H. Ginsberg, *A global, single-input-multi-output (SIMO) implementation of the algorithm of mode
//! isolation and application to analytical and experimental data*, Mechanical Systems and Signal Processing 20, 2006.

use nalgebra::DMatrix;

use super::residue_peak::strongest_peak;
use crate::error::{Error, check};
use crate::fit::{Band, Fitted, Linear, least_worth, left_over, twins, worth};
use crate::number::Complex;
use crate::responses::FrequencyResponses;

/// Number of successive peaks that prove to be no modes after which the search ends: the strongest peaks come first.
const IN_VAIN: usize = 3;

/// One mode that mode isolation found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Pole when it was isolated, 1/s.
    pub pole: nalgebra::Complex<f64>,
    /// Height of its peak over the lines around it, in what the modes found before it had left.
    pub height: f64,
    /// Root mean square of the residuals with this mode over that of the responses.
    pub left: f64,
}

/// Modes found one after another.
#[derive(Debug, Clone, PartialEq)]
pub struct Isolation {
    /// The steps, in the order in which modes were found.
    pub steps: Vec<Step>,
    /// Poles after all were refined together, 1/s, by ascending frequency.
    pub poles: Vec<nalgebra::Complex<f64>>,
}

/// Takes at most `most` modes off the responses between the edges (Hz), one after another, the strongest peak of the composite first; all modes found so far are refined
/// together after each.
///
/// # Errors
/// [`Error::OutOfRange`] for the band and for `most` (1 to 100); [`Error::Refused`] where two modes cannot be told apart.
pub fn isolate(responses: &FrequencyResponses, edges: (f64, f64), most: usize) -> Result<Isolation, Error> {
    check("most modes", most as f64, (1..=100).contains(&most), "1 to 100", "40 is a good choice")?;
    isolation_alone(&Band::new(responses, edges)?, most)
}

/// Mode isolation that knows no pole yet.
pub(crate) fn isolation_alone(band: &Band, most: usize) -> Result<Isolation, Error> {
    let linear = Linear::new(band, &[], false)?;
    let rest = linear.rest(band);
    Ok(isolation(band, Vec::new(), (linear, rest), most))
}

/// Mode isolation that starts from `poles` that are known already, with their least squares and what these leave of the responses.
pub(crate) fn isolation(
    band: &Band,
    mut poles: Vec<Complex>,
    (mut linear, mut rest): (Linear, DMatrix<f64>),
    most: usize,
) -> Isolation {
    let (mut steps, mut passed) = (Vec::new(), Vec::new());
    let mut noise = left_over(band, &linear);
    let all: f64 = band.squares.iter().sum::<f64>().max(f64::MIN_POSITIVE);
    let mut in_vain = 0;
    while steps.len() < most && in_vain < IN_VAIN {
        let Some(peak) = strongest_peak(band, &rest, &noise, &passed) else { break };
        passed.push(peak.pole.im / std::f64::consts::TAU);
        in_vain += 1;
        let mut more = poles.clone();
        more.push(peak.pole);
        let Ok((fitted, found)) = Fitted::rough(band, &more) else { continue };
        if worth(&linear, &found, &fitted.noise) < least_worth(band)
            || !twins(&fitted.poles, &fitted.residues).is_empty()
        {
            continue;
        }
        in_vain = 0;
        let after: f64 = found.left.iter().sum();
        (poles, linear) = (fitted.poles, found);
        (rest, noise) = (linear.rest(band), left_over(band, &linear));
        steps.push(Step { pole: peak.pole, height: peak.height, left: (after / all).sqrt() });
    }
    Isolation { steps, poles }
}
