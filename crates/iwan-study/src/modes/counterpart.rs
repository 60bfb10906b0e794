//! The modal Iwan model (counterpart) of a bending mode: fitted, simulated, and compared with the truth (Table 2 and Fig. 8).

use iwan_core::FourParameter;
use iwan_ident::curve_fit::fit_from;
use iwan_ident::curves::{Curves, Quantity};
use iwan_ident::identify::{Held, ModeRecord, Settings, identify};
use iwan_ident::profile::Profile;
use iwan_ident::signal::Method;
use iwan_ident::{Parameter, Parameters};
use serde::Serialize;

use super::bending_mode::BendingMode;
use super::impact_curves::options;
use super::modal_model::accelerations;
use crate::beam::BeamUnderBlows;
use crate::blows::{DT, LEVELS};
use crate::error::Error;
use crate::printed::TABLE_2;
use crate::relative_difference::relative_difference;

/// Levels up to this force, lbf, are fitted. Above it, modes of higher frequency keep the joints slipping, and the curves of a mode have more than
/// one value at an amplitude.
pub const FITTED: f64 = 1000.0;
/// Indices of the levels whose records are compared with the model for the intervals: 100 lbf, in micro-slip, and 1000 lbf, which leads into
/// macro-slip.
const RECORDS: [usize; 2] = [2, 3];
/// Degree of the polynomials in the envelopes for the intervals: between that of curves in micro-slip (3) and in macro-slip (5), because both records
/// are evaluated alike.
const ORDER: usize = 4;
/// Indices of the levels of Figs. 8a and 8b: 10 and 1000 lbf.
pub const SHOWN: [usize; 2] = [1, 3];
/// End of the early part of the record, s, which Fig. 8 draws cycle by cycle and which is also judged apart: six cycles of mode 1, in which a blow of
/// 1000 lbf keeps it in macro-slip.
pub const EARLY: f64 = 0.05;
/// Parameters that are held, because the structure's modes give them.
const KNOWN: [Parameter; 3] = [Parameter::Frequency, Parameter::DampingRatio, Parameter::KT];

/// The modal Iwan model of a mode.
#[derive(Debug, Clone)]
pub struct Counterpart {
    /// Parameters fitted to the curves, with ω0 and K_T of the structure's modes.
    pub parameters: Parameters,
    /// Whether the fit follows the curves.
    pub adequate: bool,
    /// How well the fit follows the curves, in words.
    pub misfit: String,
    /// 95 % intervals of F_S, χ and β from the records themselves.
    pub intervals: Vec<Interval>,
    /// Difference from the truth at each level.
    pub errors: Vec<Distance>,
    /// Difference from the truth at each level with F_S, χ and β as the paper prints them.
    pub errors_printed: Vec<Distance>,
    /// Modal accelerations at the levels [`SHOWN`].
    pub shown: Vec<Vec<f64>>,
}

/// The interval of a parameter by the records.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Interval {
    /// Name of the parameter, such as `f_s`.
    pub parameter: &'static str,
    /// Best value on the records.
    pub value: f64,
    /// Lower end; none where it is open.
    pub low: Option<f64>,
    /// Upper end; none where it is open.
    pub high: Option<f64>,
    /// Whether the records determine the parameter.
    pub identifiable: bool,
}

/// Difference of the model's accelerations from the truth: root mean square of the difference over that of the truth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Distance {
    /// Peak force of the blow, lbf.
    pub level: f64,
    /// Difference over 0 to 50 ms.
    pub early: f64,
    /// Difference over 0 to 200 ms.
    pub whole: f64,
}

impl Counterpart {
    /// Fits and simulates the modal model of a mode with a joint.
    ///
    /// # Errors
    /// [`Error::Identification`] where the fit fails, [`Error::Simulation`] where the model cannot be simulated.
    pub fn new(truth: &BeamUnderBlows, mode: &BendingMode) -> Result<Self, Error> {
        let place = format!("{}, {}", truth.beam.title(), mode.name);
        let (said, failed) = (Error::identification(&place), Error::simulation(&place));
        let quiet = mode.curves.iter().zip(LEVELS).filter(|(_, level)| *level <= FITTED);
        let curves: Vec<Curves> = quiet.map(|(curves, _)| curves.clone()).collect();
        let fit = fit_from(&curves, &starts(mode), &KNOWN).map_err(&said)?;
        let fitted = accelerations(mode, &fit.parameters).map_err(&failed)?;
        let printed = TABLE_2[mode.index];
        let printed = Parameters { f_s: printed.f_s, chi: printed.chi, beta: printed.beta, ..fit.parameters };
        let printed = accelerations(mode, &printed).map_err(&failed)?;
        Ok(Self {
            parameters: fit.parameters,
            adequate: fit.verdict.adequate,
            misfit: fit.verdict.misfit,
            intervals: intervals(truth, mode).map_err(&said)?,
            errors: distances(truth, mode.index, &fitted),
            errors_printed: distances(truth, mode.index, &printed),
            shown: SHOWN.map(|n| fitted[n].clone()).to_vec(),
        })
    }

    /// The joint's law.
    ///
    /// # Errors
    /// [`iwan_core::Error::OutOfRange`] where the parameters make no joint.
    pub fn law(&self) -> Result<FourParameter, iwan_core::Error> {
        let p = &self.parameters;
        FourParameter::new(p.k_t, p.f_s, p.chi, p.beta)
    }
}

/// Start values of the search: F_S a little below the plateau of the static joint force, and a grid over χ and β.
fn starts(mode: &BendingMode) -> Vec<Parameters> {
    let plateau = mode.static_curves.joint_force.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let mut starts = Vec::new();
    for chi in [-0.3, -0.15] {
        for beta in [0.05, 0.5, 2.0] {
            let (frequency, k_t) = (mode.stuck, mode.k_t);
            starts.push(Parameters { frequency, damping_ratio: 0.0, k_t, f_s: 0.8 * plateau, chi, beta });
        }
    }
    starts
}

/// Intervals by simulation in the loop on the records themselves, with the parameters held that the structure's modes give.
fn intervals(truth: &BeamUnderBlows, mode: &BendingMode) -> Result<Vec<Interval>, iwan_ident::Error> {
    let records = RECORDS.map(|n| ModeRecord {
        samples: &truth.responses[n].outputs[mode.index].acceleration,
        dt: DT,
        quantity: Quantity::Acceleration,
    });
    let known = [mode.stuck, 0.0, mode.k_t];
    let held = KNOWN.into_iter().zip(known).map(|(parameter, value)| Held { parameter, value }).collect();
    let settings = Settings { options: options(mode.stuck, ORDER), method: Method::Hilbert, held };
    let found = identify(&records, &settings)?;
    let sought = found.profiles.parameters.iter().filter(|profile| !profile.held);
    let interval = |profile: &Profile| Interval {
        parameter: profile.parameter.name(),
        value: profile.value,
        low: profile.low,
        high: profile.high,
        identifiable: profile.identifiable(),
    };
    Ok(sought.map(interval).collect())
}

/// Differences from the truth at all levels.
pub(super) fn distances(truth: &BeamUnderBlows, index: usize, accelerations: &[Vec<f64>]) -> Vec<Distance> {
    let one = |(n, model): (usize, &Vec<f64>)| {
        let truth = &truth.responses[n].outputs[index].acceleration;
        let early = ((EARLY / DT).round() as usize + 1).min(truth.len());
        Distance {
            level: LEVELS[n],
            early: relative_difference(&model[..early], &truth[..early]),
            whole: relative_difference(model, truth),
        }
    };
    accelerations.iter().enumerate().map(one).collect()
}
