//! Whether the structure with its best joints tells the curves, and where it leaves them.

use serde::Serialize;

use super::measured::Point;
use super::model::Said;

/// Dissipation missed by more is no match: about what repeated hits of one specimen differ by, as in the verdict on a mode.
const DISSIPATION: f64 = 0.03;
/// Frequency missed by more than this part of its measured shift is none.
const FREQUENCY: f64 = 0.1;
/// A shift below this part of the frequency is none: ring-downs of real structures do not repeat better.
const SHIFT_FLOOR: f64 = 1e-5;
/// Neighbours over which misfits are averaged: noise then counts less than half, and a departure keeps its place.
const NEIGHBOURS: usize = 5;
/// Misfits that noise explains, in standard deviations of the average of so many neighbours: of a few hundred averages none is beyond four by
/// chance.
const NOISE: f64 = 4.0;

/// What the structure's own curves are off by: twice what reduced quasi-static curves lose of dissipation and of the loss of frequency. A
/// departure beyond it, and beyond noise, is real however small: the structure is another one.
const OWN: f64 = 2e-3;

/// What passes: of dissipation, and of the frequency over its measured shift.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passing {
    dissipation: f64,
    shift: f64,
}

impl Passing {
    /// What repeated hits of one specimen differ by: enough for predictions.
    pub(super) const REPEATS: Self = Self { dissipation: DISSIPATION, shift: FREQUENCY };
    /// What the computation itself is off by.
    pub(super) const COMPUTED: Self = Self { dissipation: OWN, shift: OWN };
}

/// What is missed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Frequency, Hz.
    Frequency,
    /// Damping ratio, relatively.
    Damping,
}

/// Where the structure leaves a curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Departure {
    /// Mode.
    pub mode: String,
    /// What is missed.
    pub quantity: Quantity,
    /// Modal displacement at which it is missed most.
    pub displacement: f64,
    /// Measured less computed there, averaged over neighbours: Hz, or a part of the damping.
    pub misfit: f64,
    /// What would pass.
    pub limit: f64,
    /// Smallest and largest modal displacement at which it is missed by more than the limit.
    pub range: (f64, f64),
}

/// The verdict on the structure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StructureVerdict {
    /// Whether the structure with these joints tells all curves: damping within 3 %, frequency within a tenth of its shift, or both within
    /// noise.
    pub adequate: bool,
    /// Where it does not, the worst first.
    pub departures: Vec<Departure>,
    /// Where it does by that measure, and departs all the same by more than noise and its own errors, the worst first: another arrangement of
    /// joints tells these curves better.
    pub systematic: Vec<Departure>,
    /// In words.
    pub in_words: String,
}

/// Where one kind of values leaves what is said of them.
fn departure(misfits: &[f64], floor: f64) -> Option<(usize, f64, f64, (usize, usize))> {
    let n = misfits.len();
    let width = NEIGHBOURS.min(n);
    // What jumps between neighbours is noise: of a straight line second differences leave nothing, of noise six times its variance.
    let second = misfits.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2) / 6.0);
    let noise = (second.sum::<f64>() / (n as f64 - 2.0).max(1.0)).sqrt();
    let limit = floor.max(NOISE * noise / (width as f64).sqrt());
    let mean = |i: usize| {
        let from = i.saturating_sub(width / 2).min(n - width);
        misfits[from..from + width].iter().sum::<f64>() / width as f64
    };
    let beyond: Vec<usize> = (0..n).filter(|i| mean(*i).abs() > limit).collect();
    let worst = beyond.iter().copied().max_by(|a, b| mean(*a).abs().total_cmp(&mean(*b).abs()))?;
    Some((worst, mean(worst), limit, (beyond[0], beyond[beyond.len() - 1])))
}

/// Where the structure leaves a curve, frequency and damping.
pub(super) fn departures(mode: &str, points: &[Point], said: &[Said], passing: Passing) -> Vec<Departure> {
    let range = points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |r, p| (r.0.min(p.frequency), r.1.max(p.frequency)));
    let frequency_floor = (passing.shift * (range.1 - range.0)).max(SHIFT_FLOOR * range.1);
    let pairs = || points.iter().zip(said);
    let frequencies: Vec<f64> = pairs().map(|(p, s)| p.frequency - s.frequency).collect();
    let damping: Vec<f64> = pairs().map(|(p, s)| p.log_damping - s.log_damping).collect();
    [(Quantity::Frequency, frequencies, frequency_floor), (Quantity::Damping, damping, passing.dissipation)]
        .into_iter()
        .filter_map(|(quantity, misfits, floor)| {
            let (worst, misfit, limit, (first, last)) = departure(&misfits, floor)?;
            let q = |i: usize| points[i].displacement;
            let (displacement, range) = (q(worst), (q(first), q(last)));
            Some(Departure { mode: mode.to_owned(), quantity, displacement, misfit, limit, range })
        })
        .collect()
}

impl StructureVerdict {
    /// Of all departures beyond what passes, and of those beyond noise.
    pub(super) fn new(mut departures: Vec<Departure>, mut systematic: Vec<Departure>) -> Self {
        let badness = |d: &Departure| d.misfit.abs() / d.limit;
        let worst_first = |a: &Departure, b: &Departure| badness(b).total_cmp(&badness(a));
        departures.sort_by(worst_first);
        systematic.sort_by(worst_first);
        if !departures.is_empty() {
            systematic.clear();
        }
        let in_words = match (departures.first(), systematic.first()) {
            (Some(worst), _) => {
                format!("the structure with the best joints leaves the data: {}", worst.in_words())
            }
            (None, Some(worst)) => format!(
                "the structure with these joints tells frequency and damping of all measured modes as well as hits repeat, but departs from them \
                 by more than noise and its own errors: {}; another arrangement of joints (one forgotten, or tied at one end) may be the true one, \
                 and a mode that moves them in another way would tell",
                worst.in_words()
            ),
            (None, None) => {
                "the structure with these joints tells frequency and damping of all measured modes".into()
            }
        };
        Self { adequate: departures.is_empty(), departures, systematic, in_words }
    }
}

impl Departure {
    /// In words.
    #[must_use]
    pub fn in_words(&self) -> String {
        let more = if self.misfit > 0.0 { "above" } else { "below" };
        let (what, by, limit) = match self.quantity {
            Quantity::Frequency => {
                ("frequency", format!("{:.4} Hz", self.misfit.abs()), format!("{:.4} Hz", self.limit))
            }
            Quantity::Damping => {
                let by = (self.misfit.exp() - 1.0).abs();
                ("damping", format!("{:.1} %", 100.0 * by), format!("{:.1} %", 100.0 * self.limit))
            }
        };
        format!(
            "the {what} of {} lies {by} {more} it at the modal displacement {:.3e} (limit {limit}; missed from {:.3e} to {:.3e})",
            self.mode, self.displacement, self.range.0, self.range.1
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bend_is_told_from_noise_and_its_place_is_named() {
        // Noise of 1 % that jumps: no departure.
        let noise = |i: usize| if (i * 7).is_multiple_of(3) { 0.01 } else { -0.006 };
        let flat: Vec<f64> = (0..30).map(noise).collect();
        assert!(departure(&flat, 0.03).is_none());
        let bent: Vec<f64> =
            (0..30).map(|i| noise(i) + if i > 20 { 0.01 * (i - 20) as f64 } else { 0.0 }).collect();
        let (worst, misfit, _, (first, last)) = departure(&bent, 0.03).unwrap();
        assert!(worst >= 27 && misfit > 0.05 && first > 22 && last == 29, "{worst} {misfit} {first}");
    }
}
