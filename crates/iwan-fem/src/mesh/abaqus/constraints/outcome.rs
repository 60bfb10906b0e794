//! What the constraints of a file come to.

use super::super::super::constraint::{Constraint, PointMass, Section};
use super::super::super::error::MeshWarning;

/// What the kept keywords say.
#[derive(Debug, Default)]
pub(in super::super) struct Outcome {
    pub(in super::super) constraints: Vec<Constraint>,
    pub(in super::super) masses: Vec<PointMass>,
    pub(in super::super) sections: Vec<Section>,
    pub(in super::super) warnings: Vec<MeshWarning>,
}
