//! Free decay from one turning point to the next, without time steps.
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

use core::f64::consts::{FRAC_PI_2, PI};

use crate::backbone::{Backbone, PowerLaw};
use crate::error::Error;
use crate::masing::Branch;
use crate::oscillator::Oscillator;
use crate::quadrature::Rule;

/// Nodes of the quadrature in the phase, per panel.
pub(crate) const NODES: usize = 10;
/// Panels of a half cycle: below, between and above the weakest and the strongest slider.
const PANELS: usize = 3;
const RULE: Rule<NODES> = Rule::gauss_legendre();
const MATRIX: [[f64; NODES]; NODES] = RULE.integration_matrix();

/// Fixed-point passes stop when the relative change of the duration falls below this.
const PASS_TOLERANCE: f64 = 1e-12;
/// … and after this many at the latest: at ζ_v = 0.1 the passes have converged by then.
const MOST_PASSES: u32 = 40;

/// One half cycle from reversal to reversal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct HalfCycle {
    branch: Branch,
    /// Travel L.
    pub(crate) length: f64,
    /// Work of the viscous damper.
    pub(crate) viscous: f64,
    /// Work on the joint.
    pub(crate) joint: f64,
    /// Duration, s.
    pub(crate) duration: f64,
    panels: [Panel; PANELS],
    used: usize,
    /// Travel and power, where a single power law held.
    travel: Option<Travel>,
}

/// A stretch of the phase on which Ω is smooth.
#[derive(Debug, Clone, Copy)]
struct Panel {
    from: f64,
    to: f64,
    /// Ω at the nodes.
    omega: [f64; NODES],
}

const EMPTY: Panel = Panel { from: 0.0, to: 0.0, omega: [0.0; NODES] };

impl Panel {
    fn half_width(&self) -> f64 {
        0.5 * (self.to - self.from)
    }

    fn phase(&self, i: usize) -> f64 {
        self.from + self.half_width() * (1.0 + RULE.nodes[i])
    }

    fn duration(&self) -> f64 {
        self.half_width() * RULE.weights.iter().zip(&self.omega).map(|(w, o)| w / o).sum::<f64>()
    }

    /// Time from the start of the panel to the phase `theta`, and Ω there, from the polynomial through
    /// the 1/Ω at the nodes (in Legendre form).
    fn time_at(&self, theta: f64) -> (f64, f64) {
        let x = (theta - self.from) / self.half_width() - 1.0;
        let (mut time, mut slowness) = (0.0, 0.0);
        // Legendre polynomials at x, and at the nodes for the coefficients.
        let (mut p, mut below) = (1.0, 0.0);
        let (mut at, mut before) = ([1.0; NODES], [0.0; NODES]);
        for k in 0..NODES {
            let (order, double) = (k as f64, 2.0 * k as f64 + 1.0);
            let sum: f64 = (0..NODES).map(|j| RULE.weights[j] * at[j] / self.omega[j]).sum();
            let coefficient = 0.5 * double * sum;
            let above = (double * x * p - order * below) / (order + 1.0);
            let lower = if k == 0 { -1.0 } else { below };
            slowness += coefficient * p;
            time += coefficient * (above - lower) / double;
            for j in 0..NODES {
                let next = (double * RULE.nodes[j] * at[j] - order * before[j]) / (order + 1.0);
                (before[j], at[j]) = (at[j], next);
            }
            (below, p) = (p, above);
        }
        (self.half_width() * time, 1.0 / slowness)
    }
}

/// The micro-slip power law in the form the half cycle needs: P(y) = s y - ½ ω² y² + ρ y^(p+1).
#[derive(Debug, Clone, Copy)]
struct Micro {
    omega_squared: f64,
    rho: f64,
    exponent: f64,
    /// Largest L.
    longest: f64,
    /// τ_i = (1 - x^p)/(1 - x) at the nodes, x = sin²(θ_i/2).
    tau: [f64; NODES],
}

/// Viscous coupling between the nodes of a single panel over 0 … π:
/// Ω_i² gains Σ_j coupling[j][i] Ω_j.
fn coupling(viscous: f64) -> [[f64; NODES]; NODES] {
    let sine_squared = |k: usize| libm::sin(PHASES.phase(k)) * libm::sin(PHASES.phase(k));
    let mut matrix = [[0.0; NODES]; NODES];
    for (j, column) in matrix.iter_mut().enumerate() {
        for (i, entry) in column.iter_mut().enumerate() {
            let half = libm::sin(0.5 * PHASES.phase(i));
            let share = half * half * RULE.weights[j] - MATRIX[i][j];
            *entry = PI * viscous * share * sine_squared(j) / sine_squared(i);
        }
    }
    matrix
}

const PHASES: Panel = Panel { from: 0.0, to: PI, omega: [0.0; NODES] };

/// The map of one mode under a constant force.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Map<'a, B> {
    pub(crate) law: &'a B,
    pub(crate) k_inf: f64,
    pub(crate) viscous: f64,
    pub(crate) load: f64,
    micro: Option<Micro>,
    coupling: [[f64; NODES]; NODES],
    /// ∫Ω sin² from 0 to π is the sum over these times Ω at the nodes.
    work_weights: [f64; NODES],
}

impl<'a, B: Backbone> Map<'a, B> {
    /// # Errors
    /// [`Error::OutOfRange`] unless K_∞ > 0: without it the mass need not turn round.
    pub(crate) fn new(oscillator: &Oscillator, law: &'a B, load: f64) -> Result<Self, Error> {
        let k_inf = oscillator.k_inf();
        crate::error::check("k_inf", k_inf, k_inf > 0.0, "the half-cycle map needs K_inf = omega0^2 - k_t > 0")?;
        let sine = |i: usize| libm::sin(PHASES.phase(i));
        let work_weights = core::array::from_fn(|i| FRAC_PI_2 * RULE.weights[i] * sine(i) * sine(i));
        let micro = law.power_law().map(|power| Micro::new(k_inf, &power));
        let viscous = oscillator.viscous();
        let coupling = if viscous > 0.0 { coupling(viscous) } else { [[0.0; NODES]; NODES] };
        Ok(Self { law, k_inf, viscous, load, micro, coupling, work_weights })
    }

    /// The half cycle that leaves the reversal at which `branch` starts; none when the mass rests in
    /// equilibrium or the half cycle would close the loop around it (the caller then steps).
    ///
    /// `last` is the half cycle before, a start value.
    pub(crate) fn half_cycle(&self, branch: Branch, last: Option<&HalfCycle>) -> Option<HalfCycle> {
        let pull = branch.direction * (self.load - self.k_inf * branch.start.u - branch.start.force);
        if pull.is_nan() || pull <= 0.0 {
            return None;
        }
        let micro = self.micro.as_ref().and_then(|micro| self.micro_slip(micro, pull, branch, last));
        let found = micro.or_else(|| self.any_slip(branch, pull))?;
        // A loop that closes in macro-slip leaves no trace in the force.
        let strongest = self.law.strengths().1 * (1.0 - 4.0 * f64::EPSILON);
        let traceless = branch.virgin_distance(branch.end) >= strongest;
        let end = branch.start.u + branch.direction * found.length;
        (traceless || !branch.passed_by(end)).then_some(found)
    }

    /// In micro-slip under a power law. Successive half cycles are alike, so the one before gives start values
    /// and, by a short series, even the power.
    fn micro_slip(&self, micro: &Micro, pull: f64, branch: Branch, last: Option<&HalfCycle>) -> Option<HalfCycle> {
        let last = last.filter(|h| h.used == 1);
        let stuck = libm::sqrt(micro.omega_squared);
        let mut damping = last.map_or(0.25 * self.viscous * stuck * FRAC_PI_2, |h| h.viscous / (h.length * h.length));
        let mut travel = micro.travel(pull, damping, last.and_then(|h| h.travel))?;
        let mut omega = last.map_or([stuck; NODES], |h| h.panels[0].omega);
        let mut duration = 0.0;
        for _ in 0..MOST_PASSES {
            let coupled = self.coupled(&omega);
            let softening = 2.0 * micro.rho * travel.power / travel.length;
            for i in 0..NODES {
                omega[i] = libm::sqrt(micro.omega_squared - softening * micro.tau[i] + coupled[i]);
            }
            let before = core::mem::replace(&mut duration, Panel { omega, ..PHASES }.duration());
            if self.viscous == 0.0 {
                break;
            }
            let work: f64 = (0..NODES).map(|j| self.work_weights[j] * omega[j]).sum();
            damping = 0.25 * self.viscous * work;
            travel = micro.travel(pull, damping, Some(travel))?;
            if (duration - before).abs() <= PASS_TOLERANCE * duration {
                break;
            }
        }
        let length = travel.length;
        let viscous = damping * length * length;
        let mut panels = [EMPTY; PANELS];
        panels[0] = Panel { omega, ..PHASES };
        let joint = self.joint_work(branch, pull, length, viscous);
        let travel = Some(travel);
        (duration > 0.0).then_some(HalfCycle { branch, length, viscous, joint, duration, panels, used: 1, travel })
    }

    /// c Σ_j coupling[i][j] Ω_j.
    fn coupled(&self, omega: &[f64; NODES]) -> [f64; NODES] {
        let mut sum = [0.0; NODES];
        if self.viscous > 0.0 {
            for (column, o) in self.coupling.iter().zip(omega) {
                for (s, c) in sum.iter_mut().zip(column) {
                    *s += c * o;
                }
            }
        }
        sum
    }

    /// Work on the joint over the travel: what P(L) = W leaves of the pull and the residual spring.
    fn joint_work(&self, branch: Branch, pull: f64, length: f64, viscous: f64) -> f64 {
        (branch.direction * branch.start.force + pull - 0.5 * self.k_inf * length) * length - viscous
    }

    /// Any law, any amplitude: the phase is cut where the weakest and the strongest slider break loose.
    fn any_slip(&self, branch: Branch, pull: f64) -> Option<HalfCycle> {
        // G >= 0, so P < 0 here, and P is concave: Newton's method comes down monotonically.
        let mut length = 2.0 * pull / self.k_inf;
        let mut damping = 0.0;
        let mut half = HalfCycle {
            branch,
            length,
            viscous: 0.0,
            joint: 0.0,
            duration: 0.0,
            panels: [EMPTY; PANELS],
            used: 0,
            travel: None,
        };
        for _ in 0..MOST_PASSES {
            length = self.root(pull, damping, length)?;
            self.cut(&mut half, length);
            let before = half.duration;
            let work = self.speeds(&mut half, damping);
            if self.viscous == 0.0 || (half.duration - before).abs() <= PASS_TOLERANCE * half.duration {
                break;
            }
            damping = 0.25 * self.viscous * work;
        }
        half.length = length;
        half.viscous = damping * length * length;
        half.joint = self.joint_work(branch, pull, length, half.viscous);
        (half.duration > 0.0 && half.duration.is_finite()).then_some(half)
    }

    /// L with P(L) = damping·L², by Newton's method from `guess`.
    fn root(&self, pull: f64, damping: f64, guess: f64) -> Option<f64> {
        const MOST: u32 = 100;
        let k = self.k_inf + 2.0 * damping;
        let mut length = guess;
        for _ in 0..MOST {
            let half = 0.5 * length;
            let gained = pull * length - k * half * length - 4.0 * self.law.energy(half);
            let slope = pull - k * length - 2.0 * self.law.force(half);
            let step = -gained / slope;
            length += step;
            if step.abs() <= 2.0 * f64::EPSILON * length {
                return (length > 0.0).then_some(length);
            }
        }
        (length > 0.0).then_some(length)
    }

    /// Cuts the phase at the weakest and the strongest slider.
    fn cut(&self, half: &mut HalfCycle, length: f64) {
        let (weakest, strongest) = self.law.strengths();
        let phase = |phi: f64| 2.0 * libm::asin(libm::sqrt((2.0 * phi / length).min(1.0)));
        let limits = [0.0, phase(weakest), phase(strongest), PI];
        let previous = *half;
        (half.used, half.length) = (0, length);
        for limit in limits.windows(2) {
            if limit[1] - limit[0] > 1e-6 {
                let omega = previous.panels[half.used].omega;
                half.panels[half.used] = Panel { from: limit[0], to: limit[1], omega };
                half.used += 1;
            }
        }
        // A sliver left out goes to its neighbour.
        half.panels[0].from = 0.0;
        for i in 1..half.used {
            half.panels[i].from = half.panels[i - 1].to;
        }
        half.panels[half.used - 1].to = PI;
    }

    /// One pass over all nodes: Ω from the energy gained, with the damper's work up to each node taken from
    /// the Ω of the pass before; sets the duration and returns ∫Ω sin².
    fn speeds(&self, half: &mut HalfCycle, damping: f64) -> f64 {
        let length = half.length;
        let arm = 0.5 * length;
        // Work of the damper at unit c and arm, and its end value for P(L) = W.
        let (mut work_before, mut duration) = (0.0, 0.0);
        let total = 4.0 * damping;
        let mut work = 0.0;
        for panel in &mut half.panels[..half.used] {
            let width = panel.half_width();
            let sines: [f64; NODES] = core::array::from_fn(|i| libm::sin(panel.phase(i)));
            let rates: [f64; NODES] = core::array::from_fn(|j| sines[j] * sines[j] * panel.omega[j]);
            let mut omega = [0.0; NODES];
            for i in 0..NODES {
                let theta = panel.phase(i);
                let inside: f64 = (0..NODES).map(|j| MATRIX[i][j] * rates[j]).sum();
                let lost = self.viscous * (work_before + width * inside);
                let s = libm::sin(0.5 * theta);
                let c = libm::cos(0.5 * theta);
                let gained = self.gained(length, s * s, c * c) + (total * s * s - lost) * arm * arm;
                omega[i] = libm::sqrt(2.0 * gained) / (arm * sines[i]);
            }
            work_before += width * (0..NODES).map(|j| RULE.weights[j] * rates[j]).sum::<f64>();
            panel.omega = omega;
            duration += panel.duration();
            work += width * (0..NODES).map(|j| RULE.weights[j] * sines[j] * sines[j] * omega[j]).sum::<f64>();
        }
        half.duration = duration;
        work
    }

    /// P(y) - (y/L) P(L) at y = x L, where `rest` = 1 - x: free of cancellation between the pull and the end.
    fn gained(&self, length: f64, x: f64, rest: f64) -> f64 {
        let joint = x * self.law.energy(0.5 * length) - self.law.energy(0.5 * x * length);
        0.5 * self.k_inf * x * rest * length * length + 4.0 * joint
    }
}

impl Micro {
    fn new(k_inf: f64, power: &PowerLaw) -> Self {
        let p = power.exponent;
        let mut tau = [0.0; NODES];
        for (i, t) in tau.iter_mut().enumerate() {
            let (s, c) = (libm::sin(0.5 * PHASES.phase(i)), libm::cos(0.5 * PHASES.phase(i)));
            *t = (1.0 - libm::pow(s * s, p)) / (c * c);
        }
        Self {
            omega_squared: k_inf + power.stiffness,
            rho: 4.0 * power.coefficient / ((p + 1.0) * libm::pow(2.0, p + 1.0)),
            exponent: p,
            longest: 2.0 * power.limit,
            tau,
        }
    }

    /// L with s - (½ω² + damping) L + ρ L^p = 0, the balance P(L) = damping·L² over L; none beyond micro-slip.
    ///
    /// The left side is convex and falls, so Newton's method ends monotonically from the left.
    fn travel(&self, pull: f64, damping: f64, guess: Option<Travel>) -> Option<Travel> {
        const MOST: u32 = 60;
        let linear = 0.5 * self.omega_squared + damping;
        let mut at = guess.filter(|t| t.age < Travel::OLDEST).map_or_else(
            || Travel::new(pull / linear, self.exponent),
            |t| Travel { age: t.age + 1, ..t },
        );
        for _ in 0..MOST {
            let slope = linear - self.exponent * self.rho * at.power / at.length;
            let step = (pull - linear * at.length + self.rho * at.power) / slope;
            let relative = step / at.length;
            at = at.moved(relative, self.exponent);
            // The error squares: nothing is left to gain.
            if relative.abs() < 1e-8 {
                break;
            }
        }
        (at.length > 0.0 && at.length <= self.longest).then_some(at)
    }
}

/// A travel L with its power L^p.
#[derive(Debug, Clone, Copy)]
struct Travel {
    length: f64,
    power: f64,
    /// Series updates since the power was last taken in full.
    age: u32,
}

impl Travel {
    /// Rounding grows by a unit in the last place per update: this many are harmless.
    const OLDEST: u32 = 64;

    fn new(length: f64, exponent: f64) -> Self {
        Self { length, power: libm::pow(length, exponent), age: 0 }
    }

    /// The travel (1 + e) L, with (1 + e)^p by its binomial series of eight terms where that is exact.
    fn moved(self, e: f64, exponent: f64) -> Self {
        let length = self.length * (1.0 + e);
        if e.abs() > 0.01 {
            return Self::new(length, exponent);
        }
        let (mut term, mut sum) = (1.0, 0.0);
        for k in 0..8_u32 {
            let k = f64::from(k);
            term *= e * (exponent - k) * RECIPROCAL[k as usize];
            sum += term;
        }
        Self { length, power: self.power + self.power * sum, age: self.age }
    }
}

const RECIPROCAL: [f64; 8] = [1.0, 0.5, 1.0 / 3.0, 0.25, 0.2, 1.0 / 6.0, 1.0 / 7.0, 0.125];

impl HalfCycle {
    /// The reversal at which it ends.
    pub(crate) fn end(&self) -> f64 {
        self.branch.start.u + self.branch.direction * self.length
    }

    /// Displacement and velocity at the time `t` after its start.
    pub(crate) fn at(&self, t: f64) -> (f64, f64) {
        let mut left = t;
        let mut panel = &self.panels[0];
        for candidate in &self.panels[..self.used] {
            panel = candidate;
            let duration = candidate.duration();
            if left <= duration {
                break;
            }
            left -= duration;
        }
        // Newton's method on a function that is all but straight.
        let mut theta = panel.from + (panel.to - panel.from) * (left / panel.duration()).clamp(0.0, 1.0);
        let mut omega = 0.0;
        for _ in 0..8 {
            let (time, rate) = panel.time_at(theta);
            let step = (left - time) * rate;
            (theta, omega) = (theta + step, rate);
            if step.abs() < 1e-9 {
                break;
            }
        }
        let s = libm::sin(0.5 * theta);
        let d = self.branch.direction;
        let q = self.branch.start.u + d * self.length * s * s;
        (q, d * 0.5 * self.length * libm::sin(theta) * omega)
    }
}
