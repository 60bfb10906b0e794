//! Laws compared on the records of a mode, beside or without the fit of the Iwan joint.

use super::prepared::Prepared;
use super::settings::{ModeRecord, Settings};
use crate::curve_fit::{DISSIPATION, Grade, Verdict};
use crate::error::Error;
use crate::laws::{Comparison, Estimate, Extrapolation, FittedLaw, Joint, LawMode, Source, compare};
use crate::parameters::{Parameter, Parameters};
use crate::profile::Profiles;

/// Compares all laws on the records of a mode, without the simulation in the loop that [`identify`](super::identify()) needs: this takes less than a
/// second a record.
///
/// # Errors
/// As [`isolate`](crate::signal::isolate) and [`compare`].
///
/// ```
/// use iwan_ident::{curves::Quantity, identify::{ModeRecord, Settings, compare_laws}};
/// // A linear mode: 80 Hz, 0.2 % damping, with a little noise.
/// let (omega, zeta, mut noise) = (std::f64::consts::TAU * 80.0, 0.002_f64, iwan_core::SplitMix64::new(1));
/// let x: Vec<f64> = (0..8192).map(|n| n as f64 / 4096.0)
///     .map(|t| (-zeta * omega * t).exp() * (omega * t).cos() + 1e-3 * noise.next_symmetric()).collect();
/// let record = ModeRecord { samples: &x, dt: 1.0 / 4096.0, quantity: Quantity::Velocity };
/// let found = compare_laws(&[record], &Settings::default())?;
/// assert_eq!(found.chosen().law.name, "linear");
/// let ratio = &found.chosen().parameters[1];
/// assert!(ratio.low.unwrap() < zeta && zeta < ratio.high.unwrap());
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn compare_laws(records: &[ModeRecord<'_>], settings: &Settings) -> Result<Comparison, Error> {
    let prepared =
        records.iter().map(|record| Prepared::new(*record, None, settings)).collect::<Result<Vec<_>, _>>()?;
    of_prepared(&prepared, None)
}

/// Compares all laws on prepared records; `iwan` are parameters of the joint at which its search begins as well.
pub(super) fn of_prepared(prepared: &[Prepared<'_>], iwan: Option<&Parameters>) -> Result<Comparison, Error> {
    let sources: Vec<Source<'_>> = prepared
        .iter()
        .map(|p| {
            let ring_down = p.ring_down();
            Source { ring_down, first: p.first as f64 * ring_down.dt, curves: &p.curves }
        })
        .collect();
    let found = compare(&sources, iwan)?;
    Ok(if prepared.iter().any(Prepared::is_treated) { found.of_treated() } else { found })
}

/// The parameters of an Iwan joint that the records do not tell, whatever its profiles say. A joint that does not describe the records has
/// parameters, but not those of the structure; the same holds for a joint that may be a drift, and for records that
/// were filtered or windowed before. Where the joint misses something and the evidence for
/// another law is strong, a bend that the joint makes of this is no macro-slip.
pub(super) fn untold(verdict: &Verdict, laws: Option<&Comparison>) -> &'static [Parameter] {
    let against = laws.is_some_and(|laws| laws.speaks_against("iwan"));
    match verdict.grade {
        Grade::No => &Parameter::ALL,
        _ if verdict.drift || verdict.treated => &Parameter::ALL,
        Grade::Usable if against => &[Parameter::KT, Parameter::FS, Parameter::Beta],
        Grade::Usable | Grade::Matches => &[],
    }
}

/// Whether a linear mode has the damping of the record at all amplitudes and only the frequency moves, as evenly as ln amplitude: the joint found for
/// such a record never comes near its rest. In one decay a frequency that drifts with time does the same.
pub(super) fn only_the_frequency_moves(laws: &Comparison, extrapolation: Extrapolation) -> bool {
    let damped_alike = laws.named("linear").is_some_and(|linear| linear.dissipation_misfit <= DISSIPATION);
    damped_alike && laws.speaks_against("linear") && !extrapolation.untold().is_empty()
}

/// Laws that describe the records as well as the joint or better, where the joint is known to miss something (`missed`): what they say about a
/// parameter that both have is as likely.
pub(super) fn as_likely(missed: bool, laws: Option<&Comparison>) -> Vec<&FittedLaw> {
    let near = laws.into_iter().flat_map(Comparison::near);
    near.filter(|law| missed && law.law.name != "iwan").collect()
}

/// The profiles with intervals widened to contain those of other laws for the same parameters.
pub(super) fn with_others(mut profiles: Profiles, others: &[&FittedLaw]) -> Profiles {
    for law in others {
        for estimate in &law.parameters {
            if let Some(parameter) = Parameter::ALL.into_iter().find(|p| p.name() == estimate.name) {
                profiles = profiles.holding(parameter, [estimate.low, estimate.high]);
            }
        }
    }
    profiles
}

/// The comparison in which the law `iwan` has the parameters, intervals and verdict of the fit on the records themselves, so that a page says only
/// one thing about this law.
pub(super) fn beside(
    found: Comparison,
    parameters: &Parameters,
    profiles: &Profiles,
    verdict: &Verdict,
) -> Result<Comparison, Error> {
    let (_, joint) = parameters.model()?;
    let of_records = |parameter: Parameter| {
        let profile = profiles.parameters.iter().find(|p| p.parameter == parameter);
        let (low, high) = profile.map_or((None, None), |p| (p.low, p.high));
        Estimate { name: parameter.name(), value: parameters.get(parameter), low, high }
    };
    Ok(found.knowing("iwan", |iwan| {
        (iwan.dissipation_misfit, iwan.frequency_misfit) =
            (verdict.dissipation_misfit, verdict.frequency_misfit);
        iwan.grade = verdict.grade;
        iwan.parameters = Parameter::ALL.map(of_records).to_vec();
        iwan.mode = LawMode {
            frequency: parameters.frequency,
            damping_ratio: parameters.damping_ratio,
            joint: Some(Joint::FourParameter(joint)),
            parts: vec![],
        };
    }))
}
