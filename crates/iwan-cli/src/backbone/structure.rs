//! The nonlinear modes of a structure.

use iwan_input::{Drive, StructureFile};
use iwan_sim::nonlinear_mode;

use super::args::BackboneArgs;
use super::curves::{Traced, amplitudes};
use crate::failure::Failure;
use crate::session::Session;
use crate::structures::{Asked, Linear, steady};

/// A structure with the settings that the file gives for the computation.
pub(super) struct OnStructure {
    pub(super) source: String,
    pub(super) file: StructureFile,
    pub(super) model: iwan_fem::Model,
    pub(super) at: Option<String>,
    pub(super) damping_ratio: f64,
}

/// The backbones of the modes that the options name; of the first three bending modes where they name none.
pub(super) fn trace(
    on: OnStructure,
    args: &BackboneArgs,
    highest: usize,
    session: &Session,
) -> Result<Vec<Traced>, Failure> {
    let bar = session.bar("modes");
    let linear = Linear::computed(on.source, on.file, iwan_fem::NamedModes::LOOKED_UP, &bar)?;
    drop(bar);
    let reducing = session.bar("reducing");
    let asked = Asked { drive: Drive::Nothing, at: on.at, damping_ratio: on.damping_ratio, model: on.model };
    let steady = steady(&linear, asked, &reducing)?;
    drop(reducing);
    let chosen = linear.chosen(&args.modes).map_err(|error| linear.failed(&error))?;
    let busy = session.busy("balancing harmonics");
    let names: Vec<String> = steady.modes.joints().iter().map(|joint| joint.name.clone()).collect();
    let mut traced = Vec::new();
    for mode in chosen {
        // The modes of the basis come first among its coordinates, in the order of the stuck modes.
        let number = mode.pair.stuck;
        let onset = steady.modes.macro_slip(number);
        let range = amplitudes(&linear.source, &mode.name, onset, args)?;
        let curve = nonlinear_mode(&steady.modes, number, highest, &range)
            .map_err(|error| Failure::computation(format!("{}: {}: {error}", linear.source, mode.name)))?;
        let frequency = linear.frequency_stuck(&mode);
        traced.push(Traced { name: mode.name, frequency, onset, slips: names.clone(), curve });
    }
    drop(busy);
    Ok(traced)
}
