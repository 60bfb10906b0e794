//! Simulation of modes under a force.

use std::sync::Mutex;

use iwan_core::progress::{Progress, UNWATCHED};
use iwan_core::{Error, Newmark, Pulse, Representation};
use iwan_machine::threads::together;

use crate::error::SimulationError;
use crate::methods::averaged;
use crate::methods::event::{self, Cut};
use crate::methods::free_decay::{self, Decaying};
use crate::methods::quality;
use crate::methods::run;
use crate::methods::task::{Task, modal_force};
use crate::mode::Mode;
use crate::response::Response;
use crate::settings::{Method, Settings};

/// Simulates one mode under the physical `force`; the mode's `shape_at_force` makes it a modal force.
///
/// ```
/// use iwan_core::{FourParameter, Pulse};
/// use iwan_sim::{JointLaw, Mode, Settings, simulate};
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let mode = Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint)));
/// let blow = Pulse::Haversine { amplitude: 1000.0, duration: 1.6e-3 };
/// let response = simulate(&mode, &blow, &Settings::new(1e-5, 0.2))?;
/// assert_eq!(response.steps(), 20_000);
/// assert!(response.energy.error() < 1e-10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SimulationError::Parameter`] for values out of range, [`SimulationError::NotFinite`] on overflow.
pub fn simulate(mode: &Mode, force: &Pulse<'_>, settings: &Settings) -> Result<Response, SimulationError> {
    settings.ask(1, 0)?;
    simulate_observed(mode, force, settings, Response::default(), UNWATCHED)
}

/// Simulates several modes on up to `threads` threads. The results have the same bits for any number of threads.
///
/// # Errors
/// [`SimulationError::Mode`] with the name of the first mode that failed, or
/// [`SimulationError::Interrupted`] when `progress` returned `Break`.
pub fn simulate_all(
    modes: &[Mode],
    force: &Pulse<'_>,
    settings: &Settings,
    threads: usize,
    progress: Progress<'_>,
) -> Result<Vec<Response>, SimulationError> {
    /// Parts into which the work on one mode is counted.
    const SHARES: f64 = 1e6;
    settings.ask(modes.len(), 0)?;
    let done = Mutex::new((vec![0; modes.len()], 0));
    let next = Mutex::new(0..modes.len());
    let one = |index: usize| {
        let report = |share: f64| {
            // `progress` is called under the lock, so that the shares that it receives rise.
            let mut done = done.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            let (shares, sum) = &mut *done;
            // Whole numbers, whose sum is kept without rounding: adding all shares up each time took longer than 60,000 short responses.
            let share = (share * SHARES) as u64;
            *sum = *sum + share - std::mem::replace(&mut shares[index], share);
            progress(*sum as f64 / (SHARES * shares.len() as f64))
        };
        simulate_observed(&modes[index], force, settings, Response::default(), &report)
    };
    let work = || {
        let mut finished = Vec::new();
        loop {
            let index = next.lock().unwrap_or_else(std::sync::PoisonError::into_inner).next();
            let Some(index) = index else { return finished };
            finished.push((index, one(index)));
        }
    };
    let finished = together(threads.clamp(1, modes.len().max(1)), &work);
    let mut results: Vec<_> = finished.into_iter().flatten().collect();
    results.sort_by_key(|(index, _)| *index);
    results.into_iter().map(|(index, result)| result.map_err(|e| in_mode(&modes[index], e))).collect()
}

pub(crate) fn in_mode(mode: &Mode, error: SimulationError) -> SimulationError {
    match error {
        SimulationError::Interrupted => error,
        source => SimulationError::Mode { mode: mode.name.clone(), source: Box::new(source) },
    }
}

/// Refuses a run with too many cycles, and a force that the time steps would not resolve.
pub(crate) fn check_scales(mode: &Mode, force: &Pulse<'_>, settings: &Settings) -> Result<(), Error> {
    /// Largest number of cycles of a run. At one sample a cycle, 1e9 cycles fill 32 GB, and methods that go from cycle to cycle need a
    /// minute for them. More must be a mistake in the input and is refused by name. The number is repeated in the message.
    const MOST_CYCLES: f64 = 1e9;
    let cycles = mode.frequency * settings.duration;
    if cycles > MOST_CYCLES {
        let allowed = "must be at most 1e9 cycles";
        return Err(Error::OutOfRange { name: "frequency * duration", value: cycles, allowed });
    }
    let stepped = matches!(settings.method, Method::Newmark { .. });
    if stepped && settings.dt > force.longest_step() {
        let allowed = "must be at most a quarter of the force's duration or period, or the force is not seen";
        return Err(Error::OutOfRange { name: "time step", value: settings.dt, allowed });
    }
    Ok(())
}

/// Refuses a method that the mode's law does not allow, such as one that rests on Masing's rule for a joint that does not follow it.
pub(crate) fn check_method(mode: &Mode, method: Method) -> Result<(), Error> {
    let what = match (method, mode.is_plain()) {
        (Method::HalfCycle | Method::Event { .. }, true) if mode.friction_drops() => {
            "half-cycle and event rest on Masing's rule, which a joint with theta < 1 (dynamic below static friction) does not \
             follow: it needs newmark or averaging"
        }
        (Method::Newmark { joint: Representation::Continuum, .. }, _) if mode.friction_drops() => {
            "the continuum rests on Masing's rule, which a joint with theta < 1 (dynamic below static friction) does not follow: \
             step it on sliders"
        }
        (Method::Newmark { beta, gamma, .. }, true)
            if mode.friction_drops() && (beta != 0.25 || gamma != 0.5) =>
        {
            "a joint with theta < 1 (dynamic below static friction) is stepped with beta = 0.25 and gamma = 0.5 only"
        }
        (Method::HalfCycle | Method::Event { .. }, false) => {
            "half-cycle and event run Iwan joints with viscous damping only: a mode with parts or curves needs newmark or \
             averaging"
        }
        (Method::Newmark { beta, gamma, .. }, false) if beta != 0.25 || gamma != 0.5 => {
            "a mode with parts or curves is stepped with beta = 0.25 and gamma = 0.5 only"
        }
        _ => return Ok(()),
    };
    Err(Error::Unsupported { what })
}

/// Newmark's scheme as a function of the time step, for a mode of the circular frequency `omega0` (rad/s).
pub(crate) fn schemes(
    omega0: f64,
    beta: f64,
    gamma: f64,
    prewarp: bool,
) -> impl Fn(f64) -> Result<Newmark, Error> {
    move |dt| match prewarp {
        true if beta == 0.25 && gamma == 0.5 => Newmark::prewarped(dt, omega0),
        true => Err(Error::Unsupported { what: "prewarp goes with beta = 0.25 and gamma = 0.5 only" }),
        false => Newmark::new(dt, beta, gamma),
    }
}

/// Number of steps after which the force no longer changes. If the force settles on a sample, the rounding of the quotient adds no step. A
/// force that may stop abruptly is stepped one sample further, so that its last impulse has acted completely, also where it ends on a
/// sample.
fn settled_after(force: &Pulse<'_>, dt: f64, samples: usize) -> Result<usize, Error> {
    let abrupt = matches!(force, Pulse::Step { .. } | Pulse::Sine { .. } | Pulse::Sampled { .. });
    let settled = force.settled();
    let further = if abrupt && settled > 0.0 { 1.0 } else { 0.0 };
    let steps = (settled / dt * (1.0 - 4.0 * f64::EPSILON)).ceil() + further;
    if steps < samples as f64 - 1.0 {
        return Ok(steps as usize);
    }
    let what = "half-cycle and averaging need a force that settles within the duration: use newmark or event, or a \
        longer duration";
    Err(Error::Unsupported { what })
}

/// Simulates one mode; the buffers of `spare`, a response that is no longer needed, are reused.
pub(crate) fn simulate_observed(
    mode: &Mode,
    force: &Pulse<'_>,
    settings: &Settings,
    spare: Response,
    progress: Progress<'_>,
) -> Result<Response, SimulationError> {
    let force = force.checked()?;
    let (dt, samples) = (settings.dt, settings.samples()?);
    check_scales(mode, &force, settings)?;
    let oscillator = mode.oscillator()?;
    check_method(mode, settings.method)?;
    let history = modal_force(mode, &force, dt, samples);
    let task = Task { mode, force: &history, dt, samples };
    match settings.method {
        Method::Newmark { beta, gamma, prewarp, joint } => {
            let scheme_at = schemes(oscillator.omega0(), beta, gamma, prewarp);
            let mut response = run::newmark(task, &scheme_at(dt)?, joint, spare, progress)?;
            if settings.quality {
                let order = if gamma == 0.5 { 2 } else { 1 };
                response.quality = quality::of_newmark((task, &force), &response, scheme_at, order, joint)?;
            }
            Ok(response)
        }
        method @ (Method::HalfCycle | Method::Averaging) => {
            let settled = settled_after(&force, dt, samples)?;
            let job = Decaying { task, force: &force, method, settled };
            let masing = mode.is_plain() && !mode.friction_drops();
            let simulate = if masing { free_decay::simulate } else { averaged::simulate };
            simulate(job, settings.quality, spare, progress)
        }
        Method::Event { bins, grid } => {
            event::simulate(task, &force, Cut { bins, grid }, settings.quality, progress)
        }
    }
}
