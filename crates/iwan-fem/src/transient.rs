//! Time integration of the full model: average acceleration on all unknowns, Newton's method on the slips alone.
//!
//! M a + K_∞ x + E F(s) = p(t) g, s = Eᵀ x the slips. In the a-form of Newmark's scheme (β = 1/4, γ = 1/2; N. M. Newmark, J.
//! Eng. Mech. Div. ASCE 85(3):67, 1959) A = M + dt²/4 K_∞ is factored once; a step is one solve for the
//! acceleration with the joints' forces held, the small system of the slips, and its correction through the columns A⁻¹ E.

use std::ops::ControlFlow;
use std::time::Instant;

use iwan_core::{EnergyBalance, Pulse};

use crate::assembly::Assembled;
use crate::contact::{Joints, Population, tables};
use crate::error::{Error, check};
use crate::full_stepper::{FullStepper, Functional};
use crate::modes::Modes;
use crate::slip_solver::SlipSolver;

/// A linear functional of the unknowns that is recorded: a displacement, a mean over nodes, a modal coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Name.
    pub name: String,
    /// Its coefficients, one per unknown.
    pub coefficients: Vec<f64>,
}

/// A transient: force, time axis, initial velocity, joints' evaluation, what is recorded.
#[derive(Debug, Clone)]
pub struct Transient<'a> {
    /// Time step, s.
    pub dt: f64,
    /// Number of steps; the response has one sample more.
    pub steps: usize,
    /// History p(t) of the force.
    pub pulse: Pulse<'a>,
    /// Forces g on the unknowns for p = 1 ([`Assembled::load`]).
    pub load: Vec<f64>,
    /// Velocities of the unknowns at t = 0; none: at rest. Displacements and joint forces are zero then.
    pub initial_velocity: Option<Vec<f64>>,
    /// How the joints are evaluated.
    pub population: Population,
    /// What is recorded.
    pub outputs: Vec<Output>,
}

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
    /// Largest |slip| over the strength φ_max of the strongest slider; 0 for a free slip.
    pub slip_ratio: f64,
}

/// Response of a structure with discrete joints.
#[derive(Debug, Clone, PartialEq)]
pub struct TruthResponse {
    /// Time step, s.
    pub dt: f64,
    /// The outputs asked for.
    pub outputs: Vec<History>,
    /// All slips.
    pub slips: Vec<SlipHistory>,
    /// Energy balance over the whole run: input = kinetic + elastic + stored + viscous +
    /// friction + residual.
    pub energy: EnergyBalance,
    /// Bound on the joint forces' error from loops forgotten for want of memory; 0 = exact.
    pub forgotten_force: f64,
    /// Wall-clock time of the stepping alone, s.
    pub seconds: f64,
}

/// Called with the share done (0 to 1); breaking off ends the run with [`Error::Interrupted`].
pub type Progress<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

/// Progress through the part of a piece of work from one share to another.
pub(crate) fn part(
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
    [from, to]: [f64; 2],
) -> impl FnMut(f64) -> ControlFlow<()> {
    move |share| progress(from + (to - from) * share)
}

/// More numbers than this (8 GB) are not kept in memory.
const MOST_NUMBERS: f64 = 1e9;

/// Steps between two calls of the observer.
pub(crate) const OBSERVED: usize = 256;

impl Transient<'_> {
    /// Number of whole time steps in a duration; a duration that is a multiple of the step loses none to rounding.
    #[must_use]
    pub fn steps_in(dt: f64, duration: f64) -> usize {
        (duration / dt * (1.0 + 1e-12)).floor() as usize
    }

    /// Checks numbers and lengths.
    pub(crate) fn check(&self, unknowns: usize, slips: usize) -> Result<(), Error> {
        check("time step", self.dt, self.dt > 0.0, "must be a finite number of seconds > 0")?;
        check(
            "steps",
            self.steps as f64,
            self.steps as f64 * (4 * self.outputs.len() + 2 * slips) as f64 <= MOST_NUMBERS,
            "the response would need more than 8 GB of memory; lengthen the time step, shorten the duration, or ask for fewer outputs",
        )?;
        self.pulse.checked()?;
        let lengths = self.outputs.iter().map(|o| o.coefficients.len());
        let velocity = self.initial_velocity.iter().map(Vec::len);
        if let Some(found) = lengths.chain(velocity).chain([self.load.len()]).find(|&found| found != unknowns)
        {
            let finding = format!(
                "a load, initial velocity or output has {found} entries, the structure has {unknowns} unknowns"
            );
            return Err(Error::Analysis {
                analysis: "transient",
                finding,
                remedy: "make them with the same assembled structure",
            });
        }
        let given = self.load.iter().chain(self.initial_velocity.iter().flatten());
        let bad = given.chain(self.outputs.iter().flat_map(|o| &o.coefficients)).find(|x| !x.is_finite());
        bad.map_or(Ok(()), |&value| {
            Err(Error::OutOfRange {
                name: "load, initial velocity or output",
                value,
                allowed: "must be finite",
            })
        })
    }

    /// Force at each sample.
    pub(crate) fn force(&self) -> Vec<f64> {
        let mut force = vec![0.0; self.steps + 1];
        self.pulse.sample(self.dt, &mut force);
        force
    }
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
    pub(crate) fn new(of: &Transient<'_>, slips: impl Iterator<Item = String>) -> Self {
        let room = || Vec::with_capacity(of.steps + 1);
        let outputs = of.outputs.iter().map(|output| History {
            name: output.name.clone(),
            displacement: room(),
            velocity: room(),
            acceleration: room(),
        });
        let slips = slips.map(|name| SlipHistory { name, slip: room(), force: room(), slip_ratio: 0.0 });
        Self {
            outputs: outputs.collect(),
            slips: slips.collect(),
            dt: of.dt,
            input: 0.0,
            viscous: 0.0,
            joint_work: 0.0,
        }
    }

    /// First sample of output `i`.
    pub(crate) fn begin(&mut self, i: usize, velocity: f64, acceleration: f64) {
        let history = &mut self.outputs[i];
        history.displacement.push(0.0);
        history.velocity.push(velocity);
        history.acceleration.push(acceleration);
    }

    /// Next sample of output `i`: displacement and velocity follow from the accelerations by the scheme's own rule.
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

    /// Next sample of all slips, with the joints' work since the last one.
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

    /// Completes the response from kinetic and elastic energy at both ends.
    pub(crate) fn finish(
        mut self,
        joints: &mut Joints<'_>,
        strongest: impl Iterator<Item = f64>,
        [start, end]: [(f64, f64); 2],
        seconds: f64,
    ) -> Result<TruthResponse, Error> {
        for (history, strongest) in self.slips.iter_mut().zip(strongest) {
            history.slip_ratio = history.slip.iter().fold(0.0_f64, |m, s| m.max(s.abs())) / strongest;
        }
        let stored = joints.stored_energy();
        let gained = (end.0 - start.0) + (end.1 - start.1);
        let residual = self.input - gained - self.joint_work - self.viscous;
        let initial = start.0 + start.1;
        let energy = EnergyBalance {
            initial,
            input: self.input,
            kinetic: end.0,
            elastic: end.1,
            stored,
            viscous: self.viscous,
            friction: self.joint_work - stored,
            residual,
            scale: initial.abs().max(self.input.abs()).max(end.0),
        };
        if !(energy.residual.is_finite() && energy.scale.is_finite()) {
            let (finding, remedy) =
                ("the response is not finite".to_owned(), "shorten the time step or lower the load");
            return Err(Error::Analysis { analysis: "transient", finding, remedy });
        }
        let (dt, forgotten_force) = (self.dt, joints.forgotten());
        Ok(TruthResponse { dt, outputs: self.outputs, slips: self.slips, energy, forgotten_force, seconds })
    }
}

impl Assembled {
    /// The modal coordinate q = φᵀ M x of a mode as an output: the exact modal filter.
    ///
    /// # Panics
    /// When `modes` belongs to another structure or has no mode `index`.
    #[must_use]
    pub fn modal_output(&self, name: impl Into<String>, modes: &Modes, index: usize) -> Output {
        Output { name: name.into(), coefficients: self.mass().times(modes.shape(index)) }
    }

    /// The mean displacement of a node set along `direction` as an output.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn output(&self, name: impl Into<String>, set: &str, direction: [f64; 3]) -> Result<Output, Error> {
        Ok(Output { name: name.into(), coefficients: self.gauge(set, direction)? })
    }

    /// Strength of the strongest slider of each slip; infinite without a law.
    pub(crate) fn strongest(&self) -> impl Iterator<Item = f64> + '_ {
        self.slips().iter().map(|slip| slip.law.as_ref().map_or(f64::INFINITY, |law| law.strengths().1))
    }

    /// Integrates the full model.
    ///
    /// # Errors
    /// [`Error`] for numbers out of range, lengths that do not fit, and slips that do not settle.
    pub fn transient(&self, of: &Transient<'_>) -> Result<TruthResponse, Error> {
        self.transient_observed(of, &mut |_| ControlFlow::Continue(()))
    }

    /// [`transient`](Self::transient) with a progress report that may break it off.
    ///
    /// # Errors
    /// As [`transient`](Self::transient), and [`Error::Interrupted`].
    pub fn transient_observed(
        &self,
        of: &Transient<'_>,
        progress: Progress<'_>,
    ) -> Result<TruthResponse, Error> {
        of.check(self.unknowns(), self.slips().len())?;
        let mut memory = tables(self.slips().len(), of.population);
        let laws = self.slips().iter().map(|slip| slip.law.as_ref());
        let mut joints = Joints::new(laws, of.population, &mut memory)?;
        let mut stepper = FullStepper::new(self, of, &mut joints)?;
        let mut recorder = Recorder::new(of, self.slips().iter().map(|slip| slip.name.clone()));
        let outputs: Vec<Functional> =
            of.outputs.iter().map(|o| stepper.functional(&o.coefficients)).collect();
        let (force, start) = (of.force(), stepper.energy());
        for (i, output) in outputs.iter().enumerate() {
            recorder.begin(i, stepper.velocity(output), stepper.acceleration(output, force[0]));
        }
        recorder.slips(stepper.slips());
        let clock = Instant::now();
        let mut before = 0.0;
        for n in 1..=of.steps {
            stepper.step(&mut joints, force[n - 1], force[n])?;
            let here = stepper.load_displacement();
            recorder.work(0.5 * (force[n - 1] + force[n]) * (here - before));
            before = here;
            for (i, output) in outputs.iter().enumerate() {
                recorder.output(i, stepper.acceleration(output, force[n]));
            }
            recorder.slips(stepper.slips());
            if n % OBSERVED == 0 && progress(n as f64 / of.steps as f64).is_break() {
                return Err(Error::Interrupted);
            }
        }
        let seconds = clock.elapsed().as_secs_f64();
        recorder.finish(&mut joints, self.strongest(), [start, stepper.energy()], seconds)
    }
}
