//! The kinds of curves of steady vibration: force raised at one frequency, frequency swept at held force or held response, nonlinear mode.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

use super::balance::{BY_FORCE, BY_OMEGA, BY_XI, Balance, State};
use super::continuation::{Curve, Node};
use super::sweep::Control;
use crate::error::SimulationError;

/// The quantities that are unknown besides the amplitudes, and those that are held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Task {
    /// The force rises, in units of `force`, at the circular frequency `omega` (rad/s).
    Raise { omega: f64, force: f64 },
    /// The frequency changes at the excitation's amplitude `force`.
    Forced { force: f64 },
    /// The response is held; the force, in units of `force`, and the frequency change.
    Held { control: Control, level: f64, force: f64 },
    /// Free vibration of a mode, made periodic by a negative damping of all modes.
    Free { mode: usize },
}

/// A task with its equations.
///
/// The unknowns are the amplitudes, followed by those of the task: the force (in its unit); or the frequency (in units of `unit`); or force
/// and frequency; or, for free vibration, the logarithm of the modal amplitude, while frequency and damping take the place of the first
/// harmonic's modal amplitude.
#[derive(Debug)]
pub(super) struct Problem<'a> {
    pub(super) balance: Balance<'a>,
    pub(super) task: Task,
    /// Unit of frequencies, rad/s.
    pub(super) unit: f64,
    /// Relative change of the frequency that counts as a step of length 1: a few half-power widths of a lightly damped mode.
    pub(super) width: f64,
}

impl<'a> Problem<'a> {
    pub(super) fn new(balance: Balance<'a>, task: Task, unit: f64) -> Self {
        /// Default of `width`: a curve that is flat in amplitude gets some tens of points per octave.
        const WIDTH: f64 = 0.3;
        Self { balance, task, unit, width: WIDTH }
    }

    /// Number of unknowns, one more than equations.
    pub(super) fn unknowns(&self) -> usize {
        self.balance.len() + if matches!(self.task, Task::Held { .. }) { 2 } else { 1 }
    }

    /// Frequency, force and negative damping at the unknowns.
    pub(super) fn state(&self, y: &[f64]) -> State {
        let n = self.balance.len();
        match self.task {
            Task::Raise { omega, force } => State { omega, force: force * y[n], xi: 0.0 },
            Task::Forced { force } => State { omega: self.unit * y[n], force, xi: 0.0 },
            Task::Held { force, .. } => State { omega: self.unit * y[n + 1], force: force * y[n], xi: 0.0 },
            Task::Free { .. } => {
                let at = self.balance.modal();
                State { omega: self.unit * y[at], force: 0.0, xi: self.unit * y[at + 1] }
            }
        }
    }

    /// The amplitudes of all harmonics of slips and modes that belong to the unknowns.
    pub(super) fn amplitudes(&self, y: &[f64]) -> Vec<f64> {
        let n = self.balance.len();
        let mut amplitudes = y[..n].to_vec();
        if matches!(self.task, Task::Free { .. }) {
            let at = self.balance.modal();
            (amplitudes[at], amplitudes[at + 1]) = (y[n].exp(), 0.0);
        }
        amplitudes
    }

    /// The response: the amplitude pair of each harmonic.
    ///
    /// # Errors
    /// The errors of [`Balance::evaluate`].
    pub(super) fn response(&mut self, y: &[f64]) -> Result<Vec<[f64; 2]>, SimulationError> {
        let (amplitudes, state) = (self.amplitudes(y), self.state(y));
        self.balance.evaluate(&amplitudes, state)?;
        Ok(self.balance.output(&amplitudes, state).0)
    }

    /// Derivative, along a direction, of the logarithm of the response's first harmonic amplitude.
    ///
    /// # Errors
    /// The errors of [`Balance::evaluate`].
    pub(super) fn growth(&mut self, y: &[f64], direction: &[f64]) -> Result<f64, SimulationError> {
        let (amplitudes, state) = (self.amplitudes(y), self.state(y));
        self.balance.evaluate(&amplitudes, state)?;
        let (pairs, by) = self.balance.output(&amplitudes, state);
        let n = self.balance.len();
        let moved = |part: usize| {
            let own: f64 = (0..n).map(|i| by[(part, i)] * direction[i]).sum();
            own + match self.task {
                Task::Raise { force, .. } => by[(part, n + BY_FORCE)] * force * direction[n],
                Task::Forced { .. } => by[(part, n + BY_OMEGA)] * self.unit * direction[n],
                Task::Held { force, .. } => {
                    by[(part, n + BY_FORCE)] * force * direction[n]
                        + by[(part, n + BY_OMEGA)] * self.unit * direction[n + 1]
                }
                Task::Free { .. } => 0.0,
            }
        };
        let [a, b] = pairs[0];
        Ok((a * moved(0) + b * moved(1)) / (a * a + b * b))
    }

    /// Copies the derivatives of the equations with respect to the amplitudes and to the task's own unknowns.
    fn columns(&self, y: &[f64], jacobian: &mut DMatrix<f64>) {
        let n = self.balance.len();
        let all = &self.balance.jacobian;
        let rows: Range<usize> = 0..n;
        jacobian.view_mut((0, 0), (n, n)).copy_from(&all.view((0, 0), (n, n)));
        let mut set = |column: usize, from: usize, factor: f64| {
            for row in rows.clone() {
                jacobian[(row, column)] = factor * all[(row, from)];
            }
        };
        match self.task {
            Task::Raise { force, .. } => set(n, n + BY_FORCE, force),
            Task::Forced { .. } => set(n, n + BY_OMEGA, self.unit),
            Task::Held { force, .. } => {
                set(n, n + BY_FORCE, force);
                set(n + 1, n + BY_OMEGA, self.unit);
            }
            Task::Free { .. } => {
                let at = self.balance.modal();
                // The amplitude is e^y: its derivative is itself.
                set(n, at, y[n].exp());
                set(at, n + BY_OMEGA, self.unit);
                set(at + 1, n + BY_XI, self.unit);
            }
        }
    }

    /// First harmonic of a joint's slip: amplitude and phase, rad.
    pub(super) fn slip(&self, y: &[f64], joint: usize) -> [f64; 2] {
        let (a, b) = (y[joint * self.balance.each()], y[joint * self.balance.each() + 1]);
        [a.hypot(b), (-b).atan2(a)]
    }

    /// The equation of a held response: log |u| - log(displacement level at this frequency) = 0.
    fn hold(&self, y: &[f64], state: State, residual: &mut DVector<f64>, jacobian: &mut DMatrix<f64>) {
        let Task::Held { control, level, force } = self.task else { return };
        let n = self.balance.len();
        let (pairs, by) = self.balance.output(&y[..n], state);
        let [a, b] = pairs[0];
        let square = a * a + b * b;
        let wanted = control.displacement(level, state.omega);
        residual[n] = 0.5 * square.ln() - wanted.ln();
        let along = |column: usize| (a * by[(0, column)] + b * by[(1, column)]) / square;
        for column in 0..n {
            jacobian[(n, column)] = along(column);
        }
        let power = match control {
            Control::Velocity => 1.0,
            Control::Acceleration => 2.0,
            _ => 0.0,
        };
        jacobian[(n, n)] = force * along(n + BY_FORCE);
        jacobian[(n, n + 1)] = self.unit * along(n + BY_OMEGA) + power / y[n + 1];
    }
}

impl Curve for Problem<'_> {
    fn prepare(&mut self, y: &mut [f64]) -> Result<bool, SimulationError> {
        let state = self.state(y);
        let keep = if let Task::Free { mode } = self.task { Some(mode) } else { None };
        let n = self.balance.len();
        self.balance.choose(&mut y[..n], state, keep)
    }

    /// The scale of a slip is the size of all its harmonics together. A joint that hardly moves gets the part `MINOR` of the largest
    /// slip, both relative to the joints' strengths.
    fn scales(&self, y: &[f64]) -> Vec<f64> {
        /// Part of the largest slip (relative to the strengths) that is the smallest scale of any joint: a joint that slips less may change
        /// by that much in one step.
        const MINOR: f64 = 0.05;
        let (each, n, modal) = (self.balance.each(), self.balance.len(), self.balance.modal());
        let amplitudes = self.amplitudes(y);
        let size = |pairs: &[f64]| pairs.iter().map(|c| c * c).sum::<f64>().sqrt();
        let strengths: Vec<f64> =
            self.balance.system.joints.iter().map(|joint| joint.law.strengths().1).collect();
        let share = |j: usize| size(&amplitudes[j * each..][..each]) / strengths[j];
        let most = (0..strengths.len()).map(share).fold(0.0, f64::max);
        // At rest the slip at macro-slip is the scale.
        let most = if most > 0.0 { most } else { 1.0 };
        let mut scales = Vec::with_capacity(n + 2);
        for (j, strength) in strengths.iter().enumerate() {
            scales.extend(vec![strength * share(j).max(MINOR * most); each]);
        }
        // A modal amplitude that passes through zero is scaled by the modal displacement that causes the present slips.
        let usual = self.balance.system.macro_slip(self.balance.apart[0]).map_or(0.0, |q| MINOR * most * q);
        let moving = size(&amplitudes[modal..]).max(usual);
        let moving = if moving > 0.0 { moving } else { 1.0 };
        scales.extend(vec![moving; n - modal]);
        match self.task {
            Task::Raise { .. } => scales.push(y[n].abs().max(1e-3)),
            Task::Forced { .. } => scales.push(self.width * y[n]),
            Task::Held { .. } => scales.extend([y[n].abs(), self.width * y[n + 1]]),
            Task::Free { .. } => {
                (scales[modal], scales[modal + 1]) = (self.width * y[modal], self.width * y[modal]);
                scales.push(1.0);
            }
        }
        scales
    }

    /// A harmonic in resonance is small compared with the fundamental, so the curve hardly bends there. Therefore steps shrink near the
    /// frequencies at which a harmonic meets a mode: the modes' frequencies over the harmonics' orders.
    fn longest(&self, from: &Node) -> f64 {
        /// Largest step, as a part of the distance to such a frequency. Slip lowers a resonance by some per cent and widens it by about a
        /// tenth of that.
        const PART: f64 = 0.1;
        /// Shortest step, as a part of the frequency: the half-power width of a mode with 0.025 % of critical damping, less than any bolted
        /// structure has in motion.
        const LEAST: f64 = 5e-4;
        /// Relative distance to such a frequency beyond which steps are not shortened: slip does not move the resonance that far.
        const NEAR: f64 = 0.1;
        if !matches!(self.task, Task::Forced { .. } | Task::Held { .. }) {
            return f64::INFINITY;
        }
        let last = from.y.len() - 1;
        let (omega, system) = (self.unit * from.y[last], self.balance.system);
        let modes = || system.modes.iter().map(|mode| mode.omega).enumerate();
        let higher = self.balance.orders.iter().filter(|n| **n > 1.0);
        let gaps = higher.flat_map(|n| modes().map(move |(mode, own)| (mode, (own / n / omega - 1.0).abs())));
        let gap = gaps
            .filter(|(mode, gap)| *gap < NEAR && system.slips_in(*mode))
            .map(|(_, gap)| gap)
            .fold(f64::INFINITY, f64::min);
        (PART * gap).max(LEAST) * from.y[last] / from.tangent[last].abs()
    }

    fn evaluate(
        &mut self,
        y: &[f64],
        residual: &mut DVector<f64>,
        jacobian: &mut DMatrix<f64>,
    ) -> Result<(), SimulationError> {
        let (amplitudes, state) = (self.amplitudes(y), self.state(y));
        self.balance.evaluate(&amplitudes, state)?;
        let n = self.balance.len();
        residual.rows_mut(0, n).copy_from(&self.balance.residual);
        jacobian.fill(0.0);
        self.columns(y, jacobian);
        self.hold(y, state, residual, jacobian);
        Ok(())
    }
}
