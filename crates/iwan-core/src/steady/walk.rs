//! The walk through one period of a steady motion, along the branches of its loop: turning points, closed loops, corners of the law.

use super::harmonics::{Course, Harmonics, MOST_COEFFICIENTS, MOST_HARMONICS};
use super::panel::{FASTEST, FASTEST_CROWDED, LONGEST, Panel, Stretch, Sums};
use super::turns::{MOST_TURNS, Turns};
use crate::law::Backbone;
use crate::memory::{Branch, Reversal};

/// Largest number of reversals remembered at once: all turning points of a period.
const MOST_DEPTH: usize = MOST_TURNS + 1;

/// A vector with one entry per coefficient of the motion.
type Vector = [f64; MOST_COEFFICIENTS];

/// Contribution of the branch behind one reversal to the derivatives of the force's coefficients: the sum of two products of two vectors
/// each.
#[derive(Debug, Clone, Copy)]
struct Level {
    reversal: Reversal,
    direction: f64,
    /// Derivatives of the force at the reversal.
    slope: Vector,
    /// The shapes cos nθ, sin nθ at the reversal.
    shapes: Vector,
    /// ∫ e^(inθ) along the branch.
    length: [[f64; 2]; MOST_HARMONICS + 1],
    /// ∫ K e^(inθ) along the branch.
    tangent: [[f64; 2]; MOST_HARMONICS + 1],
}

impl Level {
    const NONE: Self = Self {
        reversal: Reversal::NONE,
        direction: 0.0,
        slope: [0.0; MOST_COEFFICIENTS],
        shapes: [0.0; MOST_COEFFICIENTS],
        length: [[0.0; 2]; MOST_HARMONICS + 1],
        tangent: [[0.0; 2]; MOST_HARMONICS + 1],
    };
}

/// Working memory for the computation of steady loops: 130 kB of fixed size. Make it once and reuse it.
#[derive(Debug, Clone)]
pub struct SteadyWork {
    pub(super) turns: Turns,
    levels: [Level; MOST_DEPTH],
    /// Integrals over the period.
    pub(super) sums: Sums,
    /// Integrals over the present piece of a branch.
    piece: Sums,
}

impl SteadyWork {
    /// Memory for any steady loop.
    #[expect(clippy::large_stack_arrays, reason = "made once; the caller says where it lives")]
    #[must_use]
    pub const fn new() -> Self {
        Self { turns: Turns::NONE, levels: [Level::NONE; MOST_DEPTH], sums: Sums::ZERO, piece: Sums::ZERO }
    }
}

impl Default for SteadyWork {
    fn default() -> Self {
        Self::new()
    }
}

/// Quantities that stay the same along one period.
#[derive(Debug, Clone, Copy)]
pub(super) struct Walk<'a, B> {
    pub(super) law: &'a B,
    pub(super) course: Course<'a>,
    /// Size of the Legendre tail of the force below which a stretch is accurate enough.
    pub(super) tolerance: f64,
    pub(super) with_tangent: bool,
}

/// Part of the loop's softening below which a Legendre tail of the force is small enough. The rule integrates degrees up to 31 exactly, so
/// its error is about the square of the part that degree 15 still carries. With this value the errors in the tests stay below 1e-10 of the
/// slip force. A stretch with a larger tail is divided.
const SOFTENING_TAIL: f64 = 1e-6;

/// Factor on that limit where nodes are crowded at a turning point: there the force grows like s^(8χ+16), which has a large tail although
/// the rule integrates it.
const CROWDED_TAIL: f64 = 1e4;

/// Part of the loop's force, added to that limit for its rounding.
const FORCE_TAIL: f64 = 2e-14;

/// The limit of the tail for a loop of half width `reach`.
pub(super) fn tolerance<B: Backbone>(law: &B, reach: f64) -> f64 {
    let force = law.force(reach);
    SOFTENING_TAIL * (law.initial_stiffness() * reach - force).min(force) + FORCE_TAIL * force
}

/// Shortest stretch, as a part of its branch piece, that is still divided. At a corner within the law that the law's strengths do not
/// announce, the remaining error is of the order of this part.
const SHORTEST: f64 = 1e-9;

impl<B: Backbone> Walk<'_, B> {
    fn highest(&self) -> usize {
        self.course.harmonics.highest()
    }

    fn harmonics(&self) -> Harmonics {
        self.course.harmonics
    }

    /// Integrates along the period whose turning points are in `work.turns`, from the farthest one back to itself; adds the products of the
    /// branches to `jacobian`.
    pub(super) fn go(&self, work: &mut SteadyWork, jacobian: &mut [f64]) {
        let turns = work.turns;
        work.sums.clear(self.highest());
        let first = turns.angles[0];
        let u = self.course.at(first).value;
        let (force, tangent) = self.law.force_and_tangent(u.abs());
        let start = Reversal::new(u, force.copysign(u));
        self.open(&mut work.levels[0], start, first);
        let count = self.harmonics().len();
        let Level { slope, shapes, .. } = &mut work.levels[0];
        for (slope, shape) in slope[..count].iter_mut().zip(&shapes[..count]) {
            *slope = tangent * shape;
        }
        let mut depth = 0;
        for (index, ends) in turns.found().windows(2).enumerate() {
            if index > 0 {
                depth = self.turn(work, depth, ends[0]);
            }
            depth = self.arc(work, depth, [ends[0], ends[1]], jacobian);
        }
        for level in &work.levels[..=depth] {
            self.close(level, jacobian);
        }
    }

    /// Prepares a level for the branch behind a new reversal.
    fn open(&self, level: &mut Level, reversal: Reversal, angle: f64) {
        level.reversal = reversal;
        if self.with_tangent {
            self.harmonics().shapes(angle, &mut level.shapes);
            level.length[..=self.highest()].fill([0.0; 2]);
            level.tangent[..=self.highest()].fill([0.0; 2]);
        }
    }

    fn branch(level: &Level) -> Branch {
        Branch::behind(level.reversal, level.direction, level.direction * f64::INFINITY)
    }

    /// Starts a new branch where the motion turns round, on top of the one at `depth`; returns the new depth.
    fn turn(&self, work: &mut SteadyWork, depth: usize, angle: f64) -> usize {
        let (before, after) = work.levels.split_at_mut(depth + 1);
        let (from, Some(to)) = (&before[depth], after.first_mut()) else { return depth };
        let u = self.course.at(angle).value;
        let (force, tangent) = Self::branch(from).force_and_tangent(self.law, u);
        self.open(to, Reversal::new(u, force), angle);
        if self.with_tangent {
            for i in 0..self.harmonics().len() {
                to.slope[i] = from.slope[i] + tangent * (to.shapes[i] - from.shapes[i]);
            }
        }
        depth + 1
    }

    /// Follows the motion from one turning point to the next; returns the depth at the end.
    fn arc(&self, work: &mut SteadyWork, mut depth: usize, ends: [f64; 2], jacobian: &mut [f64]) -> usize {
        let [mut at, end] = ends;
        let last = self.course.at(end).value;
        work.levels[depth].direction = if last < work.levels[depth].reversal.u { -1.0 } else { 1.0 };
        let direction = work.levels[depth].direction;
        // The branch behind the reversal number n > 1 ends at the displacement of the reversal before it; there both are forgotten.
        while depth > 1 && direction * (last - work.levels[depth - 1].reversal.u) > 0.0 {
            let closing = self.course.reaches(work.levels[depth - 1].reversal.u, at, end);
            self.piece(work, depth, [at, closing]);
            self.close(&work.levels[depth], jacobian);
            self.close(&work.levels[depth - 1], jacobian);
            depth -= 2;
            at = closing;
        }
        self.piece(work, depth, [at, end]);
        depth
    }

    /// Integrates along one branch, from corner to corner of the law.
    fn piece(&self, work: &mut SteadyWork, depth: usize, ends: [f64; 2]) {
        let [mut at, end] = ends;
        if end <= at {
            return;
        }
        let branch = Self::branch(&work.levels[depth]);
        work.piece.clear(self.highest());
        let way = [at, end].map(|angle| branch.virgin_distance(self.course.at(angle).value));
        let (weakest, strongest) = self.law.strengths();
        let mut crowded = true;
        for corner in [weakest, strongest] {
            if way[0] < corner && corner < way[1] {
                let target = branch.start.u + 2.0 * branch.direction * corner;
                let stop = self.course.reaches(target, at, end);
                self.smooth(&branch, [at, stop], crowded, &mut work.piece);
                (at, crowded) = (stop, false);
            }
        }
        self.smooth(&branch, [at, end], crowded, &mut work.piece);
        self.take(work, depth, ends);
    }

    /// Integrates along a piece without corners, in stretches as long as the rule allows.
    fn smooth(&self, branch: &Branch, ends: [f64; 2], mut crowded: bool, sums: &mut Sums) {
        let [mut at, end] = ends;
        let whole = end - at;
        if whole <= 0.0 {
            return;
        }
        let highest = self.highest() as f64;
        let longest = LONGEST.min(FASTEST / highest);
        let mut length = if crowded { (FASTEST_CROWDED / highest).min(0.5 * LONGEST) } else { longest };
        loop {
            let left = end - at;
            // The rest is divided evenly, so that no short stretch is left at the end.
            let now = if length < left { length.min(left / libm::ceil(left / length)) } else { left };
            let stretch = Stretch { start: at, length: now, crowded };
            let panel = Panel::evaluate(self.law, &self.course, branch, stretch);
            let tolerance = self.tolerance * if crowded { CROWDED_TAIL } else { 1.0 };
            if panel.tail() > tolerance && now > SHORTEST * whole {
                length = now * if crowded { 0.25 } else { 0.5 };
                continue;
            }
            panel.add(self.highest(), self.with_tangent, sums);
            at += now;
            if now >= left {
                return;
            }
            length = (2.0 * now).min(longest);
            crowded = false;
        }
    }

    /// Adds the integrals of a piece to those of the period and of the branch.
    fn take(&self, work: &mut SteadyWork, depth: usize, ends: [f64; 2]) {
        let (highest, piece, sums) = (self.highest(), &work.piece, &mut work.sums);
        for (sum, part) in sums.force[..=highest].iter_mut().zip(&piece.force) {
            *sum = [sum[0] + part[0], sum[1] + part[1]];
        }
        if !self.with_tangent {
            return;
        }
        for (sum, part) in sums.tangent[..=2 * highest].iter_mut().zip(&piece.tangent) {
            *sum = [sum[0] + part[0], sum[1] + part[1]];
        }
        let level = &mut work.levels[depth];
        let [from, to] = ends;
        for n in self.harmonics().orders() {
            let part = piece.tangent[n];
            level.tangent[n] = [level.tangent[n][0] + part[0], level.tangent[n][1] + part[1]];
            // ∫ e^(inθ) = (2/n) sin(n (to - from)/2) e^(in (to + from)/2).
            let order = n as f64;
            let size = if n == 0 { to - from } else { 2.0 / order * libm::sin(0.5 * order * (to - from)) };
            let (sine, cosine) = libm::sincos(0.5 * order * (to + from));
            level.length[n] = [level.length[n][0] + size * cosine, level.length[n][1] + size * sine];
        }
    }

    /// Clears a branch that the motion does not return to: adds its products to the derivatives of the force's coefficients.
    fn close(&self, level: &Level, jacobian: &mut [f64]) {
        if !self.with_tangent {
            return;
        }
        let (harmonics, count) = (self.harmonics(), self.harmonics().len());
        for n in harmonics.orders() {
            for part in 0..=usize::from(n > 0) {
                let row = &mut jacobian[(harmonics.index(n) + part) * count..][..count];
                let (length, tangent) = (level.length[n][part], level.tangent[n][part]);
                for ((entry, slope), shape) in row.iter_mut().zip(&level.slope).zip(&level.shapes) {
                    *entry += length * slope - tangent * shape;
                }
            }
        }
    }
}
