//! A structure as harmonic balance sees it.

use iwan_fem::{Basis, Model};
use iwan_sim::{JointedModes, Residual, SlipJoint, StuckMode};

use super::linear::Linear;
use crate::failure::Failure;

/// Modes of the basis unless the scenario says otherwise: those of the paper's beam reach to some 10 kHz, and attachment vectors
/// carry the static flexibility of all others.
const USUAL: usize = 50;

/// Stuck modes and joints of a structure under its loads, observed at a point.
#[derive(Debug)]
pub(crate) struct Steady {
    pub(crate) modes: JointedModes,
    /// The point, in words.
    pub(crate) output: String,
}

impl Steady {
    /// Of the structure with the point `at` (none: the first output of the file, else the loaded point), every elastic mode with the
    /// viscous ratio `damping_ratio`.
    pub(crate) fn new(
        linear: &Linear,
        model: Model,
        at: Option<&str>,
        damping_ratio: f64,
    ) -> Result<Self, Failure> {
        let assembled = &linear.assembled;
        let load = linear.file.forces(assembled).map_err(|error| linear.refused(error))?;
        let (output, coefficients) = observed(linear, at, &load)?;
        let basis = match model {
            Model::Basis(modes) => modes,
            Model::Kept => assembled.basis_of(model).map_err(|error| linear.failed(&error))?,
            _ => USUAL,
        };
        let failed = |error: iwan_fem::Error| linear.failed(&error);
        let reduced = assembled.reduce(basis.min(assembled.unknowns()), Basis::default()).map_err(failed)?;
        let reduced = reduced.with_damping(|_| damping_ratio).map_err(failed)?;
        let model = reduced.steady_model(&load, &coefficients).map_err(failed)?;
        let stuck = |c: &iwan_fem::SteadyCoordinate| StuckMode {
            omega: c.omega,
            damping_ratio: c.damping_ratio,
            at_force: c.at_force,
            at_output: c.at_output,
        };
        let modes = model.coordinates.iter().map(stuck).collect();
        let slip =
            |s: iwan_fem::SteadySlip| SlipJoint { name: s.name, law: s.law, participation: s.participation };
        let joints = model.slips.into_iter().map(slip).collect();
        let modes = JointedModes::new(modes, joints, Residual::default());
        let modes = modes.map_err(|error| Failure::Computation(format!("{}: {error}", linear.source)))?;
        Ok(Self { modes, output })
    }
}

/// The observed point: its name and its coefficients, one per unknown.
fn observed(linear: &Linear, at: Option<&str>, load: &[f64]) -> Result<(String, Vec<f64>), Failure> {
    let outputs = &linear.file.outputs;
    let found = match at {
        Some(name) => {
            let found = outputs.iter().find(|output| output.name == name);
            let known: Vec<&str> = outputs.iter().map(|output| output.name.as_str()).collect();
            Some(found.ok_or_else(|| {
                let message = format!("{}: there is no [[output]] \"{name}\"", linear.source);
                Failure::input(message, format!("give at = one of: {}", known.join(", ")))
            })?)
        }
        None => outputs.first(),
    };
    match found {
        Some(output) => {
            let own = linear.assembled.output(&output.name, &output.nodes, output.direction);
            let own = own.map_err(|error| linear.failed(&error))?;
            Ok((format!("displacement of the output \"{}\"", output.name), own.coefficients))
        }
        None => Ok(("displacement where the loads act, along them".into(), load.to_vec())),
    }
}
