//! From records to parameters with intervals, in one call.
//!
//! record → envelope → curves → start values → fit on the curves → refinement on the records → profile likelihood →
//! verdict. Several records are several force levels of the same mode.

mod settings;
mod prepared;
mod beside_record;
mod days;
mod laws;
mod identification;
mod minimum;
mod linear;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use iwan_machine::checkpoint::Checkpoint;
use iwan_machine::threads::{at_once, in_parallel};

use crate::curve_fit::{Beside, Doubt, Fit, Start, Verdict, fit_from, left_over, start};
use crate::curves::Curves;
use crate::error::{Error, check};
use crate::laws::Extrapolation;
use crate::likelihood::Likelihood;
use crate::parameters::{Parameter, Parameters};
use crate::refine::{Refined, RingDown, Task, TurningPoint};
use crate::signal::{Band, Isolated};
use beside_record::beside_record;
use days::{apart, days, largest, on_mean_day};
pub use identification::{Identification, Linear};
pub use laws::compare_laws;
use linear::linear;
use minimum::{Found, minimum_and_profiles};
use prepared::Prepared;
pub use settings::{Held, ModeRecord, Settings};

/// Further starts of the fit on the curves: steeper and flatter powers χ than the slope suggests, and a joint three times as stiff or half as stiff.
/// Slopes and knees can be mistaken for one another; a fit on curves costs milliseconds, so each start is tried. Which ones is a judgement, and not
/// varied.
const OTHER_STARTS: [OtherStart; 4] = [
    OtherStart { chi: -0.5, k_t: 1.0 },
    OtherStart { chi: -0.2, k_t: 1.0 },
    OtherStart { chi: -0.2, k_t: 3.0 },
    OtherStart { chi: 0.1, k_t: 0.5 },
];

/// Largest ratio of a quieter record's spectral peak to a louder record's for one mode: a joint softens with amplitude, by 30 % where it carries most
/// of the stiffness. Records beyond it are refused.
const SOFTENING: f64 = 1.3;
/// Smallest such ratio: a quieter record's peak lies lower only by the day's temperature, the mounting and the width of a spectral line. Records
/// below it are refused.
const STIFFENING: f64 = 0.98;

/// Largest difference of ln frequency between hits of one mode at the same amplitude; records beyond it are refused. Hits of a day differ by a
/// thousandth, a joint that was taken apart and bolted again by one or two per cent. A judgement.
const OTHER_DAY: f64 = 0.04;

/// A start of the fit on the curves, beside the graphical one.
struct OtherStart {
    chi: f64,
    /// K_T over that of the graphical start.
    k_t: f64,
}

/// Parameters, intervals and verdict from the records of one mode at one or several force levels.
///
/// # Errors
/// As [`isolate`](crate::signal::isolate), [`fit`](crate::curve_fit::fit()) and [`refine`](crate::refine::refine()).
///
/// ```
/// use iwan_core::{Decay, Reversal, Samples};
/// use iwan_ident::{Parameter, Parameters, curves::Quantity, identify::{Settings, ModeRecord, identify}};
/// use iwan_ident::likelihood::Buffers;
/// let truth = Parameters { frequency: 124.0, damping_ratio: 1e-3, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };
/// let (oscillator, joint) = truth.model()?;
/// let (dt, mut out) = (2e-4, [vec![0.0; 2000], vec![0.0; 2000], vec![0.0; 2000], vec![0.0; 2000]]);
/// let [displacement, velocity, acceleration, joint_force] = &mut out;
/// Decay::new(&oscillator, &joint, 0.0, iwan_core::Motion::held_at(0.2 * joint.phi_max()), vec![Reversal::default(); 200])?
///     .sample(dt, &mut Samples { displacement, velocity, acceleration, joint_force })?;
/// let record = ModeRecord { samples: &out[2], dt, quantity: Quantity::Acceleration };
/// let found = identify(&[record], &Settings::default())?;
/// // In micro-slip the power is known, and where the joint would slip is not.
/// assert!(found.verdict.adequate && found.profile(Parameter::Chi).identifiable());
/// assert!((found.parameters.chi + 0.183).abs() < 0.004);
/// assert!(found.profile(Parameter::FS).high.is_none() && !found.profile(Parameter::Beta).identifiable());
/// // For a sampler: nothing is likelier than the best fit, by more than the rounding of the search.
/// let (likelihood, mut buffers) = (&found.likelihood, Buffers::default());
/// let other = Parameters { chi: -0.19, ..found.parameters };
/// let best = likelihood.log(&found.parameters, likelihood.starts(), &mut buffers).unwrap();
/// assert!(best > likelihood.log(&other, likelihood.starts(), &mut buffers).unwrap());
/// // In another process, with the same bits.
/// let there: iwan_ident::likelihood::Likelihood = serde_json::from_str(&serde_json::to_string(likelihood)?)?;
/// assert_eq!(there.log(&other, there.starts(), &mut buffers), likelihood.log(&other, likelihood.starts(), &mut buffers));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn identify(records: &[ModeRecord<'_>], settings: &Settings) -> Result<Identification, Error> {
    identification(&not_isolated(records), settings, &Arc::default(), None)
}

/// [`identify`] of records whose mode was isolated before, by [`isolate`](crate::signal::isolate) with the options of these settings. Where a checkpoint is given, the ends of the
/// searches are kept there: another process with the same records, settings and checkpoint goes on where this one ended, and arrives at the same bits.
///
/// # Errors
/// As [`identify`]; [`Error::Refused`] for a mode that was isolated from a longer record, or at another sampling interval.
pub fn identify_isolated(
    records: &[(ModeRecord<'_>, &Isolated)],
    settings: &Settings,
    kept: Option<&Arc<Checkpoint>>,
) -> Result<Identification, Error> {
    let records: Vec<_> = records.iter().map(|(record, isolated)| (*record, Some(*isolated))).collect();
    identification(&records, settings, &Arc::default(), kept)
}

/// [`identify`] that ends soon, by an error, once another thread sets `stopped`.
///
/// # Errors
/// As [`identify`], and [`Error::Stopped`].
pub fn identify_until(
    records: &[ModeRecord<'_>],
    settings: &Settings,
    stopped: &Arc<AtomicBool>,
) -> Result<Identification, Error> {
    let found = identification(&not_isolated(records), settings, stopped, None);
    if stopped.load(Ordering::Relaxed) { Err(Error::Stopped) } else { found }
}

/// Records whose mode has still to be isolated.
fn not_isolated<'a>(records: &[ModeRecord<'a>]) -> Vec<(ModeRecord<'a>, Option<&'a Isolated>)> {
    records.iter().map(|record| (*record, None)).collect()
}

fn identification(
    records: &[(ModeRecord<'_>, Option<&Isolated>)],
    settings: &Settings,
    stopped: &Arc<AtomicBool>,
    kept: Option<&Arc<Checkpoint>>,
) -> Result<Identification, Error> {
    check("records", records.len() as f64, !records.is_empty(), "at least one", "give a record")?;
    let prepared =
        in_parallel(records, at_once(), &|(record, isolated)| Prepared::new(*record, *isolated, settings));
    let prepared = prepared.into_iter().collect::<Result<Vec<_>, _>>()?;
    check_together(&prepared)?;
    let curves: Vec<Curves> = prepared.iter().map(|p| p.curves.clone()).collect();
    let days = days(&prepared);
    let day = |i: usize| days.as_ref().map_or(0.0, |days| days[i]);
    let on_mean_day: Vec<Curves> = curves.iter().enumerate().map(|(i, c)| on_mean_day(c, day(i))).collect();
    let OnCurves { start, fit } = on_curves(&on_mean_day, &settings.held)?;
    let ring_downs: Vec<RingDown<'_>> = prepared.iter().map(Prepared::ring_down).collect();
    let held: Vec<Parameter> = settings.held.iter().map(|h| h.parameter).collect();
    let task = Task::new(&ring_downs, &fit.parameters, &held);
    let mut task = task.map_err(|e| prepared.iter().fold(e, |e, p| p.refused(e)))?;
    (task.stopped, task.kept) = (stopped.clone(), kept.cloned());
    task.begin_with(days.as_deref());
    let Found { minimum, profiles } = minimum_and_profiles(&mut task, &fit.parameters)?;
    let refined = task.refined(&minimum);
    let pairs: Vec<_> = prepared.iter().zip(&refined.starts).collect();
    let curves_of =
        |(p, start): &(&Prepared<'_>, &TurningPoint)| p.model_curves(&refined.parameters, **start, settings);
    let model_curves =
        in_parallel(&pairs, at_once(), &curves_of).into_iter().collect::<Result<Vec<_>, _>>()?;
    let linear = linear(&task, &minimum, &refined.parameters, &curves)?;
    let laws = laws::of_prepared(&prepared, Some(&refined.parameters));
    let laws = laws.map(|laws| if refined.is_of_the_law() { laws.made_by("iwan") } else { laws });
    let speaks_against = laws.as_ref().is_ok_and(|laws| laws.speaks_against("iwan"));
    let against = outside_band(&prepared, &refined).into_iter().chain(left_over(refined.relative_residual));
    let extrapolation = Extrapolation::of(&curves, refined.parameters.frequency);
    let drifts = records.len() == 1
        && laws.as_ref().is_ok_and(|laws| laws::only_the_frequency_moves(laws, extrapolation));
    let doubts = [
        (prepared.iter().any(Prepared::is_treated), Doubt::Treated),
        (prepared.iter().any(Prepared::is_driven_again), Doubt::Driven),
        (drifts, Doubt::Drift),
        (speaks_against && refined.discrepancy.is_found(), Doubt::Surpassed),
    ];
    let beside = Beside {
        reasons: against.collect(),
        leaves_noise: refined.leaves_noise(task.count()),
        doubt: doubts.into_iter().find(|(is_so, _)| *is_so).map(|(_, doubt)| doubt),
    };
    let verdict = Verdict::beside(&beside, &beside_record(&curves, &model_curves, &refined.starts));
    let others = laws::as_likely(refined.discrepancy.is_found(), laws.as_ref().ok());
    let profiles = laws::with_others(profiles, &others).without(laws::untold(&verdict, laws.as_ref().ok()));
    let profiles =
        profiles.without(extrapolation.untold()).open_beyond(Parameter::Frequency, extrapolation.limit());
    let as_likely = others.iter().map(|law| law.law.name).collect();
    let laws = laws.and_then(|laws| laws::beside(laws, &refined.parameters, &profiles, &verdict));
    Ok(Identification {
        parameters: refined.parameters,
        verdict,
        notes: prepared.iter().flat_map(Prepared::notes).collect(),
        envelopes: prepared.iter().map(|p| p.envelope.clone()).collect(),
        first_samples: prepared.iter().map(|p| p.first).collect(),
        likelihood: Likelihood::new(&task, profiles.variance, &refined.parameters, &refined.starts),
        profiles,
        refined,
        start,
        fit,
        curves,
        model_curves,
        linear,
        laws,
        as_likely,
    })
}

/// Start values and fit that follow from the curves alone.
struct OnCurves {
    start: Start,
    fit: Fit,
}

/// Start values from the curves of the loudest record, and the fit on the curves of all records.
fn on_curves(curves: &[Curves], held: &[Held]) -> Result<OnCurves, Error> {
    let loudest = curves.iter().max_by(|a, b| largest(a).total_cmp(&largest(b)));
    let mut start = start(loudest.ok_or(Error::Length { name: "curves", needed: 1, found: 0 })?)?;
    // Quieter records come nearer to the small-amplitude frequency.
    let highest = curves.iter().flat_map(|c| c.frequency.iter().copied()).fold(0.0, f64::max);
    start.parameters.frequency = start.parameters.frequency.max(highest);
    for held in held {
        *start.parameters.get_mut(held.parameter) = held.value;
    }
    let mut starts = vec![start.parameters];
    for OtherStart { chi, k_t } in OTHER_STARTS {
        let mut other = Parameters { chi, k_t: k_t * start.parameters.k_t, ..start.parameters };
        for held in held {
            *other.get_mut(held.parameter) = held.value;
        }
        starts.push(other);
    }
    let names: Vec<Parameter> = held.iter().map(|h| h.parameter).collect();
    let fit = fit_from(curves, &starts, &names)?;
    Ok(OnCurves { start, fit })
}

/// The reason against a fit whose frequency lies outside the band in which the mode was looked for: the frequency is not that mode's. None where it
/// lies inside.
fn outside_band(prepared: &[Prepared<'_>], refined: &Refined) -> Option<String> {
    let frequency = refined.parameters.frequency;
    let Band { low, high, peak } =
        prepared.iter().map(Prepared::band).find(|b| frequency < b.low || frequency > b.high)?;
    Some(format!(
        "the frequency of {frequency:.4} Hz lies outside the band of {low:.4} to {high:.4} Hz about the peak at {peak:.4} Hz"
    ))
}

/// Refuses records that cannot be hits of one mode: equal samples, peaks that no softening brings together, and frequencies too far apart at the same
/// amplitude.
fn check_together(prepared: &[Prepared<'_>]) -> Result<(), Error> {
    for (i, one) in prepared.iter().enumerate() {
        if let Some(j) = (0..i).find(|j| prepared[*j].is_same_record(one)) {
            return Err(Error::Refused {
                finding: format!("records {} and {} hold the same samples: one hit is not two", j + 1, i + 1),
                remedy: "give each record once",
            });
        }
    }
    let loudness = |p: &Prepared<'_>| largest(&p.curves);
    for (i, one) in prepared.iter().enumerate() {
        for (j, other) in prepared.iter().enumerate().take(i) {
            let (soft, hard) = if loudness(one) < loudness(other) { (one, other) } else { (other, one) };
            let ratio = soft.band().peak / hard.band().peak;
            if !(STIFFENING..=SOFTENING).contains(&ratio) {
                return Err(Error::Refused {
                    finding: format!(
                        "records {} and {} have their peaks at {:.4} and {:.4} Hz: these are not one mode",
                        j + 1,
                        i + 1,
                        other.band().peak,
                        one.band().peak
                    ),
                    remedy: "fit them one by one, or give the band of the mode that they share",
                });
            }
            let at_one_amplitude = apart(&one.curves, &other.curves);
            if at_one_amplitude.abs() > OTHER_DAY {
                return Err(Error::Refused {
                    finding: format!(
                        "records {} and {}, with peaks at {:.4} and {:.4} Hz, differ by {:.1} % of frequency at the same amplitude: these are not one mode",
                        j + 1,
                        i + 1,
                        other.band().peak,
                        one.band().peak,
                        100.0 * at_one_amplitude.abs()
                    ),
                    remedy: "fit them one by one, or give the band of the mode that they share",
                });
            }
        }
    }
    Ok(())
}
