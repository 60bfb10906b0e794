//! Half cycles of a slow decay: smooth functions of the amplitude, taken from a table.
//!
//! In micro-slip one half cycle follows from the amplitude alone (the tip of its loop has settled next to the virgin curve), in
//! macro-slip as well (the tip lies on it), and all it gives (the amplitude after it, its duration, its moments) changes
//! smoothly with the logarithm of the amplitude, but for a bend between the two. So the map is computed at a few amplitudes and interpolated by
//! polynomials; the decay still goes from half cycle to half cycle.

use std::collections::VecDeque;

use iwan_core::{Decay, FourParameter, HalfCycleTables, Motion, Oscillator, Reversal};
use rustfft::num_complex::Complex64;

use crate::curves::Quantity;
use crate::parameters::{COUNT, Parameters};

/// Spacing of the table in the logarithm of the amplitude in micro-slip, where powers of the amplitude are all there is: a slow decay of a thousand cycles is
/// then right to 1e-6 (the test in `windows`), …
const SPACING: f64 = 0.24;
/// … and in macro-slip at most, where they change with the distance from φ_max.
const SPACING_IN_MACRO_SLIP: f64 = 0.12;
/// Nodes of an interpolating polynomial. With four in place of six a third of the spacing had been needed.
const POINTS: usize = 6;
/// Half cycles before the one that is tabulated: the tip of the loop has settled by then to second order in the loss of a half cycle.
const SETTLING: usize = 3;

/// Amplitude over φ_max at which a table in micro-slip begins: the loops of its first node stay below φ_max.
pub(super) const TOP: f64 = 0.99;
/// Nodes in micro-slip at most: down to e^-1440 times the first amplitude, further than numbers reach.
const MOST: usize = 6000;
/// How far above the first amplitude a table in macro-slip begins: it ends above φ_max, whatever rounding does to its first amplitude.
const ABOVE: f64 = 0.03;
/// Half cycles by whose decay a node of micro-slip lies below the amplitude at which it was begun, and one more.
pub(super) const BELOW: f64 = SETTLING as f64 + 2.0;
/// Fastest decay, in the logarithm of the amplitude per half cycle, for which tips of loops in micro-slip count as settled.
/// Amplitudes of the test in `windows` are then off by 1.2e-5 at most, 5e-6 to 8e-6 from micro-slip on; with half as much as this by half as much there, and faster
/// decays would be computed one by one.
pub(super) const FASTEST: f64 = 0.008;
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
#[derive(Debug, Clone, Copy)]
struct Piece {
    places: [f64; POINTS],
    differences: [[f64; VALUES]; POINTS],
    from: f64,
    to: f64,
}

impl Piece {
    /// Through nodes, for the logarithms from that of node `middle` to the next one's.
    fn new(through: &[Node; POINTS], middle: usize) -> Self {
        let places: [f64; POINTS] = std::array::from_fn(|i| through[i].0);
        let mut differences: [[f64; VALUES]; POINTS] = std::array::from_fn(|i| through[i].1.values());
        for order in 1..POINTS {
            for i in (order..POINTS).rev() {
                let over = 1.0 / (places[i] - places[i - order]);
                differences[i] = std::array::from_fn(|k| (differences[i][k] - differences[i - 1][k]) * over);
            }
        }
        Self { places, differences, from: places[middle], to: places[middle + 1] }
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

/// Half cycles at a few amplitudes, each computed when it is first asked for.
#[derive(Debug, Clone)]
pub(super) struct Nodes {
    /// Logarithm of the amplitude at which the first node is begun, and the distance to the next.
    top: f64,
    spacing: f64,
    /// Number of nodes.
    count: usize,
    in_macro_slip: bool,
    /// By ascending place.
    known: Vec<Known>,
    /// Between a node and the next one, where it was asked for.
    pieces: Vec<Option<Piece>>,
}

/// The logarithm of an amplitude, and the half cycle that begins there.
type Node = (f64, HalfCycle);

/// What is known of a node.
#[derive(Debug, Clone, Copy)]
enum Known {
    NotYet,
    /// Its half cycle is none of a slow decay.
    Unfit,
    Node(Node),
}

impl Nodes {
    /// From φ_max downwards: the same nodes for every decay of an oscillator in micro-slip.
    pub(super) fn in_micro_slip(phi_max: f64) -> Self {
        let top = (TOP * phi_max).ln();
        Self { top, spacing: SPACING, count: MOST, in_macro_slip: false, known: vec![], pieces: vec![] }
    }

    /// From the logarithm of an amplitude down to the logarithm `floor`.
    pub(super) fn in_macro_slip(log: f64, floor: f64) -> Self {
        let top = log + ABOVE;
        // Down to the floor there is room for as many nodes as a polynomial needs.
        let spacing = SPACING_IN_MACRO_SLIP.min((top - floor) / POINTS as f64);
        let count = ((top - floor) / spacing) as usize + 1;
        Self { top, spacing, count, in_macro_slip: true, known: vec![], pieces: vec![] }
    }
}

/// What computations of models work in, and half cycles that they have in common.
#[derive(Debug, Clone, Default)]
pub(in crate::refine) struct Buffers {
    pub(super) stack: Vec<Reversal>,
    /// Of the models that were computed last.
    tables: VecDeque<(TableOf, Nodes)>,
    commons: VecDeque<(Parameters, Common)>,
}

/// A model, and what its half cycles are found from.
#[derive(Debug, Clone, Copy)]
pub(super) struct Common {
    pub(super) oscillator: Oscillator,
    pub(super) joint: FourParameter,
    pub(super) tables: HalfCycleTables,
}

/// What the half cycles of a table in micro-slip depend on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct TableOf {
    pub(super) parameters: Parameters,
    pub(super) omega: f64,
    pub(super) quantity: Quantity,
}

/// Tables that are kept: those of a point of a search, of its neighbours along each of the parameters, and one to spare.
pub(in crate::refine) const KEPT: usize = COUNT + 2;

impl Buffers {
    /// The model of parameters, known where it was met before; none where they are no model.
    pub(super) fn common(&mut self, parameters: &Parameters) -> Option<Common> {
        if let Some((_, common)) = self.commons.iter().find(|(known, _)| known == parameters) {
            return Some(*common);
        }
        let (oscillator, joint) = parameters.model().ok()?;
        let common = Common { oscillator, joint, tables: HalfCycleTables::new(&oscillator, &joint) };
        if self.commons.len() >= KEPT {
            self.commons.pop_front();
        }
        self.commons.push_back((*parameters, common));
        Some(common)
    }

    /// The nodes of a table in micro-slip, those of the same model where it was met before.
    pub(super) fn nodes(&mut self, of: TableOf, phi_max: f64) -> Nodes {
        let place = self.tables.iter().position(|(known, _)| *known == of);
        let known = place.and_then(|i| self.tables.remove(i));
        known.map_or_else(|| Nodes::in_micro_slip(phi_max), |(_, nodes)| nodes)
    }

    /// Keeps nodes for the next decay of the same model; the table that was not used for longest makes room.
    pub(super) fn keep(&mut self, of: TableOf, nodes: Nodes) {
        if self.tables.len() >= KEPT {
            self.tables.pop_front();
        }
        self.tables.push_back((of, nodes));
    }

    /// Number of tables that are kept.
    #[cfg(test)]
    pub(super) fn kept(&self) -> usize {
        self.tables.len()
    }
}

/// Half cycles by amplitude for the decay of one oscillator.
pub(super) struct Table<'a, F> {
    nodes: &'a mut Nodes,
    oscillator: &'a Oscillator,
    joint: &'a FourParameter,
    tables: &'a HalfCycleTables,
    /// The last decay, which the next one takes the place of.
    decay: Option<Decay<'a, FourParameter, [Reversal; SETTLING + 8]>>,
    /// Adds a node to moments.
    add: F,
    /// Place of that of the last half cycle asked for.
    piece: Option<usize>,
}

impl<'a, F: FnMut(Moment, &mut [Complex64; 4])> Table<'a, F> {
    /// By nodes that may serve several decays of the same oscillator and joint, with the same moments.
    pub(super) fn new(
        nodes: &'a mut Nodes,
        (oscillator, joint, tables): (&'a Oscillator, &'a FourParameter, &'a HalfCycleTables),
        add: F,
    ) -> Self {
        Self { nodes, oscillator, joint, tables, decay: None, add, piece: None }
    }

    /// The polynomial of a place.
    fn piece(&self, place: usize) -> Option<&Piece> {
        self.nodes.pieces.get(place)?.as_ref()
    }

    /// The half cycle that begins at the logarithm of an amplitude; none above the first node and below the last, and where half cycles are none of a slow decay.
    pub(super) fn at(&mut self, log: f64) -> Option<HalfCycle> {
        let last = self.piece.and_then(|place| self.piece(place));
        if let Some(piece) = last.filter(|p| log <= p.from && log > p.to) {
            return Some(piece.at(log));
        }
        // A node lies at the amplitude at which it was begun, or below it by less than the spacing.
        let begun = (self.nodes.top - log) / self.nodes.spacing;
        let begun = if begun >= 0.0 { begun as usize } else { return None };
        let is_above = |table: &mut Self, i: usize| table.node(i).is_some_and(|n| n.0 >= log);
        let above = [Some(begun), begun.checked_sub(1)].into_iter().flatten().find(|i| is_above(self, *i))?;
        self.piece = Some(above);
        if let Some(piece) = self.piece(above) {
            return (log > piece.to).then(|| piece.at(log));
        }
        // As many nodes below the place as above it, where the table goes so far.
        let highest = self.nodes.count.checked_sub(POINTS)?;
        let first = (above + 1).saturating_sub(POINTS / 2).min(highest);
        let first = (first..=above.min(highest)).find(|i| self.node(*i).is_some())?;
        let mut through = [Node::default(); POINTS];
        for (i, node) in through.iter_mut().enumerate() {
            *node = self.node(first + i)?;
        }
        let middle = (above - first).min(POINTS - 2);
        let piece = Piece::new(&through, middle);
        if self.nodes.pieces.len() <= above {
            self.nodes.pieces.resize(above + 1, None);
        }
        self.nodes.pieces[above] = Some(piece);
        (log > piece.to).then(|| piece.at(log))
    }

    /// A node, computed where it is asked for the first time.
    fn node(&mut self, i: usize) -> Option<Node> {
        if i >= self.nodes.count {
            return None;
        }
        if self.nodes.known.len() <= i {
            self.nodes.known.resize(i + 1, Known::NotYet);
        }
        match self.nodes.known[i] {
            Known::Node(node) => return Some(node),
            Known::Unfit => return None,
            Known::NotYet => {}
        }
        let node = self.computed(self.nodes.top - self.nodes.spacing * i as f64);
        let slow = |growth: f64| self.nodes.in_macro_slip || growth > -2.0 * FASTEST;
        let node = node.filter(|n| slow(n.1.growth));
        self.nodes.known[i] = node.map_or(Known::Unfit, Known::Node);
        node
    }

    /// The half cycle computed: in micro-slip after some that let the tip of the loop settle, and the mean of two, as the tips
    /// alternate about where they settle. In macro-slip the tip lies on the virgin curve from the first on.
    fn computed(&mut self, log: f64) -> Option<Node> {
        let held = Motion::held_at(log.exp());
        let mut decay = if let Some(decay) = self.decay.take() {
            decay.anew(held).ok()?
        } else {
            let stack = [Reversal::default(); SETTLING + 8];
            Decay::with_tables(self.oscillator, self.joint, self.tables, held, stack).ok()?
        };
        let (settling, count) = if self.nodes.in_macro_slip { (0, 1) } else { (SETTLING, 2) };
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
