//! The result of a transient (histories, slips, energy balance), and its recording step by step.

use iwan_core::EnergyBalance;

use super::joint_states::Joints;
use super::slip_solver::SlipSolver;
use super::task::Transient;
use crate::error::Error;
use crate::matrices::Assembled;

/// A time history of displacement and its derivatives, one sample per step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct History {
    /// Name of the output.
    pub name: String,
    /// Displacement (modal: mass^½·length).
    pub displacement: Vec<f64>,
    /// Velocity.
    pub velocity: Vec<f64>,
    /// Acceleration.
    pub acceleration: Vec<f64>,
}

/// Slip and force of a joint, one sample per step.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SlipHistory {
    /// Name of the slip.
    pub name: String,
    /// Slip.
    pub slip: Vec<f64>,
    /// Joint force.
    pub force: Vec<f64>,
    /// Largest |slip| over the strength φ_max of the joint's strongest slider; 0 for a slip without a joint law.
    pub slip_ratio: f64,
}

/// Response of a structure with discrete joints.
#[derive(Debug, Clone, PartialEq)]
pub struct StructureResponse {
    /// Time step, s.
    pub dt: f64,
    /// The requested outputs.
    pub outputs: Vec<History>,
    /// The histories of all slips.
    pub slips: Vec<SlipHistory>,
    /// Energy balance over the whole run: input = kinetic + elastic + stored + viscous +
    /// friction + residual.
    pub energy: EnergyBalance,
    /// Bound on the joint forces' error from loops forgotten because memory was full; 0 means exact.
    pub forgotten_force: f64,
    /// Wall-clock time of the time stepping alone, s.
    pub seconds: f64,
}

/// Number of steps between two calls of the listener. A step of the reduced model takes microseconds, one of the paper's full beam a
/// millisecond; so the calls cost nothing, and Ctrl-C acts within a second.
pub(crate) const OBSERVED: usize = 256;

/// Energy of a structure without the springs of its joints.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Energies {
    pub(crate) kinetic: f64,
    pub(crate) elastic: f64,
}

/// Records outputs, slips and works while a response is computed.
pub(crate) struct Recorder {
    outputs: Vec<History>,
    slips: Vec<SlipHistory>,
    dt: f64,
    input: f64,
    viscous: f64,
    joint_work: f64,
}

impl Recorder {
    pub(crate) fn new(task: &Transient<'_>, slips: impl Iterator<Item = String>) -> Self {
        let room = || Vec::with_capacity(task.steps + 1);
        let outputs = task.outputs.iter().map(|output| History {
            name: output.name.clone(),
            displacement: room(),
            velocity: room(),
            acceleration: room(),
        });
        let slips = slips.map(|name| SlipHistory { name, slip: room(), force: room(), slip_ratio: 0.0 });
        Self {
            outputs: outputs.collect(),
            slips: slips.collect(),
            dt: task.dt,
            input: 0.0,
            viscous: 0.0,
            joint_work: 0.0,
        }
    }

    /// Records the first sample of output `i`.
    pub(crate) fn begin(&mut self, i: usize, velocity: f64, acceleration: f64) {
        let history = &mut self.outputs[i];
        history.displacement.push(0.0);
        history.velocity.push(velocity);
        history.acceleration.push(acceleration);
    }

    /// Records the next sample of output `i`; displacement and velocity follow from the accelerations by the scheme's own rule.
    #[inline]
    pub(crate) fn output(&mut self, i: usize, acceleration: f64) {
        let (h, history) = (self.dt, &mut self.outputs[i]);
        let last = history.acceleration.len() - 1;
        let (x, v, a) = (history.displacement[last], history.velocity[last], history.acceleration[last]);
        let mean = 0.5 * h * (a + acceleration);
        history.displacement.push(x + h * (v + 0.5 * mean));
        history.velocity.push(v + mean);
        history.acceleration.push(acceleration);
    }

    /// Records the next sample of all slips, and adds the joints' work since the last sample.
    #[inline]
    pub(crate) fn slips(&mut self, solver: &SlipSolver) {
        for (i, history) in self.slips.iter_mut().enumerate() {
            let force = solver.forces()[i];
            let before = history.force.last().copied().unwrap_or(0.0);
            self.joint_work += 0.5 * (before + force) * solver.increments()[i];
            history.slip.push(solver.slips()[i]);
            history.force.push(force);
        }
    }

    /// Adds work of the applied force.
    #[inline]
    pub(crate) fn work(&mut self, work: f64) {
        self.input += work;
    }

    /// Adds energy lost in viscous damping.
    #[inline]
    pub(crate) fn viscous(&mut self, lost: f64) {
        self.viscous += lost;
    }

    /// Passes the works to `see`.
    pub(crate) fn each_number(&mut self, see: &mut dyn FnMut(&mut f64)) {
        [&mut self.input, &mut self.viscous, &mut self.joint_work].into_iter().for_each(see);
    }

    /// The histories recorded so far: three lists for each output, two for each slip.
    pub(crate) fn lists(&self) -> impl Iterator<Item = &[f64]> {
        let outputs = self.outputs.iter().flat_map(|o| [&o.displacement, &o.velocity, &o.acceleration]);
        outputs.chain(self.slips.iter().flat_map(|s| [&s.slip, &s.force])).map(Vec::as_slice)
    }

    /// Restores recorded histories of `samples` samples each; returns false if they do not fit.
    pub(crate) fn take_up(&mut self, mut lists: impl Iterator<Item = Vec<f64>>, samples: usize) -> bool {
        let outputs = self.outputs.iter_mut();
        let outputs = outputs.flat_map(|o| [&mut o.displacement, &mut o.velocity, &mut o.acceleration]);
        let mut fits = true;
        for own in outputs.chain(self.slips.iter_mut().flat_map(|s| [&mut s.slip, &mut s.force])) {
            let list = lists.next().filter(|list| list.len() == samples);
            fits &= list.is_some();
            own.clear();
            own.extend(list.into_iter().flatten());
        }
        fits && lists.next().is_none()
    }

    /// Completes the response; `start` and `end` are the energies at both ends.
    pub(crate) fn finish(
        mut self,
        joints: &mut Joints<'_>,
        strongest: impl Iterator<Item = f64>,
        [start, end]: [Energies; 2],
        seconds: f64,
    ) -> Result<StructureResponse, Error> {
        for (history, strongest) in self.slips.iter_mut().zip(strongest) {
            history.slip_ratio = history.slip.iter().fold(0.0_f64, |m, s| m.max(s.abs())) / strongest;
        }
        let stored = joints.stored_energy();
        let gained = (end.kinetic - start.kinetic) + (end.elastic - start.elastic);
        let residual = self.input - gained - self.joint_work - self.viscous;
        let initial = start.kinetic + start.elastic;
        let energy = EnergyBalance {
            initial,
            input: self.input,
            kinetic: end.kinetic,
            elastic: end.elastic,
            stored,
            viscous: self.viscous,
            friction: self.joint_work - stored,
            residual,
            scale: initial.abs().max(self.input.abs()).max(end.kinetic),
        };
        if !(energy.residual.is_finite() && energy.scale.is_finite()) {
            let (finding, remedy) =
                ("the response is not finite".to_owned(), "shorten the time step or lower the load");
            return Err(Error::Analysis { analysis: "transient", finding, remedy });
        }
        let (dt, forgotten_force) = (self.dt, joints.forgotten());
        Ok(StructureResponse {
            dt,
            outputs: self.outputs,
            slips: self.slips,
            energy,
            forgotten_force,
            seconds,
        })
    }
}

impl Assembled {
    /// Strength of the strongest slider of each slip; infinite for a slip without a law.
    pub(crate) fn strongest(&self) -> impl Iterator<Item = f64> + '_ {
        self.slips().iter().map(|slip| slip.law.as_ref().map_or(f64::INFINITY, |law| law.strengths().1))
    }
}
