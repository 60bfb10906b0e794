//! The paper's beam with four discrete Iwan joints (Deaner et al., Sec. 3.1 and Table 1), pounds-force, inches, seconds.

use std::sync::Arc;

use iwan_core::FourParameter;

use super::description::Structure;
use super::interface::{Interface, Joint, Law, Patch};
use crate::element::Material;
use crate::error::Error;
use crate::mesh::beam::{Configuration, INTERFACES, beam};

/// The joint of the paper's Table 1: K_T = 2.75e5 lbf/in, F_S = 300 lbf, χ = -0.3, β = 0.02.
///
/// # Errors
/// None occurs.
pub fn joint() -> Result<FourParameter, Error> {
    Ok(FourParameter::new(2.75e5, 300.0, -0.3, 0.02)?)
}

/// Beam, link and washers of steel 304, with Table 1's joint in x and y at each of the four interfaces; rigid patches
/// in configuration A, averaging ones in B. `refinement` 1 gives the paper's 1,554 nodes.
///
/// # Errors
/// None occurs.
///
/// ```
/// use iwan_fem::{mesh::beam::Configuration, paper};
/// let assembled = paper::structure(Configuration::A, 1)?.assemble()?;
/// assert_eq!(assembled.unknowns(), 4514);
/// assert!((assembled.total_mass() - 7.737125e-3).abs() < 1e-12);
/// # Ok::<(), iwan_fem::Error>(())
/// ```
pub fn structure(configuration: Configuration, refinement: usize) -> Result<Structure, Error> {
    let law: Law = Arc::new(joint()?);
    let patch = match configuration {
        Configuration::A => Patch::Rigid,
        Configuration::B => Patch::Averaging,
    };
    let mut structure =
        Structure::new(beam(configuration, refinement), Material::new(28.0e6, 0.29, 7.48e-4)?);
    structure.joints = INTERFACES
        .iter()
        .map(|(name, ..)| {
            Joint::new(*name, format!("{name} face"), format!("{name} patch"), Interface::Whole(patch))
                .slip([1.0, 0.0, 0.0], Some(law.clone()))
                .slip([0.0, 1.0, 0.0], Some(law.clone()))
        })
        .collect();
    Ok(structure)
}
