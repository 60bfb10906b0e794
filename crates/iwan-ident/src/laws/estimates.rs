//! Parameters of a law in their own units, with intervals.

use iwan_core::{Backbone, Part};

use super::fit::{At, Fitted, Problem};
use super::mode::{Joint, LawMode};
use super::slow::HALF_WIDTH;
use super::terms::knee;

/// Part of its prior's standard deviation below which a parameter's standard deviation must lie for the parameter to count as told by the records.
const TOLD: f64 = 0.3;
/// Step of the differences in the coordinates, which are of order one.
const STEP: f64 = 1e-5;
/// Half width, as a logarithm, from which on the interval of a positive parameter counts as open: a factor of a million to either side tells nothing. A share of next to nothing
/// has such an interval, whatever its unit.
const WIDEST: f64 = 14.0;

/// Distance from an end of its range within which a coordinate stands at that end: there the search stopped, and it found nothing. Coordinates are of
/// order one, and searches stop some 1e-5 before an end.
const AT_LIMIT: f64 = 1e-3;
/// A parameter hangs on a coordinate at an end of its range where the prior's width of the coordinate moves the parameter by more than this part of
/// its standard deviation. It then has no interval.
const HANGS: f64 = 0.1;

/// Coefficients beside an exponent, in whose unit the exponent stands: where an exponent is not told, nor is what its coefficient means. Of six hits of one double beam, three did not tell the
/// exponent of damping, and closed intervals of its coefficient all the same, one from 0.8 to 1.5 and one from 3.0 to 16.9.
const BESIDE_AN_EXPONENT: [[&str; 2]; 2] = [["damping_c", "damping_n"], ["spring_k", "spring_exponent"]];

/// Number of knees that are tried on either side of the best one.
const KNEES: usize = 10;
/// Increase of the sum of squares up to which a knee is accepted: the 95 % quantile of χ² with one degree of freedom.
const ACCEPTED: f64 = 3.841;
/// Relative distance from the best value beyond which a parameter still moves at the last knee that was tried, so that its interval is open on that
/// side.
const MOVING: f64 = 0.2;

/// A parameter of a law, with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Its name: `frequency`, `damping_ratio`, `coulomb_force`, `quadratic_c`, `damping_c`, `damping_n`, `cubic_k`, `spring_k`,
    /// `spring_exponent`, `pinning_k`, `pinning_gap`, `k_t`, `f_s`, `chi`, `beta`.
    pub name: &'static str,
    /// Its value, mass-normalised; `frequency` in Hz.
    pub value: f64,
    /// Lower end of the interval of 95 %; none: open.
    pub low: Option<f64>,
    /// Upper end of the interval of 95 %; none: open.
    pub high: Option<f64>,
}

impl Estimate {
    /// The same value without an interval.
    pub(super) const fn untold(self) -> Self {
        Self { low: None, high: None, ..self }
    }

    /// Widens the interval to contain that of another estimate of the same parameter.
    fn include(&mut self, other: &Self) {
        let join =
            |a: Option<f64>, b: Option<f64>, pick: fn(f64, f64) -> f64| a.zip(b).map(|(a, b)| pick(a, b));
        self.low = join(self.low, other.low, f64::min);
        self.high = join(self.high, other.high, f64::max);
    }

    /// Opens the interval on the side of `last`, where this value lies far from the best one.
    fn open_towards(&mut self, last: &Self) {
        let away = (last.value - self.value) / self.value.abs();
        if away > MOVING {
            self.high = None;
        } else if away < -MOVING {
            self.low = None;
        }
    }
}

/// A parameter with its name, and whether it is positive by nature: its interval is then one of the logarithm.
#[derive(Debug, Clone, Copy)]
struct Named {
    name: &'static str,
    value: f64,
    positive: bool,
}

/// The parameters of a mode, in the order of the tables.
fn values(mode: &LawMode) -> Vec<Named> {
    let positive = |name, value| Named { name, value, positive: true };
    let any = |name, value| Named { name, value, positive: false };
    let mut out = vec![any("frequency", mode.frequency), any("damping_ratio", mode.damping_ratio)];
    match &mode.joint {
        Some(Joint::FourParameter(joint)) => {
            let k_t = joint.initial_stiffness();
            out.extend([positive("k_t", k_t), positive("f_s", joint.slip_force())]);
            out.extend([any("chi", joint.chi()), any("beta", joint.beta())]);
        }
        Some(Joint::Jenkins(joint)) => {
            out.extend([positive("k_t", joint.initial_stiffness()), positive("f_s", joint.slip_force())]);
        }
        None => {}
    }
    for part in &mode.parts {
        match part {
            Part::Coulomb(part) => out.push(any("coulomb_force", part.size())),
            Part::PowerDamping(part) if part.n() == 2.0 => out.push(any("quadratic_c", part.c())),
            Part::PowerDamping(part) => {
                out.extend([positive("damping_c", part.c()), any("damping_n", part.n())]);
            }
            Part::Spring(part) if part.exponent() == 3.0 => out.push(any("cubic_k", part.k())),
            Part::Spring(part) => {
                out.extend([positive("spring_k", part.k()), any("spring_exponent", part.exponent())]);
            }
            Part::Pinning(part) => {
                out.extend([positive("pinning_k", part.k()), positive("pinning_gap", part.gap())]);
            }
        }
    }
    out
}

/// The parameters of a fitted law with their intervals. A law whose curves have a knee is fitted with the knee held at many values, and an interval
/// contains those of all knees that the records accept.
pub(super) fn estimates(problem: &Problem<'_>, fitted: &Fitted<'_>) -> Vec<Estimate> {
    let mut out = about(problem, &fitted.at, true);
    let Some(place) = knee(problem.terms) else { return out };
    let (at, ends) = (fitted.at.x[place], problem.knees());
    // Upwards and downwards from the best knee, each fit beginning at its neighbour.
    for end in [ends.1, ends.0] {
        let (mut x, mut last) = (fitted.at.x.clone(), None);
        let mut open = true;
        for k in 1..=KNEES {
            x[place] = at + (end - at) * (k as f64 / KNEES as f64).powi(2);
            let Some(held) = problem.holding(fitted.whitener, place, &x) else { continue };
            x.clone_from(&held.fitted.x);
            if held.cost - fitted.cost > ACCEPTED {
                open = false;
                continue;
            }
            let one = about(problem, &held.fitted, false);
            out.iter_mut().zip(&one).for_each(|(all, one)| all.include(one));
            open = true;
            last = Some((one, k));
        }
        // The records accept all knees up to the last one: a parameter that still moves there has no end on that side.
        if let (true, Some((last, KNEES))) = (open, last) {
            out.iter_mut().zip(&last).for_each(|(all, last)| all.open_towards(last));
        }
    }
    out
}

/// The parameters at some coordinates, with intervals from the covariance. With `may_open` an interval is open where the records say next to nothing.
fn about(problem: &Problem<'_>, fitted: &At, may_open: bool) -> Vec<Estimate> {
    let own = values(&fitted.mode);
    let logs =
        |v: &Named, w: &Named| if v.positive { (w.value / v.value).abs().ln() } else { w.value - v.value };
    // Rows: parameters, columns: coordinates. Differences are one-sided, and point inwards at an upper bound.
    let mut slopes = vec![vec![0.0; fitted.x.len()]; own.len()];
    for j in 0..fitted.x.len() {
        let step = if fitted.x[j] + STEP > problem.coordinates[j].bounds.1 { -STEP } else { STEP };
        let mut x = fitted.x.clone();
        x[j] += step;
        let Some(moved) = problem.scales.mode(problem.terms, &x) else { continue };
        for (i, (v, w)) in own.iter().zip(values(&moved)).enumerate() {
            slopes[i][j] = logs(v, &w) / step;
        }
    }
    let variance = |slope: &[f64], covariance: &dyn Fn(usize, usize) -> f64| {
        let mut sum = 0.0;
        for (i, a) in slope.iter().enumerate() {
            for (j, b) in slope.iter().enumerate() {
                sum += a * b * covariance(i, j);
            }
        }
        sum.max(0.0).sqrt()
    };
    let prior = |i: usize, j: usize| if i == j { problem.coordinates[i].width.powi(2) } else { 0.0 };
    // Zero is the least that a share can be; all other ends of ranges are only those of the search.
    let stands = |(x, end): (f64, f64)| end != 0.0 && (x - end).abs() < AT_LIMIT;
    let at_limit = |j: usize| {
        let (x, (low, high)) = (fitted.x[j], problem.coordinates[j].bounds);
        stands((x, low)) || stands((x, high))
    };
    let limits: Vec<usize> = (0..fitted.x.len()).filter(|j| at_limit(*j)).collect();
    let deviation = |slope: &[f64]| variance(slope, &|i, j| fitted.covariance[(i, j)]);
    let hangs = |slope: &[f64]| {
        let least = HANGS * deviation(slope);
        limits.iter().any(|j| slope[*j].abs() * problem.coordinates[*j].width > least)
    };
    // A spring whose exponent stands at an end of its range carries the frequency at rest, to which the damping ratio is relative, far from all frequencies that were seen.
    let carried = own.iter().zip(&slopes).any(|(v, slope)| v.name == "spring_exponent" && hangs(slope));
    let known = |v: &Named, slope: &[f64]| {
        let sd = deviation(slope);
        let untold = hangs(slope) || carried && ["frequency", "damping_ratio"].contains(&v.name);
        !untold && sd < TOLD * variance(slope, &prior) && (!v.positive || HALF_WIDTH * sd < WIDEST)
    };
    let told: Vec<&str> =
        own.iter().zip(&slopes).filter(|(v, slope)| known(v, slope)).map(|(v, _)| v.name).collect();
    let is_told = |name: &str| {
        let exponent = BESIDE_AN_EXPONENT.iter().find(|pair| pair[0] == name).map(|pair| pair[1]);
        told.contains(&name) && exponent.is_none_or(|exponent| told.contains(&exponent))
    };
    let one = |(v, slope): (&Named, &Vec<f64>)| {
        interval(v, HALF_WIDTH * deviation(slope), is_told(v.name) || !may_open)
    };
    own.iter().zip(&slopes).map(one).collect()
}

fn interval(v: &Named, half: f64, told: bool) -> Estimate {
    let (low, high) = if v.positive {
        // The value may have either sign, as that of a softening spring.
        let ends = (v.value * (-half).exp(), v.value * half.exp());
        (ends.0.min(ends.1), ends.0.max(ends.1))
    } else {
        let least = if matches!(v.name, "chi" | "cubic_k" | "frequency") { f64::NEG_INFINITY } else { 0.0 };
        ((v.value - half).max(least), v.value + half)
    };
    let end = |e: f64| (told && e.is_finite()).then_some(e);
    Estimate { name: v.name, value: v.value, low: end(low), high: end(high) }
}
