//! The half-cycle map: from one turning point to the next, without time steps.
//!
//! Between two reversals the force depends on the displacement alone. At the distance y from the reversal (q_a, F_a), in a motion in
//! direction d, Masing's rule gives F = F_a + 2 d F_virgin(y/2), so the mass has gained the energy
//!
//! P(y) = s y - ½ K_∞ y² - 4 G(y/2),   s = d (f - K_∞ q_a - F_a),
//!
//! with G the work on the virgin curve and f a constant force. The next turning point is the root L of P(L) = W, where W is the work of the
//! viscous damper. With y = ½L (1 - cos θ) the speed is ½L sin θ · Ω(θ), and Ω is a smooth function of the phase θ, close to the circular
//! frequency. The duration ∫dθ/Ω and W = c (L/2)² ∫Ω sin²θ dθ, both from 0 to π, are Gauss-Legendre sums over a few nodes. With viscous
//! damping Ω² itself contains a term in ∫Ω sin², which is found by fixed-point passes; each pass reduces the error by a factor of about
//! ζ_v.

use core::f64::consts::PI;

use super::macro_slip::{MacroSlip, Slip};
use super::micro_slip::{MicroSlip, Travel};
use super::phase::{MOST_PASSES, NODES, Node, PANELS, PASS_TOLERANCE, Phase, PhaseClock, Reading, Share};
use crate::error::Error;
use crate::law::{Backbone, PowerLaw};
use crate::memory::Branch;
use crate::step::{Motion, Oscillator};

/// Tables from which the half cycles of a mode are found. They are made once and can be shared by several decays of the mode
/// ([`Decay::with_tables`](super::Decay::with_tables)).
#[derive(Debug, Clone, Copy)]
pub struct HalfCycleTables {
    of: TablesOf,
    micro: Option<MicroSlip>,
    whole: Option<MacroSlip>,
}

/// All quantities on which the tables depend.
#[derive(Debug, Clone, Copy, PartialEq)]
struct TablesOf {
    k_inf: f64,
    viscous: f64,
    power: Option<PowerLaw>,
    slip_force: f64,
    strongest: f64,
}

impl TablesOf {
    fn new<B: Backbone>(oscillator: &Oscillator, law: &B) -> Self {
        let (k_inf, viscous) = (oscillator.k_inf(), oscillator.viscous());
        let (slip_force, strongest) = (law.slip_force(), law.strengths().1);
        Self { k_inf, viscous, power: law.power_law(), slip_force, strongest }
    }
}

impl HalfCycleTables {
    /// The tables of a mode.
    pub fn new<B: Backbone>(oscillator: &Oscillator, law: &B) -> Self {
        Self::of(TablesOf::new(oscillator, law), law)
    }

    fn of<B: Backbone>(of: TablesOf, law: &B) -> Self {
        let TablesOf { k_inf, viscous, power, .. } = of;
        let micro = power.and_then(|power| MicroSlip::new(k_inf, viscous, &power));
        let whole = power.and_then(|power| MacroSlip::new(k_inf, viscous, law, &power));
        Self { of, micro, whole }
    }
}

/// One half cycle from reversal to reversal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfCycle {
    /// Displacement at the start of the half cycle, and direction of motion ±1.
    start: f64,
    direction: f64,
    /// Travel L.
    length: f64,
    /// Work of the viscous damper.
    pub(crate) viscous: f64,
    /// Work on the joint.
    pub(crate) joint: f64,
    /// Duration, s.
    pub(crate) duration: f64,
    /// Joint force at the end of the half cycle.
    pub(crate) force: f64,
    /// For micro-slip under a power law: the data from which the next half cycle follows.
    micro: Travel,
    /// Ω over the half cycle, unless the half cycle is one of micro-slip under a power law.
    phase: Phase,
}

impl HalfCycle {
    /// Placeholder for the absence of a half cycle.
    pub(crate) const NONE: Self = Self {
        start: 0.0,
        direction: 1.0,
        length: 0.0,
        viscous: 0.0,
        joint: 0.0,
        duration: 0.0,
        force: 0.0,
        micro: Travel::NONE,
        phase: Phase::single([0.0; NODES]),
    };

    /// Displacement at the end of the half cycle.
    #[inline]
    pub(crate) fn end(&self) -> f64 {
        self.start + self.direction * self.length
    }

    /// Displacement over the half cycle, with its sign.
    pub(crate) fn travel(&self) -> f64 {
        self.direction * self.length
    }

    /// Whether the half cycle stayed in micro-slip under a power law.
    #[inline]
    pub(crate) fn is_micro_slip(&self) -> bool {
        self.micro.is_some()
    }

    /// The motion at the time `t` after the start of the half cycle; `clock` must belong to this half cycle.
    pub(crate) fn at(&self, clock: &PhaseClock, t: f64) -> Motion {
        let Reading { value: theta, omega } = clock.at(t);
        let (s, c) = libm::sincos(0.5 * theta);
        self.motion(s * s, s * c * omega)
    }

    /// The motion at the point given by the share y/L of the travel and by the speed over the travel y'/L.
    pub(crate) fn motion(&self, share: f64, speed: f64) -> Motion {
        let travel = self.direction * self.length;
        Motion { displacement: self.start + travel * share, velocity: travel * speed }
    }
}

/// A half cycle as one of the solvers finds it.
struct Found {
    length: f64,
    /// Work of the damper over the square of the travel, W/L².
    damping: f64,
    /// Joint force at the end of the half cycle.
    force: f64,
    phase: Phase,
}

/// Ω over a half cycle of given travel, and ∫Ω sin²θ dθ.
struct Settled {
    phase: Phase,
    work: f64,
}

/// Works over a half cycle.
struct HalfCycleWorks {
    viscous: f64,
    joint: f64,
}

/// The map of one mode under a constant force.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Map<'a, B> {
    pub(crate) law: &'a B,
    pub(crate) k_inf: f64,
    pub(crate) viscous: f64,
    pub(crate) load: f64,
    micro: Option<MicroSlip>,
    whole: Option<MacroSlip>,
}

impl<'a, B: Backbone> Map<'a, B> {
    /// The map of a mode. `known` tables are used if they belong to this mode; otherwise tables are made.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless K_∞ > 0: with K_∞ <= 0 the mass may never turn round.
    pub(crate) fn new(
        oscillator: &Oscillator,
        law: &'a B,
        load: f64,
        known: Option<&HalfCycleTables>,
    ) -> Result<Self, Error> {
        let k_inf = oscillator.k_inf();
        crate::error::check(
            "k_inf",
            k_inf,
            k_inf > 0.0,
            "the half-cycle map needs K_inf = omega0^2 - k_t > 0",
        )?;
        let of = TablesOf::new(oscillator, law);
        let known = known.filter(|known| known.of == of).copied();
        let HalfCycleTables { micro, whole, .. } = known.unwrap_or_else(|| HalfCycleTables::of(of, law));
        Ok(Self { law, k_inf, viscous: of.viscous, load, micro, whole })
    }

    /// Replaces `half`, the half cycle before, by the one that begins at the start of `branch`. Returns false if the mass rests in
    /// equilibrium or the half cycle would close the loop around it; the caller then integrates in steps.
    ///
    /// `half` is changed in place because a copy would have to wait until the last writes have reached memory.
    #[inline]
    pub(crate) fn half_cycle(&self, branch: &Branch, half: &mut HalfCycle) -> bool {
        let pull = branch.direction * (self.load - self.k_inf * branch.start.u - branch.start.force);
        if pull.is_nan() || pull <= 0.0 {
            return false;
        }
        if !(self.micro_slip(branch, pull, half)
            || self.macro_slip(branch, pull, half)
            || self.any_slip(branch, pull, half))
        {
            return false;
        }
        (half.start, half.direction) = (branch.start.u, branch.direction);
        // A loop may close in macro-slip, where the force is F_S on both branches. The margin is the rounding of the distance, which far
        // beyond φ_max is a difference of much larger displacements.
        let reaches = || {
            let rounding = 4.0 * f64::EPSILON * (libm::fabs(branch.start.u) + libm::fabs(branch.end));
            branch.virgin_distance(branch.end) + rounding >= self.law.strengths().1
        };
        !branch.passed_by(half.end()) || reaches()
    }

    #[inline]
    fn micro_slip(&self, branch: &Branch, pull: f64, half: &mut HalfCycle) -> bool {
        let Some(micro) = &self.micro else { return false };
        if !micro.travel(pull, &mut half.micro) {
            return false;
        }
        let travel = &half.micro;
        (half.length, half.duration) = (travel.length, travel.duration());
        half.force = branch.start.force + branch.direction * micro.force(travel);
        let works = self.works(branch, pull, travel.length, travel.damping());
        (half.viscous, half.joint) = (works.viscous, works.joint);
        true
    }

    /// Works of the damper and on the joint. The work on the joint follows from P(L) = W, the pull and the residual spring.
    #[inline]
    fn works(&self, branch: &Branch, pull: f64, length: f64, damping: f64) -> HalfCycleWorks {
        let viscous = damping * length * length;
        let held = branch.direction * branch.start.force + pull - 0.5 * self.k_inf * length;
        HalfCycleWorks { viscous, joint: held * length - viscous }
    }

    /// A half cycle under a power law that ends in macro-slip.
    #[cold]
    fn macro_slip(&self, branch: &Branch, pull: f64, half: &mut HalfCycle) -> bool {
        let Some(whole) = &self.whole else { return false };
        // The half cycle before gives a good guess of the damping W/L². Without one the linear mode gives the guess: ¼ c ω ∫sin²θ dθ = π c
        // ω/8.
        let guess = if half.length > 0.0 {
            half.viscous / (half.length * half.length)
        } else {
            0.125 * PI * self.viscous * libm::sqrt(self.k_inf)
        };
        let Some(Slip { length, damping, phase }) = whole.half_cycle(pull, guess) else { return false };
        let force = branch.start.force + branch.direction * 2.0 * self.law.slip_force();
        self.found(branch, pull, half, Found { length, damping, force, phase })
    }

    /// A half cycle under any law at any amplitude. The damper's work depends on the travel, so passes over both are made.
    #[cold]
    fn any_slip(&self, branch: &Branch, pull: f64, half: &mut HalfCycle) -> bool {
        // Since G >= 0, P < 0 at this start value, and P is concave: Newton's method descends monotonically to the root.
        let mut length = 2.0 * pull / self.k_inf;
        let (mut damping, mut duration) = (0.0, 0.0);
        let mut phase = HalfCycle::NONE.phase;
        for _ in 0..MOST_PASSES {
            let Some(root) = self.root(pull, damping, length) else { return false };
            length = root;
            let settled = self.passes(length);
            phase = settled.phase;
            let before = core::mem::replace(&mut duration, phase.duration());
            if self.viscous == 0.0 || libm::fabs(duration - before) <= PASS_TOLERANCE * duration {
                break;
            }
            damping = 0.25 * self.viscous * settled.work;
        }
        let force = branch.force_and_tangent(self.law, branch.start.u + branch.direction * length).0;
        self.found(branch, pull, half, Found { length, damping, force, phase })
    }

    /// Stores a half cycle; returns false if it has no valid duration.
    fn found(
        &self,
        branch: &Branch,
        pull: f64,
        half: &mut HalfCycle,
        Found { length, damping, force, phase }: Found,
    ) -> bool {
        let HalfCycleWorks { viscous, joint } = self.works(branch, pull, length, damping);
        let duration = phase.duration();
        *half = HalfCycle { length, viscous, joint, duration, force, phase, ..HalfCycle::NONE };
        duration > 0.0 && duration.is_finite()
    }

    /// Travel L with P(L) = damping·L², by Newton's method from `guess`.
    fn root(&self, pull: f64, damping: f64, guess: f64) -> Option<f64> {
        /// Largest number of rounds; usually a handful suffices. When it is reached, the last length is used, and the caller's passes
        /// continue from it.
        const MOST: u32 = 100;
        let k = self.k_inf + 2.0 * damping;
        let mut length = guess;
        for round in 0..MOST {
            let half = 0.5 * length;
            let gained = pull * length - k * half * length - 4.0 * self.law.energy(half);
            let slope = pull - k * length - 2.0 * self.law.force(half);
            let step = -gained / slope;
            length += step;
            // The iteration approaches from the right, so a step to the right can only be rounding.
            if libm::fabs(step) <= 4.0 * f64::EPSILON * length || (round > 0 && step >= 0.0) {
                break;
            }
        }
        (length > 0.0).then_some(length)
    }

    /// The clock of a half cycle (phase as a function of time), for output within the half cycle.
    pub(crate) fn clock(&self, half: &HalfCycle) -> PhaseClock {
        self.phase(half).clock()
    }

    /// Ω over a half cycle.
    pub(crate) fn phase(&self, half: &HalfCycle) -> Phase {
        match &self.micro {
            Some(micro) if half.micro.is_some() => micro.phase(&half.micro),
            _ => half.phase,
        }
    }

    /// Ω and ∫Ω sin² for the travel L, with the phase cut where the weakest and the strongest slider break loose. The damper's work up to
    /// each node is found by fixed-point passes.
    fn passes(&self, length: f64) -> Settled {
        let (weakest, strongest) = self.law.strengths();
        let cut = |phi: f64| 2.0 * libm::asin(libm::sqrt((2.0 * phi / length).min(1.0)));
        let mut phase = Phase::cut(cut(weakest), cut(strongest));
        let mut nodes = [[Node::default(); NODES]; PANELS];
        for (panel, nodes) in phase.panels().iter().zip(&mut nodes) {
            let shares = panel.shares();
            *nodes = core::array::from_fn(|i| {
                Node::new(shares[i], self.gained(length, shares[i]) / (0.25 * length * length))
            });
        }
        let work = phase.settle(&nodes, self.viscous, 0.0);
        Settled { phase, work }
    }

    /// P(y) - (y/L) P(L) at a share x = y/L of the travel. The pull cancels analytically, so that the difference loses no digits to it.
    fn gained(&self, length: f64, Share { gone: x, left: rest }: Share) -> f64 {
        let joint = x * self.law.energy(0.5 * length) - self.law.energy(0.5 * x * length);
        0.5 * self.k_inf * x * rest * length * length + 4.0 * joint
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::FourParameter;
    use crate::memory::{Continuum, Hysteresis, Reversal};
    use crate::step::ResidualStiffness;

    #[test]
    fn the_solver_of_macro_slip_agrees_with_the_general_one() {
        for (chi, beta) in [(-0.183, 0.3), (-0.7, 0.0), (0.4, 2.0)] {
            let law = FourParameter::new(4.45e4, 239.4, chi, beta).unwrap();
            for zeta in [0.0, 2.5e-4, 0.02] {
                let mode = Oscillator::new(124.0, zeta, law.k_t(), ResidualStiffness::Positive).unwrap();
                let map = Map::new(&mode, &law, 0.0, None).unwrap();
                for ratio in [1.2, 1.5, 3.0, 20.0] {
                    let joint = Continuum::new(&law);
                    let mut memory = joint.virgin([Reversal::default(); 8]).unwrap();
                    joint.advance(&mut memory, ratio * law.phi_max());
                    memory.reverse(&law);
                    let branch = memory.branch();
                    let pull = branch.direction * (-map.k_inf * branch.start.u - branch.start.force);
                    let (mut own, mut general) = (HalfCycle::NONE, HalfCycle::NONE);
                    assert!(map.macro_slip(&branch, pull, &mut own), "{chi} {zeta} {ratio}");
                    assert!(map.any_slip(&branch, pull, &mut general));
                    let scale = general.length * branch.start.force.abs();
                    for (name, a, b, unit) in [
                        ("length", own.length, general.length, general.length),
                        ("duration", own.duration, general.duration, general.duration),
                        ("force", own.force, general.force, general.force.abs()),
                        ("viscous", own.viscous, general.viscous, scale),
                        ("joint", own.joint, general.joint, scale),
                    ] {
                        assert!((a - b).abs() < 1e-10 * unit, "{chi} {beta} {zeta} {ratio} {name}: {a} {b}");
                    }
                }
            }
        }
    }
}
