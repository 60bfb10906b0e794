//! How well the modal filter of the paper's Eq. 18 tells the modes of the reduced beam apart.

use iwan_fem::Reduced;
use serde::Serialize;

use super::top_face::top_nodes;

/// Rank and condition of a modal filter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FilterQuality {
    /// Which displacements it takes, in words.
    pub sensors: &'static str,
    /// How many these are.
    pub channels: usize,
    /// Modes it is to tell apart: those in the basis of the reduced beam.
    pub modes: usize,
    /// Modes it can tell apart.
    pub rank: usize,
    /// Condition number of the mode shapes at the sensors: the factor by which noise may grow.
    pub condition: f64,
}

/// With all displacements, and with those across the beam's top face alone.
pub(super) fn filter_qualities(reduced: &Reduced<'_>) -> Result<Vec<FilterQuality>, iwan_fem::Error> {
    let (assembled, modes) = (reduced.assembled(), reduced.modes());
    let mesh = &assembled.structure().mesh;
    let all: Vec<usize> = (0..3 * mesh.positions.len()).collect();
    let across: Vec<usize> = top_nodes(mesh).into_iter().map(|n| 3 * n + 2).collect();
    let quality = |(sensors, dofs): (&'static str, Vec<usize>)| {
        let filter = assembled.modal_filter(modes, &dofs)?;
        let (rank, condition) = (filter.rank(), filter.condition());
        Ok(FilterQuality { sensors, channels: dofs.len(), modes: modes.len(), rank, condition })
    };
    [("all displacements", all), ("across the top face", across)].into_iter().map(quality).collect()
}
