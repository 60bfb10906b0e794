//! The forced response of a structure at one of its points.

use iwan_input::scenario::{OnStructure, SweepTable};
use iwan_sim::{Control, forced_response_of};

use super::backbones::backbones;
use super::loops::of_joints;
use super::responses::{Response, by_level};
use crate::failure::Failure;
use crate::session::Session;
use crate::structures::{Asked, Linear, steady};
use iwan_input::Drive;

/// The response of the structure, and notes for the user.
pub(super) fn respond(
    on: &OnStructure,
    table: &SweepTable,
    session: &Session,
) -> Result<(Vec<Response>, Vec<String>), Failure> {
    let drive = drive(table)?;
    let (source, file) = on.load()?;
    let mut notes = file.notes.clone();
    let bar = session.bar("modes");
    let linear = Linear::computed(source, file, iwan_fem::NamedModes::LOOKED_UP, &bar)?;
    drop(bar);
    let reducing = session.bar("reducing");
    let damping_ratio = table.damping_ratio.unwrap_or(0.0);
    let asked = Asked { drive, at: table.at.clone(), damping_ratio, model: on.model };
    let steady = steady(&linear, asked, &reducing)?;
    drop(reducing);
    let busy = session.busy("balancing harmonics");
    let failed =
        |error: &iwan_sim::SimulationError| Failure::computation(format!("{}: {error}", linear.source));
    let curves = by_level(&table.sweep, session.threads(), &|sweep| forced_response_of(&steady.modes, sweep))
        .map_err(|error| failed(&error))?;
    let backbones = backbones(&steady.modes, &table.sweep, &curves).map_err(|error| failed(&error))?;
    drop(busy);
    if backbones.is_empty() {
        notes.push(format!(
            "no mode has its resonance between {} and {} Hz",
            table.sweep.from, table.sweep.to
        ));
    }
    notes.push(format!("response: {}", steady.output));
    let name = linear.file.title.clone().unwrap_or_else(|| linear.source.clone());
    let loops = of_joints(steady.modes.joints(), &curves);
    Ok((vec![Response { name, frequency: None, informed: None, curves, backbones, loops }], notes))
}

/// What drives the structure: its loads, or the motion of its base.
fn drive(table: &SweepTable) -> Result<Drive, Failure> {
    if table.sweep.control != Control::BaseAcceleration {
        return Ok(Drive::Loads);
    }
    table.direction.map(Drive::Base).ok_or_else(|| {
        let message = "[sweep]: base_acceleration of a structure needs the direction of its base's motion";
        Failure::input(message, "add direction = [x, y, z] to [sweep]")
    })
}
