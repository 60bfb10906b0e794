//! Time integration of the reduced model: a step is one sweep over the coordinates, and the small system of the slips.
//!
//! The scheme is average acceleration (Newmark β = 1/4, γ = 1/2) in the mean velocity v̄ of a step. With e = dt ζω + dt²λ/4 and d = 1/(1 +
//! e) it is v̄ = v + d [dt/2 (p̄ g - λ q - Bᵀ N̄) - e v], q' = q + dt v̄, v' = 2 v̄ - v, where N = F(s) - K_T s is the difference of the
//! joints' forces from those of stuck joints. With N held over the step the slips move by Δs*; then (C⁻¹ - K_T) Δs + ΔF = C⁻¹ Δs* with C =
//! dt²/4 B d Bᵀ. One sweep completes a step and begins the next. (In exact arithmetic a first term d v would do the same, but the rounding
//! of d would act as damping: some 1e-16 of the energy in each step, always of one sign.)
#![expect(clippy::inline_always, reason = "what is not inlined does not get the wide registers")]

use std::time::Instant;

use super::joint_states::{Joints, tables};
use super::reduction::Reduced;
use super::response::{Energies, OBSERVED, Recorder, StructureResponse};
use super::slip_solver::{SlipSolver, Square};
use super::task::Transient;
use super::watch::{Keeper, Watch};
use crate::algebra::{Group, LANES, grouped, total};
use crate::error::Error;
use crate::matrices::inverse_of;
use iwan_core::progress::UNWATCHED;

impl Reduced<'_> {
    /// Integrates the reduced model; outputs are functionals of the unknowns of the full model.
    ///
    /// # Errors
    /// The errors of [`Assembled::transient`](crate::Assembled::transient).
    ///
    /// ```
    /// use iwan_core::Pulse;
    /// use iwan_fem::{Basis, Representation, Transient, mesh::beam::Configuration, paper};
    /// let assembled = paper::structure(Configuration::A, 1)?.assemble()?;
    /// let reduced = assembled.reduce(50, Basis::default())?;
    /// let response = reduced.transient(&Transient {
    ///     dt: 1e-5,
    ///     steps: 1000,
    ///     pulse: Pulse::Haversine { amplitude: 10.0, duration: 1.6e-3 },
    ///     load: assembled.load("tip", [0.0, 0.0, 1.0])?,
    ///     initial_velocity: None,
    ///     representation: Representation::DEFAULT_IN_A_STRUCTURE,
    ///     outputs: vec![assembled.modal_output("bending 1", reduced.modes(), 6)],
    /// })?;
    /// let peak = response.outputs[0].acceleration.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
    /// assert!((peak / 220.78 - 1.0).abs() < 2e-3);
    /// assert!(response.energy.error() < 1e-12);
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
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
        let assembled = self.assembled();
        task.check(assembled.unknowns(), assembled.slips().len())?;
        let slips = assembled.slips();
        let mut memory = tables(slips.len(), task.representation);
        let mut joints =
            Joints::new(slips.iter().map(|slip| slip.law.as_ref()), task.representation, &mut memory)?;
        let mut stepper = Stepper::new(self, task, &mut joints)?;
        let outputs: Vec<Reading> =
            task.outputs.iter().map(|o| Reading::new(&self.project(&o.coefficients))).collect();
        let mut recorder = Recorder::new(task, slips.iter().map(|slip| slip.name.clone()));
        for (i, output) in outputs.iter().enumerate() {
            recorder.begin(i, output.read(&stepper.v), output.read(&stepper.a));
        }
        recorder.slips(&stepper.slips);
        let (force, start, clock) = (task.force(), stepper.energies(), Instant::now());
        let damped = self.damping().iter().any(|c| *c != 0.0);
        // The widest vector registers of the processor. No product is fused with a sum, so the bits are the same with any width.
        let registers = pulp::Arch::new();
        stepper.predict(0.5 * (force[0] + force.get(1).unwrap_or(&0.0)));
        let mut keeper = Keeper::new(&watch, assembled, task, &force, |digest| {
            digest.text("reduced").numbers(self.eigenvalues()).numbers(self.damping())
        });
        let done = keeper.resume(&mut recorder, &mut |see| numbers(&mut stepper, &mut joints, see))?;
        for n in done + 1..=task.steps {
            let ahead = force.get(n + 1).copied().unwrap_or(0.0);
            let mean = 0.5 * (force[n - 1] + force[n]);
            stepper.solve_slips(&mut joints)?;
            let next = 0.5 * (force[n] + ahead);
            let sweep = Sweep { stepper: &mut stepper, damped, p: force[n], next };
            let (travelled, lost) = registers.dispatch(sweep);
            recorder.work(mean * travelled);
            recorder.viscous(lost);
            for (i, output) in outputs.iter().enumerate() {
                recorder.output(i, output.read(&stepper.a));
            }
            recorder.slips(&stepper.slips);
            if n % OBSERVED == 0 {
                if (watch.progress)(n as f64 / task.steps as f64).is_break() {
                    keeper.keep(n, &mut recorder, &mut |see| numbers(&mut stepper, &mut joints, see));
                    return Err(Error::Interrupted);
                }
                keeper.keep_in_time(n, &mut recorder, &mut |see| numbers(&mut stepper, &mut joints, see));
            }
        }
        keeper.keep(task.steps, &mut recorder, &mut |see| numbers(&mut stepper, &mut joints, see));
        let seconds = clock.elapsed().as_secs_f64();
        recorder.finish(&mut joints, assembled.strongest(), [start, stepper.energies()], seconds)
    }
}

/// Passes every number that one step leaves to the next to `see`.
fn numbers(stepper: &mut Stepper, joints: &mut Joints<'_>, see: &mut dyn FnMut(&mut f64)) {
    let lists = [
        &mut stepper.q,
        &mut stepper.v,
        &mut stepper.a,
        &mut stepper.mean,
        &mut stepper.joint,
        &mut stepper.ahead,
    ];
    lists.into_iter().flat_map(|list| list.as_flattened_mut()).for_each(&mut *see);
    stepper.slips.each_number(see);
    joints.each_number(see);
}

/// A functional of the coordinates: a multiple of one coordinate, or a weighted sum of all.
enum Reading {
    One(usize, f64),
    All(Vec<Group>),
}

/// Coefficients below this part of the largest count as rounding of a projection; those of a modal coordinate are 1e-15 or less. If only
/// one coefficient is left, the functional is read as that coordinate alone, which saves the sum over all in every step.
const ROUNDING: f64 = 1e-9;

impl Reading {
    fn new(coefficients: &[f64]) -> Self {
        let largest = coefficients.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        let mut large = coefficients.iter().enumerate().filter(|(_, c)| c.abs() > ROUNDING * largest);
        match (large.next(), large.next()) {
            (Some((k, &c)), None) => Self::One(k, c),
            _ => Self::All(grouped(coefficients)),
        }
    }

    #[inline]
    fn read(&self, values: &[Group]) -> f64 {
        match self {
            Self::One(k, c) => c * values[k / LANES][k % LANES],
            Self::All(coefficients) => {
                let mut sums = [0.0; LANES];
                for (c, x) in coefficients.iter().zip(values) {
                    for lane in 0..LANES {
                        sums[lane] += c[lane] * x[lane];
                    }
                }
                total(&sums)
            }
        }
    }
}

/// State and constants of the reduced model.
struct Stepper {
    dt: f64,
    q: Vec<Group>,
    v: Vec<Group>,
    a: Vec<Group>,
    /// v̄ of the present step, with the joints' forces held.
    mean: Vec<Group>,
    /// Bᵀ N.
    joint: Vec<Group>,
    eigenvalues: Vec<Group>,
    /// 2ζω.
    damping: Vec<Group>,
    /// e = dt ζω + dt² λ/4, and d = 1/(1 + e).
    excess: Vec<Group>,
    compliance: Vec<Group>,
    load: Vec<Group>,
    /// B: for each slip, all coordinates in a row.
    slip_shapes: Vec<Group>,
    /// Stiffness K_T of each slip's joint.
    k_t: Vec<f64>,
    slips: SlipSolver,
    /// C⁻¹.
    inverse: Square,
    slip_way: Vec<Group>,
    slip_load: Vec<Group>,
    /// Change of N in the last step.
    change: Vec<f64>,
    /// Bᵀ v̄, per lane; dt times its sum over the lanes is Δs*.
    ahead: Vec<Group>,
}

impl Stepper {
    fn new(reduced: &Reduced<'_>, task: &Transient<'_>, joints: &mut Joints<'_>) -> Result<Self, Error> {
        let assembled = reduced.assembled();
        let (count, r) = (assembled.slips().len(), reduced.coordinates());
        let quarter = 0.25 * task.dt * task.dt;
        let terms = reduced.eigenvalues().iter().zip(reduced.damping());
        let e: Vec<f64> = terms.map(|(lambda, c)| 0.5 * task.dt * c + quarter * lambda).collect();
        let d: Vec<f64> = e.iter().map(|e| 1.0 / (1.0 + e)).collect();
        let shape = |i: usize, k: usize| reduced.column(k)[assembled.slips()[i].unknown];
        let coupling =
            |i: usize, j: usize| quarter * (0..r).map(|k| shape(i, k) * d[k] * shape(j, k)).sum::<f64>();
        let inverse = inverse_of(count, coupling)?;
        let k_t: Vec<f64> = (0..count).map(|i| joints.trial(i, 0.0).1).collect();
        let mut stiffness = inverse.clone();
        (0..count).for_each(|i| stiffness[i * count + i] -= k_t[i]);
        let groups = r.div_ceil(LANES);
        let slip_shapes = (0..count).flat_map(|i| grouped(&(0..r).map(|k| shape(i, k)).collect::<Vec<_>>()));
        let slip_shapes = slip_shapes.collect();
        let load = reduced.project(&task.load);
        let p0 = task.pulse.at(0.0);
        let velocity = match &task.initial_velocity {
            Some(v) => reduced.project(&assembled.mass().times(v)),
            None => vec![0.0; r],
        };
        let damped = velocity.iter().zip(reduced.damping()).map(|(v, c)| c * v);
        let start: Vec<f64> = load.iter().zip(damped).map(|(g, lost)| p0 * g - lost).collect();
        let zero = || vec![[0.0; LANES]; groups];
        let slip_groups = || vec![[0.0; LANES]; count.div_ceil(LANES)];
        Ok(Self {
            dt: task.dt,
            q: zero(),
            v: grouped(&velocity),
            a: grouped(&start),
            mean: zero(),
            joint: zero(),
            eigenvalues: grouped(reduced.eigenvalues()),
            damping: grouped(reduced.damping()),
            excess: grouped(&e),
            compliance: grouped(&d),
            load: grouped(&load),
            slip_shapes,
            k_t,
            slips: SlipSolver::new(&stiffness, joints)?,
            inverse: Square::new(count, &inverse),
            slip_way: slip_groups(),
            slip_load: slip_groups(),
            change: vec![0.0; count],
            ahead: vec![[0.0; LANES]; count],
        })
    }

    /// Kinetic energy, and elastic energy without the joints.
    fn energies(&self) -> Energies {
        let mut sums = [[0.0; LANES]; 2];
        for ((q, v), lambda) in self.q.iter().zip(&self.v).zip(&self.eigenvalues) {
            for lane in 0..LANES {
                sums[0][lane] += 0.5 * v[lane] * v[lane];
                sums[1][lane] += 0.5 * lambda[lane] * q[lane] * q[lane];
            }
        }
        let stuck: f64 = self.k_t.iter().zip(self.slips.slips()).map(|(k, s)| 0.5 * k * s * s).sum();
        Energies { kinetic: total(&sums[0]), elastic: total(&sums[1]) - stuck }
    }

    /// Begins the first step, in which the mean force is `p`.
    fn predict(&mut self, p: f64) {
        let half = 0.5 * self.dt;
        for g in 0..self.q.len() {
            let (v, d, e, load) = (&self.v[g], &self.compliance[g], &self.excess[g], &self.load[g]);
            self.mean[g] = std::array::from_fn(|l| v[l] + d[l] * (half * p * load[l] - e[l] * v[l]));
        }
        self.read_slips();
    }

    /// Writes Bᵀ v̄ to `ahead`.
    #[inline(always)]
    fn read_slips(&mut self) {
        for (sum, shapes) in self.ahead.iter_mut().zip(self.slip_shapes.chunks_exact(self.mean.len())) {
            let mut sums = [0.0; LANES];
            for (shape, mean) in shapes.iter().zip(&self.mean) {
                for l in 0..LANES {
                    sums[l] += shape[l] * mean[l];
                }
            }
            *sum = sums;
        }
    }

    /// Solves for the joints' forces at the end of the present step.
    #[inline]
    fn solve_slips(&mut self, joints: &mut Joints<'_>) -> Result<(), Error> {
        for (i, sum) in self.ahead.iter().enumerate() {
            self.slip_way[i / LANES][i % LANES] = self.dt * total(sum);
        }
        self.inverse.multiply(&self.slip_way, &mut self.slip_load);
        self.change.iter_mut().zip(self.slips.forces()).for_each(|(change, force)| *change = *force);
        self.slips.step(joints, &self.slip_load)?;
        let after = self.slips.forces().iter().zip(self.slips.increments()).zip(&self.k_t);
        for (change, ((force, increment), k_t)) in self.change.iter_mut().zip(after) {
            *change = (force - *change) - k_t * increment;
        }
        Ok(())
    }

    /// Completes the step, at whose end the force is `p`, and begins the next step, in which the mean force is `next`. Returns the
    /// displacement of the load's point of attack over the step, and the energy lost in viscous damping.
    #[inline(always)]
    fn sweep<const DAMPED: bool>(&mut self, p: f64, next: f64) -> (f64, f64) {
        let (h, half, quarter) = (self.dt, 0.5 * self.dt, 0.25 * self.dt);
        let (mut travelled, mut lost) = ([0.0; LANES], [0.0; LANES]);
        let groups = self.q.len();
        for g in 0..groups {
            let mut change = [0.0; LANES];
            for (shapes, n) in self.slip_shapes.chunks_exact(groups).zip(&self.change) {
                for l in 0..LANES {
                    change[l] += shapes[g][l] * n;
                }
            }
            // Local copies, so that the compiler knows that these arrays do not overlap.
            let (mut q, mut v, mut a) = (self.q[g], self.v[g], self.a[g]);
            let (mut joint, mut mean) = (self.joint[g], self.mean[g]);
            let (d, e, lambda) = (self.compliance[g], self.excess[g], self.eigenvalues[g]);
            let (load, damping) = (self.load[g], self.damping[g]);
            for l in 0..LANES {
                joint[l] += change[l];
                let velocity = mean[l] - quarter * d[l] * change[l];
                q[l] += h * velocity;
                v[l] = 2.0 * velocity - v[l];
                travelled[l] += h * load[l] * velocity;
                let held = -(lambda[l] * q[l] + joint[l]);
                a[l] = p * load[l] + held;
                if DAMPED {
                    a[l] -= damping[l] * v[l];
                    lost[l] += h * damping[l] * velocity * velocity;
                }
                mean[l] = v[l] + d[l] * (half * (next * load[l] + held) - e[l] * v[l]);
            }
            (self.q[g], self.v[g], self.a[g]) = (q, v, a);
            (self.joint[g], self.mean[g]) = (joint, mean);
        }
        self.read_slips();
        (total(&travelled), total(&lost))
    }
}

/// [`Stepper::sweep`] in the widest vector registers of the processor.
struct Sweep<'a> {
    stepper: &'a mut Stepper,
    damped: bool,
    p: f64,
    next: f64,
}

impl pulp::NullaryFnOnce for Sweep<'_> {
    type Output = (f64, f64);

    #[inline(always)]
    fn call(self) -> (f64, f64) {
        if self.damped {
            self.stepper.sweep::<true>(self.p, self.next)
        } else {
            self.stepper.sweep::<false>(self.p, self.next)
        }
    }
}
