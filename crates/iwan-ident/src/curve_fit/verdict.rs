//! How well one four-parameter joint with a viscous damper matches dissipation and frequency together: a grade with its numbers.

/// Misfit of the dissipation, relative and as a root mean square, up to which the model matches: about what repeated hits on one specimen differ by.
/// A judgement, not calibrated.
pub(crate) const DISSIPATION: f64 = 0.03;
/// Misfit of the frequency, as a part of its measured shift, up to which the model matches, unless noise explains more. A judgement, not calibrated.
const FREQUENCY: f64 = 0.1;
/// Misfit, as a root mean square in standard deviations, that noise explains: two, as for an interval of 95 %.
const NOISE: f64 = 2.0;
/// Part of the frequency below which neither a shift nor a misfit of it counts: ring-downs of real structures do not repeat better.
const SHIFT_FLOOR: f64 = 1e-5;
/// Largest misfit of dissipation that the curves' own noise excuses, relative: nothing can be said to match curves that scatter by more.
const MOST_EXCUSED: f64 = 0.10;
/// Factor on the limits without noise up to which misfits match where the model's ring-down leaves nothing of the record but white noise: the ends of
/// smoothed curves scatter by more than they say. A misfit that the curves' own noise excuses already is not excused twice.
const EXCUSED: f64 = 2.0;
/// Misfit of the dissipation, relative, up to which a model is usable: a prediction is then better than the factor of two between damping by one blow
/// and by one ten times as hard. A judgement.
const USABLE_DISSIPATION: f64 = 0.25;
/// Misfit of the frequency, as a part of its measured shift, up to which a model is usable. A judgement.
const USABLE_FREQUENCY: f64 = 0.5;
/// Residual, as a part of the records' amplitudes, above which a model does not describe them whatever the curves say: with 30 % a tenth of the
/// energy is left.
const MOST_LEFT: f64 = 0.3;

/// Words for a joint that keeps the limits where a linear mode with a drifting frequency does so as well.
const DRIFT: &str = "follows both, but the damping ratio is the same at all amplitudes and only the frequency moves: so it does where the frequency of a linear mode drifts with time, by temperature \
                     or mounting, and one record does not tell one from the other; a hit of another strength does";

/// Words for a joint that keeps the limits where a second blow speaks against it.
const DRIVEN: &str = "follows both, but the decay is driven again within the stretch that is compared, as by a double hit: what a second blow does is taken for the joint's; cut the record there";

/// Words for a joint that keeps the limits on a record that is not as it was measured.
const TREATED: &str = "follows both, but the record was filtered or windowed before: what that did to the decay is taken for the joint's, and it tells none of its parameters";

/// A measured value of a curve, its standard deviation, and the model's value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Compared {
    pub(crate) measured: f64,
    pub(crate) deviation: f64,
    pub(crate) model: f64,
}

/// One way of laying a model's curves beside those of records, such as at equal times.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pairs {
    /// ln D (D: dissipation per cycle).
    pub(crate) dissipation: Vec<Compared>,
    /// Frequency, Hz.
    pub(crate) frequency: Vec<Compared>,
}

/// What a record says about a model beside its curves.
#[derive(Debug, Default)]
pub(crate) struct Beside {
    /// Reasons against the model, in words: with any of them the grade is `No`, whatever the curves say.
    pub(crate) reasons: Vec<String>,
    /// Whether the model's ring-down was subtracted from the record and left white noise.
    pub(crate) leaves_noise: bool,
    /// Why the model is usable at best, whatever the curves say; none where there is no such reason.
    pub(crate) doubt: Option<Doubt>,
}

/// Why a model that keeps the limits is usable at best.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Doubt {
    /// The record was filtered or windowed before: its decay is not the structure's.
    Treated,
    /// The decay is driven again within the stretch that is compared: what a second blow does tells of no joint.
    Driven,
    /// A linear mode whose frequency drifts with time would leave the same record.
    Drift,
    /// The model is known to miss something beside noise, and another law describes the record clearly better.
    Surpassed,
}

/// How well a model describes records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Grade {
    /// The model does not describe the records.
    No,
    /// The model misses more than noise explains, but is near enough to predict with, inside the amplitudes seen.
    Usable,
    /// The model matches within noise, or within what repeated hits differ by.
    Matches,
}

impl Grade {
    /// Name in results: `matches`, `usable`, `no`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Matches => "matches",
            Self::Usable => "usable",
            Self::No => "no",
        }
    }
}

/// How well a model describes records, in numbers and in words.
#[derive(Debug, Clone, PartialEq)]
pub struct Verdict {
    /// Root-mean-square misfit of ln D (D: dissipation per cycle). Values whose standard deviation exceeds the limit without noise weigh less, by
    /// their variance.
    pub dissipation_misfit: f64,
    /// Root-mean-square misfit of the frequency, Hz, weighted in the same way.
    pub frequency_misfit: f64,
    /// Measured range of the frequency, Hz.
    pub frequency_shift: f64,
    /// Whether one four-parameter joint with a viscous damper matches dissipation and frequency together: dissipation
    /// within 3 %, frequency within a tenth of its shift, or both within twice their noise.
    pub adequate: bool,
    /// Whether the joint describes the record, but a linear mode whose frequency drifts with time would leave the same one: only the frequency moves,
    /// and there is one record only.
    pub drift: bool,
    /// Whether a record was filtered next to the mode, or windowed, before it was given, whatever the model makes of it.
    pub treated: bool,
    /// How well the model describes the records: never better than dissipation and frequency both allow.
    pub grade: Grade,
    /// What does not fit, in words and numbers.
    pub misfit: String,
}

impl Verdict {
    /// The verdict from ln D and frequency (Hz) at the same amplitudes alone.
    pub(crate) fn new(dissipation: &[Compared], frequency: &[Compared]) -> Self {
        let pairs = Pairs { dissipation: dissipation.to_vec(), frequency: frequency.to_vec() };
        Self::beside(&Beside::default(), &[pairs])
    }

    /// The verdict from the curves, by the way of laying them beside each other in which the model misses most, and from what the record itself says.
    pub(crate) fn beside(beside: &Beside, ways: &[Pairs]) -> Self {
        let Beside { reasons, leaves_noise, doubt } = beside;
        let range = ways
            .iter()
            .flat_map(|pairs| &pairs.frequency)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |r, c| (r.0.min(c.measured), r.1.max(c.measured)));
        let shift = range.1 - range.0;
        let smallest = SHIFT_FLOOR * range.1;
        let d = Distance::farthest(ways.iter().map(|pairs| &pairs.dissipation), DISSIPATION);
        let f =
            Distance::farthest(ways.iter().map(|pairs| &pairs.frequency), (FREQUENCY * shift).max(smallest));
        let noise = [(NOISE * d.noise).min(MOST_EXCUSED), NOISE * f.noise];
        let limits = [DISSIPATION.max(noise[0]), (FREQUENCY * shift).max(noise[1]).max(smallest)];
        let usable =
            [USABLE_DISSIPATION.max(noise[0]), (USABLE_FREQUENCY * shift).max(noise[1]).max(smallest)];
        // Misfits that cannot be computed (NaN) are no match.
        let within = |limits: [f64; 2]| d.misfit <= limits[0] && f.misfit <= limits[1];
        let ends = if *leaves_noise { [EXCUSED * DISSIPATION, EXCUSED * FREQUENCY * shift] } else { limits };
        let excused = [limits[0].max(ends[0]), limits[1].max(ends[1])];
        let grade = match (within(excused), within(usable)) {
            _ if !reasons.is_empty() => Grade::No,
            (true, _) if doubt.is_none() => Grade::Matches,
            (true, _) | (false, true) => Grade::Usable,
            (false, false) => Grade::No,
        };
        let drift = *doubt == Some(Doubt::Drift) && grade != Grade::No;
        let treated = *doubt == Some(Doubt::Treated);
        let misfit = format!(
            "dissipation is missed by {:.2} % (limit {:.2} %), frequency by {:.4} Hz of a shift of {shift:.4} Hz (limit \
             {:.4} Hz): one four-parameter Iwan joint with a viscous damper {}",
            100.0 * d.misfit,
            100.0 * limits[0],
            f.misfit,
            limits[1],
            match grade {
                Grade::Matches if within(limits) => "matches dissipation and frequency together",
                Grade::Matches =>
                    "matches dissipation and frequency together, for it leaves nothing of the record but noise",
                Grade::Usable if treated && within(usable) => TREATED,
                Grade::Usable if *doubt == Some(Doubt::Driven) && within(usable) => DRIVEN,
                Grade::Usable if drift => DRIFT,
                Grade::Usable if within(limits) =>
                    "keeps both limits, but misses more than noise where another law does not: it is usable inside the amplitudes seen",
                Grade::Usable =>
                    "does not match dissipation and frequency together, but is usable inside the amplitudes seen",
                Grade::No if within(usable) => "does not describe this",
                Grade::No => "does not match dissipation and frequency together, and does not describe this",
            }
        );
        Self {
            dissipation_misfit: d.misfit,
            frequency_misfit: f.misfit,
            frequency_shift: shift,
            adequate: grade == Grade::Matches,
            drift,
            treated,
            grade,
            misfit: [reasons.as_slice(), &[misfit]].concat().join("; "),
        }
    }
}

/// The reason against a model that leaves a large part of the records' amplitudes, whatever the curves say; none where it leaves little.
pub(crate) fn left_over(relative_residual: f64) -> Option<String> {
    let left = 100.0 * relative_residual;
    (relative_residual > MOST_LEFT)
        .then(|| format!("its ring-down leaves {left:.0} % of the records' amplitudes"))
}

/// How far a model and noise are from measured values, as root mean squares. A value whose standard deviation exceeds `limit` weighs less, by its
/// variance: where a decay sinks into noise its curves tell nothing about a model, and excuse nothing elsewhere.
struct Distance {
    misfit: f64,
    noise: f64,
}

impl Distance {
    fn of(values: &[Compared], limit: f64) -> Self {
        let (mut misfit, mut noise, mut sum) = (0.0, 0.0, 0.0);
        for Compared { measured, deviation, model } in values {
            let weight = 1.0 / (1.0 + (deviation / limit).powi(2));
            sum += weight;
            misfit += weight * (measured - model).powi(2);
            noise += weight * deviation.powi(2);
        }
        Self { misfit: (misfit / sum).sqrt(), noise: (noise / sum).sqrt() }
    }

    /// The larger misfit of several ways of comparing, those left out in which nothing is compared; not a number where nothing is compared at all.
    fn farthest<'a>(ways: impl Iterator<Item = &'a Vec<Compared>>, limit: f64) -> Self {
        let compared = ways.filter(|values| !values.is_empty()).map(|values| Self::of(values, limit));
        // A misfit that cannot be computed stands for all.
        let worse = |a: &Self, b: &Self| b.misfit > a.misfit || b.misfit.is_nan();
        let farthest = compared.reduce(|a, b| if worse(&a, &b) { b } else { a });
        farthest.unwrap_or(Self { misfit: f64::NAN, noise: f64::NAN })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn beside(beside: &Beside, dissipation: &[Compared], frequency: &[Compared]) -> Verdict {
        Verdict::beside(beside, &[Pairs { dissipation: dissipation.to_vec(), frequency: frequency.to_vec() }])
    }

    fn beside_noise(dissipation: &[Compared], frequency: &[Compared]) -> Verdict {
        beside(&Beside { leaves_noise: true, ..Beside::default() }, dissipation, frequency)
    }

    /// A case that was seen: a joint with a little quadratic damping missed 1.9 % of dissipation and "matched", beside the sentence that the record
    /// speaks against it.
    #[test]
    fn a_law_that_another_surpasses_is_usable_at_best() {
        let surpassed = Beside { doubt: Some(Doubt::Surpassed), ..Beside::default() };
        let missed = |by: f64| -> Vec<Compared> {
            (0..10)
                .map(|i| Compared { measured: f64::from(i), deviation: 0.0, model: f64::from(i) + by })
                .collect()
        };
        let verdict = beside(&surpassed, &missed(0.019), &missed(0.0));
        assert!(verdict.grade == Grade::Usable && !verdict.adequate, "{}", verdict.misfit);
        assert!(
            verdict.misfit.contains("keeps both limits, but misses more than noise"),
            "{}",
            verdict.misfit
        );
        assert_eq!(beside(&surpassed, &missed(0.5), &missed(0.0)).grade, Grade::No);
    }

    #[test]
    fn what_is_driven_again_is_usable_at_best() {
        let driven = Beside { doubt: Some(Doubt::Driven), ..Beside::default() };
        let same = |by: f64| vec![Compared { measured: 1.0, deviation: 0.0, model: 1.0 + by }; 10];
        let verdict = beside(&driven, &same(0.0), &same(0.0));
        assert!(verdict.grade == Grade::Usable && !verdict.adequate, "{}", verdict.misfit);
        assert!(verdict.misfit.contains("driven again"), "{}", verdict.misfit);
        assert_eq!(beside(&driven, &same(0.5), &same(0.0)).grade, Grade::No);
    }

    #[test]
    fn what_was_treated_before_is_usable_at_best() {
        let treated = Beside { doubt: Some(Doubt::Treated), ..Beside::default() };
        let same = |by: f64| vec![Compared { measured: 1.0, deviation: 0.0, model: 1.0 + by }; 10];
        let verdict = beside(&treated, &same(0.0), &same(0.0));
        assert!(verdict.grade == Grade::Usable && verdict.treated && !verdict.adequate, "{}", verdict.misfit);
        assert!(verdict.misfit.contains("filtered or windowed before"), "{}", verdict.misfit);
        let other = beside(&treated, &same(0.5), &same(0.0));
        assert!(other.grade == Grade::No && other.treated, "{}", other.misfit);
    }

    #[test]
    fn what_may_be_a_drift_is_usable_at_best() {
        let drifting = Beside { doubt: Some(Doubt::Drift), ..Beside::default() };
        let missed = |by: f64| -> Vec<Compared> {
            (0..10)
                .map(|i| Compared { measured: f64::from(i), deviation: 0.0, model: f64::from(i) + by })
                .collect()
        };
        let drift = beside(&drifting, &missed(0.0), &missed(0.0));
        assert!(drift.grade == Grade::Usable && drift.drift, "{}", drift.misfit);
        assert!(drift.misfit.contains("drifts with time"), "{}", drift.misfit);
        // A record that the model does not describe at all is no drift either.
        let other = beside(&drifting, &missed(0.5), &missed(0.0));
        assert!(other.grade == Grade::No && !other.drift, "{}", other.misfit);
    }

    #[test]
    fn noise_excuses_what_it_explains_and_no_more() {
        let values = |deviation: f64| -> Vec<Compared> {
            (0..10)
                .map(|i| Compared {
                    measured: 0.1 * f64::from(i),
                    deviation,
                    model: 0.1 * f64::from(i) + 0.05,
                })
                .collect()
        };
        let exact: Vec<Compared> = values(0.0).iter().map(|c| Compared { model: c.measured, ..*c }).collect();
        assert!(Verdict::new(&exact, &exact).adequate);
        let verdict = Verdict::new(&values(0.01), &exact);
        assert!(!verdict.adequate && verdict.misfit.contains("missed by 5.00 %"), "{}", verdict.misfit);
        assert_eq!(verdict.grade, Grade::Usable);
        assert!(Verdict::new(&values(0.04), &exact).adequate);
        // A frequency missed by a twentieth of its shift passes.
        assert!(Verdict::new(&exact, &values(0.0)).adequate);
        // A residual of a third of the amplitudes is no match, whatever the curves say.
        let against = Beside { reasons: left_over(0.33).into_iter().collect(), ..Beside::default() };
        let refused = beside(&against, &exact, &exact);
        assert_eq!(refused.grade, Grade::No);
        // The sentence of such a verdict once said "matches" and "usable" all the same.
        assert_eq!(left_over(0.3), None);
        assert!(
            !refused.misfit.contains("matches") && refused.misfit.contains("leaves 33 %"),
            "{}",
            refused.misfit
        );
    }

    /// A case that was seen, a pendulum on a clock that stutters: its curves scatter by 8 %, an Iwan joint misses 15 % of its dissipation, and the
    /// residuals have no correlation. It is no match.
    #[test]
    fn two_excuses_do_not_add_up() {
        let exact: Vec<Compared> = (0..10)
            .map(|i| Compared { measured: f64::from(i), deviation: 0.08, model: f64::from(i) })
            .collect();
        let missed: Vec<Compared> =
            exact.iter().map(|c| Compared { model: c.measured + 0.1515, ..*c }).collect();
        assert_eq!(beside_noise(&missed, &exact).grade, Grade::Usable);
        // A misfit of 5 % beside white residuals is that of the curves' ends.
        let ends: Vec<Compared> =
            exact.iter().map(|c| Compared { model: c.measured + 0.05, deviation: 0.0, ..*c }).collect();
        assert_eq!(beside_noise(&ends, &exact).grade, Grade::Matches);
        assert_eq!(Verdict::new(&ends, &exact).grade, Grade::Usable);
    }

    /// Behind a decay that sank into noise, curves are off by their own standard deviations. Such values neither speak against the model nor excuse
    /// it.
    #[test]
    fn a_tail_in_noise_tells_nothing() {
        let known = |by: f64| (0..10).map(move |i| (f64::from(i), 0.01, by));
        let compared = |by: f64| -> Vec<Compared> {
            let tail = (10..30).map(|i| (f64::from(i), 0.5, if i % 2 == 0 { 0.5 } else { -0.5 }));
            let all = known(by).chain(tail);
            all.map(|(measured, deviation, by)| Compared { measured, deviation, model: measured + by })
                .collect()
        };
        let exact = compared(0.0);
        for (by, grade) in [(0.0, Grade::Matches), (0.2, Grade::Usable), (0.5, Grade::No)] {
            let verdict = Verdict::new(&compared(by), &exact);
            assert_eq!(verdict.grade, grade, "{}", verdict.misfit);
        }
    }

    #[test]
    fn noise_excuses_no_misfit_of_several_limits() {
        let missed = |by: f64, deviation: f64| -> Vec<Compared> {
            (0..10)
                .map(|i| Compared { measured: f64::from(i), deviation, model: f64::from(i) + by })
                .collect()
        };
        let exact = missed(0.0, 0.0);
        // A pendulum, whose dissipation is missed by 42.6 %, with curves of any noise.
        for deviation in [0.0, 0.1, 10.0] {
            let verdict = beside_noise(&missed(0.426, deviation), &exact);
            assert_eq!(verdict.grade, Grade::No, "{}", verdict.misfit);
        }
    }
}
