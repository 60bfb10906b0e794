//! Time integration of the full model: average acceleration on all unknowns, Newton's method on the slips alone.
//!
//! The equations are M a + K_∞ x + E F(s) = p(t) g with the slips s = Eᵀ x. In the a-form of Newmark's scheme (β = 1/4, γ = 1/2; N. M.
//! Newmark, J. Eng. Mech. Div. ASCE 85(3):67, 1959) A = M + dt²/4 K_∞ is factored once. A step consists of one solve for the acceleration
//! with the joints' forces held, the small system of the slips, and the correction of the acceleration through the columns A⁻¹ E.

use std::time::Instant;

use super::joint_states::{Joints, tables};
use super::response::{Energies, OBSERVED, Recorder, StructureResponse};
use super::slip_solver::{SlipSolver, Square};
use super::task::Transient;
use super::watch::{Keeper, Watch};
use crate::algebra::{Cholesky, Group, LANES, NodalProduct, add_scaled, dot};
use crate::error::Error;
use crate::matrices::{Assembled, inverse_of};
use iwan_core::progress::UNWATCHED;

impl Assembled {
    /// Integrates the full model.
    ///
    /// # Errors
    /// [`Error`] for numbers out of range, lengths that do not fit, and slips that do not settle.
    pub fn transient(&self, task: &Transient<'_>) -> Result<StructureResponse, Error> {
        self.transient_observed(task, UNWATCHED)
    }

    /// [`transient`](Self::transient) with a progress report whose listener may stop it, and with a checkpoint from which it can continue.
    ///
    /// # Errors
    /// The errors of [`transient`](Self::transient), [`Error::Interrupted`], and [`Error::Analysis`] for a checkpoint that does not fit.
    pub fn transient_observed<'w>(
        &self,
        task: &Transient<'_>,
        watch: impl Into<Watch<'w>>,
    ) -> Result<StructureResponse, Error> {
        let watch = watch.into();
        task.check(self.unknowns(), self.slips().len())?;
        if self.damping().is_some() {
            return Err(Error::Analysis {
                analysis: "transient",
                finding: "the full model knows no viscous damping, and the matrices bring one".into(),
                remedy: "choose model = \"reduced\", or leave `damping` out of [matrices]",
            });
        }
        let mut memory = tables(self.slips().len(), task.representation);
        let laws = self.slips().iter().map(|slip| slip.law.as_ref());
        let mut joints = Joints::new(laws, task.representation, &mut memory)?;
        let mut stepper = FullStepper::new(self, task, &mut joints)?;
        let mut recorder = Recorder::new(task, self.slips().iter().map(|slip| slip.name.clone()));
        let outputs: Vec<Functional> =
            task.outputs.iter().map(|o| stepper.functional(&o.coefficients)).collect();
        let (force, start) = (task.force(), stepper.energies());
        for (i, output) in outputs.iter().enumerate() {
            recorder.begin(i, stepper.velocity(output), stepper.acceleration(output, force[0]));
        }
        recorder.slips(stepper.slips());
        let clock = Instant::now();
        let mut keeper = Keeper::new(&watch, self, task, &force, |digest| digest.text("full"));
        let mut before = 0.0;
        let done =
            keeper.resume(&mut recorder, &mut |see| numbers(&mut stepper, &mut joints, &mut before, see))?;
        for n in done + 1..=task.steps {
            stepper.step(&mut joints, force[n - 1], force[n])?;
            let here = stepper.load_displacement();
            recorder.work(0.5 * (force[n - 1] + force[n]) * (here - before));
            before = here;
            for (i, output) in outputs.iter().enumerate() {
                recorder.output(i, stepper.acceleration(output, force[n]));
            }
            recorder.slips(stepper.slips());
            if n % OBSERVED == 0 {
                let mut shown = |see: &mut dyn FnMut(&mut f64)| {
                    numbers(&mut stepper, &mut joints, &mut before, see);
                };
                if (watch.progress)(n as f64 / task.steps as f64).is_break() {
                    keeper.keep(n, &mut recorder, &mut shown);
                    return Err(Error::Interrupted);
                }
                keeper.keep_in_time(n, &mut recorder, &mut shown);
            }
        }
        keeper.keep(task.steps, &mut recorder, &mut |see| {
            numbers(&mut stepper, &mut joints, &mut before, see);
        });
        let seconds = clock.elapsed().as_secs_f64();
        recorder.finish(&mut joints, self.strongest(), [start, stepper.energies()], seconds)
    }
}

/// Passes every number that one step leaves to the next to `see`, including the displacement `before` of the load's point of attack.
fn numbers(
    stepper: &mut FullStepper<'_>,
    joints: &mut Joints<'_>,
    before: &mut f64,
    see: &mut dyn FnMut(&mut f64),
) {
    let free = &mut stepper.free;
    let lists = [
        &mut stepper.x,
        &mut stepper.v,
        &mut stepper.a,
        &mut stepper.internal,
        &mut stepper.increment,
        &mut free.displacement,
        &mut free.velocity,
    ];
    lists.into_iter().flatten().for_each(&mut *see);
    see(before);
    stepper.slips.each_number(see);
    joints.each_number(see);
}

/// A linear functional of the unknowns: its non-zero coefficients, and its values on the free motions.
pub(crate) struct Functional {
    terms: Vec<(usize, f64)>,
    /// All coefficients, if more than a quarter of them are not zero.
    dense: Option<Vec<f64>>,
    free: Vec<f64>,
}

impl Functional {
    fn new(coefficients: &[f64], motions: &[Vec<f64>]) -> Self {
        let terms: Vec<_> = coefficients.iter().copied().enumerate().filter(|(_, c)| *c != 0.0).collect();
        // A few coefficients are read one by one, many are read together with the zeros in a row. The limit between the two affects only
        // the time; a quarter is a judgement.
        let dense = (4 * terms.len() > coefficients.len()).then(|| coefficients.to_vec());
        Self { terms, dense, free: motions.iter().map(|motion| dot(motion, coefficients)).collect() }
    }

    #[inline]
    fn at(&self, x: &[f64]) -> f64 {
        match &self.dense {
            Some(dense) => dot(dense, x),
            None => self.terms.iter().map(|&(j, c)| c * x[j]).sum(),
        }
    }
}

/// The rigid motions of a free structure, integrated separately: they grow without bound, and K_∞ times them is pure rounding.
struct Free {
    motions: Vec<Vec<f64>>,
    /// Force on each motion for p = 1.
    load: Vec<f64>,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
}

impl Free {
    /// Splits load and initial velocity into the part that moves the free motions and the rest.
    fn split(assembled: &Assembled, task: &Transient<'_>) -> (Self, Vec<f64>, Vec<f64>) {
        let motions = assembled.free_motions();
        let mut rest = task.initial_velocity.clone().unwrap_or_else(|| vec![0.0; assembled.unknowns()]);
        let momenta = assembled.mass().times(&rest);
        let velocity: Vec<f64> = motions.iter().map(|motion| dot(motion, &momenta)).collect();
        assembled.remove(&mut rest, &motions);
        let load: Vec<f64> = motions.iter().map(|motion| dot(motion, &task.load)).collect();
        let mut held = task.load.clone();
        for (motion, part) in motions.iter().zip(&load) {
            add_scaled(&mut held, -part, &assembled.mass().times(motion));
        }
        let displacement = vec![0.0; motions.len()];
        (Self { motions, load, displacement, velocity }, held, rest)
    }

    /// One step of average acceleration, in which the mean force is `mean` times the load.
    fn step(&mut self, h: f64, mean: f64) {
        for ((x, v), g) in self.displacement.iter_mut().zip(&mut self.velocity).zip(&self.load) {
            *x += h * (*v + 0.5 * h * mean * g);
            *v += h * mean * g;
        }
    }
}

/// State and factors of the full model; x, v and a do not contain the free motions.
pub(crate) struct FullStepper<'a> {
    assembled: &'a Assembled,
    factor: Cholesky,
    stiffness: NodalProduct,
    dt: f64,
    x: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    /// K_∞ times the displacement predicted for the next step, and the increment of that displacement over the last prediction. K_∞ x is
    /// summed over increments to keep the digits that a large stiffness would cost at small strain.
    internal: Vec<f64>,
    increment: Vec<f64>,
    free: Free,
    /// The load as a functional, and the load without the part that accelerates the free motions.
    load: Functional,
    held_load: Vec<f64>,
    /// Index of the unknown of each slip, and A⁻¹ times its unit vector.
    unknowns: Vec<usize>,
    columns: Vec<Vec<f64>>,
    slips: SlipSolver,
    /// S of the slips' system, the slips' increments with the joints' forces held, and S times these increments.
    slip_stiffness: Square,
    slip_way: Vec<Group>,
    slip_load: Vec<Group>,
    forces_before: Vec<f64>,
    scratch: (Vec<f64>, Vec<f64>),
}

impl<'a> FullStepper<'a> {
    pub(crate) fn new(
        assembled: &'a Assembled,
        task: &Transient<'_>,
        joints: &mut Joints<'_>,
    ) -> Result<Self, Error> {
        let quarter = 0.25 * task.dt * task.dt;
        let effective = assembled.mass().plus(quarter, assembled.slipping_stiffness());
        let factor = Cholesky::new(assembled.analysis()?, &effective)?;
        let unknowns: Vec<usize> = assembled.slips().iter().map(|slip| slip.unknown).collect();
        let column = |&unknown: &usize| {
            let mut column = vec![0.0; assembled.unknowns()];
            column[unknown] = 1.0;
            factor.solve(&mut column);
            column
        };
        let columns: Vec<Vec<f64>> = unknowns.iter().map(column).collect();
        let count = unknowns.len();
        let stiffness = inverse_of(count, |i, j| quarter * columns[j][unknowns[i]])?;
        let (free, held_load, v) = Free::split(assembled, task);
        let p0 = task.pulse.at(0.0);
        let mut a: Vec<f64> = held_load.iter().map(|g| p0 * g).collect();
        if p0 != 0.0 {
            Cholesky::new(assembled.analysis()?, assembled.mass())?.solve(&mut a);
        }
        let increment = v.iter().zip(&a).map(|(v, a)| task.dt * v + quarter * a).collect();
        let groups = || vec![[0.0; LANES]; count.div_ceil(LANES)];
        Ok(Self {
            assembled,
            factor,
            stiffness: assembled.nodal_stiffness(),
            dt: task.dt,
            x: vec![0.0; assembled.unknowns()],
            v,
            a,
            internal: vec![0.0; assembled.unknowns()],
            increment,
            load: Functional::new(&task.load, &free.motions),
            free,
            held_load,
            unknowns,
            columns,
            slips: SlipSolver::new(&stiffness, joints)?,
            slip_stiffness: Square::new(count, &stiffness),
            slip_way: groups(),
            slip_load: groups(),
            forces_before: Vec::new(),
            scratch: (Vec::new(), Vec::new()),
        })
    }

    pub(crate) fn functional(&self, coefficients: &[f64]) -> Functional {
        Functional::new(coefficients, &self.free.motions)
    }

    /// Displacement of the load's point of attack.
    pub(crate) fn load_displacement(&self) -> f64 {
        self.load.at(&self.x) + dot(&self.load.free, &self.free.displacement)
    }

    pub(crate) fn velocity(&self, functional: &Functional) -> f64 {
        functional.at(&self.v) + dot(&functional.free, &self.free.velocity)
    }

    /// Acceleration of the functional at the applied force `p`.
    pub(crate) fn acceleration(&self, functional: &Functional, p: f64) -> f64 {
        functional.at(&self.a) + p * dot(&functional.free, &self.free.load)
    }

    pub(crate) fn slips(&self) -> &SlipSolver {
        &self.slips
    }

    /// Kinetic energy, and elastic energy without the joints.
    pub(crate) fn energies(&self) -> Energies {
        let (mass, stiffness) = (self.assembled.mass(), self.assembled.slipping_stiffness());
        let kinetic = mass.form(&self.v, &self.v) + dot(&self.free.velocity, &self.free.velocity);
        Energies { kinetic: 0.5 * kinetic, elastic: 0.5 * stiffness.square(&self.x) }
    }

    /// One step, over which the applied force changes from `before` to `p`.
    pub(crate) fn step(&mut self, joints: &mut Joints<'_>, before: f64, p: f64) -> Result<(), Error> {
        let (h, quarter) = (self.dt, 0.25 * self.dt * self.dt);
        for ((x, v), a) in self.x.iter_mut().zip(&mut self.v).zip(&self.a) {
            *x += h * *v + quarter * a;
            *v += 0.5 * h * a;
        }
        self.free.step(h, 0.5 * (before + p));
        self.stiffness.multiply(&self.increment, &mut self.a);
        for (internal, a) in self.internal.iter_mut().zip(&mut self.a) {
            *internal += *a;
            *a = -*internal;
        }
        if p != 0.0 {
            add_scaled(&mut self.a, p, &self.held_load);
        }
        for (&unknown, force) in self.unknowns.iter().zip(self.slips.forces()) {
            self.a[unknown] -= force;
        }
        self.factor.solve_with(&mut self.a, &mut self.scratch.0, &mut self.scratch.1);
        self.correct(joints, quarter)?;
        let state = self.x.iter_mut().zip(&mut self.v).zip(&mut self.increment);
        for (((x, v), increment), a) in state.zip(&self.a) {
            *x += quarter * a;
            *v += 0.5 * h * a;
            *increment = h * *v + 2.0 * quarter * a;
        }
        for (&unknown, slip) in self.unknowns.iter().zip(self.slips.slips()) {
            self.x[unknown] = *slip;
        }
        Ok(())
    }

    /// Solves for the joints' forces at the step's end, and subtracts their effect from the acceleration.
    fn correct(&mut self, joints: &mut Joints<'_>, quarter: f64) -> Result<(), Error> {
        for (i, &unknown) in self.unknowns.iter().enumerate() {
            let way = (self.x[unknown] - self.slips.slips()[i]) + quarter * self.a[unknown];
            self.slip_way[i / LANES][i % LANES] = way;
        }
        self.slip_stiffness.multiply(&self.slip_way, &mut self.slip_load);
        self.forces_before.clear();
        self.forces_before.extend_from_slice(self.slips.forces());
        self.slips.step(joints, &self.slip_load)?;
        for ((column, before), after) in self.columns.iter().zip(&self.forces_before).zip(self.slips.forces())
        {
            add_scaled(&mut self.a, before - after, column);
        }
        Ok(())
    }
}
