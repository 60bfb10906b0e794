//! From one turning point to the next, without time steps.
//!
//! Between two reversals the force depends on displacement alone: at the distance y from the reversal
//! (q_a, F_a), moving in direction d, Masing's rule gives F = F_a + 2 d F_virgin(y/2), so the mass has gained
//!
//! P(y) = s y - ½ K_∞ y² - 4 G(y/2),   s = d (f - K_∞ q_a - F_a),
//!
//! with G the work on the virgin curve and f a constant force. The next turning point is the root L of
//! P(L) = W, W the work of the viscous damper. With y = ½L (1 - cos θ) the speed is ½L sin θ · Ω(θ) and Ω is
//! a smooth function of the phase θ, near the circular frequency: the duration ∫dθ/Ω and
//! W = c (L/2)² ∫Ω sin²θ dθ from 0 to π are Gauss-Legendre sums over a few nodes. With viscous damping
//! Ω² itself has a term in ∫Ω sin², found by fixed-point passes that gain a factor of about ζ_v each.

use crate::backbone::Backbone;
use crate::error::Error;
use crate::masing::Branch;
use crate::micro_slip::{MOST_PASSES, MicroSlip, PASS_TOLERANCE, Travel};
use crate::oscillator::Oscillator;
use crate::phase::{MATRIX, NODES, PANELS, Phase, PhaseClock, RULE};

/// One half cycle from reversal to reversal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfCycle {
    /// Displacement at its start, and direction of motion ±1.
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
    /// Joint force at its end.
    pub(crate) force: f64,
    /// In micro-slip under a power law: what the next half cycle starts from.
    micro: Travel,
}

/// What a node of the quadrature needs in every pass.
#[derive(Debug, Clone, Copy, Default)]
struct Node {
    /// Share y/L of the travel.
    share: f64,
    /// sin²θ.
    sine_squared: f64,
    /// P(y) - (y/L) P(L), per (L/2)².
    gained: f64,
}

impl HalfCycle {
    /// No half cycle yet.
    pub(crate) const NONE: Self = Self {
        start: 0.0,
        direction: 1.0,
        length: 0.0,
        viscous: 0.0,
        joint: 0.0,
        duration: 0.0,
        force: 0.0,
        micro: Travel::NONE,
    };

    /// Displacement at its end.
    #[inline]
    pub(crate) fn end(&self) -> f64 {
        self.start + self.direction * self.length
    }

    /// Whether it stayed in micro-slip under a power law.
    #[inline]
    pub(crate) fn is_micro_slip(&self) -> bool {
        self.micro.is_some()
    }

    /// Displacement and velocity at the time `t` after its start; `clock` is its own.
    pub(crate) fn at(&self, clock: &PhaseClock, t: f64) -> (f64, f64) {
        let (theta, omega) = clock.at(t);
        self.motion(theta, omega)
    }

    /// Displacement and velocity at a phase and its Ω.
    pub(crate) fn motion(&self, theta: f64, omega: f64) -> (f64, f64) {
        let ((s, c), d) = (libm::sincos(0.5 * theta), self.direction);
        (self.start + d * self.length * s * s, d * self.length * s * c * omega)
    }
}

/// The map of one mode under a constant force.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Map<'a, B> {
    pub(crate) law: &'a B,
    pub(crate) k_inf: f64,
    pub(crate) viscous: f64,
    pub(crate) load: f64,
    micro: Option<MicroSlip>,
}

impl<'a, B: Backbone> Map<'a, B> {
    /// # Errors
    /// [`Error::OutOfRange`] unless K_∞ > 0: without it the mass need not turn round.
    pub(crate) fn new(oscillator: &Oscillator, law: &'a B, load: f64) -> Result<Self, Error> {
        let k_inf = oscillator.k_inf();
        crate::error::check(
            "k_inf",
            k_inf,
            k_inf > 0.0,
            "the half-cycle map needs K_inf = omega0^2 - k_t > 0",
        )?;
        let viscous = oscillator.viscous();
        let micro = law.power_law().and_then(|power| MicroSlip::new(k_inf, viscous, &power));
        Ok(Self { law, k_inf, viscous, load, micro })
    }

    /// Turns `half`, the half cycle before, into the one that leaves the reversal at which `branch` starts; false
    /// when the mass rests in equilibrium or the half cycle would close the loop around it (the caller then steps).
    ///
    /// In place, because copies of what was just written would wait for the stores.
    #[inline]
    pub(crate) fn half_cycle(&self, branch: &Branch, half: &mut HalfCycle) -> bool {
        let pull = branch.direction * (self.load - self.k_inf * branch.start.u - branch.start.force);
        if pull.is_nan() || pull <= 0.0 {
            return false;
        }
        if !(self.micro_slip(branch, pull, half) || self.any_slip(branch, pull, half)) {
            return false;
        }
        (half.start, half.direction) = (branch.start.u, branch.direction);
        // A loop that closes in macro-slip leaves no trace in the force.
        let strongest = || self.law.strengths().1 * (1.0 - 4.0 * f64::EPSILON);
        !branch.passed_by(half.end()) || branch.virgin_distance(branch.end) >= strongest()
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
        (half.viscous, half.joint) = self.works(branch, pull, travel.length, travel.damping());
        true
    }

    /// Works of the damper and on the joint: P(L) = W leaves the latter from the pull and the residual spring.
    #[inline]
    fn works(&self, branch: &Branch, pull: f64, length: f64, damping: f64) -> (f64, f64) {
        let viscous = damping * length * length;
        (
            viscous,
            (branch.direction * branch.start.force + pull - 0.5 * self.k_inf * length) * length - viscous,
        )
    }

    /// Any law, any amplitude.
    #[cold]
    fn any_slip(&self, branch: &Branch, pull: f64, half: &mut HalfCycle) -> bool {
        // G >= 0, so P < 0 here, and P is concave: Newton's method comes down monotonically.
        let mut length = 2.0 * pull / self.k_inf;
        let (mut damping, mut duration) = (0.0, 0.0);
        for _ in 0..MOST_PASSES {
            let Some(root) = self.root(pull, damping, length) else { return false };
            length = root;
            let (phase, work) = self.passes(length);
            let before = core::mem::replace(&mut duration, phase.duration());
            if self.viscous == 0.0 || libm::fabs(duration - before) <= PASS_TOLERANCE * duration {
                break;
            }
            damping = 0.25 * self.viscous * work;
        }
        let force = branch.force_and_tangent(self.law, branch.start.u + branch.direction * length).0;
        let (viscous, joint) = self.works(branch, pull, length, damping);
        *half = HalfCycle { length, viscous, joint, duration, force, ..HalfCycle::NONE };
        duration > 0.0 && duration.is_finite()
    }

    /// L with P(L) = damping·L², by Newton's method from `guess`.
    fn root(&self, pull: f64, damping: f64, guess: f64) -> Option<f64> {
        const MOST: u32 = 100;
        let k = self.k_inf + 2.0 * damping;
        let mut length = guess;
        for round in 0..MOST {
            let half = 0.5 * length;
            let gained = pull * length - k * half * length - 4.0 * self.law.energy(half);
            let slope = pull - k * length - 2.0 * self.law.force(half);
            let step = -gained / slope;
            length += step;
            // It comes from the right: a step back is rounding.
            if libm::fabs(step) <= 4.0 * f64::EPSILON * length || (round > 0 && step >= 0.0) {
                break;
            }
        }
        (length > 0.0).then_some(length)
    }

    /// The clock of a half cycle, for dense output.
    pub(crate) fn clock(&self, half: &HalfCycle) -> PhaseClock {
        self.phase(half).clock()
    }

    /// Ω over a half cycle.
    pub(crate) fn phase(&self, half: &HalfCycle) -> Phase {
        match &self.micro {
            Some(micro) if half.micro.is_some() => micro.phase(&half.micro),
            _ => self.passes(half.length).0,
        }
    }

    /// Ω and ∫Ω sin² for the travel L, the phase cut where the weakest and the strongest slider break
    /// loose; the damper's work up to each node by fixed-point passes.
    fn passes(&self, length: f64) -> (Phase, f64) {
        let (weakest, strongest) = self.law.strengths();
        let cut = |phi: f64| 2.0 * libm::asin(libm::sqrt((2.0 * phi / length).min(1.0)));
        let mut phase = Phase::cut(cut(weakest), cut(strongest));
        let mut nodes = [[Node::default(); NODES]; PANELS];
        for (panel, nodes) in phase.panels_mut().iter().zip(&mut nodes) {
            *nodes = core::array::from_fn(|i| self.node(panel.phase(i), length));
        }
        let (mut duration, mut work) = (0.0, 0.0);
        for _ in 0..MOST_PASSES {
            work = self.pass(&mut phase, &nodes, work);
            let before = core::mem::replace(&mut duration, phase.duration());
            if self.viscous == 0.0 || libm::fabs(duration - before) <= PASS_TOLERANCE * duration {
                break;
            }
        }
        (phase, work)
    }

    /// One pass over all nodes: Ω from the energy gained, less the damper's work from the Ω before, of which
    /// `total` is ∫Ω sin². P(L) leaves that total over, so that the speed vanishes at the end. Returns the new total.
    fn pass(&self, phase: &mut Phase, nodes: &[[Node; NODES]], total: f64) -> f64 {
        let (mut work_before, mut work) = (0.0, 0.0);
        for (panel, nodes) in phase.panels_mut().iter_mut().zip(nodes) {
            let width = panel.half_width();
            let rates: [f64; NODES] = core::array::from_fn(|j| nodes[j].sine_squared * panel.omega[j]);
            for (i, node) in nodes.iter().enumerate() {
                let inside: f64 = MATRIX[i].iter().zip(&rates).map(|(b, r)| b * r).sum();
                let lost = self.viscous * (work_before + width * inside - node.share * total);
                panel.omega[i] = libm::sqrt(2.0 * (node.gained - lost) / node.sine_squared);
            }
            let weighted =
                |rate: &dyn Fn(usize) -> f64| (0..NODES).map(|j| RULE.weights[j] * rate(j)).sum::<f64>();
            work_before += width * weighted(&|j| rates[j]);
            work += width * weighted(&|j| nodes[j].sine_squared * panel.omega[j]);
        }
        work
    }

    /// What the phase `theta` contributes to every pass.
    fn node(&self, theta: f64, length: f64) -> Node {
        let (s, c) = (libm::sin(0.5 * theta), libm::cos(0.5 * theta));
        let (x, rest, arm) = (s * s, c * c, 0.5 * length);
        Node { share: x, sine_squared: 4.0 * x * rest, gained: self.gained(length, x, rest) / (arm * arm) }
    }

    /// P(y) - (y/L) P(L) at y = x L, where `rest` = 1 - x: free of cancellation between the pull and the end.
    fn gained(&self, length: f64, x: f64, rest: f64) -> f64 {
        let joint = x * self.law.energy(0.5 * length) - self.law.energy(0.5 * x * length);
        0.5 * self.k_inf * x * rest * length * length + 4.0 * joint
    }
}
