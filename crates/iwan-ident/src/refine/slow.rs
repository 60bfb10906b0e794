//! Half cycles of a slow decay: smooth functions of the amplitude, taken from a table.
//!
//! In micro-slip one half cycle follows from the amplitude alone (the tip of its loop has settled next to the virgin curve), in
//! macro-slip as well (the tip lies on it), and all it gives (the amplitude after it, its duration, its moments) changes
//! smoothly with the logarithm of the amplitude, but for a bend between the two. So the map is computed at a few amplitudes and interpolated by cubics; the decay still goes from half cycle to half cycle.

use iwan_core::{Decay, FourParameter, Motion, Oscillator, Reversal};
use rustfft::num_complex::Complex64;

/// Spacing of the table in the logarithm of the amplitude: amplitudes of a record of a thousand cycles are then right to 5e-6 (the test in `windows`).
const SPACING: f64 = 0.08;
/// Half cycles before the one that is tabulated: the tip of the loop has settled by then to second order in the loss of a half cycle.
const SETTLING: usize = 3;

/// How far above the first amplitude a table begins: more than the half cycles before a node take.
const ABOVE: f64 = 0.03;
/// Fastest decay, in the logarithm of the amplitude per half cycle, for which tips of loops count as settled.
pub(super) const FASTEST: f64 = 0.004;

/// What a half cycle is.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct HalfCycle {
    /// Change of the logarithm of the amplitude.
    pub(super) growth: f64,
    /// Seconds.
    pub(super) duration: f64,
    /// Integrals of x e^(-iω_r (t - m)) (t - m)^k about m, a quarter of the reference period behind the beginning; of a half cycle
    /// that begins at a positive displacement.
    pub(super) moments: [Complex64; 4],
}

/// A node of a half cycle for the moments: seconds from its beginning, displacement, velocity, weight.
pub(super) struct Moment {
    pub(super) late: f64,
    pub(super) displacement: f64,
    pub(super) velocity: f64,
    pub(super) weight: f64,
}

/// Half cycles by amplitude, computed as they are asked for.
pub(super) struct Table<'a, F> {
    oscillator: &'a Oscillator,
    joint: &'a FourParameter,
    /// Adds a node to moments.
    add: F,
    /// Logarithms of the amplitudes, falling, and what the half cycles are.
    nodes: Vec<(f64, HalfCycle)>,
    /// Where the next node is begun.
    next: f64,
    /// No node is begun below.
    floor: f64,
    /// Whether a half cycle had no end or did not decay.
    failed: bool,
    stack: [Reversal; SETTLING + 8],
}

impl<'a, F: FnMut(Moment, &mut [Complex64; 4])> Table<'a, F> {
    /// From the logarithm of an amplitude downwards, to `floor` at most.
    pub(super) fn below(
        oscillator: &'a Oscillator,
        joint: &'a FourParameter,
        log: f64,
        floor: f64,
        add: F,
    ) -> Self {
        let stack = [Reversal::default(); SETTLING + 8];
        Self { oscillator, joint, add, nodes: vec![], next: log + ABOVE, floor, failed: false, stack }
    }

    /// Whether all half cycles so far were those of a decay.
    pub(super) fn decays(&self) -> bool {
        !self.failed
    }

    /// The half cycle that begins at the logarithm of an amplitude, not above that of the last call; none below the floor, where
    /// a half cycle takes more than the table's step, and where there is no decay.
    pub(super) fn at(&mut self, log: f64) -> Option<HalfCycle> {
        while self.nodes.len() < 4 || self.nodes[self.nodes.len() - 2].0 > log {
            if self.next < self.floor {
                return None;
            }
            let node = self.node(self.next);
            self.failed = node.is_none();
            let node =
                node.filter(|n| n.1.growth > -2.0 * FASTEST && (!self.nodes.is_empty() || n.0 >= log))?;
            self.nodes.push(node);
            self.next -= SPACING;
        }
        let last = self.nodes.len() - 1;
        let i = self.nodes.iter().rposition(|n| n.0 >= log).unwrap_or(0).clamp(1, last - 2);
        let four = &self.nodes[i - 1..i + 3];
        // Lagrange's cubic through the four nodes about the place.
        let weight = |j: usize| {
            (0..4).filter(|k| *k != j).fold(1.0, |w, k| w * (log - four[k].0) / (four[j].0 - four[k].0))
        };
        let mut half = HalfCycle::default();
        for (j, (_, node)) in four.iter().enumerate() {
            let w = weight(j);
            half.growth += w * node.growth;
            half.duration += w * node.duration;
            half.moments.iter_mut().zip(node.moments).for_each(|(m, n)| *m += w * n);
        }
        Some(half)
    }

    /// The half cycle computed: after some that let the tip of the loop settle.
    fn node(&mut self, log: f64) -> Option<(f64, HalfCycle)> {
        let held = Motion::held_at(log.exp());
        let mut decay = Decay::new(self.oscillator, self.joint, 0.0, held, self.stack.as_mut_slice()).ok()?;
        let (mut from, mut began) = (log.exp(), 0.0);
        for _ in 0..SETTLING {
            let turned = decay.next()?;
            (from, began) = (turned.displacement, turned.time);
        }
        // The mean of two half cycles: the tips of the loops alternate about where they settle.
        let (mut mean, mut middle) = (HalfCycle::default(), 0.0);
        for _ in 0..2 {
            let (mut moments, sign, add) = ([Complex64::default(); 4], from.signum(), &mut self.add);
            let turned = decay.next_with(|n| {
                let node = Moment {
                    late: n.time - began,
                    displacement: sign * n.displacement,
                    velocity: sign * n.velocity,
                    weight: n.weight,
                };
                add(node, &mut moments);
            })?;
            middle += 0.5 * from.abs().ln();
            mean.growth += 0.5 * (turned.displacement / from).abs().ln();
            mean.duration += 0.5 * (turned.time - began);
            mean.moments.iter_mut().zip(moments).for_each(|(m, one)| *m += 0.5 * one);
            (from, began) = (turned.displacement, turned.time);
        }
        let known = mean.growth.is_finite() && mean.growth < 0.0;
        known.then_some((middle, mean))
    }
}
