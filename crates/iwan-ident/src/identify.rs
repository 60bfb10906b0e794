//! From records to parameters with intervals, in one call.
//!
//! record → envelope → curves → start values → fit on the curves → refinement on the records → profile likelihood →
//! verdict. Several records are several force levels of the same mode.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use iwan_core::{Decay, Reversal, Samples};

use crate::curves::{Curves, ForceAxis, Quantity};
use crate::error::{Error, check};
use crate::fit::{Fit, fit_from};
use crate::least_squares::Minimum;
use crate::likelihood::Likelihood;
use crate::parameters::{Parameter, Parameters};
use crate::profile::{Extent, Profile, Profiles, profiles, slip_seen};
use crate::refine::{Refined, RingDown, Task};
use crate::signal::{Envelope, Isolated, Method, Options, isolate};
use crate::start::{Start, start};
use crate::verdict::{Compared, Verdict};

/// Searches that begin anew because a profile found a better minimum.
const ANEW: usize = 6;
/// Part of ω0² that stands for no joint at all.
const NO_JOINT: f64 = 1e-9;

/// A record of one mode, mass-normalised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source<'a> {
    /// Uniform samples.
    pub samples: &'a [f64],
    /// Sampling interval, s.
    pub dt: f64,
    /// What was measured.
    pub quantity: Quantity,
}

/// How an identification goes about it; `Settings::default()` finds everything itself.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Settings {
    /// How the mode is taken out of each record.
    pub options: Options,
    /// The envelope that curves and verdict are made from.
    pub method: Method,
    /// Parameters that keep a given value.
    pub held: Vec<(Parameter, f64)>,
}

/// The simplest model: a linear mode with viscous damping, and whether it is enough.
#[derive(Debug, Clone, PartialEq)]
pub struct Linear {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Viscous damping ratio.
    pub damping_ratio: f64,
    /// Root mean square of its residuals over that of the records' amplitudes.
    pub relative_residual: f64,
    /// Schwarz's criterion of the linear model less that of the full one: below 0 the joint is not needed.
    pub criterion: f64,
}

impl Linear {
    /// Whether the records are told as well without a joint.
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
    /// Their profiles, with the 95 % intervals.
    pub profiles: Profiles,
    /// The refinement behind them.
    pub refined: Refined,
    /// The records' likelihood, for samplers.
    pub likelihood: Likelihood,
    /// Start values off the curves of the loudest record.
    pub start: Start,
    /// The fit on the curves that the refinement began with.
    pub fit: Fit,
    /// Envelope of each record.
    pub envelopes: Vec<Envelope>,
    /// Curves of each record, against modal force.
    pub curves: Vec<Curves>,
    /// The same curves of the model's ring-downs, by the same method.
    pub model_curves: Vec<Curves>,
    /// First sample of each record that was compared with the model.
    pub first_samples: Vec<usize>,
    /// The linear mode with viscous damping.
    pub linear: Linear,
    /// Whether the model matches, how far off it is.
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

    /// What the records do not tell, in words: open intervals, a joint that is not needed, a model that does not fit.
    #[must_use]
    pub fn in_words(&self) -> Vec<String> {
        let mut words = vec![self.verdict.misfit.clone()];
        if self.linear.is_enough() {
            words.push(format!(
                "the joint is not needed: a linear mode of {:.6} Hz with {:.4} % viscous damping tells the records as well",
                self.linear.frequency,
                100.0 * self.linear.damping_ratio
            ));
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

/// A record on its way.
struct Prepared<'a> {
    source: Source<'a>,
    isolated: Isolated,
    envelope: Envelope,
    curves: Curves,
    /// Samples that are compared with the model, the index of the first, and the width of their band in Hz.
    stretch: Vec<f64>,
    first: usize,
    band: Option<f64>,
}

impl<'a> Prepared<'a> {
    fn new(source: Source<'a>, settings: &Settings) -> Result<Self, Error> {
        let isolated = isolate(source.samples, source.dt, &settings.options)?;
        let envelope = isolated.envelope(settings.method, settings.options.order)?;
        let curves = Curves::new(&envelope, source.quantity, ForceAxis::Modal)?;
        let automatic = settings.options.band.is_none() && settings.options.window.is_none();
        let raw = settings.options.filter_order == 0 || (automatic && isolated.is_alone(source.samples));
        let (stretch, first, band) = if raw {
            let range = isolated.free_decay(source.samples, settings.options.window);
            (source.samples[range.clone()].to_vec(), range.start, None)
        } else {
            let range = isolated.window.clone();
            let band = isolated.band.high - isolated.band.low;
            (isolated.samples[range.clone()].to_vec(), range.start, Some(band))
        };
        Ok(Self { source, isolated, envelope, curves, stretch, first, band })
    }

    fn ring_down(&self) -> RingDown<'_> {
        RingDown {
            samples: &self.stretch,
            dt: self.source.dt,
            quantity: self.source.quantity,
            band: self.band,
        }
    }

    fn notes(&self) -> impl Iterator<Item = String> + '_ {
        let seconds = self.first as f64 * self.source.dt;
        let what = match self.band {
            None => {
                "no other line stands out of the spectrum: the model is compared with the record as it is"
            }
            Some(_) => "the model is compared with the record in the band",
        };
        let own = format!("{what}, from {seconds:.6} s on");
        self.envelope.notes.iter().cloned().chain([own])
    }
}

/// Parameters, intervals and verdict from the records of one mode at one or several force levels.
///
/// # Errors
/// As [`isolate`], [`fit`](crate::fit::fit()) and [`refine`](crate::refine::refine()).
///
/// ```
/// use iwan_core::{Decay, Reversal, Samples};
/// use iwan_ident::{Parameter, Parameters, curves::Quantity, identify::{Settings, Source, identify}};
/// use iwan_ident::likelihood::Buffers;
/// let truth = Parameters { frequency: 124.0, damping_ratio: 1e-3, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };
/// let (oscillator, joint) = truth.model()?;
/// let (dt, mut out) = (2e-4, [vec![0.0; 2000], vec![0.0; 2000], vec![0.0; 2000], vec![0.0; 2000]]);
/// let [displacement, velocity, acceleration, joint_force] = &mut out;
/// let start = iwan_core::Motion::held_at(0.2 * joint.phi_max());
/// Decay::new(&oscillator, &joint, 0.0, start, vec![Reversal::default(); 200])?
///     .sample(dt, &mut Samples { displacement, velocity, acceleration, joint_force })?;
/// let source = Source { samples: &out[2], dt, quantity: Quantity::Acceleration };
/// let found = identify(&[source], &Settings::default())?;
/// // In micro-slip the power is known, and where the joint would slip is not.
/// assert!(found.verdict.adequate && found.profile(Parameter::Chi).identifiable());
/// assert!((found.parameters.chi + 0.183).abs() < 0.004);
/// assert!(found.profile(Parameter::FS).high.is_none() && !found.profile(Parameter::Beta).identifiable());
/// // For a sampler: nothing is likelier than the best fit, by more than the rounding of the search.
/// let (likelihood, mut buffers) = (&found.likelihood, Buffers::default());
/// let other = Parameters { chi: -0.19, ..found.parameters };
/// let best = likelihood.log(&found.parameters, likelihood.starts(), &mut buffers).unwrap();
/// assert!(best > likelihood.log(&other, likelihood.starts(), &mut buffers).unwrap());
/// # Ok::<(), iwan_ident::Error>(())
/// ```
pub fn identify(sources: &[Source<'_>], settings: &Settings) -> Result<Identification, Error> {
    identification(sources, settings, &Arc::default())
}

/// [`identify`] that ends soon, by an error, once another thread sets `stopped`.
///
/// # Errors
/// As [`identify`], and [`Error::Stopped`].
pub fn identify_until(
    sources: &[Source<'_>],
    settings: &Settings,
    stopped: &Arc<AtomicBool>,
) -> Result<Identification, Error> {
    let found = identification(sources, settings, stopped);
    if stopped.load(Ordering::Relaxed) { Err(Error::Stopped) } else { found }
}

fn identification(
    sources: &[Source<'_>],
    settings: &Settings,
    stopped: &Arc<AtomicBool>,
) -> Result<Identification, Error> {
    check("records", sources.len() as f64, !sources.is_empty(), "at least one", "give a record")?;
    let prepared =
        sources.iter().map(|source| Prepared::new(*source, settings)).collect::<Result<Vec<_>, _>>()?;
    let curves: Vec<Curves> = prepared.iter().map(|p| p.curves.clone()).collect();
    let (start, fit) = on_curves(&curves, &settings.held)?;
    let records: Vec<RingDown<'_>> = prepared.iter().map(Prepared::ring_down).collect();
    let held: Vec<Parameter> = settings.held.iter().map(|h| h.0).collect();
    let mut task = Task::new(&records, &fit.parameters, &held)?;
    task.stopped = stopped.clone();
    let (minimum, profiles) = minimum_and_profiles(&mut task, &fit.parameters)?;
    let refined = task.refined(&minimum);
    let model_curves = prepared
        .iter()
        .zip(&refined.starts)
        .map(|(p, start)| p.model_curves(&refined.parameters, *start, settings))
        .collect::<Result<Vec<_>, _>>()?;
    let linear = linear(&task, &minimum, &refined.parameters, &curves)?;
    Ok(Identification {
        parameters: refined.parameters,
        verdict: verdict(&curves, &model_curves, refined.leaves_noise(task.count())),
        notes: prepared.iter().flat_map(Prepared::notes).chain(start.notes.iter().cloned()).collect(),
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
    })
}

/// Start values and the fit on the curves.
fn on_curves(curves: &[Curves], held: &[(Parameter, f64)]) -> Result<(Start, Fit), Error> {
    let largest = |c: &Curves| c.displacement.iter().copied().fold(0.0, f64::max);
    let loudest = curves.iter().max_by(|a, b| largest(a).total_cmp(&largest(b)));
    let mut start = start(loudest.ok_or(Error::Length { name: "curves", needed: 1, found: 0 })?)?;
    // Quieter records come nearer to the small-amplitude frequency.
    let highest = curves.iter().flat_map(|c| c.frequency.iter().copied()).fold(0.0, f64::max);
    start.parameters.frequency = start.parameters.frequency.max(highest);
    for (parameter, value) in held {
        *start.parameters.get_mut(*parameter) = *value;
    }
    let mut starts = vec![start.parameters];
    for (chi, k_t) in [(-0.5, 1.0), (-0.2, 1.0), (-0.2, 3.0), (0.1, 0.5)] {
        let mut other = Parameters { chi, k_t: k_t * start.parameters.k_t, ..start.parameters };
        for (parameter, value) in held {
            *other.get_mut(*parameter) = *value;
        }
        starts.push(other);
    }
    let names: Vec<Parameter> = held.iter().map(|h| h.0).collect();
    let fit = fit_from(curves, &starts, &names)?;
    Ok((start, fit))
}

/// Searches until no profile finds a better minimum. Where the records do not see macro-slip, the best fit without it.
fn minimum_and_profiles(task: &mut Task, first: &Parameters) -> Result<(Minimum, Profiles), Error> {
    let mut minimum = task.solve(first)?;
    let first = task.coordinates(first)?;
    let (mut round, mut finished) = (0, false);
    loop {
        let micro_slip = task.micro_slip(&[&minimum.x, &first]);
        let extent =
            if slip_seen(task, &minimum, micro_slip.as_ref()) { Extent::Full } else { Extent::MicroSlip };
        match (extent, &micro_slip) {
            (Extent::MicroSlip, Some(without)) => minimum = without.clone(),
            _ if finished => {}
            _ => {
                (minimum, finished) = (task.finish(&minimum)?, true);
                continue;
            }
        }
        match profiles(task, &minimum, micro_slip.as_ref(), (extent, round > ANEW)) {
            Ok(profiles) => return Ok((minimum, profiles)),
            Err(better) => match task.resume(&better, &minimum) {
                Some(deeper) if round < ANEW => minimum = deeper,
                _ => round = ANEW,
            },
        }
        round += 1;
    }
}

/// The linear mode on the same records, from the mean damping of the curves.
fn linear(
    task: &Task,
    minimum: &Minimum,
    parameters: &Parameters,
    curves: &[Curves],
) -> Result<Linear, Error> {
    let ratios: Vec<f64> = curves.iter().flat_map(|c| c.damping_ratio.iter().copied()).collect();
    let damping_ratio = (ratios.iter().sum::<f64>() / ratios.len() as f64).max(0.0);
    let omega_squared = (TAU * parameters.frequency).powi(2);
    let first = Parameters {
        damping_ratio,
        k_t: NO_JOINT * omega_squared,
        f_s: omega_squared,
        chi: 0.0,
        beta: 0.0,
        ..*parameters
    };
    let (linear, found) = task.without_joint(&first, minimum)?;
    let (n, fewer) = (task.count() as f64, (task.free().len() - linear.free().len()) as f64);
    let refined = linear.refined(&found);
    Ok(Linear {
        frequency: refined.parameters.frequency,
        damping_ratio: refined.parameters.damping_ratio,
        relative_residual: refined.relative_residual,
        criterion: n * (found.cost / minimum.cost).ln() - fewer * n.ln(),
    })
}

impl Prepared<'_> {
    /// Curves of the model's ring-down by the same filter and envelope, at those times of the record's that both cover.
    fn model_curves(
        &self,
        parameters: &Parameters,
        start: (f64, f64),
        settings: &Settings,
    ) -> Result<Curves, Error> {
        let (dt, late) = (self.source.dt, self.first as f64 * self.source.dt + start.1);
        let count = (self.isolated.samples.len() as f64 - late / dt) as usize;
        let samples = ring_down(parameters, start.0, (dt, count), self.source.quantity)?;
        let band = Some((self.isolated.band.low, self.isolated.band.high));
        let window = Some((0.0, self.isolated.trusted().1 - late));
        let options = Options { band, window, order: Some(self.envelope.order), ..settings.options };
        let isolated = isolate(&samples, dt, &options)?.weighted_as(&self.isolated);
        let envelope = isolated.envelope(settings.method, options.order)?;
        let model = Curves::new(&envelope, self.source.quantity, ForceAxis::Modal)?;
        Ok(model.at(late, &self.curves.t))
    }
}

/// Free decay from rest at a displacement, `count` samples every `dt` seconds.
fn ring_down(
    parameters: &Parameters,
    displacement: f64,
    (dt, count): (f64, usize),
    quantity: Quantity,
) -> Result<Vec<f64>, Error> {
    let (oscillator, joint) = parameters.model()?;
    let stack = vec![Reversal::default(); (2.5 * count as f64 * dt * parameters.frequency) as usize + 16];
    let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; count]);
    let [q, v, a, f] = &mut out;
    let mut samples = Samples { displacement: q, velocity: v, acceleration: a, joint_force: f };
    let start = iwan_core::Motion::held_at(displacement);
    Decay::new(&oscillator, &joint, 0.0, start, stack)?.sample(dt, &mut samples)?;
    let [displacement, velocity, acceleration, _] = out;
    Ok(match quantity {
        Quantity::Displacement => displacement,
        Quantity::Velocity => velocity,
        Quantity::Acceleration => acceleration,
    })
}

/// Compares curves and the model's at the times they share.
fn verdict(curves: &[Curves], model: &[Curves], noise_only: bool) -> Verdict {
    let (mut dissipation, mut frequency) = (vec![], vec![]);
    for (record, model) in curves.iter().zip(model) {
        for (j, t) in model.t.iter().enumerate() {
            let Some(i) = record.t.iter().position(|s| s == t) else { continue };
            if record.dissipation[i] > 0.0 && model.dissipation[j] > 0.0 {
                dissipation.push(Compared {
                    measured: record.dissipation[i].ln(),
                    deviation: record.log_dissipation_sd[i],
                    model: model.dissipation[j].ln(),
                });
            }
            frequency.push(Compared {
                measured: record.frequency[i],
                deviation: record.frequency_sd[i],
                model: model.frequency[j],
            });
        }
    }
    Verdict::new(&dissipation, &frequency, noise_only)
}
