//! A model's ring-down as complex amplitudes in the windows. Its half cycles are computed one by one, or taken from a table, in micro-slip many at once.

use std::f64::consts::{PI, TAU};

use iwan_core::{Decay, FourParameter, HalfCycleTables, Oscillator, Reversal};
use rustfft::num_complex::Complex64;

use super::slow::{Buffers, Common, HalfCycle, Moment, Nodes, Table, TableOf};
use super::strides::{MOST_CHANGE, NODES, Rule, Stride};
use super::windows::{Gathered, Moments, Windows};
use crate::curves::Quantity;
use crate::parameters::Parameters;
use crate::refine::release::TurningPoint;
use crate::turn::turn;

/// Distance of neighbouring windows, in cycles, from which on a window counts as a cubic over half a cycle, so that four moments of each half cycle
/// are enough: the part of sin⁴ that is left out is then below 40/24 (π/16/cycles)⁴ at the ends of the half cycle.
const LONG: f64 = 3.0;
/// Half travel over φ_max below which the half cycle before must lie for a decay to go on by a table in micro-slip. The table's first node is the half cycle after a release at 0.99 φ_max, whose half
/// travel lies below that by half of what it loses; a half cycle that follows one below 0.96 φ_max lies below the node, however fast the decay is.
const MICRO: f64 = 0.96;

/// How a decay goes on after half cycles that were computed one by one.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Onward {
    /// The last window has ended.
    Ended,
    /// By a table in macro-slip.
    InMacroSlip,
    /// By a table in micro-slip, with a half cycle of this travel (with its sign).
    InMicroSlip(f64),
}

/// The tables by which a decay may go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Tables {
    None,
    InMicroSlip,
    All,
}

/// The oscillator and the joint that decay, and the quantity whose amplitudes are wanted.
#[derive(Clone, Copy)]
struct Model<'a> {
    oscillator: &'a Oscillator,
    joint: &'a FourParameter,
    tables: &'a HalfCycleTables,
    quantity: Quantity,
}

impl Windows {
    /// Complex amplitudes of the model's ring-down from rest at `start` into `out`, one per window; false when there is no ring-down. Before the
    /// release the motion is mirrored in time, because the release is a turning point.
    pub(in crate::refine) fn of_model(
        &self,
        parameters: &Parameters,
        start: TurningPoint,
        quantity: Quantity,
        buffers: &mut Buffers,
        out: &mut [Complex64],
    ) -> bool {
        let Some(Common { oscillator, joint, tables: half_cycle_tables }) = buffers.common(parameters) else {
            return false;
        };
        let half_cycles = (2.5 * (self.end() + start.time.abs()) * parameters.frequency) as usize + 16;
        if buffers.stack.len() < half_cycles {
            buffers.stack.resize(half_cycles, Reversal::default());
        }
        let table_of = TableOf { parameters: *parameters, omega: self.omega, quantity };
        let model = Model { oscillator: &oscillator, joint: &joint, tables: &half_cycle_tables, quantity };
        out.fill(Complex64::default());
        let mut may = if self.tables && self.is_long() { Tables::All } else { Tables::None };
        let mut now = start;
        loop {
            let first = (now.time == start.time).then_some(start.time);
            let onward = self.add_plainly(model, &mut now, (first, may), &mut buffers.stack, out);
            if onward.is_none_or(|onward| onward == Onward::Ended) {
                return onward.is_some();
            }
            let mut nodes = buffers.nodes(table_of, joint.phi_max());
            if let Some(Onward::InMicroSlip(travel)) = onward {
                let done = self.add_micro_slip(model, now, travel, &mut nodes, out);
                buffers.keep(table_of, nodes);
                if done {
                    return true;
                }
                // The table has no further half cycle: all are computed one by one, from the release on.
                out.fill(Complex64::default());
                (now, may) = (start, Tables::None);
            } else {
                self.add_macro_slip(model, &mut now, &mut nodes, out);
                buffers.keep(table_of, nodes);
                may = Tables::InMicroSlip;
            }
        }
    }

    /// Whether a window counts as a cubic over half a cycle.
    fn is_long(&self) -> bool {
        self.hop * self.omega >= LONG * TAU
    }

    /// Adds half cycles one by one from the turning point `now` on, until the last window ends or the decay can go on by a table. `first` is the time of the release where the decay
    /// begins with it. None where there is no decay.
    fn add_plainly(
        &self,
        Model { oscillator, joint, tables, quantity }: Model<'_>,
        now: &mut TurningPoint,
        (mut first, may): (Option<f64>, Tables),
        stack: &mut [Reversal],
        out: &mut [Complex64],
    ) -> Option<Onward> {
        let held = iwan_core::Motion::held_at(now.displacement);
        let mut decay = Decay::with_tables(oscillator, joint, tables, held, stack).ok()?;
        let (began, long, phi_max) = (now.time, self.is_long(), joint.phi_max());
        let mut before = f64::INFINITY;
        while now.time < self.end() {
            if let Some(travel) = decay.travel().filter(|_| first.is_none()) {
                if may != Tables::None && before < 2.0 * MICRO * phi_max {
                    return Some(Onward::InMicroSlip(travel));
                }
                // The joint slips as a whole in this half cycle, and so it did in the one before, which was longer.
                if may == Tables::All && travel.abs() > 2.0 * phi_max && travel * now.displacement < 0.0 {
                    return Some(Onward::InMacroSlip);
                }
            }
            let (mut moments, mut gathered) = (Moments::default(), Gathered::default());
            let middle = now.time + 0.5 * PI / self.omega;
            let turned = decay.next_with(|node| {
                let t = began + node.time;
                let motion = Motion { displacement: node.displacement, velocity: node.velocity };
                if long && first.is_none() {
                    let late = t - middle;
                    moments.add(late, self.term(late, motion, node.weight, quantity));
                    return;
                }
                self.add(t, motion, node.weight, quantity, (&mut gathered, out));
                if first.is_some_and(|release| node.time < release) {
                    let t = began - node.time;
                    self.add(t, motion.mirrored(), node.weight, quantity, (&mut gathered, out));
                }
            })?;
            self.spread_gathered(&gathered, quantity, out);
            if long && first.is_none() {
                self.add_moments(middle, &moments, quantity, out);
            }
            first = None;
            before = (turned.displacement - now.displacement).abs();
            *now = TurningPoint { time: began + turned.time, displacement: turned.displacement, ..*now };
        }
        Some(Onward::Ended)
    }

    /// Tables on `nodes`, with moments about the middle of the reference's half period.
    fn table<'a>(
        &'a self,
        Model { oscillator, joint, tables, quantity }: Model<'a>,
        nodes: &'a mut Nodes,
    ) -> Table<'a, impl FnMut(Moment, &mut [Complex64; 4]) + use<'a>> {
        let quarter = 0.5 * PI / self.omega;
        let add = move |node: Moment, moments: &mut [Complex64; 4]| {
            let Moment { late, displacement, velocity, weight } = node;
            let late = late - quarter;
            let mut sum = Moments::default();
            sum.add(late, self.term(late, Motion { displacement, velocity }, weight, quantity));
            moments.iter_mut().zip(sum.0).for_each(|(m, s)| *m += s);
        };
        Table::new(nodes, (oscillator, joint, tables), add)
    }

    /// Adds the moments of a half cycle that begins at the time `t` (s). They refer to the middle of the half cycle: `add_moments` turns their phase to the record's beginning.
    fn add_half_cycle(
        &self,
        t: f64,
        half: &HalfCycle,
        weight: Complex64,
        quantity: Quantity,
        out: &mut [Complex64],
    ) {
        let moments = Moments(half.moments.map(|m| m * weight));
        self.add_moments(t + 0.5 * PI / self.omega, &moments, quantity, out);
    }

    /// Adds half cycles in macro-slip from a table, from the turning point `now` on, until the last window ends or the table does.
    fn add_macro_slip(
        &self,
        model: Model<'_>,
        now: &mut TurningPoint,
        nodes: &mut Nodes,
        out: &mut [Complex64],
    ) {
        let mut table = self.table(model, nodes);
        while now.time < self.end() {
            let Some(half) = table.in_macro_slip(now.displacement.abs()) else { break };
            self.add_half_cycle(now.time, &half, now.displacement.signum().into(), model.quantity, out);
            let displacement = -now.displacement * half.growth.exp();
            *now = TurningPoint { time: now.time + half.duration, displacement, ..*now };
        }
    }

    /// Adds half cycles in micro-slip from a table until the last window ends. They begin at the turning point `now`, the first one with `travel`. False where the table has no further half
    /// cycle.
    fn add_micro_slip(
        &self,
        model: Model<'_>,
        now: TurningPoint,
        travel: f64,
        nodes: &mut Nodes,
        out: &mut [Complex64],
    ) -> bool {
        let (mut log, mut sign, quantity) = ((0.5 * travel.abs()).ln(), -travel.signum(), model.quantity);
        let mut table = self.table(model, nodes);
        let Some(HalfCycle { tip, .. }) = table.in_micro_slip(log) else { return false };
        if quantity == Quantity::Displacement {
            // Macro-slip leaves a displacement about which the decay swings from then on.
            self.add_constant(now.time, now.displacement - sign * tip, out);
        }
        let mut t = now.time;
        let rule = Rule::over(self.hop * self.omega / TAU);
        while t < self.end() {
            if let Some(rule) = &rule
                && let Some((stride, halves)) = self.stride(&mut table, log, rule)
            {
                for ((half, (_, late)), weight) in halves.iter().zip(stride.nodes).zip(rule.weights) {
                    self.add_half_cycle(t + late, half, weight * sign, quantity, out);
                }
                let (gone, late) = stride.end;
                (log, sign, t) = (log + gone, rule.sign_behind(sign), t + late);
                continue;
            }
            let Some(half) = table.in_micro_slip(log) else { return false };
            self.add_half_cycle(t, &half, sign.into(), quantity, out);
            (log, sign, t) = (log + half.growth, -sign, t + half.duration);
        }
        true
    }

    /// Adds a displacement that is constant from the time `t` (s) on. Windows that have begun by then see its onset; at their own ends they vanish with three derivatives, so that they do not see
    /// it go on.
    fn add_constant(&self, t: f64, displacement: f64, out: &mut [Complex64]) {
        // ∫ cos(θ + ντ) e^(-iωτ) dτ and ∫ sin(θ + ντ) e^(-iωτ) dτ from 0 on, without what an upper end would add.
        let integrals = |rate: f64, [c, s]: [f64; 2]| {
            let over = displacement / (rate * rate - self.omega * self.omega);
            let i_omega = Complex64::new(0.0, self.omega);
            [(i_omega * c - rate * s) * over, (i_omega * s + rate * c) * over]
        };
        self.add_following(t, integrals, Quantity::Displacement, out);
    }

    /// The stride from the ln half travel `log` on with the half cycles at its nodes; none where the table has none, and where the decay changes by more than the rule can sum.
    fn stride(
        &self,
        table: &mut Table<'_, impl FnMut(Moment, &mut [Complex64; 4])>,
        log: f64,
        rule: &Rule,
    ) -> Option<(Stride, [HalfCycle; NODES])> {
        let stride = table.stride(log, rule)?;
        let (gone, late) = stride.end;
        let change = gone.hypot(self.omega * late - PI * rule.length as f64);
        let mut halves = [HalfCycle::default(); NODES];
        for (half, (gone, _)) in halves.iter_mut().zip(&stride.nodes) {
            *half = table.in_micro_slip(log + gone)?;
        }
        (change < MOST_CHANGE).then_some((stride, halves))
    }

    /// The integrand of a moment without the window: x e^(-iω_r t) dt, and for acceleration -v e^(-iω_r t) dt.
    fn term(&self, t: f64, motion: Motion, seconds: f64, quantity: Quantity) -> Complex64 {
        turn(self.omega * t) * (motion.seen(quantity) * seconds)
    }

    /// Adds the motion at one node of the quadrature to what is gathered for the windows.
    fn add(
        &self,
        t: f64,
        motion: Motion,
        seconds: f64,
        quantity: Quantity,
        (gathered, out): (&mut Gathered, &mut [Complex64]),
    ) {
        self.gather(t, motion.seen(quantity) * seconds, quantity, gathered, out);
    }
}

/// Displacement and velocity at one time.
#[derive(Debug, Clone, Copy)]
struct Motion {
    displacement: f64,
    velocity: f64,
}

impl Motion {
    /// The signal whose integrals in windows are taken. Acceleration is integrated by parts, so that minus the velocity stands for it.
    fn seen(self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Displacement => self.displacement,
            Quantity::Velocity => self.velocity,
            Quantity::Acceleration => -self.velocity,
        }
    }

    /// The motion as long before a turning point as this motion is after it.
    fn mirrored(self) -> Self {
        Self { velocity: -self.velocity, ..self }
    }
}

#[cfg(test)]
mod tests {
    use iwan_core::{Continuum, Hysteresis, Newmark, Samples};

    use super::*;

    const MODE: Parameters =
        Parameters { frequency: 124.0, damping_ratio: 1e-3, k_t: 4.45e4, f_s: 239.4, chi: -0.183, beta: 0.3 };

    /// Time steps of the continuum: displacement, velocity, acceleration every `dt`.
    fn motion(ratio: f64, dt: f64, samples: usize) -> [Vec<f64>; 4] {
        let (oscillator, joint) = MODE.model().unwrap();
        let law = Continuum::new(&joint);
        let mut memory = law.virgin(vec![Reversal::default(); 4096]).unwrap();
        law.advance(&mut memory, ratio * joint.phi_max());
        let fraction = 40;
        let mut out: [Vec<f64>; 4] = std::array::from_fn(|_| vec![0.0; (samples - 1) * fraction + 1]);
        let [displacement, velocity, acceleration, joint_force] = &mut out;
        let scheme = Newmark::prewarped(dt / fraction as f64, oscillator.omega0()).unwrap();
        let mut buffers = Samples { displacement, velocity, acceleration, joint_force };
        scheme.integrate(&oscillator, &law, &mut memory, 0.0, &[], &mut buffers).unwrap();
        out.map(|x| x.into_iter().step_by(fraction).collect())
    }

    #[test]
    fn amplitudes_of_the_model_are_those_of_its_samples() {
        let dt = 1.0 / (124.0 * 40.0);
        let joint = MODE.model().unwrap().1;
        // Windows one cycle apart are filled node by node, windows five cycles apart by the moments of half cycles.
        for (ratio, cycles, count) in [(0.1, 1.0, 46), (2.0, 1.0, 46), (0.1, 5.0, 6), (2.0, 5.0, 6)] {
            let samples = motion(ratio, dt, 2001);
            let windows = Windows::over(2000.0 * dt, 123.0, cycles);
            assert_eq!(windows.count, count);
            for (i, quantity) in
                [Quantity::Displacement, Quantity::Velocity, Quantity::Acceleration].into_iter().enumerate()
            {
                let mut model = vec![Complex64::default(); windows.count];
                let start = TurningPoint { displacement: ratio * joint.phi_max(), time: 0.0, day: 0.0 };
                assert!(windows.of_model(&MODE, start, quantity, &mut Buffers::default(), &mut model));
                let record = windows.of_samples(&samples[i], dt);
                for (k, (a, b)) in model.iter().zip(&record).enumerate() {
                    // A residual displacement of the centre varies slowly, so that the windows do not see it.
                    let error = (a - b).norm() / b.norm();
                    assert!(error < 2e-5, "{ratio} {cycles} {quantity:?} window {k}: {error:e}");
                }
            }
        }
    }

    /// Largest difference between a decay by tables and one by single half cycles, over the larger of the amplitude and 1e-4 of the largest one.
    fn table_beside_half_cycles(ratio: f64, mode: &Parameters, windows: Windows, quantity: Quantity) -> f64 {
        let phi_max = mode.model().unwrap().1.phi_max();
        let start = TurningPoint { displacement: ratio * phi_max, time: -1e-3, day: 0.0 };
        let [mut table, mut plain] = [(); 2].map(|()| vec![Complex64::default(); windows.count]);
        let buffers = &mut Buffers::default();
        assert!(windows.of_model(mode, start, quantity, buffers, &mut table));
        let one_by_one = Windows { tables: false, ..windows };
        assert!(one_by_one.of_model(mode, start, quantity, buffers, &mut plain));
        let largest = plain.iter().map(|z| z.norm()).fold(0.0, f64::max);
        let errors = table.iter().zip(&plain).map(|(a, b)| (a - b).norm() / b.norm().max(1e-4 * largest));
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn a_table_of_half_cycles_is_the_decay_itself() {
        let cases = [
            (3.0, 1e-4),
            (1.2, 1e-4),
            (0.97, 1e-4),
            (0.6, 1e-3),
            (0.6, 5e-3),
            (0.6, 0.03),
            (0.05, 1e-5),
            (3.0, 0.02),
            (1.2, 0.05),
        ];
        for (ratio, damping_ratio) in cases {
            let mode = Parameters { damping_ratio, ..MODE };
            for quantity in [Quantity::Displacement, Quantity::Velocity, Quantity::Acceleration] {
                // The reference lies below the mode, next to it, and so far above that half cycles are added one by one.
                for (reference, seconds) in [(122.5, 9.0), (123.5, 9.0), (123.5, 40.0), (128.0, 9.0)] {
                    let windows = Windows::over(seconds, reference, 1.0);
                    let error = table_beside_half_cycles(ratio, &mode, windows, quantity);
                    let most = if ratio > 2.0 { 2.5e-5 } else { 1e-5 };
                    assert!(
                        error < most,
                        "{ratio} {damping_ratio} {quantity:?} {reference} {seconds}: {error:e}"
                    );
                }
            }
        }
    }

    #[test]
    fn decays_that_share_nodes_have_the_bits_of_their_own() {
        let phi_max = MODE.model().unwrap().1.phi_max();
        let windows = Windows::over(9.0, 123.5, 1.0);
        let quantity = Quantity::Acceleration;
        let shared = &mut Buffers::default();
        // Softer and harder releases in turn, and another mode between them.
        for (ratio, damping_ratio) in [(0.1, 1e-4), (2.0, 1e-4), (0.1, 2e-4), (0.5, 1e-4), (0.02, 1e-4)] {
            let mode = Parameters { damping_ratio, ..MODE };
            let start = TurningPoint { displacement: ratio * phi_max, time: -1e-3, day: 0.0 };
            let [mut own, mut other] = [(); 2].map(|()| vec![Complex64::default(); windows.count]);
            assert!(windows.of_model(&mode, start, quantity, &mut Buffers::default(), &mut own));
            assert!(windows.of_model(&mode, start, quantity, shared, &mut other));
            assert_eq!(own, other, "{ratio} {damping_ratio}");
        }
        assert_eq!(shared.kept(), 2);
    }

    #[test]
    fn a_release_between_samples_is_a_shift() {
        let dt = 1.0 / (124.0 * 400.0);
        let joint = MODE.model().unwrap().1;
        let samples = &motion(0.5, dt, 8001)[2];
        let windows = Windows::over(6000.0 * dt, 124.0, 1.0);
        for early in [30_usize, 90] {
            let record = windows.of_samples(&samples[early..], dt);
            let mut model = record.clone();
            let start =
                TurningPoint { displacement: 0.5 * joint.phi_max(), time: -(early as f64) * dt, day: 0.0 };
            assert!(windows.of_model(
                &MODE,
                start,
                Quantity::Acceleration,
                &mut Buffers::default(),
                &mut model
            ));
            for (a, b) in model.iter().zip(&record) {
                assert!((a - b).norm() < 2e-5 * b.norm());
            }
        }
    }
}
