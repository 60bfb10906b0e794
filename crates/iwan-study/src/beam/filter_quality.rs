//! Quality of the modal filter of the paper's Eq. 18 on the modes of the reduced beam: how many modes it separates, and how much it amplifies noise.

use iwan_fem::Reduced;
use serde::Serialize;

use super::top_face::top_nodes;

/// Rank and condition of a modal filter.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FilterQuality {
    /// The displacements that the filter uses, in words.
    pub sensors: &'static str,
    /// Number of these displacements.
    pub channels: usize,
    /// Number of modes to be separated: those in the basis of the reduced beam.
    pub modes: usize,
    /// Number of modes that the filter can separate.
    pub rank: usize,
    /// Condition number of the mode shapes at the sensors: the largest factor by which noise may be amplified.
    pub condition: f64,
}

/// The quality of the filter with all displacements, and with those normal to the beam's top face alone.
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
