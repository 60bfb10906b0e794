//! Responses of any length, passed on in stretches as they are computed, in memory that does not grow with their length.

use std::ops::ControlFlow;

use iwan_core::progress::Progress;
use iwan_core::{EnergyBalance, Error, Newmark, Pulse, Representation};

use crate::error::SimulationError;
use crate::methods::between;
use crate::methods::outside::Follower;
use crate::methods::quality::{FEWEST, reference, relative};
use crate::methods::run::{strongest, told};
use crate::methods::stepped::{self, Stepped};
use crate::methods::task::{CHUNK, Room, Task, first_not_finite, for_companions, reversals};
use crate::mode::Mode;
use crate::response::{Response, Totals};
use crate::settings::{Method, Settings};
use crate::simulate::{check_method, check_scales, in_mode, schemes};

/// Largest number of half cycles that a continuum remembers in a stream; they take 1 MB for each run. A mode with 0.003 % of critical
/// damping has decayed to 0.2 % by then. When the limit is reached, the innermost loops are forgotten, and `Quality::forgotten_force`
/// bounds the error.
const MOST: f64 = 65_536.0;

/// The samples of all modes in one stretch of time.
#[derive(Debug)]
pub struct Stretch<'a> {
    /// Index of the stretch's first sample; the initial state has index 0.
    pub first: usize,
    /// For each mode displacement, velocity, acceleration and joint force, as in [`Response`].
    pub modes: Vec<[&'a [f64]; 4]>,
}

/// Simulates several modes in time steps and passes their samples to `take` in stretches of 65,536 steps. Each mode with its companion runs
/// takes 4 MB. The samples are those of [`simulate`](crate::simulate()) bit by bit, the error estimates to rounding.
///
/// ```
/// use std::ops::ControlFlow;
/// use iwan_core::{FourParameter, Pulse, progress::UNWATCHED};
/// use iwan_sim::{JointLaw, Mode, Settings, simulate, stream};
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let modes = [Mode::new("bending 1", 124.0, Some(JointLaw::FourParameter(joint)))];
/// let blow = Pulse::Haversine { amplitude: 1000.0, duration: 1.6e-3 };
/// let (settings, mut last) = (Settings::new(1e-5, 0.5), 0.0);
/// let totals = stream(&modes, &blow, &settings, &mut |stretch| {
///     last = *stretch.modes[0][0].last().unwrap_or(&last);
///     ControlFlow::Continue(())
/// }, UNWATCHED)?;
/// let whole = simulate(&modes[0], &blow, &settings)?;
/// assert_eq!(whole.displacement.last(), Some(&last));
/// assert_eq!((totals[0].energy, totals[0].quality), (whole.energy, whole.quality));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The errors of [`simulate_all`](crate::simulate_all); also [`SimulationError::Parameter`] for methods other than Newmark's, and
/// [`SimulationError::Interrupted`] when `take` returns `Break`.
pub fn stream(
    modes: &[Mode],
    force: &Pulse<'_>,
    settings: &Settings,
    take: &mut dyn FnMut(&Stretch<'_>) -> ControlFlow<()>,
    progress: Progress<'_>,
) -> Result<Vec<Totals>, SimulationError> {
    let force = force.checked()?;
    let samples = settings.samples()?;
    let plans = modes.iter().map(|mode| Plan::new(mode, &force, settings).map_err(|e| in_mode(mode, e)));
    let mut plans = plans.collect::<Result<Vec<_>, _>>()?;
    let begun = plans.iter_mut().map(|plan| {
        let mode = plan.mode;
        Streamed::new(plan, &force).map_err(|e| in_mode(mode, e))
    });
    let mut runs = begun.collect::<Result<Vec<_>, _>>()?;
    let mut physical = vec![0.0; CHUNK + 2];
    let mut first = 0;
    loop {
        let last = (first + CHUNK).min(samples - 1);
        let range = Range { first, last, ends: last == samples - 1 };
        let room = (last + 2 - first).min(samples - first);
        let used = force.sample_from(first, settings.dt, &mut physical[..room]);
        for run in &mut runs {
            run.advance(range, &force, &physical[..used]).map_err(|e| in_mode(run.mode, e))?;
        }
        let modes = runs.iter().map(|run| run.handed(range.count(1))).collect();
        if take(&Stretch { first, modes }).is_break()
            || progress(last as f64 / (samples - 1).max(1) as f64).is_break()
        {
            return Err(SimulationError::Interrupted);
        }
        first = last;
        if range.ends {
            break;
        }
    }
    runs.into_iter().map(|run| Ok(run.totals())).collect()
}

/// The steps from sample `first` to sample `last`. The last sample is also the first of the next range and is counted there.
#[derive(Clone, Copy)]
struct Range {
    first: usize,
    last: usize,
    /// Whether this is the last range.
    ends: bool,
}

impl Range {
    /// Number of steps in this range of a run whose steps are `stride` times as long.
    fn steps(self, stride: usize) -> usize {
        self.last / stride - self.first / stride
    }

    /// Number of samples of such a run that belong to this range.
    fn count(self, stride: usize) -> usize {
        self.steps(stride) + usize::from(self.ends)
    }
}

/// Data of one mode that its runs borrow.
struct Plan<'a> {
    mode: &'a Mode,
    dt: f64,
    samples: usize,
    joint: Representation,
    scheme: Newmark,
    /// The scheme at twice the step, if that step is not too long for the mode.
    coarse: Option<Newmark>,
    /// 2^order - 1, with the order of the scheme.
    divisor: f64,
    rooms: [Room; 4],
    quality: bool,
}

impl<'a> Plan<'a> {
    fn new(mode: &'a Mode, force: &Pulse<'_>, settings: &Settings) -> Result<Self, SimulationError> {
        let Method::Newmark { beta, gamma, prewarp, joint } = settings.method else {
            let what = "responses are handed out as they come by Newmark's method only: choose newmark, or leave the stream";
            return Err(Error::Unsupported { what }.into());
        };
        check_scales(mode, force, settings)?;
        check_method(mode, settings.method)?;
        let (dt, samples, oscillator) = (settings.dt, settings.samples()?, mode.oscillator()?);
        let scheme_at = schemes(oscillator.omega0(), beta, gamma, prewarp);
        let cycles = mode.frequency * dt * samples as f64;
        let room = || Room { reversals: reversals(cycles, MOST), ..Room::default() };
        let coarse = settings.quality && samples.div_ceil(2) >= FEWEST;
        Ok(Self {
            mode,
            dt,
            samples,
            joint,
            scheme: scheme_at(dt)?,
            coarse: if coarse { scheme_at(2.0 * dt).ok() } else { None },
            divisor: if gamma == 0.5 { 3.0 } else { 1.0 },
            rooms: [room(), room(), room(), room()],
            quality: settings.quality,
        })
    }
}

/// One run, with its samples of the latest stretch.
struct Buffered<'a> {
    stepped: Box<dyn Stepped + 'a>,
    response: Response,
    /// Ratio of the run's step to that of the response: 1 or 2.
    stride: usize,
    peak: f64,
}

impl<'a> Buffered<'a> {
    fn new(
        task: Task<'a>,
        scheme: &Newmark,
        joint: Representation,
        room: &'a mut Room,
        stride: usize,
    ) -> Result<Self, SimulationError> {
        let stepped = stepped::begin(task, scheme, joint, room)?;
        let response = Response::zeros(task.dt, CHUNK / stride + 1);
        Ok(Self { stepped, response, stride, peak: 0.0 })
    }

    /// Advances the run over the steps of `range`.
    fn advance(&mut self, range: Range, force: &[f64]) -> Result<(), Error> {
        let mut samples = self.response.samples();
        self.stepped.advance(force, &mut samples.between(0, range.steps(self.stride)))?;
        let displacement = &self.response.displacement[..range.count(self.stride)];
        self.peak = displacement.iter().fold(self.peak, |most, q| most.max(q.abs()));
        Ok(())
    }

    /// The energy balance of the latest steps.
    fn balance(&mut self, range: Range, force: &[f64]) -> EnergyBalance {
        let mut samples = self.response.samples();
        self.stepped.balance(force, &samples.between(0, range.steps(self.stride)))
    }

    fn displacement(&self, count: usize) -> &[f64] {
        &self.response.displacement[..count]
    }

    fn is_finite(&self, count: usize) -> bool {
        let Response { displacement, velocity, acceleration, .. } = &self.response;
        first_not_finite([displacement, velocity, acceleration].map(|x| &x[..count])).is_none()
    }
}

/// A companion run: computed beside the response to estimate its errors.
struct Companion<'a> {
    run: Buffered<'a>,
    /// Largest difference so far between this run and the one that it is compared with.
    difference: f64,
}

impl<'a> Companion<'a> {
    fn new(run: Result<Buffered<'a>, SimulationError>) -> Option<Self> {
        // A companion that cannot be set up only removes its own estimate.
        run.ok().map(|run| Self { run, difference: 0.0 })
    }

    /// Advances over the steps of `range`, with the modal force at this run's own steps; returns false if the run has failed.
    fn advance(&mut self, range: Range, force: &[f64]) -> bool {
        self.run.advance(range, force).is_ok() && self.run.is_finite(range.count(self.run.stride))
    }
}

/// A mode whose response is streamed, with its companion runs.
struct Streamed<'a> {
    mode: &'a Mode,
    run: Buffered<'a>,
    force: Vec<f64>,
    /// Companion with steps twice as long.
    coarse: Option<Companion<'a>>,
    /// Companion for a force from a file: the same steps, under samples that act as the file's force does between the steps.
    whole: Option<Companion<'a>>,
    /// Companion without sliders (continuum), for the discretisation error.
    continuum: Option<Companion<'a>>,
    /// Whether no joint is cut into sliders and estimates are requested: the discretisation error is then 0.
    exact: bool,
    /// Whether the force comes from a file.
    unsmooth: bool,
    divisor: f64,
    follower: Option<Follower<'a>>,
    totals: Totals,
    energy: Option<EnergyBalance>,
}

impl<'a> Streamed<'a> {
    fn new(plan: &'a mut Plan<'_>, force: &Pulse<'_>) -> Result<Self, SimulationError> {
        let Plan { mode, dt, samples, joint, scheme, coarse, divisor, rooms, quality } = plan;
        let (mode, dt, samples) = (*mode, *dt, *samples);
        let task = Task { mode, force: &[], dt, samples };
        let twice = Task { dt: 2.0 * dt, samples: samples.div_ceil(2), ..task };
        let cut = mode.joint.is_some() && matches!(joint, Representation::Sliders { .. });
        let unsmooth = matches!(force, Pulse::Sampled { .. });
        let [own, longer, continuum, whole] = rooms;
        let run = Buffered::new(task, scheme, *joint, own, 1)?;
        let (mut second, mut third, mut fourth) = (None, None, None);
        if let Some(coarse) = coarse {
            second = Companion::new(Buffered::new(twice, coarse, *joint, longer, 2));
            let finest = reference(mode, *joint);
            if cut && second.is_some() {
                let (task, scheme, stride) =
                    if unsmooth { (task, &*scheme, 1) } else { (twice, &*coarse, 2) };
                third = Companion::new(Buffered::new(task, scheme, finest, continuum, stride));
            }
            if unsmooth && second.is_some() {
                fourth = Companion::new(Buffered::new(task, scheme, *joint, whole, 1));
            }
        }
        Ok(Self {
            mode,
            run,
            force: vec![],
            coarse: second,
            whole: fourth,
            continuum: third,
            exact: *quality && !cut,
            unsmooth,
            divisor: *divisor,
            follower: mode.curves.as_ref().map(|curves| Follower::new(curves, dt)),
            totals: Totals { dt, strongest: strongest(mode), ..Totals::default() },
            energy: None,
        })
    }

    /// Advances the mode and its companions over the steps of `range`; `samples` are those of the physical force from the first step on.
    fn advance(&mut self, range: Range, force: &Pulse<'_>, samples: &[f64]) -> Result<(), SimulationError> {
        let shape = self.mode.shape_at_force;
        self.force.clear();
        self.force.extend(samples.iter().map(|p| p * shape));
        let clock = std::time::Instant::now();
        self.run.advance(range, &self.force)?;
        self.totals.seconds += clock.elapsed().as_secs_f64();
        let energy = self.run.balance(range, &self.force);
        self.energy = Some(self.energy.map_or(energy, |before| before.then(&energy)));
        let Response { displacement, velocity, acceleration, .. } = &self.run.response;
        let motion = [displacement, velocity, acceleration].map(|x| &x[..range.count(1)]);
        if let Some(n) = first_not_finite(motion) {
            let time = (range.first + n) as f64 * self.totals.dt;
            return Err(told(self.mode, SimulationError::NotFinite { time }));
        }
        if let Some(follower) = &mut self.follower {
            follower.follow(motion[0], motion[1]);
            self.totals.quality.outside_curves = follower.found()?;
        }
        self.totals.peak_acceleration =
            motion[2].iter().fold(self.totals.peak_acceleration, |most, a| most.max(a.abs()));
        self.totals.steps = range.last;
        self.totals.final_displacement = motion[0].last().copied().unwrap_or(0.0);
        let (dt, samples) = (self.totals.dt, range.steps(1) + 2);
        let double = for_companions(force, (2.0 * dt, shape), range.first / 2, samples.div_ceil(2));
        let whole = if self.whole.is_some() {
            for_companions(force, (dt, shape), range.first, samples)
        } else {
            vec![]
        };
        self.compare(range, [&double, &whole]);
        Ok(())
    }

    /// Advances the companions and compares them. `double` is the force for steps twice as long, `whole` the force for the companion that
    /// acts as the file does.
    fn compare(&mut self, range: Range, [double, whole]: [&[f64]; 2]) {
        let fine = &self.run.response.displacement;
        let companions = [&mut self.coarse, &mut self.continuum, &mut self.whole];
        let beside = if self.unsmooth { &self.force } else { double };
        for (companion, force) in companions.into_iter().zip([double, beside, whole]) {
            if companion.as_mut().is_some_and(|c| !c.advance(range, force)) {
                *companion = None;
            }
        }
        if let (Some(continuum), Some(coarse)) = (&mut self.continuum, &self.coarse) {
            let stride = continuum.run.stride;
            let against = if stride == 1 { fine } else { &coarse.run.response.displacement };
            let pairs = against.iter().zip(continuum.run.displacement(range.count(stride)));
            continuum.difference = pairs.fold(continuum.difference, |most, (a, b)| most.max((a - b).abs()));
        }
        if let Some(coarse) = &mut self.coarse {
            let (double, divisor) = (coarse.run.displacement(range.count(2)), self.divisor);
            // Without a force from a file the response itself takes the place of `whole`.
            let whole = self.whole.as_ref().map_or(fine, |whole| &whole.run.response.displacement);
            let most = between::error(fine, whole, double, divisor);
            coarse.difference = coarse.difference.max(most);
        }
    }

    /// The first `count` samples of the latest stretch.
    fn handed(&self, count: usize) -> [&[f64]; 4] {
        let Response { displacement, velocity, acceleration, joint_force, .. } = &self.run.response;
        [displacement, velocity, acceleration, joint_force].map(|x| &x[..count])
    }

    fn totals(self) -> Totals {
        let mut totals = self.totals;
        let (peak, quality) = (self.run.peak, &mut totals.quality);
        quality.forgotten_force = self.run.stepped.forgotten();
        quality.discretisation_error = self.exact.then_some(0.0);
        if let Some(continuum) = &self.continuum {
            quality.discretisation_error = Some(relative(continuum.difference, continuum.run.peak));
        }
        if let Some(coarse) = &self.coarse {
            let told = !self.unsmooth || self.whole.is_some();
            quality.time_step_error = told.then(|| relative(coarse.difference, peak));
        }
        Totals { peak_displacement: peak, energy: self.energy.unwrap_or_default(), ..totals }
    }
}
