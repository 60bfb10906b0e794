//! The exact solution of a slider population, from event to event.
//!
//! Between two events (a slider breaks loose, the motion turns round, the force changes its formula) the mode
//! is linear, and its Taylor series in time converges everywhere: a few terms over a fraction of a period are
//! exact to rounding, resonance, critical damping and negative stiffness included. Events are roots
//! of that polynomial. Slow beside the time steppers, and the reference for their order.

use super::energy::{EnergyBalance, JointEnergy, Works};
use super::motion::Motion;
use super::oscillator::Oscillator;
use super::pulse::{Pulse, Stretch};
use super::response::Samples;
use crate::error::{Error, check};
use crate::memory::{Hysteresis, Run, Runs, Segment, Sliders};
use crate::quadrature::Rule;

/// Terms of the series. With [`ANGLE`] the first one left out is 0.5^18/18! = 6e-22 of the motion; fifteen would
/// leave 0.5^15/15! = 2e-17.
const TERMS: usize = 18;
/// Largest angle per series, rad of the fastest of ω0, the force and √|K_∞|. Within half a radian the velocity has
/// one extremum at the most, on which the search for turning points relies; a smaller angle costs time and changes
/// rounding only (a test).
const ANGLE: f64 = 0.5;
/// For the works of damper and force over one series: exact up to degree 15, beyond which the product of two series
/// over half a radian is below rounding.
const RULE: Rule<8> = Rule::gauss_legendre();
/// Most rounds in the search for a root, which halve its bracket where Newton's method would leave it. Up to 62
/// were seen, for roots next to zero; 80 halvings leave less than the rounding of any time.
const MOST_ROUNDS: u32 = 80;
/// Share of the output interval within which two times are one: a change of the force's formula so close ahead has
/// already happened. Rounding leaves some 1e-16 of the time; a step between two such times would be of no length.
const SAME_TIME: f64 = 1e-12;

/// Event-driven integration of a mode with a population of sliders.
///
/// ```
/// use iwan_core::{EventDriven, Oscillator, Pulse, ResidualStiffness, Run, Samples, Slider, Sliders};
/// // One Jenkins element of strength 0.5 that a mode released at speed 1 never reaches: a sine.
/// let mut table = [Slider::default(); 2];
/// let sliders = Sliders::from_elements(&[0.5], &[3.0], &mut table)?;
/// let mode = Oscillator::new(1.0, 0.0, 3.0, ResidualStiffness::Positive)?;
/// let (mut q, mut v, mut a, mut f) = ([0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]);
/// let mut out = Samples { displacement: &mut q, velocity: &mut v, acceleration: &mut a, joint_force: &mut f };
/// let mut state = sliders.virgin([Run::default(); 1])?;
/// let balance = EventDriven::new(&mode, sliders, Pulse::None, 1.0)?.integrate(&mut state, 1.0, 0.25, &mut out)?;
/// assert!((q[1] - 1.0 / mode.omega0()).abs() < 1e-15);
/// assert!(balance.error() < 1e-14);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct EventDriven<'a> {
    oscillator: Oscillator,
    sliders: Sliders<'a>,
    force: Pulse<'a>,
    force_scale: f64,
    angle: f64,
}

/// A Taylor polynomial in time.
#[derive(Clone, Copy)]
struct Series([f64; TERMS]);

impl Series {
    fn at(&self, t: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * t + c)
    }

    fn derivative(&self) -> Self {
        let mut slope = [0.0; TERMS];
        for (n, c) in self.0.iter().enumerate().skip(1) {
            slope[n - 1] = n as f64 * c;
        }
        Self(slope)
    }

    /// The root of `self - level` in [0, h], where the ends have opposite signs (or the first is zero).
    fn root(&self, level: f64, h: f64) -> f64 {
        let slope = self.derivative();
        let (mut low, mut high, mut t) = (0.0, h, h);
        let end = self.at(h) - level;
        for _ in 0..MOST_ROUNDS {
            let value = self.at(t) - level;
            if value * end > 0.0 {
                high = t;
            } else {
                low = t;
            }
            let newton = t - value / slope.at(t);
            let next = if newton > low && newton < high { newton } else { 0.5 * (low + high) };
            if libm::fabs(next - t) <= f64::EPSILON * h {
                return next;
            }
            t = next;
        }
        t
    }
}

/// How a stretch of linear motion ends.
enum Event {
    /// The time is over.
    Time,
    /// The motion turns round.
    Turn,
    /// A slider breaks loose.
    Break,
}

/// When and how a stretch of linear motion ends.
struct Ending {
    /// Time from its start.
    after: f64,
    event: Event,
}

/// The motion at one instant, and the works so far.
struct Course {
    q: f64,
    v: f64,
    works: Works,
}

impl Course {
    fn motion(&self) -> Motion {
        Motion { displacement: self.q, velocity: self.v }
    }
}

impl<'a> EventDriven<'a> {
    /// A mode with `sliders` under `force_scale` · `force`.
    ///
    /// # Errors
    /// As [`Pulse::checked`]; [`Error::OutOfRange`] when `force_scale` is not finite.
    pub fn new(
        oscillator: &Oscillator,
        sliders: Sliders<'a>,
        force: Pulse<'a>,
        force_scale: f64,
    ) -> Result<Self, Error> {
        check("force_scale", force_scale, true, "must be a finite number")?;
        Ok(Self { oscillator: *oscillator, sliders, force: force.checked()?, force_scale, angle: ANGLE })
    }

    /// The same with another angle (rad at small amplitude, 0 < angle <= 0.5) per series: the results must
    /// agree to rounding.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn with_angle(self, angle: f64) -> Result<Self, Error> {
        check("angle", angle, angle > 0.0 && angle <= ANGLE, "must satisfy 0 < angle <= 0.5")?;
        Ok(Self { angle, ..self })
    }

    /// Integrates from the joint's `state` and `velocity`, with output every `dt`.
    ///
    /// # Errors
    /// [`Error::Length`] when the buffers disagree, [`Error::OutOfRange`] for the time step.
    pub fn integrate<S: AsRef<[Run]> + AsMut<[Run]>>(
        &self,
        state: &mut Runs<S>,
        velocity: f64,
        dt: f64,
        out: &mut Samples<'_>,
    ) -> Result<EnergyBalance, Error> {
        check("time step", dt, dt > 0.0, "must be a finite number of seconds > 0")?;
        let samples = out.checked_len()?;
        let stored = self.sliders.stored_energy(state);
        let mut course = Course { q: state.displacement(), v: velocity, works: Works::default() };
        let start = course.motion();
        for n in 0..samples {
            if n > 0 {
                self.advance(state, &mut course, (n - 1) as f64 * dt, dt);
            }
            let t = n as f64 * dt;
            let joint = self.sliders.joint_force(state);
            let force = self.force_scale * self.force.at(t);
            let a = force - self.oscillator.viscous() * course.v - self.oscillator.k_inf() * course.q - joint;
            out.set(n, [course.q, course.v, a, joint]);
        }
        let stored = JointEnergy { start: stored, end: self.sliders.stored_energy(state) };
        Ok(EnergyBalance::close(&self.oscillator, [start, course.motion()], stored, course.works))
    }

    /// From the time `t` to `t + dt`.
    fn advance<S: AsRef<[Run]> + AsMut<[Run]>>(
        &self,
        state: &mut Runs<S>,
        course: &mut Course,
        t: f64,
        dt: f64,
    ) {
        let mut elapsed = 0.0;
        while elapsed < dt {
            let now = t + elapsed;
            let mut stretch = self.force.stretch(now);
            // A change of formula closer than rounding has already happened.
            if stretch.until - now <= SAME_TIME * dt {
                stretch = self.force.stretch(stretch.until);
            }
            let stiffest = libm::sqrt(libm::fabs(self.oscillator.k_inf()));
            let fastest = self.oscillator.omega0().max(libm::fabs(stretch.omega)).max(stiffest);
            let mut h = (dt - elapsed).min(self.angle / fastest);
            h = h.min(stretch.until - now);
            let last = h >= dt - elapsed;
            let passed = self.piece(state, course, &stretch, h);
            elapsed = if last && passed >= h { dt } else { elapsed + passed };
        }
    }

    /// Linear motion over at most `h`; returns the time passed.
    fn piece<S: AsRef<[Run]> + AsMut<[Run]>>(
        &self,
        state: &mut Runs<S>,
        course: &mut Course,
        stretch: &Stretch,
        h: f64,
    ) -> f64 {
        let table = self.sliders.table();
        let segment = state.segment(table);
        let series = self.series(course, &segment, stretch);
        let heading = heading(&series);
        if heading * state.direction() < 0.0 {
            state.reverse(table);
            return 0.0;
        }
        if heading == 0.0 {
            return h;
        }
        let Ending { after: passed, event } = first_event(&series, &segment, heading, h);
        let velocity = series.derivative();
        let q = match event {
            Event::Break => segment.anchor + heading * segment.reach,
            Event::Time | Event::Turn => series.at(passed),
        };
        let v = if matches!(event, Event::Turn) { 0.0 } else { velocity.at(passed) };
        let power = |t: f64| self.force_scale * stretch.at(t) * velocity.at(t);
        course.works.force += RULE.integrate(0.0, passed, power);
        course.works.damper +=
            self.oscillator.viscous() * RULE.integrate(0.0, passed, |t| velocity.at(t) * velocity.at(t));
        let mean = 0.5 * ((q - segment.anchor) + (course.q - segment.anchor));
        course.works.joint += (segment.base + segment.stiffness * mean) * (q - course.q);
        (course.q, course.v) = (q, v);
        state.rest_at(q);
        if matches!(event, Event::Break) {
            state.break_loose(table);
        }
        passed
    }

    /// Taylor series of the displacement: (n+1)(n+2) c_{n+2} = p_n - c (n+1) c_{n+1} - (K_∞ + K) c_n.
    fn series(&self, course: &Course, segment: &Segment, stretch: &Stretch) -> Series {
        let (k, c) = (self.oscillator.k_inf(), self.oscillator.viscous());
        let slope = k + segment.stiffness;
        let held = k * course.q + segment.base + segment.stiffness * (course.q - segment.anchor);
        let force = stretch.series(self.force_scale);
        let mut q = [0.0; TERMS];
        (q[0], q[1]) = (course.q, course.v);
        for n in 0..TERMS - 2 {
            let order = n as f64 + 1.0;
            let restoring = if n == 0 { held } else { slope * q[n] };
            q[n + 2] = (force[n] - c * order * q[n + 1] - restoring) / (order * (order + 1.0));
        }
        Series(q)
    }
}

/// Sign of the motion's next change: of the first derivative that does not vanish.
fn heading(series: &Series) -> f64 {
    series.0.iter().skip(1).find(|c| **c != 0.0).map_or(0.0, |c| 1.0_f64.copysign(*c))
}

/// When and how the motion in direction `heading` ends within `h`.
fn first_event(series: &Series, segment: &Segment, heading: f64, h: f64) -> Ending {
    let velocity = series.derivative();
    let turn = turning_time(&velocity, heading, h);
    let monotone = turn.unwrap_or(h);
    let level = segment.anchor + heading * segment.reach;
    if heading * (series.at(monotone) - level) > 0.0 {
        return Ending { after: series.root(level, monotone), event: Event::Break };
    }
    let event = if turn.is_some() { Event::Turn } else { Event::Time };
    Ending { after: monotone, event }
}

/// First time in (0, h] at which the velocity has changed sign, if it does. Over the short span of a series the
/// velocity has at most one extremum, where it may dip through zero and come back.
fn turning_time(velocity: &Series, heading: f64, h: f64) -> Option<f64> {
    if heading * velocity.at(h) < 0.0 {
        // At rest at the start, the root at zero is not meant.
        return Some(departed(velocity, h));
    }
    let acceleration = velocity.derivative();
    let dips = heading * acceleration.0[0] < 0.0 && heading * acceleration.at(h) > 0.0;
    let lowest = if dips { acceleration.root(0.0, h) } else { return None };
    (heading * velocity.at(lowest) < 0.0).then(|| departed(velocity, lowest))
}

/// Root of the velocity in (0, h], with the root at 0 of a motion that starts at rest divided out.
fn departed(velocity: &Series, h: f64) -> f64 {
    if velocity.0[0] != 0.0 {
        return velocity.root(0.0, h);
    }
    let mut reduced = [0.0; TERMS];
    reduced[..TERMS - 1].copy_from_slice(&velocity.0[1..]);
    Series(reduced).root(0.0, h)
}

impl Stretch {
    /// Force at `t` from the start of the stretch.
    fn at(&self, t: f64) -> f64 {
        let wave =
            if self.amplitude == 0.0 { 0.0 } else { self.amplitude * libm::cos(self.omega * t + self.phase) };
        self.offset + self.slope * t + wave
    }

    /// Taylor coefficients of `scale` · f.
    fn series(&self, scale: f64) -> [f64; TERMS] {
        let mut terms = [0.0; TERMS];
        if self.amplitude != 0.0 {
            // Derivatives of the cosine: cos, -sin, -cos, sin.
            let (s, c) = (libm::sin(self.phase), libm::cos(self.phase));
            let mut factor = scale * self.amplitude;
            for (n, term) in terms.iter_mut().enumerate() {
                *term = factor * [c, -s, -c, s][n % 4];
                factor *= self.omega / (n as f64 + 1.0);
            }
        }
        terms[0] += scale * self.offset;
        terms[1] += scale * self.slope;
        terms
    }
}
