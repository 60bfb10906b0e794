//! Viscous and frictional dissipation told apart by comparing force levels at equal times.
//!
//! Within one ring-down the slope of dissipation over force mixes three things: the joints' power law, a viscous term of
//! slope 2, and what other modes add, which fades while they ring down. At the same time after blows of the same shape the
//! other modes stand in the same proportion, so that from level to level
//! D = 2π ζ_v ω0 ω q² + B(t) F^s with one s and one ζ_v: B is free at every time, s and ζ_v are sought.

use std::f64::consts::TAU;

use crate::curves::Curves;
use crate::error::{Error, check, check_length};

/// Number of times at which levels are compared: smooth curves hold at most a dozen independent values, so that more times say the same.
const TIMES: usize = 40;
/// Number of values of ζ_v, evenly from 0 up to the most that the curves allow, that are tried before the best is refined. The misfit may have
/// several valleys (local minima); one that lies between two tries, half a per cent of the range apart, would be missed.
const TRIED: usize = 200;
/// Number of golden sections of the bracket: 0.618^60 brings it to 3e-13 of its length, which is rounding.
const SECTIONS: usize = 60;

/// Viscous damping and power law of friction that all levels have in common.
#[derive(Debug, Clone, PartialEq)]
pub struct Levels {
    /// Viscous damping ratio ζ_v.
    pub damping_ratio: f64,
    /// Power s of the frictional dissipation over force.
    pub slope: f64,
    /// RMS residual of ln D (friction part) about the common power law.
    pub misfit: f64,
    /// Slopes from each level to the next.
    pub steps: Vec<LevelStep>,
}

/// Mean slope of ln D over ln F from one level to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LevelStep {
    /// Slope of the whole dissipation.
    pub total: f64,
    /// Slope of the dissipation without the viscous term.
    pub friction: f64,
}

/// Compares the curves of at least three levels, from the softest to the hardest blow; `frequency` is ω0/2π in Hz.
///
/// # Errors
/// [`Error::TooShort`] with fewer than three levels; [`Error::OutOfRange`] for the frequency; [`Error::Refused`] when the curves
/// share no time, or a dissipation is not positive.
///
/// ```
/// use iwan_ident::curves::Curves;
/// use iwan_ident::levels::compare_levels;
/// // Blows of 1, 3 and 10 on a mode of 100 Hz with ζ_v = 3e-4 and friction of the power 2.7, which fades with other modes.
/// let omega = std::f64::consts::TAU * 100.0;
/// let level = |blow: f64| {
///     let t: Vec<f64> = (0..50).map(|i| 0.01 * f64::from(i)).collect();
///     let q: Vec<f64> = t.iter().map(|t| 1e-3 * blow * (-t).exp()).collect();
///     let force: Vec<f64> = q.iter().map(|q| omega * omega * q).collect();
///     let viscous = |q: &f64| std::f64::consts::TAU * 3e-4 * (omega * q).powi(2);
///     let dissipation = (0..50).map(|i| viscous(&q[i]) + 1e-10 * (1.0 + (-3.0 * t[i]).exp()) * force[i].powf(2.7)).collect();
///     let (zeros, frequency) = (vec![0.0; 50], vec![100.0; 50]);
///     Curves { t, displacement: q, frequency, damping_ratio: zeros.clone(), dissipation, force, axis: Default::default(),
///         log_dissipation_sd: zeros.clone(), frequency_sd: zeros, independent: 5.0 }
/// };
/// let found = compare_levels(&[level(1.0), level(3.0), level(10.0)], 100.0)?;
/// assert!((found.damping_ratio - 3e-4).abs() < 1e-7 && (found.slope - 2.7).abs() < 1e-3);
/// // As it is the slope drifts with the level, without the viscous term it does not.
/// assert!(found.steps[1].total > found.steps[0].total + 0.05 && (found.steps[1].friction - found.steps[0].friction).abs() < 1e-3);
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn compare_levels(curves: &[Curves], frequency: f64) -> Result<Levels, Error> {
    if curves.len() < 3 {
        let remedy = "record at three force levels at least";
        return Err(Error::TooShort { what: "force levels", found: curves.len(), needed: 3, remedy });
    }
    check("frequency", frequency, frequency > 0.0, "> 0 Hz", "give the small-amplitude frequency")?;
    let levels = at_equal_times(curves)?;
    let omega = TAU * frequency;
    let limit = levels
        .iter()
        .flat_map(|c| (0..c.t.len()).map(move |i| c.dissipation[i] / viscous(c, i, omega)))
        .fold(f64::INFINITY, f64::min);
    if limit.is_nan() || limit <= 0.0 {
        let remedy = "leave out levels at which the envelope does not decay";
        return Err(Error::Refused { finding: "a dissipation is not positive".into(), remedy });
    }
    let miss = |zeta: f64| common_slope(&levels, zeta, omega).map_or(f64::INFINITY, |found| found.misfit);
    let damping_ratio = lowest(&miss, limit);
    let CommonSlope { slope, misfit } =
        common_slope(&levels, damping_ratio, omega).ok_or_else(|| Error::Refused {
            finding: "the levels do not differ in force".into(),
            remedy: "record at different force levels",
        })?;
    let steps = levels.windows(2).map(|pair| LevelStep {
        total: step([&pair[0], &pair[1]], 0.0, omega),
        friction: step([&pair[0], &pair[1]], damping_ratio, omega),
    });
    Ok(Levels { damping_ratio, slope, misfit, steps: steps.collect() })
}

/// The curves at TIMES times that all of them cover.
fn at_equal_times(curves: &[Curves]) -> Result<Vec<Curves>, Error> {
    let ends = |c: &Curves| Some((*c.t.first()?, *c.t.last()?));
    let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
    for c in curves {
        check_length("dissipation", c.dissipation.len(), c.t.len())?;
        let (first, last) = ends(c).unwrap_or((f64::INFINITY, f64::NEG_INFINITY));
        (from, to) = (from.max(first), to.min(last));
    }
    if from.is_nan() || from >= to {
        let remedy = "choose windows that overlap";
        return Err(Error::Refused { finding: "the curves of the levels share no time".into(), remedy });
    }
    // The times lie inside the ends, so that rounding does not lose one of them.
    let time = |i: usize| from + (to - from) * (i as f64 + 0.5) / TIMES as f64;
    let times: Vec<f64> = (0..TIMES).map(time).collect();
    Ok(curves.iter().map(|c| c.at(&times)).collect())
}

/// Viscous dissipation of entry `i` per unit of ζ_v.
fn viscous(c: &Curves, i: usize, omega: f64) -> f64 {
    TAU * omega * TAU * c.frequency[i] * c.displacement[i].powi(2)
}

/// The point (ln F, ln D) of an entry, D without the viscous term; none where the viscous term is larger than the dissipation.
fn point(c: &Curves, i: usize, zeta: f64, omega: f64) -> Option<(f64, f64)> {
    let friction = c.dissipation[i] - zeta * viscous(c, i, omega);
    (friction > 0.0).then(|| (c.force[i].ln(), friction.ln()))
}

/// The slope of ln D over ln F that all levels share, with an intercept of its own at each time.
struct CommonSlope {
    slope: f64,
    /// Root mean square residual of ln D.
    misfit: f64,
}

fn common_slope(levels: &[Curves], zeta: f64, omega: f64) -> Option<CommonSlope> {
    let mut centred = Vec::with_capacity(TIMES * levels.len());
    for i in 0..TIMES {
        let points: Vec<(f64, f64)> =
            levels.iter().map(|c| point(c, i, zeta, omega)).collect::<Option<_>>()?;
        let n = points.len() as f64;
        let mean = points.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
        centred.extend(points.iter().map(|p| (p.0 - mean.0, p.1 - mean.1)));
    }
    let sum = |term: &dyn Fn(&(f64, f64)) -> f64| centred.iter().map(term).sum::<f64>();
    let slope = sum(&|p| p.0 * p.1) / sum(&|p| p.0 * p.0);
    let rest = sum(&|p| (p.1 - slope * p.0).powi(2));
    slope.is_finite().then(|| CommonSlope { slope, misfit: (rest / centred.len() as f64).sqrt() })
}

/// Mean slope between two levels.
fn step([soft, hard]: [&Curves; 2], zeta: f64, omega: f64) -> f64 {
    let slopes = (0..TIMES).filter_map(|i| {
        let (a, b) = (point(soft, i, zeta, omega)?, point(hard, i, zeta, omega)?);
        Some((b.1 - a.1) / (b.0 - a.0))
    });
    let (sum, count) = slopes.fold((0.0, 0.0), |(sum, n), slope| (sum + slope, n + 1.0));
    sum / count
}

/// The place between 0 and `limit` at which a function is lowest: by trial, then by golden sections.
fn lowest(miss: &dyn Fn(f64) -> f64, limit: f64) -> f64 {
    let at = |i: usize| limit * i as f64 / TRIED as f64;
    let best = (0..TRIED).min_by(|&i, &j| miss(at(i)).total_cmp(&miss(at(j)))).unwrap_or(0);
    let (mut low, mut high) = (at(best.saturating_sub(1)), at(best + 1));
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..SECTIONS {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if miss(a) <= miss(b) { high = b } else { low = a }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_cannot_be_compared_is_refused() {
        assert!(compare_levels(&[], 100.0).unwrap_err().to_string().contains("force levels"));
        let none = Curves {
            t: vec![],
            displacement: vec![],
            frequency: vec![],
            damping_ratio: vec![],
            dissipation: vec![],
            force: vec![],
            axis: crate::curves::ForceAxis::Modal,
            log_dissipation_sd: vec![],
            frequency_sd: vec![],
            independent: 0.0,
        };
        let error = compare_levels(&[none.clone(), none.clone(), none.clone()], 100.0).unwrap_err();
        assert!(error.to_string().contains("share no time"), "{error}");
        assert!(compare_levels(&[none.clone(), none.clone(), none], 0.0).is_err());
    }
}
