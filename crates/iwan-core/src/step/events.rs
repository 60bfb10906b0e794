//! The exact solution of a mode with a slider population, from event to event.
//!
//! Between two events (a slider breaks loose, the motion turns round, the force changes its formula) the mode is linear. Its Taylor series
//! in time converges everywhere: a few terms over a fraction of a period are exact to rounding, even at resonance, critical damping and
//! negative stiffness. Events are roots of that polynomial. The method is slow compared with the time steppers; it is the reference for
//! their order of accuracy.

use super::energy::{EnergyBalance, JointEnergy, Works};
use super::motion::Motion;
use super::oscillator::Oscillator;
use super::pulse::{Pulse, Stretch};
use super::response::Samples;
use crate::error::{Error, check};
use crate::memory::{Hysteresis, Run, Runs, Segment, Sliders};
use crate::quadrature::Rule;

/// Number of terms of the series. With [`ANGLE`] the first term left out is 0.5^18/18! = 6e-22 of the motion; with fifteen terms it would
/// be 0.5^15/15! = 2e-17.
const TERMS: usize = 18;
/// Largest angle per series, rad of the fastest of ω0, the force and √|K_∞|. Within half a radian the velocity has at most one extremum;
/// the search for turning points relies on that. A smaller angle costs time and changes only the rounding (a test shows it).
const ANGLE: f64 = 0.5;
/// Quadrature of the works of damper and force over one series. It is exact up to degree 15; beyond, the product of two series over half a
/// radian is below rounding.
const RULE: Rule<8> = Rule::gauss_legendre();
/// Largest number of rounds in the search for a root; a round halves the bracket where Newton's method would leave it. Up to 62 rounds were
/// seen, for roots next to zero; 80 halvings leave less than the rounding of any time, so the last value is returned.
const MOST_ROUNDS: u32 = 80;
/// Share of the output interval within which two times count as equal: a change of the force's formula that lies closer ahead counts as
/// past. Rounding leaves some 1e-16 of the time, and a step between two such times would have no length.
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

    /// The root of `self - level` in [0, h]. At the two ends the difference must have opposite signs, or be zero at the first.
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

/// The event that ends a piece of linear motion.
enum Event {
    /// The time interval is over.
    Time,
    /// The motion turns round.
    Turn,
    /// A slider breaks loose.
    Break,
}

/// When and by which event a piece of linear motion ends.
struct Ending {
    /// Time since the start of the piece, s.
    after: f64,
    event: Event,
}

/// The motion at one instant, and the works up to then.
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

    /// The same solution with another largest angle per series (rad at small amplitude, 0 < angle <= 0.5). The results must agree to
    /// rounding.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn with_angle(self, angle: f64) -> Result<Self, Error> {
        check("angle", angle, angle > 0.0 && angle <= ANGLE, "must satisfy 0 < angle <= 0.5")?;
        Ok(Self { angle, ..self })
    }

    /// Integrates from the displacement in the joint's `state` and from `velocity`, with one output sample every `dt` (s).
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

    /// Integrates from the time `t` to `t + dt`.
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

    /// Follows one piece of linear motion over at most the time `h`; returns the time passed.
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

    /// Taylor coefficients c_n of the displacement: (n+1)(n+2) c_{n+2} = p_n - c (n+1) c_{n+1} - (K_∞ + K) c_n, with the viscous
    /// coefficient c.
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

/// Direction, ±1, in which the motion goes next: the sign of the first derivative that does not vanish.
fn heading(series: &Series) -> f64 {
    series.0.iter().skip(1).find(|c| **c != 0.0).map_or(0.0, |c| 1.0_f64.copysign(*c))
}

/// Time and kind of the first event within `h` in a motion in direction `heading`.
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

/// First time in (0, h] at which the velocity has changed sign, or none. Over the short span of a series the velocity has at most one
/// extremum, where it may pass through zero and come back.
fn turning_time(velocity: &Series, heading: f64, h: f64) -> Option<f64> {
    if heading * velocity.at(h) < 0.0 {
        // If the motion starts at rest, the root at zero must not be found.
        return Some(departed(velocity, h));
    }
    let acceleration = velocity.derivative();
    let dips = heading * acceleration.0[0] < 0.0 && heading * acceleration.at(h) > 0.0;
    let lowest = if dips { acceleration.root(0.0, h) } else { return None };
    (heading * velocity.at(lowest) < 0.0).then(|| departed(velocity, lowest))
}

/// Root of the velocity in (0, h]. If the motion starts at rest, its root at 0 is divided out first.
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
