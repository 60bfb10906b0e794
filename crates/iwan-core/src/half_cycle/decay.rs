//! Free decay by half cycles, from any state, with output at uniform times.

use super::dormand_prince::Moment;
use super::map::{HalfCycle, HalfCycleTables, Map};
use super::phase::PhaseClock;
use crate::error::Error;
use crate::law::Backbone;
use crate::memory::{Branch, Continuum, Hysteresis, Reversal, Reversals};
use crate::step::{EnergyBalance, JointEnergy, Motion, Oscillator, Samples, Works};

/// Free decay of a mode under a constant force: the half-cycle energy map.
///
/// The map is exact except for the quadrature over the phase (12 nodes a half cycle). Where the motion starts between turning points, and
/// in half cycles that close older loops, an adaptive Runge-Kutta method integrates up to the next reversal.
///
/// ```
/// use iwan_core::{Backbone, Decay, FourParameter, Motion, Oscillator, ResidualStiffness, Reversal};
/// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
/// let mode = Oscillator::new(124.0, 0.0, joint.k_t(), ResidualStiffness::Positive)?;
/// let start = 0.1 * joint.phi_max();
/// let mut decay = Decay::new(&mode, &joint, 0.0, Motion::held_at(start), [Reversal::default(); 64])?;
/// let first = decay.next().unwrap();
/// // What friction took from the first half cycle is half a closed loop of the mean amplitude, nearly.
/// let lost = 0.5 * mode.k_inf() * (start.powi(2) - first.displacement.powi(2))
///     + joint.energy(start) - joint.energy(first.displacement);
/// let mean = 0.5 * (start - first.displacement);
/// assert!((lost / (0.5 * joint.dissipation(mean)) - 1.0).abs() < 0.01);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Decay<'a, B, S> {
    pub(super) map: Map<'a, B>,
    oscillator: Oscillator,
    pub(super) joint: Continuum<&'a B>,
    pub(super) memory: Reversals<S>,
    /// Time, displacement and velocity that correspond to `memory`.
    pub(super) now: Moment,
    /// The latest half cycle of the map, and whether it starts at `now` and is not finished.
    half: HalfCycle,
    under_way: bool,
    /// The clock of the unfinished half cycle, made when a time within it is asked for.
    clock: Option<PhaseClock>,
    /// The motion at the start, and the energy stored in the joint's springs at the start.
    start: Motion,
    stored: f64,
    /// Works since the start: of the constant force, on the damper and on the joint.
    pub(super) works: Works,
}

/// A reversal of a free decay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningPoint {
    /// Time since the start, s.
    pub time: f64,
    /// Displacement at the reversal.
    pub displacement: f64,
    /// Joint force at the reversal.
    pub joint_force: f64,
}

/// A quadrature node of a half cycle with its weight in time: Σ `weight` f is ∫ f dt over the half cycle, for smooth f as exact as the map
/// itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathNode {
    /// Time since the start, s.
    pub time: f64,
    /// Displacement.
    pub displacement: f64,
    /// Velocity.
    pub velocity: f64,
    /// Quadrature weight of the node, s.
    pub weight: f64,
}

impl<'a, B: Backbone, S: AsRef<[Reversal]> + AsMut<[Reversal]>> Decay<'a, B, S> {
    /// A decay that starts from a virgin joint, loaded along its virgin curve up to the displacement of `start` and released with the
    /// velocity of `start`; `load` is a constant force. `stack` provides room for reversals, one per half cycle and at least three.
    ///
    /// # Errors
    /// [`Error::Length`]; [`Error::OutOfRange`] when K_∞ <= 0, a value is not finite or the start lies beyond 1e12 times the displacement of macro-slip.
    pub fn new(
        oscillator: &Oscillator,
        law: &'a B,
        load: f64,
        start: Motion,
        stack: S,
    ) -> Result<Self, Error> {
        let memory = pulled(law, Continuum::new(law).virgin(stack)?, start.displacement)?;
        Self::from_memory(oscillator, law, load, memory, start.velocity)
    }

    /// Does what [`new`](Self::new) does without a load, with tables of the mode that several decays share. Tables of another mode are
    /// ignored.
    ///
    /// ```
    /// use iwan_core::{
    ///     Backbone, Decay, FourParameter, HalfCycleTables, Motion, Oscillator, ResidualStiffness, Reversal,
    /// };
    /// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
    /// let mode = Oscillator::new(124.0, 1e-3, joint.k_t(), ResidualStiffness::Positive)?;
    /// let (stack, start) = ([Reversal::default(); 64], Motion::held_at(0.002));
    /// let own = Decay::new(&mode, &joint, 0.0, start, stack)?.next();
    /// let tables = HalfCycleTables::new(&mode, &joint);
    /// assert_eq!(Decay::with_tables(&mode, &joint, &tables, start, stack)?.next(), own);
    /// // Those of another mode change nothing.
    /// let other = Oscillator::new(124.0, 2e-3, joint.k_t(), ResidualStiffness::Positive)?;
    /// let tables = HalfCycleTables::new(&other, &joint);
    /// assert_eq!(Decay::with_tables(&mode, &joint, &tables, start, stack)?.next(), own);
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// The errors of [`new`](Self::new).
    pub fn with_tables(
        oscillator: &Oscillator,
        law: &'a B,
        tables: &HalfCycleTables,
        start: Motion,
        stack: S,
    ) -> Result<Self, Error> {
        let memory = pulled(law, Continuum::new(law).virgin(stack)?, start.displacement)?;
        Self::with_map(Map::new(oscillator, law, 0.0, Some(tables))?, *oscillator, memory, start.velocity)
    }

    /// A decay that continues from a state reached by time stepping, given by `memory` and `velocity`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when K_∞ <= 0, a value is not finite or the start lies beyond 1e12 times the displacement of macro-slip.
    pub fn from_memory(
        oscillator: &Oscillator,
        law: &'a B,
        load: f64,
        memory: Reversals<S>,
        velocity: f64,
    ) -> Result<Self, Error> {
        crate::error::check("load", load, true, "must be a finite number")?;
        Self::with_map(Map::new(oscillator, law, load, None)?, *oscillator, memory, velocity)
    }

    /// Ends this decay and begins another one of the same mode under the same load, as [`new`](Self::new) does; the tables of the map and
    /// the stack are reused.
    ///
    /// ```
    /// use iwan_core::{Backbone, Decay, FourParameter, Motion, Oscillator, ResidualStiffness, Reversal};
    /// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
    /// let mode = Oscillator::new(124.0, 1e-3, joint.k_t(), ResidualStiffness::Positive)?;
    /// let begun = |at| Decay::new(&mode, &joint, 0.0, Motion::held_at(at), [Reversal::default(); 64]);
    /// let mut decay = begun(0.01)?;
    /// decay.next();
    /// let mut decay = decay.anew(Motion::held_at(0.002))?;
    /// assert_eq!(decay.next(), begun(0.002)?.next());
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::OutOfRange`] when a value is not finite or lies beyond what [`new`](Self::new) allows.
    pub fn anew(self, start: Motion) -> Result<Self, Error> {
        let law = self.map.law;
        let memory = pulled(law, self.memory.into_virgin(law.initial_stiffness()), start.displacement)?;
        Self::with_map(self.map, self.oscillator, memory, start.velocity)
    }

    fn with_map(
        map: Map<'a, B>,
        oscillator: Oscillator,
        memory: Reversals<S>,
        velocity: f64,
    ) -> Result<Self, Error> {
        let law = map.law;
        let joint = Continuum::new(law);
        let q = joint.displacement(&memory);
        let farthest = FARTHEST * law.strengths().1;
        let fastest = farthest * libm::sqrt(map.k_inf);
        let ranges = [
            (
                "displacement",
                q,
                farthest,
                "a finite number, at most 1e12 times the displacement of macro-slip: lower the force or check the joint",
            ),
            (
                "velocity",
                velocity,
                fastest,
                "a finite number, at most that of a swing of 1e12 times the displacement of macro-slip: lower the force or check the joint",
            ),
        ];
        for (name, value, limit, allowed) in ranges {
            crate::error::check(name, value, libm::fabs(value) <= limit, allowed)?;
        }
        let stored = joint.stored_energy(&memory);
        let now = Moment { time: 0.0, q, v: velocity };
        let start = Motion { displacement: q, velocity };
        let (half, under_way, clock, works) = (HalfCycle::NONE, false, None, Works::default());
        let mut decay =
            Self { map, oscillator, joint, memory, now, half, under_way, clock, start, stored, works };
        if velocity == 0.0 {
            decay.turn_towards_equilibrium();
        } else if velocity * decay.memory.direction() < 0.0 {
            decay.memory.reverse(law);
        }
        Ok(decay)
    }

    /// The joint's memory at the last turning point.
    pub fn memory(&self) -> &Reversals<S> {
        &self.memory
    }

    /// For a start at rest: turns the memory towards the direction in which the mass will move.
    fn turn_towards_equilibrium(&mut self) {
        let pull = self.acceleration(&self.memory.branch(), self.now.q, 0.0);
        if pull * self.memory.direction() < 0.0 {
            self.memory.reverse(self.map.law);
        }
        self.set_out();
    }

    /// Begins the half cycle that starts at a reversal, if the map covers it.
    #[inline]
    pub(super) fn set_out(&mut self) {
        let branch = self.memory.branch_ref();
        self.under_way =
            branch.scale == 2.0 && branch.start_is(self.now.q) && self.map.half_cycle(branch, &mut self.half);
    }

    pub(super) fn acceleration(&self, branch: &Branch, q: f64, v: f64) -> f64 {
        let (force, _) = branch.force_and_tangent(self.map.law, q);
        self.map.load - self.map.viscous * v - self.map.k_inf * q - force
    }

    /// Displacement, with its sign, from the last turning point to the next one; none where the map does not cover the half cycle between them (a start between turning
    /// points, or an older loop that closes).
    ///
    /// In micro-slip all that follows from a turning point, but for a constant displacement, follows from this travel alone: Masing's rule gives every half cycle the same branch.
    ///
    /// ```
    /// use iwan_core::{Decay, FourParameter, Motion, Oscillator, ResidualStiffness, Reversal};
    /// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
    /// let mode = Oscillator::new(124.0, 1e-3, joint.k_t(), ResidualStiffness::Positive)?;
    /// let mut decay = Decay::new(&mode, &joint, 0.0, Motion::held_at(0.001), [Reversal::default(); 64])?;
    /// let travel = decay.travel().unwrap();
    /// assert_eq!(0.001 + travel, decay.next().unwrap().displacement);
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    pub fn travel(&self) -> Option<f64> {
        self.under_way.then(|| self.half.travel())
    }

    /// Moves to the next turning point; none if the mass is at rest or creeps towards rest.
    #[expect(
        clippy::should_implement_trait,
        reason = "an iterator would hide that the decay goes on behind it"
    )]
    pub fn next(&mut self) -> Option<TurningPoint> {
        if self.under_way {
            self.finish();
        } else if !self.march(f64::INFINITY) {
            return None;
        }
        let (time, displacement) = (self.now.time, self.now.q);
        Some(TurningPoint { time, displacement, joint_force: self.joint.joint_force(&self.memory) })
    }

    /// Does what [`next`](Self::next) does and passes the nodes of the half cycle to `visit`, in the order of time, for integrals over the
    /// motion that need no uniform samples. Returns none also where the map does not cover the half cycle (a start between turning points,
    /// or an older loop that closes).
    ///
    /// ```
    /// use iwan_core::{Decay, FourParameter, Motion, Oscillator, ResidualStiffness, Reversal};
    /// let joint = FourParameter::new(4.45e4, 239.4, -0.183, 0.3)?;
    /// let mode = Oscillator::new(124.0, 1e-3, joint.k_t(), ResidualStiffness::Positive)?;
    /// let mut decay = Decay::new(&mode, &joint, 0.0, Motion::held_at(0.01), [Reversal::default(); 64])?;
    /// let (mut travel, mut duration) = (0.0, 0.0);
    /// let end = decay.next_with(|node| {
    ///     travel += node.weight * node.velocity;
    ///     duration += node.weight;
    /// });
    /// assert!((0.01 + travel - end.unwrap().displacement).abs() < 1e-12);
    /// assert!((duration - end.unwrap().time).abs() < 1e-15);
    /// # Ok::<(), iwan_core::Error>(())
    /// ```
    pub fn next_with(&mut self, mut visit: impl FnMut(PathNode)) -> Option<TurningPoint> {
        if !self.under_way {
            return None;
        }
        let (half, start) = (&self.half, self.now.time);
        self.map.phase(half).visit(|node| {
            let Motion { displacement, velocity } = half.motion(node.share, node.speed);
            visit(PathNode { time: start + node.time, displacement, velocity, weight: node.weight });
        });
        self.next()
    }

    /// Completes the half cycle of the map and begins the next.
    #[inline]
    fn finish(&mut self) {
        let half = &self.half;
        let (before, end) = (self.now.q, half.end());
        self.works.force += self.map.load * (end - before);
        self.works.damper += half.viscous;
        self.works.joint += half.joint;
        self.now = Moment { time: self.now.time + half.duration, q: end, v: 0.0 };
        self.clock = None;
        if half.is_micro_slip() {
            self.memory.turn_within(end, half.force, self.map.law);
        } else {
            self.joint.advance(&mut self.memory, end);
            self.memory.reverse(self.map.law);
        }
        self.set_out();
    }

    /// The motion at the time `t`; `t` must not be earlier than in the last call.
    fn motion_at(&mut self, t: f64) -> Motion {
        loop {
            if self.under_way {
                let half = &self.half;
                if t - self.now.time <= half.duration {
                    let clock = self.clock.get_or_insert_with(|| self.map.clock(half));
                    return half.at(clock, t - self.now.time);
                }
                self.finish();
            } else if !self.march(t) {
                return Motion { displacement: self.now.q, velocity: self.now.v };
            }
        }
    }

    /// Writes the samples at 0, dt, 2 dt, … from the start. Call it once, on a new decay.
    ///
    /// # Errors
    /// [`Error::Length`], or [`Error::OutOfRange`] when `dt` is not a finite number > 0.
    pub fn sample(&mut self, dt: f64, out: &mut Samples<'_>) -> Result<(), Error> {
        self.sample_from(0.0, dt, out)
    }

    /// Does what [`sample`](Self::sample) does at `first`, `first` + dt, … seconds after the start.
    ///
    /// # Errors
    /// As [`sample`](Self::sample); [`Error::OutOfRange`] when `first` is not a finite number >= 0.
    pub fn sample_from(&mut self, first: f64, dt: f64, out: &mut Samples<'_>) -> Result<(), Error> {
        crate::error::check("time step", dt, dt > 0.0, "must be a finite number of seconds > 0")?;
        crate::error::check("first time", first, first >= 0.0, "must be a finite number of seconds >= 0")?;
        let samples = out.checked_len()?;
        for n in 0..samples {
            let Motion { displacement: q, velocity: v } = self.motion_at(first + n as f64 * dt);
            let branch = self.memory.branch();
            let (force, _) = branch.force_and_tangent(self.map.law, q);
            let a = self.map.load - self.map.viscous * v - self.map.k_inf * q - force;
            out.set(n, [q, v, a, force]);
        }
        Ok(())
    }

    /// Energy balance from the start to the last turning point.
    #[must_use]
    pub fn energy(&self) -> EnergyBalance {
        let stored = JointEnergy { start: self.stored, end: self.joint.stored_energy(&self.memory) };
        let now = Motion { displacement: self.now.q, velocity: self.now.v };
        EnergyBalance::close(&self.oscillator, [self.start, now], stored, self.works)
    }
}

/// The memory of a virgin joint after it was loaded along its virgin curve up to `displacement`, which no comparison would refuse if it were no number.
fn pulled<B: Backbone, S: AsRef<[Reversal]> + AsMut<[Reversal]>>(
    law: &B,
    mut memory: Reversals<S>,
    displacement: f64,
) -> Result<Reversals<S>, Error> {
    crate::error::check("displacement", displacement, true, "must be a finite number")?;
    Continuum::new(law).advance(&mut memory, displacement);
    Ok(memory)
}

/// Largest start of a free decay, as a multiple of the displacement φ_max at which the last slider slips. A half cycle in macro-slip takes
/// 2 F_S/K_∞ off the amplitude (the area of the loop over the stiffness), which is at most 2 K_T/K_∞ φ_max: of 1e12 φ_max that leaves four
/// digits in a double, for K_T of the size of K_∞, and of 1e16 φ_max none, so that the decay would never end. Farther starts are refused.
const FARTHEST: f64 = 1e12;
