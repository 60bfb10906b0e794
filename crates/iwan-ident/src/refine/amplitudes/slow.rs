//! Half cycles as smooth functions, taken from a table.
//!
//! In micro-slip Masing's rule gives every half cycle the same branch, so that all of it, but for a constant displacement, follows from its travel, and with it the travel of the
//! next half cycle. In macro-slip it follows from the amplitude at which it begins, because the tip of the loop lies on the virgin curve. Both change smoothly with the logarithm, except
//! for a bend between micro-slip and macro-slip. So half cycles are computed at a few amplitudes or half travels, the nodes of a table, and interpolated by polynomials; the
//! decay goes on from half cycle to half cycle, or by strides over many of them.

use std::collections::VecDeque;

use iwan_core::{Decay, FourParameter, HalfCycleTables, Motion, Oscillator, Reversal};
use rustfft::num_complex::Complex64;

use super::strides::{Rule, STRIDE_VALUES, Stride};
use super::tabled::{Node, Tabled};
use crate::curves::Quantity;
use crate::parameters::{COUNT, Parameters};

/// Spacing of a table's nodes in ln travel in micro-slip, where half cycles depend on powers of the travel only: a slow decay of a thousand cycles is then right to 8e-6 of its
/// amplitudes, most of which is the windows' cubic over half a cycle (the test in `decay`).
const SPACING: f64 = 0.4;
/// Spacing of a table's nodes in macro-slip, where half cycles change with the distance from φ_max: in ln of the amplitude less [`KNEE`] times φ_max. Amplitudes of the test in `decay` are then
/// right to 1.3e-5.
const SPACING_IN_MACRO_SLIP: f64 = 0.3;
/// Part of φ_max from which these amplitudes are counted, so that nodes stand close to each other above φ_max. With 0.85 to 0.92 the same errors were left; with zero, nodes at half of this spacing
/// were off by 6e-5.
const KNEE: f64 = 0.9;
/// Half travel over φ_max at which a table in micro-slip begins: the bend at φ_max lies above all of its nodes.
const TOP: f64 = 0.99;
/// Most nodes of a table in micro-slip: they reach down to e^-2400 times the first amplitude, further than floating-point numbers do.
const MOST: usize = 6000;
/// Amplitude over φ_max at which a table in macro-slip ends: nearer to φ_max half cycles turn round before the joint slips as a whole.
const FLOOR: f64 = 1.02;
/// Most nodes of a table in macro-slip: they reach up to 80,000 times φ_max, and above half cycles are computed one by one.
const MOST_IN_MACRO_SLIP: usize = 46;
/// Half cycles whose travels give the turning point about which they swing. Travels shrink by a part g from one to the next, and what is left out is g^6/128: 1e-8 where a half
/// cycle loses a tenth.
const FOLLOWING: usize = 6;

/// What one half cycle, from turning point to turning point, does to the motion and adds to the windows.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct HalfCycle {
    /// Change of ln amplitude, or of ln travel, to the next half cycle.
    pub(super) growth: f64,
    /// Duration, s.
    pub(super) duration: f64,
    /// The displacement at which it begins in a decay about zero.
    pub(super) tip: f64,
    /// Integrals of x e^(-iω_r (t - m)) (t - m)^k for k = 0 to 3, of a half cycle that begins at a positive displacement; m is a quarter of the
    /// reference period after its beginning.
    pub(super) moments: [Complex64; 4],
}

/// Real numbers in a half cycle: growth, duration, tip and four complex moments.
const VALUES: usize = 11;

impl HalfCycle {
    fn values(&self) -> [f64; VALUES] {
        let [a, b, c, d] = self.moments;
        [self.growth, self.duration, self.tip, a.re, a.im, b.re, b.im, c.re, c.im, d.re, d.im]
    }

    fn of(v: &[f64; VALUES]) -> Self {
        let moments = std::array::from_fn(|i| Complex64::new(v[3 + 2 * i], v[4 + 2 * i]));
        Self { growth: v[0], duration: v[1], tip: v[2], moments }
    }
}

/// A node of the quadrature over a half cycle: seconds from the beginning of the half cycle, displacement, velocity, and weight in s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moment {
    pub(super) late: f64,
    pub(super) displacement: f64,
    pub(super) velocity: f64,
    pub(super) weight: f64,
}

/// Half cycles at a few amplitudes, and strides over many of them: the same nodes serve every decay of an oscillator.
#[derive(Debug, Clone)]
pub(super) struct Nodes {
    phi_max: f64,
    /// Half cycles in micro-slip by ln of half their travel.
    in_micro_slip: Tabled<VALUES>,
    /// Strides in micro-slip by their length in half cycles: records of different lengths have different ones.
    strides: Vec<(usize, Tabled<STRIDE_VALUES>)>,
    /// Half cycles in macro-slip by ln of the amplitude at which they begin, less `KNEE` φ_max.
    in_macro_slip: Tabled<VALUES>,
}

impl Nodes {
    fn new(phi_max: f64) -> Self {
        let reach = SPACING_IN_MACRO_SLIP * (MOST_IN_MACRO_SLIP - 1) as f64;
        Self {
            phi_max,
            in_micro_slip: Tabled::new((TOP * phi_max).ln(), SPACING, MOST),
            strides: vec![],
            in_macro_slip: Tabled::new(
                ((FLOOR - KNEE) * phi_max).ln() + reach,
                SPACING_IN_MACRO_SLIP,
                MOST_IN_MACRO_SLIP,
            ),
        }
    }
}

/// Buffers for the computation of models, and half cycles that several models have in common.
#[derive(Debug, Clone, Default)]
pub(in crate::refine) struct Buffers {
    pub(super) stack: Vec<Reversal>,
    /// Tables of the models that were computed last.
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

/// What the half cycles of a table depend on.
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

    /// The nodes of a model's tables, those kept for the same model where there are any.
    pub(super) fn nodes(&mut self, of: TableOf, phi_max: f64) -> Nodes {
        let place = self.tables.iter().position(|(known, _)| *known == of);
        let known = place.and_then(|i| self.tables.remove(i));
        known.map_or_else(|| Nodes::new(phi_max), |(_, nodes)| nodes)
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

/// Half cycles and strides for the decays of one oscillator.
pub(super) struct Table<'a, F> {
    nodes: &'a mut Nodes,
    source: Source<'a, F>,
}

/// A decay of which a few half cycles are computed.
type Computed<'a> = Decay<'a, FourParameter, [Reversal; FOLLOWING + 4]>;

/// Duration of the first half cycle after a release, and the displacement at its end.
struct First {
    duration: f64,
    end: f64,
}

/// What computes the nodes of a table.
struct Source<'a, F> {
    oscillator: &'a Oscillator,
    joint: &'a FourParameter,
    tables: &'a HalfCycleTables,
    /// The decay that computed the last node, and the nodes of the quadrature that it passed; the next node takes over both buffers.
    decay: Option<Computed<'a>>,
    path: Vec<Moment>,
    /// Adds a node of the quadrature to the moments of a half cycle.
    add: F,
}

impl<'a, F: FnMut(Moment, &mut [Complex64; 4])> Table<'a, F> {
    /// A table on nodes that may serve several decays of the same oscillator and joint with the same moments.
    pub(super) fn new(
        nodes: &'a mut Nodes,
        (oscillator, joint, tables): (&'a Oscillator, &'a FourParameter, &'a HalfCycleTables),
        add: F,
    ) -> Self {
        Self { nodes, source: Source { oscillator, joint, tables, decay: None, path: vec![], add } }
    }

    /// The half cycle in micro-slip that has ln of half its travel at `log`; none above the first node, below the last one, and where a half cycle cannot be computed.
    pub(super) fn in_micro_slip(&mut self, log: f64) -> Option<HalfCycle> {
        let source = &mut self.source;
        let values = self.nodes.in_micro_slip.at(log, |log| source.in_micro_slip(log))?;
        Some(HalfCycle::of(&values))
    }

    /// The half cycle in macro-slip that begins at an amplitude, with the joint slipping as a whole before and at its end; none outside the table, and where it would have to look at half
    /// cycles that end in micro-slip.
    pub(super) fn in_macro_slip(&mut self, amplitude: f64) -> Option<HalfCycle> {
        let (source, phi_max) = (&mut self.source, self.nodes.phi_max);
        let log = (amplitude - KNEE * phi_max).ln();
        let values = self.nodes.in_macro_slip.at(log, |log| source.in_macro_slip(log, phi_max))?;
        Some(HalfCycle::of(&values))
    }

    /// The stride in micro-slip over as many half cycles as `rule` sums, from one on that has ln of half its travel at `log`; none where the table does not reach so far.
    pub(super) fn stride(&mut self, log: f64, rule: &Rule) -> Option<Stride> {
        let Nodes { in_micro_slip, strides, .. } = &mut *self.nodes;
        let source = &mut self.source;
        let place = strides.iter().position(|(length, _)| *length == rule.length).unwrap_or_else(|| {
            // The first half cycle's node lies below the beginning of its table, by less than the spacing.
            let top = in_micro_slip.top - in_micro_slip.spacing;
            strides.push((rule.length, Tabled::new(top, in_micro_slip.spacing, in_micro_slip.count)));
            strides.len() - 1
        });
        let mut half_cycle =
            |log: f64| in_micro_slip.at(log, |log| source.in_micro_slip(log)).map(|v| HalfCycle::of(&v));
        let values = strides[place].1.at(log, |log| {
            let values = rule.values(log, |log| half_cycle(log).map(|half| (half.growth, half.duration)))?;
            Some((log, values))
        })?;
        Some(Stride::of(&values))
    }
}

impl<'a, F: FnMut(Moment, &mut [Complex64; 4])> Source<'a, F> {
    /// The node whose computation begins with a release at the ln amplitude `log`; none where it cannot be computed.
    fn in_micro_slip(&mut self, log: f64) -> Option<Node<VALUES>> {
        let start = log.exp();
        let (mut decay, half) = self.released(start)?;
        let mut travels = [start - half.end; FOLLOWING];
        let mut from = half.end;
        for travel in &mut travels[1..] {
            let to = decay.next()?.displacement;
            (*travel, from) = ((to - from).abs(), to);
        }
        self.decay = Some(decay);
        let (growth, tip) = ((travels[1] / travels[0]).ln(), tip(travels));
        Some(((0.5 * travels[0]).ln(), self.values(&half, growth, tip, tip - start)?))
    }

    /// The node for a release at a displacement whose distance from `KNEE` φ_max has the logarithm `log`; none where it cannot be computed, and where the half cycle would end in micro-slip.
    fn in_macro_slip(&mut self, log: f64, phi_max: f64) -> Option<Node<VALUES>> {
        let start = log.exp() + KNEE * phi_max;
        let (decay, half) = self.released(start)?;
        self.decay = Some(decay);
        let slips = start - half.end > 2.0 * phi_max && half.end < 0.0;
        Some((log, self.values(&half, (-half.end / start).ln(), start, 0.0)?)).filter(|_| slips)
    }

    /// The decay after a release at a displacement, and its first half cycle, whose quadrature is in `path`.
    fn released(&mut self, start: f64) -> Option<(Computed<'a>, First)> {
        let held = Motion::held_at(start);
        let mut decay = if let Some(decay) = self.decay.take() {
            decay.anew(held).ok()?
        } else {
            let stack = [Reversal::default(); FOLLOWING + 4];
            Decay::with_tables(self.oscillator, self.joint, self.tables, held, stack).ok()?
        };
        let path = &mut self.path;
        path.clear();
        let turned = decay.next_with(|n| {
            let (late, displacement, velocity, weight) = (n.time, n.displacement, n.velocity, n.weight);
            path.push(Moment { late, displacement, velocity, weight });
        })?;
        Some((decay, First { duration: turned.time, end: turned.displacement }))
    }

    /// The values of a half cycle with its path moved by `shift`, of a decay about zero that begins it at `tip`; none unless the decay loses amplitude.
    fn values(&mut self, half: &First, growth: f64, tip: f64, shift: f64) -> Option<[f64; VALUES]> {
        let mut moments = [Complex64::default(); 4];
        for node in &self.path {
            (self.add)(Moment { displacement: node.displacement + shift, ..*node }, &mut moments);
        }
        let known = growth.is_finite() && growth < 0.0;
        known.then(|| HalfCycle { growth, duration: half.duration, tip, moments }.values())
    }
}

/// The displacement from which a decay about zero begins the first of these travels: their sum with alternating signs, by Euler's transformation (M. Abramowitz, I. A. Stegun,
/// *Handbook of Mathematical Functions*, Eq. 3.6.27).
fn tip(mut travels: [f64; FOLLOWING]) -> f64 {
    let (mut sum, mut part) = (0.0, 0.5);
    for order in 0..FOLLOWING {
        sum += part * travels[0];
        part *= 0.5;
        for i in 0..FOLLOWING - order - 1 {
            travels[i] -= travels[i + 1];
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tip_is_the_alternating_sum_of_the_travels_to_come() {
        for ratio in [0.9_f64, 0.99, 0.9999] {
            let mut travel = 2.0 / ratio;
            let travels = [(); FOLLOWING].map(|()| {
                travel *= ratio;
                travel
            });
            assert!((tip(travels) - 2.0 / (1.0 + ratio)).abs() < 2.0 * (1.0 - ratio).powi(6) / 64.0 + 1e-15);
        }
    }
}
