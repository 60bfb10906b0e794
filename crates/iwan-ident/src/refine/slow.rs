//! Half cycles of a slow decay: smooth functions of the amplitude, taken from a table.
//!
//! In micro-slip one half cycle follows from the amplitude alone (the tip of its loop has settled next to the virgin curve), in
//! macro-slip as well (the tip lies on it), and all it gives (the amplitude after it, its duration, its moments) changes
//! smoothly with the logarithm of the amplitude, but for a bend between the two. So the map is computed at a few amplitudes and interpolated by
//! polynomials; the decay still goes from half cycle to half cycle.

use iwan_core::{Decay, FourParameter, Motion, Oscillator, Reversal};
use rustfft::num_complex::Complex64;

/// Spacing of the table in the logarithm of the amplitude in micro-slip, where powers of the amplitude are all there is: amplitudes of a
/// record of a thousand cycles are then right to 3e-5, from micro-slip on to 2e-6 (the test in `windows`), …
const SPACING: f64 = 0.24;
/// … and in macro-slip at most, where they change with the distance from φ_max.
const SPACING_IN_MACRO_SLIP: f64 = 0.12;
/// Nodes of an interpolating polynomial. With four in place of six a third of the spacing had been needed.
const POINTS: usize = 6;
/// Half cycles before the one that is tabulated: the tip of the loop has settled by then to second order in the loss of a half cycle.
const SETTLING: usize = 3;

/// How far above the first amplitude a table begins: more than the half cycles before a node take.
const ABOVE: f64 = 0.03;
/// Fastest decay, in the logarithm of the amplitude per half cycle, for which tips of loops in micro-slip count as settled.
/// In micro-slip the amplitudes of the test in `windows` are then off by 2e-6 at most; with half as much as this by 2e-7 to 1e-6, and faster decays would be computed one by one.
pub(super) const FASTEST: f64 = 0.018;
/// The same at φ_max for tables in macro-slip, of which no half cycle shall end without slipping as a whole.
pub(super) const FASTEST_IN_MACRO_SLIP: f64 = 0.06;

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

/// Numbers in a half cycle.
const VALUES: usize = 10;

impl HalfCycle {
    fn values(&self) -> [f64; VALUES] {
        let [a, b, c, d] = self.moments;
        [self.growth, self.duration, a.re, a.im, b.re, b.im, c.re, c.im, d.re, d.im]
    }

    fn of(v: &[f64; VALUES]) -> Self {
        let moments = std::array::from_fn(|i| Complex64::new(v[2 + 2 * i], v[3 + 2 * i]));
        Self { growth: v[0], duration: v[1], moments }
    }
}

/// The polynomial through neighbouring nodes, in Newton's form, and the logarithms between which it is taken.
struct Piece {
    places: [f64; POINTS],
    differences: [[f64; VALUES]; POINTS],
    from: f64,
    to: f64,
}

impl Piece {
    /// Through the nodes from `first` on, for the logarithms from that of node `middle` to the next one's.
    fn new(nodes: &[(f64, HalfCycle)], first: usize, middle: usize) -> Self {
        let through = &nodes[first..first + POINTS];
        let places: [f64; POINTS] = std::array::from_fn(|i| through[i].0);
        let mut differences: [[f64; VALUES]; POINTS] = std::array::from_fn(|i| through[i].1.values());
        for order in 1..POINTS {
            for i in (order..POINTS).rev() {
                let over = 1.0 / (places[i] - places[i - order]);
                differences[i] = std::array::from_fn(|k| (differences[i][k] - differences[i - 1][k]) * over);
            }
        }
        Self { places, differences, from: nodes[middle].0, to: nodes[middle + 1].0 }
    }

    fn at(&self, log: f64) -> HalfCycle {
        let mut sum = self.differences[POINTS - 1];
        for (place, difference) in self.places.iter().zip(&self.differences).rev().skip(1) {
            let late = log - place;
            sum.iter_mut().zip(difference).for_each(|(s, d)| *s = *s * late + d);
        }
        HalfCycle::of(&sum)
    }
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
    /// The last decay, which the next one takes the place of.
    decay: Option<Decay<'a, FourParameter, [Reversal; SETTLING + 8]>>,
    /// Adds a node to moments.
    add: F,
    /// Logarithms of the amplitudes, falling, and what the half cycles are.
    nodes: Vec<(f64, HalfCycle)>,
    /// Where the next node is begun, and the distance to the one behind it.
    next: f64,
    spacing: f64,
    /// That of the last half cycle asked for.
    piece: Option<Piece>,
    /// No node is begun below; none in micro-slip.
    floor: Option<f64>,
    /// Whether a half cycle had no end or did not decay.
    failed: bool,
}

impl<'a, F: FnMut(Moment, &mut [Complex64; 4])> Table<'a, F> {
    /// From the logarithm of an amplitude downwards: in macro-slip to the logarithm `floor` at most, in micro-slip without end.
    pub(super) fn below(
        oscillator: &Oscillator,
        joint: &'a FourParameter,
        log: f64,
        floor: Option<f64>,
        add: F,
    ) -> Self {
        let (held, stack) = (Motion::held_at(log.exp()), [Reversal::default(); SETTLING + 8]);
        Self {
            decay: Decay::new(oscillator, joint, 0.0, held, stack).ok(),
            add,
            nodes: vec![],
            next: log + ABOVE,
            // Down to the floor there is room for as many nodes as a polynomial needs.
            spacing: floor
                .map_or(SPACING, |end| SPACING_IN_MACRO_SLIP.min((log + ABOVE - end) / POINTS as f64)),
            piece: None,
            floor,
            failed: false,
        }
    }

    /// Whether all half cycles so far were those of a decay.
    pub(super) fn decays(&self) -> bool {
        !self.failed
    }

    /// The half cycle that begins at the logarithm of an amplitude, not above that of the last call; none below the floor, where
    /// a half cycle takes more than the table's step, and where there is no decay.
    pub(super) fn at(&mut self, log: f64) -> Option<HalfCycle> {
        if let Some(piece) = self.piece.as_ref().filter(|p| log <= p.from && log > p.to) {
            return Some(piece.at(log));
        }
        // As many nodes below the place as above it, where the table goes on so far.
        let wanted = |table: &Self| table.nodes.iter().filter(|n| n.0 < log).count() < POINTS / 2;
        while self.nodes.len() < POINTS || wanted(self) {
            if self.floor.is_some_and(|floor| self.next < floor) {
                break;
            }
            let node = self.node(self.next);
            self.failed = node.is_none();
            let slow = |growth: f64| self.floor.is_some() || growth > -2.0 * FASTEST;
            let node = node.filter(|n| slow(n.1.growth) && (!self.nodes.is_empty() || n.0 >= log))?;
            self.nodes.push(node);
            self.next -= self.spacing;
        }
        let last = self.nodes.len().checked_sub(1).filter(|last| *last + 1 >= POINTS)?;
        let middle = self.nodes.iter().rposition(|n| n.0 >= log).filter(|i| *i < last)?;
        let first = (middle + 1).saturating_sub(POINTS / 2).min(last + 1 - POINTS);
        let piece = self.piece.insert(Piece::new(&self.nodes, first, middle));
        Some(piece.at(log))
    }

    /// The half cycle computed: in micro-slip after some that let the tip of the loop settle, and the mean of two, as the tips
    /// alternate about where they settle. In macro-slip the tip lies on the virgin curve from the first on.
    fn node(&mut self, log: f64) -> Option<(f64, HalfCycle)> {
        let mut decay = self.decay.take()?.anew(Motion::held_at(log.exp())).ok()?;
        let (settling, count) = if self.floor.is_some() { (0, 1) } else { (SETTLING, 2) };
        let (mut from, mut began) = (log.exp(), 0.0);
        for _ in 0..settling {
            let turned = decay.next()?;
            (from, began) = (turned.displacement, turned.time);
        }
        let (mut mean, mut middle, part) = (HalfCycle::default(), 0.0, 1.0 / f64::from(count));
        for _ in 0..count {
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
            middle += part * from.abs().ln();
            mean.growth += part * (turned.displacement / from).abs().ln();
            mean.duration += part * (turned.time - began);
            mean.moments.iter_mut().zip(moments).for_each(|(m, one)| *m += part * one);
            (from, began) = (turned.displacement, turned.time);
        }
        self.decay = Some(decay);
        let known = mean.growth.is_finite() && mean.growth < 0.0;
        known.then_some((middle, mean))
    }
}
