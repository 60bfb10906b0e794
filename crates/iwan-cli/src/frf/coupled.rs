//! The forced responses of modes that share joints.

use iwan_input::scenario::{SteadyScenario, SweepTable};
use iwan_sim::{Control, JointedModes, Mode, SharedJoint, SimulationError, StuckRange, forced_response_of};

use super::backbones::backbones;
use super::loops::of_joints;
use super::responses::{Response, by_level, refuse_of_structures, shape};
use crate::failure::Failure;
use crate::session::Session;

/// The modes and the joints that they share.
struct Coupled {
    modes: Vec<Mode>,
    joints: Vec<SharedJoint>,
}

/// At a named point, the response of all modes together; without a point, the modal displacement of each mode with its resonance in the band. Also
/// returns notes for the user.
pub(super) fn respond(
    name: &str,
    scenario: &SteadyScenario,
    table: &SweepTable,
    session: &Session,
) -> Result<(Vec<Response>, Vec<String>), Failure> {
    refuse_of_structures(name, table)?;
    let coupled = Coupled { modes: scenario.modes(), joints: scenario.joints() };
    let busy = session.busy("balancing harmonics");
    let failed = |error: SimulationError| failed(name, &error);
    let (within, notes) = coupled.within(table).map_err(failed)?;
    if within.is_empty() {
        let message =
            format!("{name}: no mode has its resonance in the band of [sweep]: {}", notes.join("; "));
        return Err(Failure::input(message, "choose from and to around a mode's frequency"));
    }
    let mut responses = Vec::new();
    if let Some(at) = &table.at {
        let shapes =
            coupled.modes.iter().map(|mode| shape(name, mode, table)).collect::<Result<Vec<_>, _>>()?;
        responses.push(coupled.response(at, None, &shapes, table, session).map_err(failed)?);
    } else {
        for r in within {
            let mode = &coupled.modes[r];
            let unit: Vec<f64> = (0..coupled.modes.len()).map(|i| f64::from(u8::from(i == r))).collect();
            let found = coupled.response(&mode.name, Some(mode.frequency), &unit, table, session);
            let informed = scenario.modes[r].informed;
            responses.push(Response { informed, ..found.map_err(failed)? });
        }
    }
    drop(busy);
    Ok((responses, notes))
}

impl Coupled {
    /// Indices of the modes with a resonance in the band, and notes on the other modes, which remain in the equations.
    fn within(&self, table: &SweepTable) -> Result<(Vec<usize>, Vec<String>), SimulationError> {
        let (from, to) = (table.sweep.from, table.sweep.to);
        let (mut within, mut notes) = (Vec::new(), Vec::new());
        let ranges = StuckRange::of_coupled(&self.modes, &self.joints)?;
        for (r, (mode, StuckRange { slipping, stuck })) in self.modes.iter().zip(ranges).enumerate() {
            if stuck < from || slipping > to {
                notes.push(format!(
                    "mode \"{}\" has its resonance outside {from} to {to} Hz, between {slipping:.4} and {stuck:.4} Hz; it takes part \
                     in the motion of the others",
                    mode.name
                ));
            } else {
                within.push(r);
            }
        }
        Ok((within, notes))
    }

    fn response(
        &self,
        name: &str,
        frequency: Option<f64>,
        at_output: &[f64],
        table: &SweepTable,
        session: &Session,
    ) -> Result<Response, SimulationError> {
        let mut system = JointedModes::of_coupled(&self.modes, &self.joints, at_output)?;
        if table.sweep.control == Control::BaseAcceleration {
            system = system.on_moving_base();
        }
        let curves = by_level(&table.sweep, session.threads(), &|sweep| forced_response_of(&system, sweep))?;
        let backbones = backbones(&system, &table.sweep, &curves)?;
        let loops = of_joints(system.joints(), &curves);
        Ok(Response { name: name.into(), frequency, informed: None, curves, backbones, loops })
    }
}

fn failed(name: &str, error: &SimulationError) -> Failure {
    match error {
        SimulationError::Interrupted => Failure::Interrupted,
        SimulationError::NotFinite { .. } => {
            Failure::computation(format!("{name}: {error}")).of(error.kind())
        }
        _ => Failure::input(format!("{name}: {error}"), "change this in the scenario").of(error.kind()),
    }
}
