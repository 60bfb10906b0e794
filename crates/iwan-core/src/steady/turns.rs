//! All angles at which a steady motion turns round, found with certainty.
//!
//! A stretch (interval of angles) is settled in two cases. Taylor's theorem, with the bound of the third derivative, excludes a zero of the
//! slope in it; or it shows that the slope is monotone, so that the signs at the ends decide. Every other stretch is halved.

use super::harmonics::{Course, MOST_HARMONICS, bracketed};
use core::f64::consts::PI;

/// Largest number of turning points in one period: the slope has at most twice the highest harmonic as zeros.
pub(super) const MOST_TURNS: usize = 2 * MOST_HARMONICS;

/// Number of stretches per harmonic and period at the beginning. With fewer, the fundamental alone requires halving; with more, most
/// stretches are settled at once and computed in vain.
const STRETCHES: usize = 4;

/// Stretches shorter than this (rad) are judged by the signs at their ends. A pair of turning points hidden in such a stretch makes a loop
/// of 1e-21 of the third derivative, which is below rounding.
const SHORTEST: f64 = 1e-7;

/// Angles at which a motion turns round, ascending.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turns {
    pub(super) angles: [f64; MOST_TURNS + 2],
    pub(super) count: usize,
}

impl Turns {
    pub(super) const NONE: Self = Self { angles: [0.0; MOST_TURNS + 2], count: 0 };

    pub(super) fn found(&self) -> &[f64] {
        &self.angles[..self.count]
    }

    fn add(&mut self, angle: f64) {
        // Turning points in excess of the possible number come from rounding; the first ones are kept.
        if self.count < MOST_TURNS {
            self.angles[self.count] = angle;
            self.count += 1;
        }
    }

    /// Finds the turning points of one period from the angle 0 on (of half a period with odd harmonics).
    pub(super) fn find(&mut self, course: &Course<'_>) {
        self.count = 0;
        let harmonics = course.harmonics;
        let count = STRETCHES * harmonics.highest().max(2) / if harmonics.is_odd() { 2 } else { 1 };
        let width = harmonics.period() / count as f64;
        let first = Edge::at(course, 0.0);
        let mut low = first;
        for i in 1..=count {
            let mut high = Edge::at(course, i as f64 * width);
            if i == count {
                // The period closes here: a turning point at the seam must be found once, whatever rounding makes of the slope.
                high.falls = first.falls != harmonics.is_odd();
            }
            self.search(course, low, high);
            low = high;
        }
    }

    /// Finds the turning points between two angles, by halving until each stretch is settled.
    fn search(&mut self, course: &Course<'_>, from: Edge, to: Edge) {
        // Upper ends of the stretches that wait, the next one on top. Halving from STRETCHES per harmonic down to SHORTEST takes 24 rounds.
        let mut waiting = [to; 32];
        let (mut depth, mut low) = (1, from);
        while depth > 0 {
            let high = waiting[depth - 1];
            let half = 0.5 * (high.angle - low.angle);
            let curved = course.third * half;
            let middle = Edge::at(course, low.angle + half);
            let still = middle.slope.abs() > (middle.curvature.abs() + 0.5 * curved) * half;
            let monotone = middle.curvature.abs() > curved || half < SHORTEST || depth == waiting.len();
            if still || monotone {
                if !still && low.falls != high.falls {
                    self.add(root(course, low, high));
                }
                low = high;
                depth -= 1;
            } else {
                waiting[depth] = middle;
                depth += 1;
            }
        }
    }
}

/// One end of a stretch.
#[derive(Debug, Clone, Copy)]
struct Edge {
    angle: f64,
    slope: f64,
    curvature: f64,
    /// Whether the motion falls at this end; at rest it counts as not falling.
    falls: bool,
}

impl Edge {
    fn at(course: &Course<'_>, angle: f64) -> Self {
        let local = course.at(angle);
        let falls = local.slope < 0.0;
        Self { angle, slope: local.slope, curvature: local.curvature, falls }
    }
}

/// The zero of the slope between two ends where its signs differ.
fn root(course: &Course<'_>, low: Edge, high: Edge) -> f64 {
    let sign = if high.falls { -1.0 } else { 1.0 };
    bracketed(low.angle, high.angle, |angle| {
        let local = course.at(angle);
        (sign * local.slope, sign * local.curvature)
    })
}

/// Index of the turning point with the largest excursion from zero, and the displacement there.
pub(super) fn farthest(course: &Course<'_>, turns: &[f64]) -> (usize, f64) {
    let mut best = (0, 0.0_f64);
    for (index, &angle) in turns.iter().enumerate() {
        let value = course.at(angle).value;
        if index == 0 || value.abs() > best.1.abs() {
            best = (index, value);
        }
    }
    best
}

/// Rotates the turning points into the order in which the motion meets them, beginning with the one at `index`; that one is repeated at the
/// end, one period later.
pub(super) fn from_turn(course: &Course<'_>, turns: &mut Turns, index: usize) {
    let (count, period) = (turns.count, course.harmonics.period());
    turns.angles[..count].rotate_left(index);
    for angle in &mut turns.angles[count - index..count] {
        *angle += period;
    }
    turns.angles[count] = turns.angles[0] + period;
    turns.count = count + 1;
    debug_assert!(turns.angles[0] <= 2.0 * PI);
}
