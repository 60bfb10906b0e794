//! The speed within a half cycle, as a function of the phase θ: y = ½L (1 - cos θ), y' = ½L sin θ · Ω(θ).

use core::f64::consts::PI;

use crate::elementary::sine;
use crate::quadrature::Rule;

/// Number of quadrature nodes in the phase, per panel; even, because shares are computed in pairs. Errors of turning points and their times
/// against 20 nodes, over 30 half cycles of smooth laws from 0.01 to 3 φ_max: with 8 nodes 1e-8 without a damper, 3e-6 at ζ_v = 1 % and
/// 6e-5 at 10 %; with 10 nodes 1e-9, 9e-8 and 2e-6; with 12 nodes 2e-10, 4e-9 and 4e-8; with 14 nodes 5e-11, 5e-10 and 1e-9. A tabulated
/// density has corners within the panels: with 12 nodes its error is 4e-8, and 1e-6 at 10 %. Two more nodes cost a seventh of the time in
/// macro-slip and nothing in micro-slip.
pub(crate) const NODES: usize = 12;
/// Number of panels of a half cycle: Ω has a corner where the weakest slider breaks loose and one where the strongest does, and is smooth
/// below, between and above them.
pub(crate) const PANELS: usize = 3;
/// The Gauss-Legendre rule in the phase.
pub(crate) const RULE: Rule<NODES> = Rule::gauss_legendre();
/// Integrals from the start of a panel up to its nodes.
pub(crate) const MATRIX: [[f64; NODES]; NODES] = RULE.integration_matrix();
/// The transpose of [`MATRIX`]: a product with it adds whole columns, so that no sum runs across the lanes of a register.
const COLUMNS: [[f64; NODES]; NODES] = {
    let mut columns = [[0.0; NODES]; NODES];
    let mut i = 0;
    while i < NODES {
        let mut j = 0;
        while j < NODES {
            columns[j][i] = MATRIX[i][j];
            j += 1;
        }
        i += 1;
    }
    columns
};
/// The share y/L of the travel at the nodes of a whole half cycle: x = sin²(θ/2).
pub(crate) const SHARE: [f64; NODES] = {
    let mut share = [0.0; NODES];
    let mut i = 0;
    while i < NODES {
        let s = sine(0.25 * PI * (1.0 + RULE.nodes[i]));
        share[i] = s * s;
        i += 1;
    }
    share
};

/// Relative change of the duration below which the fixed-point passes for the damper's work end. Turning points are then exact to 5e-12 at
/// ζ_v = 10 % and to 1e-13 at 1 %; 1e-10 leaves errors of 2e-10, and 1e-14 gains next to nothing for one more pass.
pub(crate) const PASS_TOLERANCE: f64 = 1e-12;
/// Largest number of fixed-point passes: 3 are needed at ζ_v = 0.025 %, 5 at 1 %, 11 at 10 %, 28 at 50 %. From ζ_v = 0.7 on, where a mode
/// hardly swings, the limit is reached and the last pass is used.
pub(crate) const MOST_PASSES: u32 = 60;

/// Shortest panel, rad. A corner of Ω closer than this to another corner or to an end gets no panel border of its own. The value is
/// arbitrary: limits from 1e-8 to 1e-2 gave the same bits in all that was tried, because such corners hardly occur.
const SLIVER: f64 = 1e-6;

/// Step in the phase, rad, below which Newton's method for the clock ends: the remaining error is about the square of the step. 1e-5 would
/// suffice.
const CLOCK_STEP: f64 = 1e-9;
/// Largest number of rounds of Newton's method for the clock. The function is nearly linear; three rounds were never exceeded.
const CLOCK_ROUNDS: u32 = 8;

/// A stretch of the phase on which Ω is smooth, with Ω at the nodes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Panel {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) omega: [f64; NODES],
}

impl Panel {
    pub(crate) const WHOLE: Self = Self { from: 0.0, to: PI, omega: [0.0; NODES] };

    pub(crate) fn half_width(&self) -> f64 {
        0.5 * (self.to - self.from)
    }

    /// The shares of the travel at the nodes, computed in pairs, as the nodes are symmetric about the middle.
    pub(crate) fn shares(&self) -> [Share; NODES] {
        if self.from == 0.0 && self.to == PI {
            return core::array::from_fn(|i| Share { gone: SHARE[i], left: SHARE[NODES - 1 - i] });
        }
        let (sine, cosine) = libm::sincos(0.25 * (self.from + self.to));
        let mut shares = [Share::default(); NODES];
        for i in 0..NODES / 2 {
            let (s, c) = libm::sincos(0.5 * self.half_width() * RULE.nodes[i]);
            let square = |x: f64| x * x;
            let share = |gone: f64, left: f64| Share { gone: square(gone), left: square(left) };
            shares[i] = share(sine * c + cosine * s, cosine * c - sine * s);
            shares[NODES - 1 - i] = share(sine * c - cosine * s, cosine * c + sine * s);
        }
        shares
    }

    /// Duration of the panel, ∫dθ/Ω.
    pub(crate) fn duration(&self) -> f64 {
        self.half_width() * RULE.weights.iter().zip(&self.omega).map(|(w, o)| w / o).sum::<f64>()
    }

    /// Times of the nodes from the start of the panel.
    fn times(&self) -> [Tick; NODES] {
        let width = self.half_width();
        let slowness = self.omega.map(|o| width / o);
        core::array::from_fn(|i| {
            let time: f64 = MATRIX[i].iter().zip(&slowness).map(|(b, s)| b * s).sum();
            Tick { time, weight: RULE.weights[i] * slowness[i] }
        })
    }

    /// The Legendre coefficients of the polynomial through the values 1/Ω at the nodes.
    fn slowness(&self) -> [f64; NODES] {
        // Legendre polynomials at the nodes, by the three-term recurrence.
        let (mut at, mut before) = ([1.0; NODES], [0.0; NODES]);
        core::array::from_fn(|k| {
            let (order, double) = (k as f64, 2.0 * k as f64 + 1.0);
            let sum: f64 = (0..NODES).map(|j| RULE.weights[j] * at[j] / self.omega[j]).sum();
            for j in 0..NODES {
                let next = (double * RULE.nodes[j] * at[j] - order * before[j]) / (order + 1.0);
                (before[j], at[j]) = (at[j], next);
            }
            0.5 * double * sum
        })
    }
}

/// Share of the travel at a phase: x = sin²(θ/2) = y/L has been travelled, 1 - x is left. Both are stored, because near the end the
/// difference 1 - x would lose its digits.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Share {
    pub(crate) gone: f64,
    pub(crate) left: f64,
}

/// Time of a node, with its weight.
#[derive(Debug, Clone, Copy)]
struct Tick {
    /// Time from the start of the panel.
    time: f64,
    /// Weight dt of the node in an integral over time.
    weight: f64,
}

/// A node of a half cycle with its place, speed and time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Waypoint {
    /// Share y/L of the travel.
    pub(crate) share: f64,
    /// Speed over travel, y'/L.
    pub(crate) speed: f64,
    /// Time from the start of the half cycle.
    pub(crate) time: f64,
    /// Weight dt of the node in an integral over time.
    pub(crate) weight: f64,
}

/// Result of a clock: the time at a phase or the phase at a time, and Ω there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Reading {
    /// The time or the phase that was asked for.
    pub(crate) value: f64,
    /// Ω at that time or phase.
    pub(crate) omega: f64,
}

/// Time as a function of the phase within a panel.
#[derive(Debug, Clone, Copy)]
struct Clock {
    from: f64,
    half_width: f64,
    duration: f64,
    slowness: [f64; NODES],
}

impl Clock {
    fn new(panel: &Panel) -> Self {
        let (half_width, duration) = (panel.half_width(), panel.duration());
        Self { from: panel.from, half_width, duration, slowness: panel.slowness() }
    }

    /// Time from the start of the panel to the phase `theta`, and Ω there. ∫P_k is (P_{k+1} - P_{k-1})/(2k+1).
    fn time_at(&self, theta: f64) -> Reading {
        let x = (theta - self.from) / self.half_width - 1.0;
        let (mut time, mut slowness) = (0.0, 0.0);
        let (mut p, mut below) = (1.0, 0.0);
        for (k, c) in self.slowness.iter().enumerate() {
            let (above, lower) = (RISE[k] * x * p - FALL[k] * below, if k == 0 { -1.0 } else { below });
            slowness += c * p;
            time += c * SHARE_OF_ORDER[k] * (above - lower);
            (below, p) = (p, above);
        }
        Reading { value: self.half_width * time, omega: 1.0 / slowness }
    }

    /// The phase at the time `t` from the start of the panel, and Ω there, by Newton's method on a nearly linear function.
    fn phase_at(&self, t: f64) -> Reading {
        let mut theta = self.from + 2.0 * self.half_width * (t / self.duration).clamp(0.0, 1.0);
        let mut omega = 0.0;
        for _ in 0..CLOCK_ROUNDS {
            let Reading { value: time, omega: rate } = self.time_at(theta);
            let step = (t - time) * rate;
            (theta, omega) = (theta + step, rate);
            if libm::fabs(step) < CLOCK_STEP {
                break;
            }
        }
        Reading { value: theta, omega }
    }
}

/// (2k+1)/(k+1), the factor of x P_k in the recurrence of Legendre polynomials.
const RISE: [f64; NODES] = orders(true);
/// k/(k+1), the factor of P_{k-1} in that recurrence.
const FALL: [f64; NODES] = orders(false);
/// 1/(2k+1), the factor of P_{k+1} - P_{k-1} in ∫P_k.
const SHARE_OF_ORDER: [f64; NODES] = {
    let mut share = [1.0; NODES];
    let mut k = 0;
    while k < NODES {
        share[k] = 1.0 / (2.0 * k as f64 + 1.0);
        k += 1;
    }
    share
};

const fn orders(rise: bool) -> [f64; NODES] {
    let mut factor = [0.0; NODES];
    let mut k = 0;
    while k < NODES {
        let order = k as f64;
        factor[k] = if rise { 2.0 * order + 1.0 } else { order } / (order + 1.0);
        k += 1;
    }
    factor
}

/// Data of a quadrature node that every pass needs.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Node {
    /// Share y/L of the travel.
    share: f64,
    /// sin²θ = 4 x (1 - x).
    sine_squared: f64,
    /// P(y) - (y/L) P(L), per (L/2)².
    gained: f64,
}

impl Node {
    /// The node at a share of the travel.
    pub(crate) fn new(share: Share, gained: f64) -> Self {
        Self { share: share.gone, sine_squared: 4.0 * share.gone * share.left, gained }
    }
}

/// Ω over a whole half cycle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Phase {
    panels: [Panel; PANELS],
    used: usize,
}

impl Phase {
    /// A half cycle in one panel.
    pub(crate) const fn single(omega: [f64; NODES]) -> Self {
        Self { panels: [Panel { omega, ..Panel::WHOLE }; PANELS], used: 1 }
    }

    /// Panels with borders at the phases `first` and `last`; a panel shorter than [`SLIVER`] is merged with its neighbour.
    pub(crate) fn cut(first: f64, last: f64) -> Self {
        let mut phase = Self::single([0.0; NODES]);
        let mut start = 0.0;
        phase.used = 0;
        for end in [first, last] {
            if end - start > SLIVER && PI - end > SLIVER {
                phase.panels[phase.used] = Panel { from: start, to: end, ..Panel::WHOLE };
                phase.used += 1;
                start = end;
            }
        }
        phase.panels[phase.used].from = start;
        phase.used += 1;
        phase
    }

    /// Moves the border of a half cycle with two panels; the old Ω at the nodes serves as a first guess.
    pub(crate) fn cut_again(&mut self, at: f64) {
        if self.used == 2 {
            (self.panels[0].to, self.panels[1].from) = (at, at);
        }
    }

    /// Computes Ω from the energy gained less the damper's work, by fixed-point passes. `work` is the guess of ∫Ω sin² that corresponds to
    /// the present Ω; the new value is returned.
    pub(crate) fn settle(&mut self, nodes: &[[Node; NODES]; PANELS], viscous: f64, mut work: f64) -> f64 {
        let mut duration = 0.0;
        for _ in 0..MOST_PASSES {
            work = self.pass(nodes, viscous, work);
            let before = core::mem::replace(&mut duration, self.duration());
            if viscous == 0.0 || libm::fabs(duration - before) <= PASS_TOLERANCE * duration {
                break;
            }
        }
        work
    }

    /// One pass over all nodes: Ω from the energy gained less the damper's work, which is computed from the old Ω; `total` is ∫Ω sin² of
    /// the old Ω. At the end P(L) equals the total work, so that the speed vanishes there. Returns the new total.
    fn pass(&mut self, nodes: &[[Node; NODES]; PANELS], viscous: f64, total: f64) -> f64 {
        let (mut work_before, mut work) = (0.0, 0.0);
        for (panel, nodes) in self.panels[..self.used].iter_mut().zip(nodes) {
            let width = panel.half_width();
            let rates: [f64; NODES] = core::array::from_fn(|j| nodes[j].sine_squared * panel.omega[j]);
            let mut inside = [0.0; NODES];
            for (column, rate) in COLUMNS.iter().zip(&rates) {
                inside.iter_mut().zip(column).for_each(|(sum, b)| *sum += b * rate);
            }
            panel.omega = core::array::from_fn(|i| {
                let node = &nodes[i];
                let lost = viscous * (work_before + width * inside[i] - node.share * total);
                libm::sqrt(2.0 * (node.gained - lost) / node.sine_squared)
            });
            let weighted =
                |rate: &dyn Fn(usize) -> f64| (0..NODES).map(|j| RULE.weights[j] * rate(j)).sum::<f64>();
            work_before += width * weighted(&|j| rates[j]);
            work += width * weighted(&|j| nodes[j].sine_squared * panel.omega[j]);
        }
        work
    }

    pub(crate) fn panels(&self) -> &[Panel] {
        &self.panels[..self.used]
    }

    pub(crate) fn duration(&self) -> f64 {
        self.panels().iter().map(Panel::duration).sum()
    }

    /// Passes the nodes to `node` in the order of time.
    pub(crate) fn visit(&self, mut node: impl FnMut(Waypoint)) {
        let mut before = 0.0;
        for panel in self.panels() {
            let (shares, times) = (panel.shares(), panel.times());
            let speeds: [f64; NODES] =
                core::array::from_fn(|i| libm::sqrt(shares[i].gone * shares[i].left) * panel.omega[i]);
            for (i, Tick { time, weight }) in times.into_iter().enumerate() {
                node(Waypoint { share: shares[i].gone, speed: speeds[i], time: before + time, weight });
            }
            before += panel.duration();
        }
    }

    /// The clock of the half cycle, for output at times within it.
    pub(crate) fn clock(&self) -> PhaseClock {
        let clocks = core::array::from_fn(|i| Clock::new(&self.panels[i.min(self.used - 1)]));
        PhaseClock { clocks, used: self.used }
    }
}

/// Phase and Ω as functions of time over a whole half cycle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PhaseClock {
    clocks: [Clock; PANELS],
    used: usize,
}

impl PhaseClock {
    /// Phase and Ω at the time `t` after the start.
    pub(crate) fn at(&self, t: f64) -> Reading {
        let mut left = t;
        for clock in &self.clocks[..self.used - 1] {
            if left <= clock.duration {
                return clock.phase_at(left);
            }
            left -= clock.duration;
        }
        self.clocks[self.used - 1].phase_at(left)
    }
}
