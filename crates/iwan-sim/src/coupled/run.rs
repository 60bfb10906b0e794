//! Coupled modes in time steps, without checks of the input.

use std::time::Instant;

use iwan_core::{
    Backbone, Continuum, CoupledEnergy, CoupledModes, CoupledMotion, CoupledRows, JointEnergy,
    JointsInMotion, Lanes, OneJoint, Progress, Representation, Reversal, Run, Runs, SeveralJoints, Slider,
    Sliders, TabledFourParameter, groups,
};

use super::response::{CoupledResponse, JointHistory};
use super::task::{Task, of_mode, storage};
use crate::error::SimulationError;
use crate::joint_law::JointLaw;
use crate::joint_law::with_law;
use crate::methods::task::{CHUNK, MOST, finite, reversals};
use crate::response::Response;

/// Number of samples computed before they are distributed to modes and joints. With four modes their rows take 100 kB and stay in the cache
/// until then. From 256 to 4096 the time does not change.
const ROWS: usize = 1024;

/// Average acceleration with the joints in the given representation; the response contains the coupled modes only.
pub(super) fn newmark(
    task: &Task<'_>,
    prewarp: bool,
    joint: Representation,
    progress: Progress<'_>,
) -> Result<CoupledResponse, SimulationError> {
    let run = Stepping { task, coupled: task.coupled(prewarp)? };
    let mut response = match joint {
        Representation::Sliders { bins, grid } => {
            let mut tables = vec![vec![Slider::default(); Sliders::table_len(bins)]; task.joints.len()];
            let cut = |(joint, table)| {
                let joint: &super::joint::SharedJoint = joint;
                let table: &mut Vec<Slider> = table;
                with_law!(&joint.law, law => Sliders::discretise(law, grid, bins, table))
            };
            let laws = task.joints.iter().zip(&mut tables).map(cut).collect::<Result<Vec<_>, _>>()?;
            let virgin = |law: &Sliders<'_>| law.virgin(vec![Run::default(); law.len()]);
            let mut states = laws.iter().map(virgin).collect::<Result<Vec<_>, _>>()?;
            match (laws.as_slice(), states.as_mut_slice()) {
                ([law], [state]) => run.on_sliders(law, state, progress)?,
                (laws, states) => run.steps(
                    &mut SeveralJoints::new(laws, states, storage)?,
                    CoupledModes::integrate,
                    progress,
                )?,
            }
        }
        Representation::Continuum => match task.joints.as_slice() {
            [one] => match &one.law {
                JointLaw::FourParameter(law) => run.alone(TabledFourParameter::new(*law), progress)?,
                law => with_law!(law, law => run.alone(law, progress))?,
            },
            _ => run.together(progress)?,
        },
    };
    for (history, joint) in response.joints.iter_mut().zip(&task.joints) {
        history.name.clone_from(&joint.name);
        history.strongest = joint.law.strengths().1;
    }
    for (r, mode) in response.modes.iter_mut().enumerate() {
        let reach =
            |joint: &super::joint::SharedJoint| joint.law.strengths().1 / joint.participation[r].abs();
        mode.strongest = task.joints.iter().map(reach).fold(f64::INFINITY, f64::min);
    }
    Ok(response)
}

struct Stepping<'a> {
    task: &'a Task<'a>,
    coupled: Coupled,
}

/// Coupled modes that own their memory.
type Coupled = CoupledModes<Vec<Lanes>>;

impl Stepping<'_> {
    /// Memory for the reversals of a joint, which turns round at most as often as the fastest of the modes.
    fn stack(&self) -> Vec<Reversal> {
        let fastest = self.task.modes.iter().map(|mode| mode.frequency).fold(0.0, f64::max);
        vec![Reversal::default(); reversals(fastest * self.task.dt * self.task.samples as f64, MOST)]
    }

    /// One joint in the continuum.
    fn alone<B: Backbone>(&self, law: B, progress: Progress<'_>) -> Result<CoupledResponse, SimulationError> {
        let law = Continuum::new(law);
        let mut state = law.virgin(self.stack())?;
        let mut response =
            self.steps(&mut OneJoint::new(&law, &mut state), CoupledModes::integrate, progress)?;
        response.joints[0].forgotten_force = state.forgotten();
        Ok(response)
    }

    /// Several joints in the continuum.
    fn together(&self, progress: Progress<'_>) -> Result<CoupledResponse, SimulationError> {
        let shared = |joint: &super::joint::SharedJoint| -> Box<dyn Backbone> {
            match &joint.law {
                JointLaw::FourParameter(law) => Box::new(TabledFourParameter::new(*law)),
                other => Box::new(other.clone()),
            }
        };
        let boxed: Vec<_> = self.task.joints.iter().map(shared).collect();
        let laws: Vec<_> = boxed.iter().map(|law| Continuum::new(law.as_ref())).collect();
        let virgin = |law: &Continuum<&dyn Backbone>| law.virgin(self.stack());
        let mut states = laws.iter().map(virgin).collect::<Result<Vec<_>, _>>()?;
        let mut response = self.steps(
            &mut SeveralJoints::new(&laws, &mut states, storage)?,
            CoupledModes::integrate,
            progress,
        )?;
        for (history, state) in response.joints.iter_mut().zip(&states) {
            history.forgotten_force = state.forgotten();
        }
        Ok(response)
    }

    /// One joint on sliders, by the fast path for up to four modes.
    fn on_sliders(
        &self,
        law: &Sliders<'_>,
        state: &mut Runs<Vec<Run>>,
        progress: Progress<'_>,
    ) -> Result<CoupledResponse, SimulationError> {
        let mut joint = OneJoint::new(law, state);
        let step = |coupled: &Coupled,
                    motion: &mut CoupledMotion<Vec<Lanes>>,
                    joint: &mut OneJoint<'_, Sliders<'_>, Runs<Vec<Run>>>,
                    force: &[f64],
                    rows: &mut CoupledRows<'_>| {
            let (law, state) = joint.parts();
            coupled.integrate_sliders(motion, law, state, force, rows)
        };
        self.steps(&mut joint, step, progress)
    }

    /// Integrates in stretches, computes the energy balance, and checks that all values are finite.
    fn steps<J: JointsInMotion>(
        &self,
        joints: &mut J,
        mut step: impl FnMut(
            &Coupled,
            &mut CoupledMotion<Vec<Lanes>>,
            &mut J,
            &[f64],
            &mut CoupledRows<'_>,
        ) -> Result<(), iwan_core::Error>,
        progress: Progress<'_>,
    ) -> Result<CoupledResponse, SimulationError> {
        let Task { modes, force, samples, .. } = self.task;
        let (n, j) = (modes.len(), self.task.joints.len());
        let mut rows = Rows::new(ROWS.min(*samples), n, j);
        let mut response = self.room();
        let displacement: Vec<f64> = modes.iter().map(|mode| mode.initial.displacement).collect();
        let velocity: Vec<f64> = modes.iter().map(|mode| mode.initial.velocity).collect();
        let p0 = force.first().copied().unwrap_or(0.0);
        let mut motion = CoupledMotion::new(&self.coupled, joints, [&displacement, &velocity], p0, storage)?;
        let mut energy = CoupledEnergy::new(&self.coupled, storage)?;
        let stored = |joints: &dyn Fn(usize) -> f64| (0..j).map(joints).collect::<Vec<_>>();
        let before = stored(&|i| joints.stored_energy(i));
        let (clock, mut first, mut told) = (Instant::now(), 0, 0);
        loop {
            let count = (samples - first).min(ROWS);
            let rest = force.get(first..).unwrap_or(&[]);
            let mut stretch = rows.first(count);
            step(&self.coupled, &mut motion, joints, rest, &mut stretch)?;
            energy.add(&self.coupled, rest, &stretch)?;
            self.hand_out(&stretch, first, &mut response);
            first += count - 1;
            if first - told >= CHUNK || first + 1 >= *samples {
                told = first;
                if progress(first as f64 / (samples - 1).max(1) as f64).is_break() {
                    return Err(SimulationError::Interrupted);
                }
            }
            if first + 1 >= *samples {
                break;
            }
        }
        response.seconds = clock.elapsed().as_secs_f64();
        let after = stored(&|i| joints.stored_energy(i));
        response.energy = energy.balance(JointEnergy { start: before.iter().sum(), end: after.iter().sum() });
        for (i, joint) in response.joints.iter_mut().enumerate() {
            let work =
                |n: usize| 0.5 * (joint.force[n - 1] + joint.force[n]) * (joint.slip[n] - joint.slip[n - 1]);
            joint.friction = (1..*samples).map(work).sum::<f64>() - (after[i] - before[i]);
        }
        for (r, mode) in response.modes.iter_mut().enumerate() {
            mode.energy = energy.of_mode(r);
            mode.seconds = response.seconds;
            *mode = finite(std::mem::take(mode)).map_err(|error| of_mode(modes[r], error))?;
        }
        Ok(response)
    }

    fn room(&self) -> CoupledResponse {
        let Task { modes, joints, dt, samples, .. } = self.task;
        let zeros = || vec![0.0; *samples];
        let history = |_| JointHistory { slip: zeros(), force: zeros(), ..JointHistory::default() };
        CoupledResponse {
            modes: modes.iter().map(|_| Response::zeros(*dt, *samples)).collect(),
            joints: joints.iter().map(history).collect(),
            ..CoupledResponse::default()
        }
    }

    /// Distributes rows to modes and joints, from sample `first` on.
    fn hand_out(&self, rows: &CoupledRows<'_>, first: usize, response: &mut CoupledResponse) {
        let (width, j) = (groups(self.task.modes.len()), self.task.joints.len());
        let samples = rows.slip.len() / j;
        for (i, joint) in response.joints.iter_mut().enumerate() {
            let of_joint = |row: &[f64], to: &mut [f64]| {
                to.iter_mut().zip(row.iter().skip(i).step_by(j)).for_each(|(to, x)| *to = *x);
            };
            of_joint(rows.slip, &mut joint.slip[first..first + samples]);
            of_joint(rows.joint_force, &mut joint.force[first..first + samples]);
        }
        for (r, mode) in response.modes.iter_mut().enumerate() {
            let of_mode = |row: &[Lanes], to: &mut [f64]| {
                let values = row.as_flattened().iter().skip(r).step_by(4 * width);
                to.iter_mut().zip(values).for_each(|(to, x)| *to = *x);
            };
            of_mode(rows.displacement, &mut mode.displacement[first..first + samples]);
            of_mode(rows.velocity, &mut mode.velocity[first..first + samples]);
            of_mode(rows.acceleration, &mut mode.acceleration[first..first + samples]);
            let stiffness = self.task.modal_stiffness[r];
            for n in first..first + samples {
                mode.joint_force[n] = stiffness * mode.displacement[n];
            }
            for (joint, history) in self.task.joints.iter().zip(&response.joints) {
                let (b, k) = (joint.participation[r], joint.law.initial_stiffness());
                for n in first..first + samples {
                    mode.joint_force[n] += b * (history.force[n] - k * history.slip[n]);
                }
            }
        }
    }
}

/// The rows of one stretch.
struct Rows {
    width: usize,
    joints: usize,
    modal: [Vec<Lanes>; 3],
    of_joints: [Vec<f64>; 2],
}

impl Rows {
    fn new(samples: usize, modes: usize, joints: usize) -> Self {
        let width = groups(modes);
        Self {
            width,
            joints,
            modal: std::array::from_fn(|_| storage(samples * width)),
            of_joints: std::array::from_fn(|_| vec![0.0; samples * joints]),
        }
    }

    /// The first `count` rows.
    fn first(&mut self, count: usize) -> CoupledRows<'_> {
        let [displacement, velocity, acceleration] = &mut self.modal;
        let [slip, joint_force] = &mut self.of_joints;
        let (modal, joints) = (count * self.width, count * self.joints);
        CoupledRows {
            displacement: &mut displacement[..modal],
            velocity: &mut velocity[..modal],
            acceleration: &mut acceleration[..modal],
            slip: &mut slip[..joints],
            joint_force: &mut joint_force[..joints],
        }
    }
}
