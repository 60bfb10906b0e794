//! The result of an identification, in numbers and in words.

use super::laws::untold;
use crate::curve_fit::{Fit, Grade, Start, Verdict};
use crate::curves::Curves;
use crate::error::Error;
use crate::laws::{Comparison, Extrapolation};
use crate::likelihood::Likelihood;
use crate::parameters::{Parameter, Parameters};
use crate::profile::{Profile, Profiles};
use crate::refine::{Discrepancy, Refined};
use crate::signal::Envelope;

/// Relative scatter of the days' frequencies up to which no sentence mentions it: ring-downs of real structures do not repeat better.
const LEAST_TOLD: f64 = 1e-5;

/// The simplest model, a linear mode with viscous damping, and whether it is enough.
#[derive(Debug, Clone, PartialEq)]
pub struct Linear {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Viscous damping ratio.
    pub damping_ratio: f64,
    /// Root mean square of its residuals over root mean square of the records' amplitudes.
    pub relative_residual: f64,
    /// Schwarz's criterion of the linear model less that of the model with a joint: below 0 the joint is not needed.
    pub criterion: f64,
}

impl Linear {
    /// Whether a linear mode describes the records as well as the joint, even where neither describes them: see [`Identification::needs_no_joint`].
    #[must_use]
    pub fn is_enough(&self) -> bool {
        self.criterion < 0.0
    }
}

/// What records tell about a mode.
#[derive(Debug, Clone)]
pub struct Identification {
    /// The parameters.
    pub parameters: Parameters,
    /// Profiles of the parameters, with the 95 % intervals.
    pub profiles: Profiles,
    /// The refinement on the records that gave the parameters.
    pub refined: Refined,
    /// The records' likelihood, for samplers.
    pub likelihood: Likelihood,
    /// Start values read off the curves of the loudest record.
    pub start: Start,
    /// The fit on the curves with which the refinement began.
    pub fit: Fit,
    /// Envelope of each record.
    pub envelopes: Vec<Envelope>,
    /// Curves of each record, against modal force.
    pub curves: Vec<Curves>,
    /// Curves of the model's ring-downs, one per record, made by the same method.
    pub model_curves: Vec<Curves>,
    /// Index of the first sample of each record that was compared with the model.
    pub first_samples: Vec<usize>,
    /// The linear mode with viscous damping.
    pub linear: Linear,
    /// Other laws on the same records, and smooth curves; where there are none, the error that says why.
    pub laws: Result<Comparison, Error>,
    /// Names of the other laws that describe the records as well as the joint, or better, where the joint is known to miss something: the intervals
    /// contain theirs.
    pub as_likely: Vec<&'static str>,
    /// Whether the model matches the records, and how far off it is.
    pub verdict: Verdict,
    /// What was found and done, in words.
    pub notes: Vec<String>,
}

impl Identification {
    /// The profile of one parameter.
    ///
    /// # Panics
    /// Never: all six are there.
    #[must_use]
    pub fn profile(&self, parameter: Parameter) -> &Profile {
        let place = Parameter::ALL.iter().position(|p| *p == parameter).unwrap_or_default();
        &self.profiles.parameters[place]
    }

    /// Smallest and largest modal displacement amplitude (mass-normalised) that the records hold; none where they hold no curve.
    #[must_use]
    pub fn informed(&self) -> Option<[f64; 2]> {
        let all = || self.curves.iter().flat_map(|c| c.displacement.iter().copied()).filter(|a| *a > 0.0);
        let range = [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max)];
        (range[1] > 0.0 && range[1].is_finite()).then_some(range)
    }

    /// Standard deviation of the days' frequencies, relative; zero for one record.
    fn strayed(&self) -> f64 {
        let days = || self.refined.starts.iter().map(|start| start.day);
        let count = self.refined.starts.len() as f64;
        let mean = days().sum::<f64>() / count;
        (days().map(|day| (day - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0)).sqrt()
    }

    /// What the model misses beside noise, and what intervals allow for in addition, in words; none where only noise is left.
    fn discrepancy_in_words(&self) -> Vec<String> {
        let found = &self.refined.discrepancy;
        let hertz = |relative: f64| relative * self.parameters.frequency;
        let size = |d: f64, f: f64| format!("{:.2} % of dissipation and {:.4} Hz", 100.0 * d, hertz(f));
        let Discrepancy { dissipation, frequency, .. } = *found;
        let law = (dissipation > 0.0).then(|| {
            format!(
                "the law itself misses about {} beside noise (standard deviations)",
                size(dissipation, frequency)
            )
        });
        let levels = (found.dissipation_of_level > 0.0).then(|| {
            let size = size(found.dissipation_of_level, found.frequency_of_level);
            format!("levels of force differ at the same amplitude by {size}")
        });
        let records = (found.dissipation_of_record > 0.0).then(|| {
            let size = size(found.dissipation_of_record, found.frequency_of_record);
            format!("the records differ among each other by {size}")
        });
        let strayed = self.strayed();
        let days = (strayed > LEAST_TOLD).then(|| {
            format!(
                "the frequencies of the {} records stray by {:.4} Hz (standard deviation), for which each has a day of its own",
                self.refined.starts.len(),
                hertz(strayed)
            )
        });
        let found: Vec<String> = law.into_iter().chain(levels).chain(records).chain(days).collect();
        let misses = (!found.is_empty()).then(|| format!("{}: the intervals allow for it", found.join("; ")));
        let allowed = self.refined.discrepancy.allowed;
        let clean = (allowed > 0.0).then(|| {
            format!(
                "the record shows no noise that would say what the law misses, as simulations and filtered records do: the intervals allow for {:.1} % of dissipation",
                100.0 * allowed
            )
        });
        misses.into_iter().chain(clean).collect()
    }

    /// Whether a linear mode describes the records as well as the joint does, and the joint describes them: records that neither describes need
    /// another law.
    #[must_use]
    pub fn needs_no_joint(&self) -> bool {
        self.linear.is_enough() && self.verdict.grade != Grade::No
    }

    /// Why intervals were left open that the profiles alone would close.
    fn untold_in_words(&self) -> Option<String> {
        match (untold(&self.verdict, self.laws.as_ref().ok()), &self.laws) {
            ([], _) => None,
            _ if self.verdict.treated && self.verdict.grade != Grade::No => None,
            _ if self.verdict.drift => {
                Some("what may be a drift tells none of the joint's parameters".into())
            }
            (_, Ok(laws)) if self.verdict.grade != Grade::No => Some(format!(
                "these records speak against the joint and for {}: K_T, F_S and beta, which a bend of the curves would tell, are left open",
                laws.chosen().law.words
            )),
            _ => Some("the joint does not describe these records: they tell none of its parameters".into()),
        }
    }

    /// In words: the laws whose intervals are contained in those of the joint's parameters.
    fn others_in_words(&self) -> Option<String> {
        (!self.as_likely.is_empty() && self.verdict.grade != Grade::No).then(|| {
            let names = self.as_likely.join(", ");
            format!("laws that tell the records as well or better: {names}; the intervals hold what they say of the same parameters")
        })
    }

    /// The verdict, what the model misses, and what the records do not tell, in words: open intervals, a joint that is not needed, a model that does
    /// not fit.
    #[must_use]
    pub fn in_words(&self) -> Vec<String> {
        let mut words = vec![self.verdict.misfit.clone()];
        words.extend(self.discrepancy_in_words());
        words.extend(self.laws.as_ref().ok().and_then(|laws| laws.backbone.scatter_in_words()));
        if self.needs_no_joint() {
            words.push(format!(
                "the joint is not needed: a linear mode of {:.6} Hz with {:.4} % viscous damping tells the records as well",
                self.linear.frequency,
                100.0 * self.linear.damping_ratio
            ));
        }
        words.extend(self.others_in_words());
        words.extend(self.untold_in_words());
        words.extend(Extrapolation::of(&self.curves, self.parameters.frequency).in_words());
        if self.verdict.grade == Grade::No {
            return words;
        }
        for profile in &self.profiles.parameters {
            let name = profile.parameter.name();
            words.extend(match (profile.held, profile.low, profile.high) {
                (true, ..) | (_, Some(_), Some(_)) => None,
                (_, Some(low), None) => {
                    Some(format!("{name} > {low:.4e}, no upper bound from these records"))
                }
                (_, None, Some(high)) => {
                    Some(format!("{name} < {high:.4e}, no lower bound from these records"))
                }
                (_, None, None) => {
                    Some(format!("{name} is open on both sides: these records do not tell it"))
                }
            });
        }
        words
    }
}
