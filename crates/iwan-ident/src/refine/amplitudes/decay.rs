//! A model's ring-down as complex amplitudes in the windows. Its half cycles are computed one by one, or taken from a table where they are many and
//! alike.

use std::f64::consts::{PI, TAU};

use iwan_core::{Decay, FourParameter, HalfCycleTables, Oscillator, Reversal};
use rustfft::num_complex::Complex64;

use super::slow::{
    BELOW, Buffers, Common, FASTEST, FASTEST_IN_MACRO_SLIP, Moment, Nodes, TOP, Table, TableOf,
};
use super::windows::{Gathered, Moments, Windows};
use crate::curves::Quantity;
use crate::parameters::Parameters;
use crate::refine::release::TurningPoint;
use crate::turn::turn;

/// Distance of neighbouring windows, in cycles, from which on a window counts as a cubic over half a cycle, so that four moments of each half cycle
/// are enough: the part of sin⁴ that is left out is then below 40/24 (π/16/cycles)⁴ at the ends of the half cycle.
const LONG: f64 = 3.0;
/// Largest amplitude over φ_max at which a decay goes on by a table in micro-slip, where a half cycle takes next to nothing off the amplitude.
const MICRO: f64 = 0.96;
/// Smallest amplitude over φ_max at which a decay goes on by a table in macro-slip: nearer to the end of macro-slip the table needs as many half
/// cycles as it saves.
const MACRO: f64 = 1.15;
/// Amplitude over φ_max at which a table in macro-slip ends: its last polynomial reaches below this amplitude, and the middle of its last half cycle
/// shall not reach φ_max.
const MACRO_ENDS: f64 = 1.05;
/// Cycles that must be left of the record for a table to be worth its ten nodes and more, of five half cycles each.
const LEFT: f64 = 60.0;

/// The kind of half cycles that a table holds: all in micro-slip, or all in macro-slip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Regime {
    Micro,
    Macro,
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
        let tables = self.tables && self.hop * self.omega >= LONG * TAU;
        let table_of = TableOf { parameters: *parameters, omega: self.omega, quantity };
        let model = Model { oscillator: &oscillator, joint: &joint, tables: &half_cycle_tables, quantity };
        out.fill(Complex64::default());
        let (mut now, mut regime) = (start, None);
        while now.time < self.end() {
            let next = if tables { self.slow_regime(&now, joint.phi_max()) } else { None };
            let by_table = next.filter(|_| next != regime && now.time > start.time);
            let went = match by_table {
                Some(Regime::Micro) => {
                    let mut nodes = buffers.nodes(table_of, joint.phi_max());
                    self.add_by_table(model, &mut now, &mut nodes, out);
                    buffers.keep(table_of, nodes);
                    true
                }
                Some(Regime::Macro) => {
                    let floor = (MACRO_ENDS * joint.phi_max()).ln();
                    let mut nodes = Nodes::in_macro_slip(now.displacement.abs().ln(), floor);
                    self.add_by_table(model, &mut now, &mut nodes, out);
                    true
                }
                None => {
                    let first = (now.time == start.time).then_some(start.time);
                    let left = |now: &TurningPoint, change: f64| {
                        let next = if tables { self.slow_regime(now, joint.phi_max()) } else { None };
                        let ratio = now.displacement.abs() / joint.phi_max();
                        let is_slow = |regime: Regime| match regime {
                            Regime::Micro => change < FASTEST && ratio.ln() < TOP.ln() - BELOW * change,
                            Regime::Macro => change < FASTEST_IN_MACRO_SLIP / ratio,
                        };
                        next.filter(|n| Some(*n) != regime && is_slow(*n))
                    };
                    self.add_plainly(model, &mut now, first, &mut buffers.stack, left, out)
                }
            };
            regime = by_table.or(regime);
            if !went {
                return false;
            }
        }
        true
    }

    /// The kind of table by which a decay can go on from the turning point `now`; none where too few cycles are left for a table to be worth it, and
    /// where the amplitude is too close to φ_max.
    fn slow_regime(&self, now: &TurningPoint, phi_max: f64) -> Option<Regime> {
        let ratio = now.displacement.abs() / phi_max;
        let enough = now.time > 0.0 && (self.end() - now.time) * self.omega > LEFT * TAU;
        match ratio {
            _ if !enough => None,
            r if r < MICRO => Some(Regime::Micro),
            r if r > MACRO => Some(Regime::Macro),
            _ => None,
        }
    }

    /// Adds half cycles one by one from the turning point `now` on, until the last window ends or `left` names the kind of table by which the decay
    /// can go on. `left` is given the turning point and the larger change of ln amplitude of the last two half cycles: the two changes differ where a
    /// decay goes on about a displacement that is not zero. `first` is the time of the release where the decay begins with it. False where there is
    /// no decay.
    fn add_plainly(
        &self,
        Model { oscillator, joint, tables, quantity }: Model<'_>,
        now: &mut TurningPoint,
        first: Option<f64>,
        stack: &mut [Reversal],
        left: impl Fn(&TurningPoint, f64) -> Option<Regime>,
        out: &mut [Complex64],
    ) -> bool {
        let held = iwan_core::Motion::held_at(now.displacement);
        let Ok(mut decay) = Decay::with_tables(oscillator, joint, tables, held, stack) else { return false };
        let (began, long, mut first) = (now.time, self.hop * self.omega >= LONG * TAU, first);
        let mut logs = [f64::INFINITY, f64::INFINITY, f64::INFINITY, now.displacement.abs().ln()];
        while now.time < self.end() {
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
            });
            let Some(turned) = turned else { return false };
            self.spread_gathered(&gathered, quantity, out);
            if long && first.is_none() {
                self.add_moments(middle, &moments, quantity, out);
            }
            first = None;
            let crosses = now.displacement * turned.displacement < 0.0;
            *now = TurningPoint { time: began + turned.time, displacement: turned.displacement, ..*now };
            logs = [logs[1], logs[2], logs[3], turned.displacement.abs().ln()];
            // The mean over half cycles of both signs: a decay out of macro-slip goes on about a displacement that is not zero.
            let growth = 0.5 * (logs[3] - logs[1]);
            let bend = 0.5 * (logs[3] - logs[2] - logs[1] + logs[0]);
            let change = (logs[3] - logs[2]).abs().max((logs[2] - logs[1]).abs());
            match left(now, if crosses { change } else { f64::INFINITY }) {
                Some(Regime::Macro) => break,
                Some(Regime::Micro) if bend.is_finite() => {
                    let amplitude = (0.5 * (logs[3] + logs[2] + growth) + 0.25 * bend).exp();
                    now.displacement = amplitude * turned.displacement.signum();
                    break;
                }
                _ => {}
            }
        }
        true
    }

    /// Adds half cycles from a table, from the turning point `now` on, until the last window ends or the table has no further half cycle.
    fn add_by_table(
        &self,
        Model { oscillator, joint, tables, quantity }: Model<'_>,
        now: &mut TurningPoint,
        nodes: &mut Nodes,
        out: &mut [Complex64],
    ) {
        let (quarter, mut sign) = (0.5 * PI / self.omega, now.displacement.signum());
        let mut log = now.displacement.abs().ln();
        let add = |node: Moment, moments: &mut [Complex64; 4]| {
            let Moment { late, displacement, velocity, weight } = node;
            let late = late - quarter;
            let mut sum = Moments::default();
            sum.add(late, self.term(late, Motion { displacement, velocity }, weight, quantity));
            moments.iter_mut().zip(sum.0).for_each(|(m, s)| *m += s);
        };
        let mut table = Table::new(nodes, (oscillator, joint, tables), add);
        while now.time < self.end() {
            let Some(half) = table.at(log) else { break };
            // The moments refer to the middle of their half cycle: `add_moments` turns their phase to the record's beginning.
            let moments = Moments(half.moments.map(|m| m * sign));
            self.add_moments(now.time + quarter, &moments, quantity, out);
            (log, sign) = (log + half.growth, -sign);
            *now = TurningPoint { time: now.time + half.duration, displacement: sign * log.exp(), ..*now };
        }
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

    #[test]
    fn a_table_of_half_cycles_is_the_decay_itself() {
        let phi_max = MODE.model().unwrap().1.phi_max();
        for (ratio, damping_ratio) in
            [(3.0, 1e-4), (1.2, 1e-4), (0.97, 1e-4), (0.6, 1e-3), (0.6, 2e-3), (0.6, 5e-3), (0.05, 1e-5)]
        {
            let mode = Parameters { damping_ratio, ..MODE };
            let windows = Windows::over(9.0, 123.5, 1.0);
            let start = TurningPoint { displacement: ratio * phi_max, time: -1e-3, day: 0.0 };
            let [mut table, mut plain] = [(); 2].map(|()| vec![Complex64::default(); windows.count]);
            let (quantity, buffers) = (Quantity::Acceleration, &mut Buffers::default());
            assert!(windows.of_model(&mode, start, quantity, buffers, &mut table));
            let one_by_one = Windows { tables: false, ..windows };
            assert!(one_by_one.of_model(&mode, start, quantity, buffers, &mut plain));
            let largest = plain.iter().map(|z| z.norm()).fold(0.0, f64::max);
            for (k, (a, b)) in table.iter().zip(&plain).enumerate() {
                let error = (a - b).norm() / b.norm().max(1e-4 * largest);
                assert!(error < 1.5e-5, "{ratio} {damping_ratio} window {k}: {error:e}");
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
