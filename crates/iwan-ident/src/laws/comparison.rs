//! Laws compared by evidence, and the law to take.

use iwan_machine::threads::{at_once, in_parallel};

use super::extrapolation::Extrapolation;
use super::slow::{Backbone, Source, measure};
use super::together::{FittedLaw, grid, together};
use crate::curve_fit::Grade;
use crate::curves::amplitude_drop;
use crate::error::{Error, check};
use crate::parameters::Parameters;
use crate::signal::HARDLY;

/// Difference of the criterion (twice the negative logarithm of the evidence) up to which a law is as good as the best: evidence of a factor e (R. E.
/// Kass and A. E. Raftery, Bayes factors, J. Am. Statist. Assoc. 90:773, 1995: "not worth more than a bare mention").
const AS_GOOD: f64 = 2.0;
/// Difference of the criterion from which on evidence is strong, by the scale of Kass and Raftery.
const STRONG: f64 = 6.0;
/// What records say about all laws.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// All laws that could be fitted, in the order of the list.
    pub laws: Vec<FittedLaw>,
    /// Index in `laws` of the simplest law that is as good as the best.
    pub chosen: usize,
    /// Smooth curves of frequency and damping ratio against amplitude, with bands.
    pub backbone: Backbone,
    /// Displacement amplitude at the first sample of each record.
    pub released: Vec<f64>,
    /// Standard deviation of the noise over the root mean square of the record, as the windows see both, one per record.
    pub noise: Vec<f64>,
}

/// Fits all laws to the ring-downs of a mode. The search for the four-parameter joint begins at the parameters `iwan` as well, where they are given.
///
/// # Errors
/// [`Error::TooShort`] for a record of fewer than a dozen cycles; [`Error::Refused`] where no smooth curves follow a record, or where all records
/// together see less than 2 % of amplitude.
pub fn compare(sources: &[Source<'_>], iwan: Option<&Parameters>) -> Result<Comparison, Error> {
    check("records", sources.len() as f64, !sources.is_empty(), "at least one", "give a record")?;
    let lost = amplitude_drop(sources.iter().map(|s| s.curves));
    if lost < HARDLY {
        return Err(Error::Refused {
            finding: format!("over {:.2} % of amplitude all laws look alike", 100.0 * lost),
            remedy: "record longer, or harder and softer hits of the same specimen",
        });
    }
    let grid = grid(sources);
    let measured = in_parallel(sources, at_once(), &|source| measure(&grid, source));
    let measured = measured.into_iter().collect::<Result<Vec<_>, _>>()?;
    let together = together(grid, &measured, sources).ok_or_else(|| Error::Refused {
        finding: "what the records tell of frequency and damping makes no curves".into(),
        remedy: "check the band and the window",
    })?;
    let mut laws = together.laws(iwan);
    let best = laws.iter().map(|l| l.criterion).fold(f64::INFINITY, f64::min);
    for law in &mut laws {
        law.criterion -= best;
        if Extrapolation::of(sources.iter().map(|s| s.curves), law.mode.frequency).is_far() {
            law.parameters.iter_mut().filter(|p| BY_THE_REST.contains(&p.name)).for_each(|p| *p = p.untold());
        }
    }
    let chosen = choice(&laws).ok_or_else(|| Error::Refused {
        finding: "no law could be fitted".into(),
        remedy: "check the band and the window",
    })?;
    Ok(Comparison {
        laws,
        chosen,
        backbone: Backbone::new(
            &together.grid,
            &together.smooth,
            together.span,
            (together.scatter.0, &together.scatter.1),
        ),
        released: measured.iter().map(|m| m.released).collect(),
        noise: measured.iter().map(|m| m.noise / m.level).collect(),
    })
}

/// The criterion of a law as it counts in the choice. A joint with a further part combines two laws of the list, follows many a smooth curve, and has
/// its knee sought along its whole range; so it is taken only where the evidence for it is strong. Without that, nine of a hundred pendulums in noise
/// of 40 dB were taken for a joint with dry friction.
fn weighed(law: &FittedLaw) -> f64 {
    law.criterion + if law.law.is_combined() { STRONG } else { 0.0 }
}

/// Parameters that a law tells by its frequency at rest: that itself, what is relative to it, and the stiffness that the curves see beside it. Without an interval where that frequency is far
/// from all that was seen: a linear mode of 30 Hz whose frequency drifted by 0.05 Hz a second had 37.6 to 38.9 Hz at rest.
const BY_THE_REST: [&str; 4] = ["frequency", "damping_ratio", "chi", "spring_k"];

/// Ratio of misfits from which on a law is not taken for its fewer parameters: another law is as good by evidence, neither matches the records, and
/// the other misses less of both curves by this factor. A judgement.
const FARTHER: f64 = 2.0;

/// Index of the simplest of the laws that are as good as the best; none where there are no laws. A law that describes the records goes before one
/// that does not, unless the evidence against it is strong. Where noise is small, evidence comes from the loudest cycles alone; so the evidence for a
/// law is not heard where another law of a better grade misses less of both curves.
fn choice(laws: &[FittedLaw]) -> Option<usize> {
    let surpassed = |l: &FittedLaw| {
        laws.iter().any(|other| {
            other.grade > l.grade
                && other.dissipation_misfit < l.dissipation_misfit
                && other.frequency_misfit < l.frequency_misfit
        })
    };
    let open: Vec<(usize, &FittedLaw)> = laws.iter().enumerate().filter(|(_, l)| !surpassed(l)).collect();
    let best = open.iter().map(|(_, l)| weighed(l)).fold(f64::INFINITY, f64::min);
    let near = || open.iter().filter(|(_, l)| weighed(l) <= best + STRONG);
    let grade = near().map(|(_, l)| l.grade).max()?;
    let of_grade = || open.iter().filter(|(_, l)| l.grade == grade);
    let least = of_grade().map(|(_, l)| weighed(l)).fold(f64::INFINITY, f64::min);
    let good = || of_grade().filter(|(_, l)| weighed(l) <= least + AS_GOOD);
    // Fewer parameters are no reason to take a law that is much farther from both curves.
    let far = |l: &FittedLaw| {
        l.grade != Grade::Matches
            && good().any(|(_, other)| {
                FARTHER * other.dissipation_misfit < l.dissipation_misfit
                    && FARTHER * other.frequency_misfit < l.frequency_misfit
            })
    };
    let simplest = good().filter(|(_, l)| !far(l)).min_by(|(_, a), (_, b)| {
        let order = a.parameters.len().cmp(&b.parameters.len());
        order.then(a.criterion.total_cmp(&b.criterion))
    });
    simplest.map(|(i, _)| *i)
}

impl Comparison {
    /// The same comparison where more is known of the law with this name; the choice is made anew.
    pub(crate) fn knowing(mut self, name: &str, more: impl FnOnce(&mut FittedLaw)) -> Self {
        if let Some(law) = self.laws.iter_mut().find(|l| l.law.name == name) {
            more(law);
        }
        self.chosen = choice(&self.laws).unwrap_or(self.chosen);
        self
    }

    /// The same comparison of records that the law with this name reproduces to their last digits: curves, which are less exact, cannot speak against
    /// it. A record without noise once spoke for quadratic damping beside the joint that had made it.
    pub(crate) fn made_by(self, name: &str) -> Self {
        self.knowing(name, |law| law.criterion = 0.0)
    }

    /// The same comparison of records that were filtered or windowed before: a law that describes them is usable at best, and they tell no parameter of the structure.
    pub(crate) fn of_treated(mut self) -> Self {
        for law in &mut self.laws {
            law.grade = law.grade.min(Grade::Usable);
            law.parameters.iter_mut().for_each(|p| *p = p.untold());
        }
        self.chosen = choice(&self.laws).unwrap_or(self.chosen);
        self
    }

    /// The law to take.
    #[must_use]
    pub fn chosen(&self) -> &FittedLaw {
        &self.laws[self.chosen]
    }

    /// Whether the evidence against the law with this name is strong; also where it could not be fitted.
    #[must_use]
    pub fn speaks_against(&self, name: &str) -> bool {
        let own = self.named(name).map_or(f64::INFINITY, |law| law.criterion);
        own > self.chosen().criterion + STRONG
    }

    /// The laws that describe the records and have no strong evidence against them.
    pub(crate) fn near(&self) -> impl Iterator<Item = &FittedLaw> {
        let limit = self.chosen().criterion + STRONG;
        self.laws.iter().filter(move |law| law.criterion <= limit && law.grade != Grade::No)
    }

    /// The law to take in one sentence, with its misfit and that of an Iwan joint.
    #[must_use]
    pub fn in_words(&self) -> String {
        let law = self.chosen();
        let misses = |l: &FittedLaw| {
            let (d, f) = (100.0 * l.dissipation_misfit, l.frequency_misfit);
            format!("{d:.2} % of dissipation and {f:.4} Hz")
        };
        let comparable = |l: &&FittedLaw| l.dissipation_misfit.is_finite() && l.frequency_misfit.is_finite();
        let verdict = match law.grade {
            Grade::Matches => format!("{} describes these records: it misses {}", law.law.words, misses(law)),
            Grade::Usable => {
                format!("{} comes nearest to these records: it misses {}", law.law.words, misses(law))
            }
            Grade::No if !comparable(&law) => {
                "no law of the list describes these records, and none has curves to compare: use the measured ones".into()
            }
            Grade::No => format!(
                "no law of the list describes these records; {} comes nearest and misses {}: use the curves",
                law.law.words,
                misses(law)
            ),
        };
        match self.named("iwan").filter(|iwan| iwan.law.name != law.law.name).filter(comparable) {
            Some(iwan) => format!("{verdict}; an Iwan joint misses {}", misses(iwan)),
            None => verdict,
        }
    }

    /// The law with this name, if it could be fitted.
    #[must_use]
    pub fn named(&self, name: &str) -> Option<&FittedLaw> {
        self.laws.iter().find(|l| l.law.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::{CANDIDATES, Estimate, LawMode};

    fn law(
        place: usize,
        criterion: f64,
        (dissipation_misfit, frequency_misfit): (f64, f64),
        grade: Grade,
    ) -> FittedLaw {
        let parameters = vec![
            Estimate { name: "frequency", value: 1.0, low: None, high: None };
            2 + CANDIDATES[place].terms.len()
        ];
        FittedLaw {
            law: CANDIDATES[place],
            criterion,
            dissipation_misfit,
            frequency_misfit,
            discrepancy: (0.0, 0.0),
            held_out: None,
            grade,
            parameters,
            mode: LawMode { frequency: 1.0, damping_ratio: 0.0, joint: None, parts: vec![] },
        }
    }

    #[test]
    fn evidence_is_not_heard_for_a_law_that_misses_more_of_both_curves() {
        let of = |misses: (f64, f64), grade| {
            choice(&[law(0, 0.0, misses, grade), law(1, 400.0, (0.027, 0.019), Grade::Matches)])
        };
        // Misses more of both, and does not describe the records: the other is taken.
        assert_eq!(of((0.068, 0.051), Grade::Usable), Some(1));
        // Misses less of one: the evidence decides.
        assert_eq!(of((0.068, 0.010), Grade::Usable), Some(0));
        // Describes the records as well: the evidence decides.
        assert_eq!(of((0.029, 0.020), Grade::Matches), Some(0));
        assert_eq!(choice(&[]), None);
    }

    /// A case that was seen: a spring beyond a gap was taken for its fewer parameters where an Iwan joint misses a third as much.
    #[test]
    fn simplicity_is_no_reason_to_miss_more_of_both_curves() {
        let place = |name| CANDIDATES.iter().position(|c| c.name == name).unwrap();
        let [gap, joint] = ["pinning", "iwan"].map(place);
        let of = |grade| {
            let mut all = [law(gap, 1.0, (0.14, 0.12), grade), law(joint, 0.0, (0.05, 0.04), grade)];
            all[1].parameters.extend_from_within(..2);
            choice(&all)
        };
        assert_eq!(of(Grade::Usable), Some(1));
        assert_eq!(of(Grade::Matches), Some(0));
    }

    #[test]
    fn a_joint_with_something_beside_it_needs_strong_evidence() {
        let place = |name| CANDIDATES.iter().position(|c| c.name == name).unwrap();
        let (plain, combined) = (place("duffing"), place("iwan-coulomb"));
        let of = |criterion| {
            let misses = (0.01, 0.001);
            choice(&[
                law(plain, criterion, misses, Grade::Matches),
                law(combined, 0.0, misses, Grade::Matches),
            ])
        };
        assert_eq!(of(5.0), Some(0));
        assert_eq!(of(9.0), Some(1));
    }
}
