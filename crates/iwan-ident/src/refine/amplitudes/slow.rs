//! Half cycles of a slow decay: smooth functions of the amplitude, taken from a table.
//!
//! In micro-slip a half cycle follows from its amplitude alone, because the tip of its loop has settled next to the virgin curve; in macro-slip as
//! well, because the tip lies on that curve. All that a half cycle gives (the amplitude after it, its duration, its moments) changes smoothly with ln
//! amplitude, except for a bend between micro-slip and macro-slip. So half cycles are computed at a few amplitudes, the nodes of a table, and
//! interpolated by polynomials; the decay still goes from half cycle to half cycle.

use std::collections::VecDeque;

use iwan_core::{Decay, FourParameter, HalfCycleTables, Motion, Oscillator, Reversal};
use rustfft::num_complex::Complex64;

use crate::curves::Quantity;
use crate::parameters::{COUNT, Parameters};

/// Spacing of a table's nodes in ln amplitude in micro-slip, where half cycles depend on powers of the amplitude only: a slow decay of a thousand
/// cycles is then right to 1.5e-5 of its amplitudes (the test in `decay`), most of which is the settling of loops (see [`FASTEST`]).
const SPACING: f64 = 0.24;
/// Largest spacing of a table's nodes in ln amplitude in macro-slip, where half cycles change with the distance from φ_max.
const SPACING_IN_MACRO_SLIP: f64 = 0.12;
/// Nodes of an interpolating polynomial. Four nodes in place of six would have needed a third of the spacing.
const POINTS: usize = 6;
/// Half cycles that are computed before the tabulated ones in micro-slip: by then the tip of the loop has settled to second order in the loss of a
/// half cycle.
const SETTLING: usize = 3;

/// Amplitude over φ_max at which a table in micro-slip begins: the loops of its first node stay below φ_max.
pub(super) const TOP: f64 = 0.99;
/// Most nodes of a table in micro-slip: they reach down to e^-1440 times the first amplitude, further than floating-point numbers do.
const MOST: usize = 6000;
/// How far above the decay's first amplitude a table in macro-slip begins, in ln amplitude: rounding does not put that amplitude outside the table,
/// which ends above φ_max.
const ABOVE: f64 = 0.03;
/// Most half cycles by whose decay a node in micro-slip lies below the amplitude at which its computation begins, and one half cycle more.
pub(super) const BELOW: f64 = SETTLING as f64 + 2.0;
/// Fastest decay, in ln amplitude per half cycle, for which the tips of loops in micro-slip count as settled; faster decays are computed one by one.
/// Amplitudes of the test in `decay` are then off by 1.2e-5 at most, by 5e-6 to 8e-6 where the decay begins in micro-slip. Half this value would
/// halve the latter errors, and decays above it would be computed one by one.
pub(super) const FASTEST: f64 = 0.008;
/// Fastest decay at φ_max, in ln amplitude per half cycle, by a table in macro-slip, in which every half cycle shall end with the joint slipping as a
/// whole. At larger amplitudes the limit is lower by the factor φ_max over amplitude.
pub(super) const FASTEST_IN_MACRO_SLIP: f64 = 0.06;

/// What one half cycle, from turning point to turning point, does to the motion and adds to the windows.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct HalfCycle {
    /// Change of ln amplitude.
    pub(super) growth: f64,
    /// Duration, s.
    pub(super) duration: f64,
    /// Integrals of x e^(-iω_r (t - m)) (t - m)^k for k = 0 to 3, of a half cycle that begins at a positive displacement; m is a quarter of the
    /// reference period after its beginning.
    pub(super) moments: [Complex64; 4],
}

/// Real numbers in a half cycle: growth, duration and four complex moments.
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

/// The polynomial through neighbouring nodes in Newton's form (`places` in ln amplitude, divided `differences`), and the ln amplitudes `from` (upper)
/// and `to` (lower) between which it is used.
#[derive(Debug, Clone, Copy)]
struct Piece {
    places: [f64; POINTS],
    differences: [[f64; VALUES]; POINTS],
    from: f64,
    to: f64,
}

impl Piece {
    /// The polynomial through the nodes `through`, for ln amplitudes between node `middle` and the next one.
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

/// A node of the quadrature over a half cycle: seconds from the beginning of the half cycle, displacement, velocity, and weight in s.
pub(super) struct Moment {
    pub(super) late: f64,
    pub(super) displacement: f64,
    pub(super) velocity: f64,
    pub(super) weight: f64,
}

/// Half cycles at a few amplitudes, each computed when it is first asked for.
#[derive(Debug, Clone)]
pub(super) struct Nodes {
    /// ln amplitude at which the computation of the first node begins, and the distance to the next node in ln amplitude.
    top: f64,
    spacing: f64,
    /// Number of nodes.
    count: usize,
    in_macro_slip: bool,
    /// What is known of each node, from the largest amplitude on.
    known: Vec<Known>,
    /// The polynomial between each node and the next one, where it was asked for.
    pieces: Vec<Option<Piece>>,
}

/// The logarithm of an amplitude, and the half cycle that begins there.
type Node = (f64, HalfCycle);

/// What is known of a node.
#[derive(Debug, Clone, Copy)]
enum Known {
    NotYet,
    /// Its half cycle decays too fast for a table, or cannot be computed.
    Unfit,
    Node(Node),
}

impl Nodes {
    /// A table from φ_max downwards: the same nodes serve every decay of an oscillator in micro-slip.
    pub(super) fn in_micro_slip(phi_max: f64) -> Self {
        let top = (TOP * phi_max).ln();
        Self { top, spacing: SPACING, count: MOST, in_macro_slip: false, known: vec![], pieces: vec![] }
    }

    /// A table in macro-slip from the ln amplitude `log` down to the ln amplitude `floor`.
    pub(super) fn in_macro_slip(log: f64, floor: f64) -> Self {
        let top = log + ABOVE;
        // Above the floor there is room for as many nodes as a polynomial needs.
        let spacing = SPACING_IN_MACRO_SLIP.min((top - floor) / POINTS as f64);
        let count = ((top - floor) / spacing) as usize + 1;
        Self { top, spacing, count, in_macro_slip: true, known: vec![], pieces: vec![] }
    }
}

/// Buffers for the computation of models, and half cycles that several models have in common.
#[derive(Debug, Clone, Default)]
pub(in crate::refine) struct Buffers {
    pub(super) stack: Vec<Reversal>,
    /// Tables in micro-slip of the models that were computed last.
    tables: VecDeque<(TableOf, Nodes)>,
    commons: VecDeque<(Parameters, Common)>,
}

/// A model, and the tables from which its half cycles are found.
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

/// Tables and models that are kept: those at one point of a search, at its neighbours along each of the parameters, and one to spare. The oldest
/// makes room.
pub(in crate::refine) const KEPT: usize = COUNT + 2;

impl Buffers {
    /// The model of these parameters, taken from the kept ones where it is among them; none where the parameters are no model.
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

    /// The nodes of a table in micro-slip, those kept for the same model where there are any.
    pub(super) fn nodes(&mut self, of: TableOf, phi_max: f64) -> Nodes {
        let place = self.tables.iter().position(|(known, _)| *known == of);
        let known = place.and_then(|i| self.tables.remove(i));
        known.map_or_else(|| Nodes::in_micro_slip(phi_max), |(_, nodes)| nodes)
    }

    /// Keeps nodes for the next decay of the same model; the table that was unused for longest makes room.
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
    /// The decay that computed the last node; the next node takes over its buffers.
    decay: Option<Decay<'a, FourParameter, [Reversal; SETTLING + 8]>>,
    /// Adds a node of the quadrature to the moments of a half cycle.
    add: F,
    /// Place of the polynomial that gave the last half cycle.
    piece: Option<usize>,
}

impl<'a, F: FnMut(Moment, &mut [Complex64; 4])> Table<'a, F> {
    /// A table on nodes that may serve several decays of the same oscillator and joint with the same moments.
    pub(super) fn new(
        nodes: &'a mut Nodes,
        (oscillator, joint, tables): (&'a Oscillator, &'a FourParameter, &'a HalfCycleTables),
        add: F,
    ) -> Self {
        Self { nodes, oscillator, joint, tables, decay: None, add, piece: None }
    }

    /// The polynomial between node `place` and the next one, where it is known.
    fn piece(&self, place: usize) -> Option<&Piece> {
        self.nodes.pieces.get(place)?.as_ref()
    }

    /// The half cycle that begins at the ln amplitude `log`; none above the first node, below the last one, and where half cycles decay too fast for
    /// a table.
    pub(super) fn at(&mut self, log: f64) -> Option<HalfCycle> {
        let last = self.piece.and_then(|place| self.piece(place));
        if let Some(piece) = last.filter(|p| log <= p.from && log > p.to) {
            return Some(piece.at(log));
        }
        // A node lies at the amplitude at which its computation began, or below it by less than the spacing.
        let begun = (self.nodes.top - log) / self.nodes.spacing;
        let begun = if begun >= 0.0 { begun as usize } else { return None };
        let is_above = |table: &mut Self, i: usize| table.node(i).is_some_and(|n| n.0 >= log);
        let above = [Some(begun), begun.checked_sub(1)].into_iter().flatten().find(|i| is_above(self, *i))?;
        self.piece = Some(above);
        if let Some(piece) = self.piece(above) {
            return (log > piece.to).then(|| piece.at(log));
        }
        // As many nodes below `log` as above it, where the table goes so far.
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

    /// Node `i`, computed when it is first asked for; none where it is unfit for a table.
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

    /// Computes the half cycle at the ln amplitude `log`. In micro-slip a few half cycles first let the tip of the loop settle, and the mean of the
    /// next two is taken, because tips alternate about the curve on which they settle. In macro-slip the tip lies on the virgin curve from the first
    /// half cycle on.
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
