//! The equations of harmonic balance, with the slips of the joints as unknowns.
//!
//! The unknowns are cosine and sine coefficient of each odd harmonic of each slip, x, and for each harmonic those of one modal amplitude,
//! q, of the mode kept apart. With g = F - K_T x, the joints' forces beyond their initial stiffness, and the flexibility R of all other
//! modes, the equations are
//!
//! x + R g - b q - R_f f = 0,   D q + bᵀ g - φ f = 0.
//!
//! A pair (a, b) stands for the complex amplitude a - i b of e^(inθ).

use iwan_core::{Harmonics, SteadyWork, steady_force};
use nalgebra::{DMatrix, DVector};

use super::jointed::JointedModes;
use super::receptance::{C, Receptance, dynamic_stiffness, nearest};
use crate::error::SimulationError;

/// The quantities besides the unknown amplitudes.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    /// Frequency, rad/s.
    pub(super) omega: f64,
    /// Amplitude of the excitation.
    pub(super) force: f64,
    /// Damping subtracted from all modes, 1/s: for a nonlinear mode 2 ζ ω.
    pub(super) xi: f64,
}

/// The equations with their derivatives, and the memory for their evaluation.
#[derive(Debug)]
pub(super) struct Balance<'a> {
    pub(super) system: &'a JointedModes,
    harmonics: Harmonics,
    /// The orders of the harmonics as floating-point numbers.
    pub(super) orders: Vec<f64>,
    /// Index of the mode kept apart, for each harmonic.
    pub(super) apart: Vec<usize>,
    work: Box<SteadyWork>,
    /// g, in the order of x.
    excess: Vec<f64>,
    /// Derivatives of g of each joint with respect to its slip's coefficients, row by row.
    slopes: Vec<f64>,
    /// Residuals of the equations.
    pub(super) residual: DVector<f64>,
    /// Derivatives of the equations with respect to x and q, then to ω, f and ξ.
    pub(super) jacobian: DMatrix<f64>,
}

/// Columns of the derivatives by ω, f and ξ, counted from the end of the amplitudes.
pub(super) const BY_OMEGA: usize = 0;
pub(super) const BY_FORCE: usize = 1;
pub(super) const BY_XI: usize = 2;
const STATES: usize = 3;

/// The product c (a - i b), as a pair.
fn times(c: C, pair: [f64; 2]) -> [f64; 2] {
    [c.re * pair[0] + c.im * pair[1], c.re * pair[1] - c.im * pair[0]]
}

impl<'a> Balance<'a> {
    /// The equations with odd harmonics up to `highest`.
    ///
    /// # Errors
    /// The errors of [`Harmonics::odd`].
    pub(super) fn new(system: &'a JointedModes, highest: usize) -> Result<Self, SimulationError> {
        let harmonics = Harmonics::odd(highest)?;
        let orders: Vec<f64> = harmonics.orders().map(|n| n as f64).collect();
        let (joints, each) = (system.joints.len(), harmonics.len());
        let count = (joints + 1) * each;
        Ok(Self {
            system,
            harmonics,
            apart: vec![0; orders.len()],
            orders,
            work: Box::new(SteadyWork::new()),
            excess: vec![0.0; joints * each],
            slopes: vec![0.0; joints * each * each],
            residual: DVector::zeros(count),
            jacobian: DMatrix::zeros(count, count + STATES),
        })
    }

    /// Number of unknown amplitudes, which is also the number of equations.
    pub(super) fn len(&self) -> usize {
        (self.system.joints.len() + 1) * self.each()
    }

    /// Number of coefficients of one slip.
    pub(super) fn each(&self) -> usize {
        self.harmonics.len()
    }

    /// Index at which the modal amplitudes begin.
    pub(super) fn modal(&self) -> usize {
        self.system.joints.len() * self.each()
    }

    /// Evaluates g and its derivatives.
    fn joints(&mut self, x: &[f64]) -> Result<(), SimulationError> {
        let each = self.each();
        for (j, joint) in self.system.joints.iter().enumerate() {
            let slip = &x[j * each..][..each];
            let excess = &mut self.excess[j * each..][..each];
            let slopes = &mut self.slopes[j * each * each..][..each * each];
            let (harmonics, work) = (self.harmonics, &mut self.work);
            steady_force(&&*joint.law, harmonics, slip, excess, Some(&mut *slopes), work)?;
            let k_t = joint.law.initial_stiffness();
            for (i, (g, u)) in excess.iter_mut().zip(slip).enumerate() {
                *g -= k_t * u;
                slopes[i * each + i] -= k_t;
            }
        }
        Ok(())
    }

    /// Chooses the modes kept apart anew and sets their amplitudes in `y`; for the first harmonic the mode `keep` is used, if given.
    /// Returns whether a choice has changed.
    ///
    /// # Errors
    /// The errors of [`evaluate`](Self::evaluate).
    pub(super) fn choose(
        &mut self,
        y: &mut [f64],
        state: State,
        keep: Option<usize>,
    ) -> Result<bool, SimulationError> {
        let mut changed = false;
        for (h, &n) in self.orders.iter().enumerate() {
            let wanted = match keep {
                Some(mode) if h == 0 => mode,
                _ => nearest(self.system, n, state.omega),
            };
            changed |= self.apart[h] != wanted;
            self.apart[h] = wanted;
        }
        if !changed {
            return Ok(false);
        }
        self.joints(&y[..self.modal()])?;
        for h in 0..self.orders.len() {
            if h == 0 && keep.is_some() {
                continue;
            }
            let at = self.modal() + 2 * h;
            [y[at], y[at + 1]] = self.modal_amplitude(self.apart[h], h, state);
        }
        Ok(true)
    }

    /// Amplitude of a mode at a harmonic, from the joints' forces of the last evaluation.
    fn modal_amplitude(&self, mode: usize, h: usize, state: State) -> [f64; 2] {
        let own = &self.system.modes[mode];
        let mut load = [if h == 0 { own.at_force * state.force } else { 0.0 }, 0.0];
        for (j, joint) in self.system.joints.iter().enumerate() {
            let g = &self.excess[j * self.each() + 2 * h..][..2];
            load = [load[0] - joint.participation[mode] * g[0], load[1] - joint.participation[mode] * g[1]];
        }
        let [d, ..] = dynamic_stiffness(self.system, mode, self.orders[h], state.omega, state.xi);
        times(d.inv(), load)
    }

    /// Evaluates the equations and their derivatives at the amplitudes `y`.
    ///
    /// # Errors
    /// [`SimulationError::Parameter`] where an amplitude is not finite.
    pub(super) fn evaluate(&mut self, y: &[f64], state: State) -> Result<(), SimulationError> {
        self.joints(&y[..self.modal()])?;
        self.jacobian.fill(0.0);
        for h in 0..self.orders.len() {
            let flexible = Receptance::at(self.system, self.apart[h], self.orders[h], state.omega, state.xi);
            for j in 0..self.system.joints.len() {
                self.slip_rows(y, state, h, j, &flexible);
            }
            self.modal_rows(y, state, h, &flexible);
        }
        Ok(())
    }

    /// g of one joint at one harmonic, as a pair.
    fn pair(&self, joint: usize, h: usize) -> [f64; 2] {
        let at = joint * self.each() + 2 * h;
        [self.excess[at], self.excess[at + 1]]
    }

    fn slip_rows(&mut self, y: &[f64], state: State, h: usize, j: usize, flexible: &Receptance) {
        let (each, count, joints) = (self.each(), self.len(), self.system.joints.len());
        let (row, modal) = (j * each + 2 * h, self.modal() + 2 * h);
        let b = self.system.joints[j].participation[flexible.apart];
        let mut sums = [[0.0; 2]; 3];
        for k in 0..joints {
            let g = self.pair(k, h);
            for (sum, part) in sums.iter_mut().zip(&flexible.slips) {
                let moved = times(part[j * joints + k], g);
                *sum = [sum[0] + moved[0], sum[1] + moved[1]];
            }
            let r = flexible.slips[0][j * joints + k];
            for column in 0..each {
                let slope = |part: usize| self.slopes[k * each * each + (2 * h + part) * each + column];
                let moved = times(r, [slope(0), slope(1)]);
                self.jacobian[(row, k * each + column)] += moved[0];
                self.jacobian[(row + 1, k * each + column)] += moved[1];
            }
        }
        let drive = if h == 0 { state.force } else { 0.0 };
        for part in 0..2 {
            self.residual[row + part] = y[row + part] + sums[0][part] - b * y[modal + part];
            self.jacobian[(row + part, row + part)] += 1.0;
            self.jacobian[(row + part, modal + part)] = -b;
        }
        for (which, sum) in sums.iter().enumerate() {
            let pushed = times(flexible.force[which][j], [drive, 0.0]);
            for part in 0..2 {
                if which == 0 {
                    self.residual[row + part] -= pushed[part];
                } else {
                    let column = count + if which == 1 { BY_OMEGA } else { BY_XI };
                    self.jacobian[(row + part, column)] = sum[part] - pushed[part];
                }
            }
        }
        if h == 0 {
            let unit = times(flexible.force[0][j], [1.0, 0.0]);
            self.jacobian[(row, count + BY_FORCE)] = -unit[0];
            self.jacobian[(row + 1, count + BY_FORCE)] = -unit[1];
        }
    }

    /// The equation of the mode kept apart, divided by its stiffness ω_m², so that it has the same weight as those of the slips.
    fn modal_rows(&mut self, y: &[f64], state: State, h: usize, flexible: &Receptance) {
        let (each, count) = (self.each(), self.len());
        let row = self.modal() + 2 * h;
        let own = self.system.modes[flexible.apart];
        let scale = 1.0 / (own.omega * own.omega);
        let q = [y[row], y[row + 1]];
        let moved = flexible.stiffness.map(|d| times(d, q));
        let push = if h == 0 { own.at_force } else { 0.0 };
        let mut load = [moved[0][0] - push * state.force, moved[0][1]];
        for (k, joint) in self.system.joints.iter().enumerate() {
            let b = joint.participation[flexible.apart];
            let g = self.pair(k, h);
            load = [load[0] + b * g[0], load[1] + b * g[1]];
            for part in 0..2 {
                for column in 0..each {
                    let slope = self.slopes[k * each * each + (2 * h + part) * each + column];
                    self.jacobian[(row + part, k * each + column)] = scale * b * slope;
                }
            }
        }
        let d = flexible.stiffness[0];
        let products = [[d.re, d.im], [-d.im, d.re]];
        for part in 0..2 {
            self.residual[row + part] = scale * load[part];
            for (other, product) in products[part].iter().enumerate() {
                self.jacobian[(row + part, row + other)] = scale * product;
            }
            self.jacobian[(row + part, count + BY_OMEGA)] = scale * moved[1][part];
            self.jacobian[(row + part, count + BY_XI)] = scale * moved[2][part];
        }
        self.jacobian[(row, count + BY_FORCE)] = -scale * push;
    }

    /// The response: the amplitude pair of each harmonic, and the derivatives of the first harmonic's pair with respect to the amplitudes,
    /// ω, f and ξ (two rows). Both use the joints' forces of the last evaluation.
    pub(super) fn output(&self, y: &[f64], state: State) -> (Vec<[f64; 2]>, DMatrix<f64>) {
        let (each, count) = (self.each(), self.len());
        let mut by = DMatrix::zeros(2, count + STATES);
        let mut pairs = vec![[0.0; 2]; self.orders.len()];
        for (h, &n) in self.orders.iter().enumerate() {
            let apart = self.apart[h];
            let at = self.modal() + 2 * h;
            let own = self.system.modes[apart].at_output;
            // Flexibility from the joints and from the excitation to the response.
            let (mut paths, direct) = self.paths(h, n, state);
            if h == 0 {
                for part in 0..2 {
                    by[(part, at + part)] = own;
                }
            }
            let mut pair = [own * y[at], own * y[at + 1]];
            for (k, path) in paths.iter_mut().enumerate() {
                let g = self.pair(k, h);
                let moved = path.map(|p| times(p, g));
                pair = [pair[0] - moved[0][0], pair[1] - moved[0][1]];
                if h > 0 {
                    continue;
                }
                for column in 0..each {
                    let slope = |part: usize| self.slopes[k * each * each + part * each + column];
                    let moved = times(path[0], [slope(0), slope(1)]);
                    by[(0, k * each + column)] -= moved[0];
                    by[(1, k * each + column)] -= moved[1];
                }
                for part in 0..2 {
                    by[(part, count + BY_OMEGA)] -= moved[1][part];
                    by[(part, count + BY_XI)] -= moved[2][part];
                }
            }
            if h == 0 {
                let pushed = direct.map(|d| times(d, [state.force, 0.0]));
                let unit = times(direct[0], [1.0, 0.0]);
                pair = [pair[0] + pushed[0][0], pair[1] + pushed[0][1]];
                for part in 0..2 {
                    by[(part, count + BY_OMEGA)] += pushed[1][part];
                    by[(part, count + BY_XI)] += pushed[2][part];
                    by[(part, count + BY_FORCE)] += unit[part];
                }
            }
            pairs[h] = pair;
        }
        (pairs, by)
    }

    /// Flexibilities of all modes except the one kept apart, with their derivatives: from each joint to the response, and from the
    /// excitation to the response.
    fn paths(&self, h: usize, n: f64, state: State) -> (Vec<[C; 3]>, [C; 3]) {
        let system = self.system;
        let zero = C::new(0.0, 0.0);
        let residual = |j: usize| system.residual.output.get(j).copied().unwrap_or(0.0);
        let mut paths: Vec<[C; 3]> =
            (0..system.joints.len()).map(|j| [C::new(residual(j), 0.0), zero, zero]).collect();
        let mut direct = [C::new(system.residual.direct, 0.0), zero, zero];
        for (mode, own) in system.modes.iter().enumerate().filter(|(mode, _)| *mode != self.apart[h]) {
            if own.at_output == 0.0 {
                continue;
            }
            let [d, by_omega, by_xi] = dynamic_stiffness(system, mode, n, state.omega, state.xi);
            let inverse = d.inv() * own.at_output;
            let parts = [inverse, -by_omega * d.inv() * inverse, -by_xi * d.inv() * inverse];
            for (which, part) in parts.iter().enumerate() {
                direct[which] += part * own.at_force;
                for (path, joint) in paths.iter_mut().zip(&system.joints) {
                    path[which] += part * joint.participation[mode];
                }
            }
        }
        (paths, direct)
    }
}
