//! Whether the structure with its best joints describes the curves, and where it departs from them.

use iwan_ident::estimate::student_quantile;
use serde::Serialize;

use super::measured::Point;
use super::model::Said;

/// A larger relative misfit of dissipation is no match: about as much as repeated hits of one specimen differ, as in the verdict on a single mode.
const DISSIPATION: f64 = 0.03;
/// A misfit of frequency larger than this part of the measured shift is no match.
const FREQUENCY: f64 = 0.1;
/// A shift smaller than this part of the frequency does not count: ring-downs of real structures do not repeat better.
pub(super) const SHIFT_FLOOR: f64 = 1e-5;
/// Number of neighbouring points over which misfits are averaged: noise then counts less than half, and a departure keeps its place.
const NEIGHBOURS: usize = 5;
/// Misfits up to this many standard deviations of such an average are explained by noise: of a few hundred averages none lies beyond four by chance.
const NOISE: f64 = 4.0;

/// The structure's own error, relative: twice what reduced quasi-static curves lose of dissipation and of the softening of the frequency. A departure
/// beyond it, and beyond noise, is real however small: the structure differs from the model.
pub(super) const OWN: f64 = 2e-3;

/// Part of all updates in which a right structure is suspected by chance.
const SUSPECTED: f64 = 0.05;
/// Number of second differences on either side of an average whose scatter gives the noise there. Noise may grow with the amplitude, as where it is a
/// part of the frequency's shift: more differences would mix in other amplitudes, fewer would determine the noise too poorly.
const BESIDE: usize = 4;

/// Limits within which a curve passes: of dissipation, and of the frequency over its measured shift.
#[derive(Debug, Clone, Copy)]
pub(super) struct Passing {
    dissipation: f64,
    shift: f64,
    noise: Noise,
}

/// How the limit of noise is computed.
#[derive(Debug, Clone, Copy)]
enum Noise {
    /// A number of standard deviations of an average, from the scatter of the whole curve.
    Deviations(f64),
    /// A probability that an average exceeds the limit by chance, from the scatter beside the average.
    Chance(f64),
}

impl Passing {
    /// The differences between repeated hits of one specimen: enough for predictions.
    pub(super) const REPEATS: Self =
        Self { dissipation: DISSIPATION, shift: FREQUENCY, noise: Noise::Deviations(NOISE) };

    /// The error of the computation itself, and the noise that is exceeded by chance in one of twenty updates with curves of these numbers of points.
    pub(super) fn computed(points: impl Iterator<Item = usize>) -> Self {
        // Two series per curve, frequency and damping.
        let averages: usize = points.map(|n| 2 * (n - NEIGHBOURS.min(n) + 1)).sum();
        let chance = SUSPECTED / (averages as f64).max(1.0);
        Self { dissipation: OWN, shift: OWN, noise: Noise::Chance(chance) }
    }
}

/// Standard deviation of the noise in values, and its degrees of freedom, from second differences: these vanish for a straight line, and have six
/// times the variance of the noise.
pub(super) fn scatter(values: &[f64]) -> (f64, f64) {
    let count = values.len().saturating_sub(2) as f64;
    let square: f64 = values.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2) / 6.0).sum();
    // Neighbouring differences have the correlations -4/6 and 1/6; the degrees of freedom are twice the square of the mean of their squares over its
    // variance.
    let freedom = 36.0 * count * count
        / (36.0 * count + 32.0 * (count - 1.0).max(0.0) + 2.0 * (count - 2.0).max(0.0)).max(1.0);
    ((square / count.max(1.0)).sqrt(), freedom)
}

/// The quantity in which the structure departs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Frequency, Hz.
    Frequency,
    /// Damping ratio, relatively.
    Damping,
}

/// A range of a curve where the structure departs from it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Departure {
    /// Name of the mode.
    pub mode: String,
    /// The quantity.
    pub quantity: Quantity,
    /// Modal displacement at which the departure is largest, relative to its limit.
    pub displacement: f64,
    /// Measured minus computed value there, averaged over neighbours: Hz, or relative for damping.
    pub misfit: f64,
    /// Largest misfit that would pass there, in the same unit.
    pub limit: f64,
    /// Smallest and largest modal displacement at which the misfit exceeds its limit.
    pub range: (f64, f64),
}

/// The verdict on the structure.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StructureVerdict {
    /// Whether the structure with these joints describes all curves: damping within 3 %, frequency within a tenth of its shift, or both within noise.
    pub adequate: bool,
    /// Departures where it does not, the worst first.
    pub departures: Vec<Departure>,
    /// Departures within those limits that exceed noise and the computation's own errors, the worst first: another arrangement of joints would
    /// describe these curves better.
    pub systematic: Vec<Departure>,
    /// Possible mistakes in the curves themselves, such as wrong units.
    pub hints: Vec<String>,
    /// The whole verdict in words.
    pub in_words: String,
}

/// The departure of one series of misfits, if any: index, averaged misfit and limit where it is worst, and first and last index beyond the limit.
fn departure(misfits: &[f64], floor: f64, noise: Noise) -> Option<(usize, f64, f64, (usize, usize))> {
    let n = misfits.len();
    let width = NEIGHBOURS.min(n);
    let from = |i: usize| i.saturating_sub(width / 2).min(n - width);
    let mean = |i: usize| misfits[from(i)..from(i) + width].iter().sum::<f64>() / width as f64;
    let limit = |i: usize| {
        let reach = match noise {
            Noise::Deviations(most) => most * scatter(misfits).0,
            Noise::Chance(chance) => {
                // The outermost second differences use one value beyond their middles.
                let (first, last) = (from(i).saturating_sub(BESIDE + 1), from(i) + width + BESIDE + 1);
                let (noise, freedom) = scatter(&misfits[first..last.min(n)]);
                student_quantile(chance, freedom) * noise
            }
        };
        floor.max(reach / (width as f64).sqrt())
    };
    let limits: Vec<f64> = (0..n).map(limit).collect();
    let badness = |i: usize| mean(i).abs() / limits[i];
    let beyond: Vec<usize> = (0..n).filter(|i| badness(*i) > 1.0).collect();
    let worst = beyond.iter().copied().max_by(|a, b| badness(*a).total_cmp(&badness(*b)))?;
    Some((worst, mean(worst), limits[worst], (beyond[0], beyond[beyond.len() - 1])))
}

/// Departures of the structure from a curve, in frequency and damping.
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
            let (worst, misfit, limit, (first, last)) = departure(&misfits, floor, passing.noise)?;
            let q = |i: usize| points[i].displacement;
            let (displacement, range) = (q(worst), (q(first), q(last)));
            Some(Departure { mode: mode.to_owned(), quantity, displacement, misfit, limit, range })
        })
        .collect()
}

impl StructureVerdict {
    /// Makes the verdict from all departures beyond the passing limits, those beyond noise, and possible mistakes in the curves.
    pub(super) fn new(
        mut departures: Vec<Departure>,
        mut systematic: Vec<Departure>,
        hints: Vec<String>,
    ) -> Self {
        let badness = |d: &Departure| d.misfit.abs() / d.limit;
        let worst_first = |a: &Departure, b: &Departure| badness(b).total_cmp(&badness(a));
        departures.sort_by(worst_first);
        systematic.sort_by(worst_first);
        if !departures.is_empty() {
            systematic.clear();
        }
        let hinted = appended(&hints);
        let in_words = match (departures.first(), systematic.first()) {
            (Some(worst), _) => {
                format!(
                    "the structure with the best joints leaves the data: {}{hinted}; the intervals of all unknowns are left open, as parameters of a structure \
                     that does not describe the data say nothing about the joints",
                    worst.in_words()
                )
            }
            (None, Some(worst)) => format!(
                "the structure with these joints tells frequency and damping of all measured modes as well as hits repeat, but departs from them \
                 by more than its own errors and more than noise does in one of twenty updates: {}; another arrangement of joints (one forgotten, or tied at \
                 one end) may be the true one, the intervals hold for this one alone, and a mode that moves the joints in another way would tell{hinted}",
                worst.in_words()
            ),
            (None, None) => format!(
                "the structure with these joints tells frequency and damping of all measured modes{hinted}"
            ),
        };
        Self { adequate: departures.is_empty(), departures, systematic, hints, in_words }
    }
}

impl Departure {
    /// The departure in words.
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

/// The hints, each after a semicolon, to be put behind a sentence.
pub(super) fn appended(hints: &[String]) -> String {
    hints.iter().fold(String::new(), |all, hint| all + "; " + hint)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bend_is_told_from_noise_and_its_place_is_named() {
        // Noise of 1 % that jumps from point to point is no departure.
        let noise = |i: usize| if (i * 7).is_multiple_of(3) { 0.01 } else { -0.006 };
        let flat: Vec<f64> = (0..30).map(noise).collect();
        let repeats = Passing::REPEATS.noise;
        assert!(departure(&flat, 0.03, repeats).is_none());
        let bent: Vec<f64> =
            (0..30).map(|i| noise(i) + if i > 20 { 0.01 * (i - 20) as f64 } else { 0.0 }).collect();
        let (worst, misfit, _, (first, last)) = departure(&bent, 0.03, repeats).unwrap();
        assert!(worst >= 27 && misfit > 0.05 && first > 22 && last == 29, "{worst} {misfit} {first}");
    }

    /// In 200 updates with four series of 25 misfits that are noise alone, even or growing with the amplitude, about one in twenty must be suspected.
    #[test]
    fn noise_alone_is_suspected_in_one_of_twenty() {
        let mut random = iwan_core::SplitMix64::new(7);
        let noise = Passing::computed([25, 25].into_iter()).noise;
        for growth in [1.0_f64, 1.2] {
            let mut suspected = 0;
            for _ in 0..200 {
                let mut series = || -> Vec<f64> {
                    let mut normal = || (0..12).map(|_| random.next_symmetric()).sum::<f64>() / 2.0;
                    (0..25).map(|i| growth.powi(i) * normal()).collect()
                };
                suspected +=
                    i32::from((0..4).filter(|_| departure(&series(), 0.0, noise).is_some()).count() > 0);
            }
            assert!((1..=20).contains(&suspected), "{growth}: {suspected}");
        }
    }
}
