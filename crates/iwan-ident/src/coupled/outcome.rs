//! Results of a coupled fit.

use super::unknowns::{Sharing, Unknown, Values};

/// Two models predict equally well where their misfits of the records kept out differ by less than this factor. A judgement.
const NEARLY: f64 = 1.05;
/// A model is not to be trusted where its misfit of the records kept out is more than this many times that of the records fitted, unless it is less than
/// [`WELL`] of the motion. Blows five times as hard as any that were fitted are missed by up to five times as much by the right model of the paper's beam.
const DISTRUSTED: f64 = 10.0;
const WELL: f64 = 0.02;

/// Distance of a model from one series of a record.
#[derive(Debug, Clone, PartialEq)]
pub struct Misfit {
    /// Name of the record.
    pub record: String,
    /// Number of the mode; 0 throughout where the series is a sum of forced modes.
    pub mode: usize,
    /// Root mean square of the difference over that of the record.
    pub relative: f64,
}

/// One of the models compared.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedSharing {
    /// Which modes share which joints.
    pub sharing: Sharing,
    /// The values at the minimum.
    pub values: Values,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Schwarz's criterion less that of the best model: 0 for the best, and 10 and more speak clearly against a model.
    pub criterion: f64,
    /// Misfits by record and mode of the records that were fitted.
    pub misfits: Vec<Misfit>,
    /// Misfits of the records that were kept out.
    pub held_out: Vec<Misfit>,
    /// Root mean square of all misfits of the records that were fitted.
    pub misfit: f64,
    /// Root mean square of all misfits of the records that were kept out; none where there are none.
    pub held_out_misfit: Option<f64>,
    /// Largest slip over φ_max: `[record][joint]`.
    pub slip_ratios: Vec<Vec<f64>>,
    /// Whether the search reached a minimum.
    pub converged: bool,
    /// What the model shows at the sensors: `[record][motion][sample]`, first the records fitted, then those kept out.
    pub motions: Vec<Vec<Vec<f64>>>,
}

/// A number with its 95 % interval; an end that is `None` is open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoupledEstimate {
    /// Which unknown it is.
    pub unknown: Unknown,
    /// The best value; for a compliance its product with K_T.
    pub value: f64,
    /// Lower end.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
}

impl CoupledEstimate {
    /// Whether the records bound the number on both sides.
    #[must_use]
    pub const fn identifiable(&self) -> bool {
        self.low.is_some() && self.high.is_some()
    }
}

/// A direction in the coordinates of the unknowns (logarithms of K_T and F_S, per cent of frequencies); lists of them end with the least certain.
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledCombination {
    /// Standard deviation along the direction; infinite where the records do not bound it.
    pub deviation: f64,
    /// Component of each unknown, in the order of the estimates.
    pub direction: Vec<f64>,
}

/// All models compared, the one to take, and what the records tell of it.
#[derive(Debug, Clone, PartialEq)]
pub struct CoupledFit {
    /// Linear, uncoupled, and with one or more shared joints.
    pub models: Vec<FittedSharing>,
    /// Index of the model to take, which has the least criterion.
    pub chosen: usize,
    /// Frequencies, damping and joints of the chosen model, with intervals.
    pub estimates: Vec<CoupledEstimate>,
    /// How certain the estimates are together, by directions.
    pub combinations: Vec<CoupledCombination>,
    /// What the records do not tell or what is doubtful in them, in sentences.
    pub warnings: Vec<String>,
}

impl CoupledFit {
    /// The model to take.
    #[must_use]
    pub fn best(&self) -> &FittedSharing {
        &self.models[self.chosen]
    }

    /// The same fit of records that were filtered or windowed before: they tell no parameter of the structure.
    #[must_use]
    pub fn of_treated(mut self) -> Self {
        for estimate in &mut self.estimates {
            (estimate.low, estimate.high) = (None, None);
        }
        for combination in &mut self.combinations {
            combination.deviation = f64::INFINITY;
        }
        self.warnings.push(
            "records were windowed or filtered next to a mode before they were given here: the values are those of the structure and of that together, and all intervals are open"
                .into(),
        );
        self
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
