//! What comes out.

use super::unknowns::{Sharing, Unknown, Values};

/// Models whose misfits of the records kept out differ by less than this factor predict equally well. A judgement.
const NEARLY: f64 = 1.05;
/// A model that misses the records kept out by more than so many times what it leaves of those fitted is not to be trusted, unless it misses them by less than
/// [`WELL`] of the motion. Blows five times as hard as any that were fitted are missed by up to five times as much by the right model of the paper's beam.
const DISTRUSTED: f64 = 10.0;
const WELL: f64 = 0.02;

/// How far a model is from one series of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// Name of the record.
    pub record: String,
    /// Number of the mode; of a sum of forced modes that is 0 for all.
    pub mode: usize,
    /// Root mean square of the difference over that of the record.
    pub relative: f64,
}

/// One of the models compared.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedSharing {
    /// Which modes share what.
    pub sharing: Sharing,
    /// The best numbers.
    pub values: Values,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Schwarz's criterion less that of the best model: 0 for the best, and 10 and more speak clearly against a model.
    pub criterion: f64,
    /// By record and mode, of the records that were fitted.
    pub misfits: Vec<Misfit>,
    /// Of the records that were kept out.
    pub held_out: Vec<Misfit>,
    /// Root mean square of all misfits of the records fitted.
    pub misfit: f64,
    /// The same of those kept out; none without.
    pub held_out_misfit: Option<f64>,
    /// Largest slip over φ_max by record and joint.
    pub slip_ratios: Vec<Vec<f64>>,
    /// Whether the search ended by itself.
    pub converged: bool,
    /// What it shows at the sensors: by record (those fitted, then those kept out), motion and sample.
    pub motions: Vec<Vec<Vec<f64>>>,
}

/// A number with its 95 % interval; none is open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoupledEstimate {
    /// Which one.
    pub unknown: Unknown,
    /// The best value; of a compliance its product with K_T.
    pub value: f64,
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl CoupledEstimate {
    /// Whether the records bound it on both sides.
    #[must_use]
    pub const fn identifiable(&self) -> bool {
        self.low.is_some() && self.high.is_some()
    }
}

/// A combination of unknowns in their coordinates (logarithms of K_T and F_S, per cent of frequencies), the worst told last.
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledCombination {
    /// Standard deviation along it; infinite where nothing tells it.
    pub deviation: f64,
    /// Share of each unknown, by the order of the estimates.
    pub direction: Vec<f64>,
}

/// All models, the one to take, and what is told of it.
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledFit {
    /// Linear, uncoupled, and with one or more shared joints.
    pub models: Vec<FittedSharing>,
    /// Index of the one to take: the least criterion.
    pub chosen: usize,
    /// Frequencies, damping and joints of the chosen model, with intervals.
    pub estimates: Vec<CoupledEstimate>,
    /// What the records tell of them together.
    pub combinations: Vec<CoupledCombination>,
    /// What the records do not hold, in sentences.
    pub warnings: Vec<String>,
}

impl CoupledFit {
    /// The model to take.
    #[must_use]
    pub fn best(&self) -> &FittedSharing {
        &self.models[self.chosen]
    }

    /// The model with this sharing.
    #[must_use]
    pub fn of(&self, sharing: Sharing) -> Option<&FittedSharing> {
        self.models.iter().find(|model| model.sharing == sharing)
    }

    /// What was found, in sentences: whether modes share joints, and what prediction says of it.
    #[must_use]
    pub fn in_words(&self) -> Vec<String> {
        let best = self.best();
        let mut words = vec![match best.sharing {
            Sharing::Linear => "linear modes tell these records as well as any joint".into(),
            Sharing::Uncoupled => {
                "the modes do not share a joint: each with a joint of its own is best".into()
            }
            Sharing::Shared(1) => "all modes share one joint".into(),
            Sharing::Shared(joints) => format!("the modes share {joints} joints"),
        }];
        let percent = |share: f64| format!("{:.3} %", 100.0 * share);
        let others = self.models.iter().filter(|model| model.sharing != best.sharing);
        let of = |model: &FittedSharing| {
            format!("{}: {} (criterion +{:.0})", model.sharing.name(), percent(model.misfit), model.criterion)
        };
        let list: Vec<String> = others.map(of).collect();
        words.push(format!("its misfit is {}; {}", percent(best.misfit), list.join(", ")));
        if let Some(misfit) = best.held_out_misfit {
            let named =
                |m: &FittedSharing| Some(format!("{} {}", m.sharing.name(), percent(m.held_out_misfit?)));
            let all: Vec<String> = self.models.iter().filter_map(named).collect();
            let least = self.models.iter().filter_map(|m| m.held_out_misfit).fold(f64::INFINITY, f64::min);
            let times = misfit / best.misfit.max(f64::MIN_POSITIVE);
            let others = if misfit <= NEARLY * least {
                "no other model misses less"
            } else {
                "another model misses less"
            };
            let trust =
                if times > DISTRUSTED && misfit > WELL { "; do not trust its predictions" } else { "" };
            let missed = percent(misfit);
            words.push(format!(
                "the records kept out are missed by {missed}, {times:.1} times what is left of those fitted, and {others} ({}){trust}",
                all.join(", ")
            ));
        }
        words
    }
}
