//! The size of a structure in numbers.

use maud::{Markup, html};
use serde::Serialize;

use super::linear::Linear;
use crate::page::numbers::short;

/// Numbers of nodes, elements, unknowns and joints of a structure.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Size {
    pub(crate) nodes: usize,
    pub(crate) elements: usize,
    pub(crate) unknowns: usize,
    pub(crate) joints: usize,
    pub(crate) slips: usize,
    pub(crate) total_mass: f64,
}

impl Size {
    /// The size of a structure.
    pub(crate) fn of(linear: &Linear) -> Self {
        let structure = &linear.file.structure;
        Self {
            nodes: structure.mesh.positions.len(),
            elements: structure.mesh.elements.len(),
            unknowns: linear.assembled.unknowns(),
            joints: structure.joints.len(),
            slips: linear.assembled.slips().len(),
            total_mass: linear.assembled.total_mass(),
        }
    }

    /// The size as a paragraph of a page.
    pub(crate) fn paragraph(&self) -> Markup {
        html! {
            p.about {
                (self.nodes) " nodes, " (self.elements) " elements, " (self.unknowns) " unknowns, " (self.joints) " joints with "
                (self.slips) " slips; total mass " (short(self.total_mass)) ". Units are the user's own consistent set."
            }
        }
    }
}
