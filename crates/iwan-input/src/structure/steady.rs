//! A structure file in steady vibration: what drives the structure, where it is observed, and its modes and joints.

use iwan_fem::{Assembled, Basis, Model, NamedModes, Progress, SteadyCoordinate, SteadySlip};
use iwan_machine::listed;
use iwan_sim::{JointedModes, Residual, SlipJoint, StuckMode};

use super::file::StructureFile;
use super::run::RunError;
use crate::error::InputError;

/// Number of modes in the basis unless the user states another: those of the paper's beam reach some 10 kHz, and attachment vectors carry
/// the static flexibility of all other modes.
const USUAL: usize = 50;

/// Least share of the largest modal force at which a rigid-body motion counts as excited by the base, so that the base does not hold the
/// structure and the task is refused. Smaller shares are rounding.
const FREE: f64 = 1e-6;

/// The excitation of a structure in steady vibration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Drive {
    /// A force that is distributed over the loads of the file.
    Loads,
    /// An acceleration of the supports and of the springs' ground ends, along this direction of length 1; displacements are relative to the
    /// base.
    Base([f64; 3]),
    /// No excitation: nonlinear modes.
    Nothing,
}

/// What is to be computed of a structure in steady vibration.
#[derive(Debug, Clone, Copy)]
pub struct SteadyTask<'a> {
    /// The excitation.
    pub drive: Drive,
    /// Name of the output whose motion is the response; none: the first output of the file, or, where the file has none, the points where
    /// the loads act.
    pub at: Option<&'a str>,
    /// Viscous damping ratio of every elastic mode.
    pub damping_ratio: f64,
    /// The model, with its number of stuck modes; attachment vectors of the slips carry the flexibility of all other modes.
    pub model: Model,
}

/// A structure in the form that harmonic balance needs.
#[derive(Debug, Clone)]
pub struct SteadyStructure {
    /// The structure's stuck modes, and the joints that couple them.
    pub modes: JointedModes,
    /// Description of the response in words.
    pub output: String,
}

impl StructureFile {
    /// Reduces the structure, whose modes are `named`, for harmonic balance. `progress` is told the share of the reduction that is done.
    ///
    /// # Errors
    /// [`RunError`] for an unknown output, for a structure without a load, for a base that does not hold the structure, for damping beyond
    /// critical, and for a joint that slips in a rigid-body motion.
    ///
    /// ```
    /// use iwan_fem::{Model, NamedModes};
    /// use iwan_input::{Drive, SteadyTask, StructureFile, built_in_structure};
    /// let file = StructureFile::read(&built_in_structure("paper-a")?)?;
    /// let named = NamedModes::new(&file.structure, 3)?;
    /// let task = SteadyTask { drive: Drive::Loads, at: Some("tip"), damping_ratio: 1e-3, model: Model::Basis(12) };
    /// let steady = file.steady(&named, &task, iwan_core::progress::UNWATCHED)?;
    /// assert_eq!(steady.output, "displacement of the output \"tip\"");
    /// let number = named.named("bending 1")?.pair.stuck;
    /// let curve = iwan_sim::nonlinear_mode(&steady.modes, number, 3, &[1e-4, 1e-3])?;
    /// assert!(curve.points[1].frequency < curve.points[0].frequency);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn steady(
        &self,
        named: &NamedModes,
        task: &SteadyTask<'_>,
        progress: Progress<'_>,
    ) -> Result<SteadyStructure, RunError> {
        let assembled = &named.assembled;
        let load = self.driven(assembled, task.drive)?;
        let (output, coefficients) = self.observed(assembled, task)?;
        let basis = match task.model {
            model @ Model::Basis(_) => assembled.basis_of(model)?,
            model if model == Model::Kept || self.structure.kept.is_some() => {
                assembled.basis_of(Model::Kept)?
            }
            _ => USUAL.min(assembled.unknowns()),
        };
        let reduced = assembled.reduce_observed(basis, Basis::default(), progress)?;
        let model = reduced.with_damping(|_| task.damping_ratio)?.steady_model(&load, &coefficients)?;
        if let Drive::Base(direction) = task.drive {
            held(direction, &model.coordinates)?;
        }
        let stuck = |c: &SteadyCoordinate| StuckMode {
            omega: c.omega,
            damping_ratio: c.damping_ratio,
            at_force: c.at_force,
            at_output: c.at_output,
        };
        let modes = model.coordinates.iter().map(stuck).collect();
        let slip = |s: SteadySlip| SlipJoint { name: s.name, law: s.law, participation: s.participation };
        let joints = model.slips.into_iter().map(slip).collect();
        let modes = JointedModes::new(modes, joints, Residual::default()).map_err(|error| {
            let remedy = "let stiffness beside the joints hold what they connect: a slip that nothing brings back has no steady motion";
            InputError::new(format!("steady vibration: {error}"), remedy)
        })?;
        Ok(SteadyStructure { modes, output })
    }

    /// Forces on the unknowns under an excitation of size 1.
    fn driven(&self, assembled: &Assembled, drive: Drive) -> Result<Vec<f64>, RunError> {
        match drive {
            Drive::Loads => Ok(self.forces(assembled)?),
            Drive::Base(direction) => Ok(assembled.base_force(direction)?),
            Drive::Nothing => Ok(vec![0.0; assembled.unknowns()]),
        }
    }

    /// The observed point: its name, and its coefficients, one per unknown.
    fn observed(&self, assembled: &Assembled, task: &SteadyTask<'_>) -> Result<(String, Vec<f64>), RunError> {
        let found = match task.at {
            Some(name) => {
                let found = self.outputs.iter().find(|output| output.name == name);
                let known: Vec<&str> = self.outputs.iter().map(|output| output.name.as_str()).collect();
                Some(found.ok_or_else(|| {
                    let remedy = if known.is_empty() {
                        "add [[output]] with name, nodes and direction".to_owned()
                    } else {
                        format!("give at = one of: {}", listed(known))
                    };
                    InputError::new(format!("there is no [[output]] \"{name}\""), remedy)
                })?)
            }
            None => self.outputs.first(),
        };
        if let Some(output) = found {
            let own = output.at.forces(assembled, 1.0)?;
            return Ok((format!("displacement of the output \"{}\"", output.name), own));
        }
        if matches!(task.drive, Drive::Base(_)) {
            let message =
                "the structure has no [[output]]: nothing says whose response to the base's motion is meant";
            return Err(InputError::new(message, "add [[output]] with name, nodes and direction").into());
        }
        Ok(("displacement where the loads act, along them".into(), self.forces(assembled)?))
    }
}

/// Refuses a base that does not hold the structure.
fn held(direction: [f64; 3], coordinates: &[SteadyCoordinate]) -> Result<(), InputError> {
    let most = coordinates.iter().fold(0.0, |most: f64, c| most.max(c.at_force.abs()));
    let free = coordinates.iter().any(|c| c.omega == 0.0 && c.at_force.abs() > FREE * most);
    if !free {
        return Ok(());
    }
    let message = format!(
        "base_acceleration: nothing holds the structure to its base along {direction:?}: it would stay where it is"
    );
    Err(InputError::new(
        message,
        "add [[support]] or a spring to the ground, or give force in place of base_acceleration",
    ))
}
