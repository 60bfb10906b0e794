//! Stiffness and mass of one element. Each element has one file, with a drawing of its nodes.

mod material;
mod geometry;
mod isotropic;
mod rules;
mod hex8;
mod hex8_incompatible;
mod hex20;
mod tet4;
mod tet10;
mod wedge6;
mod wedge15;
mod quality;

use crate::error::Error;
use crate::mesh::Shape;
use geometry::NoVolume;
pub use material::Material;
pub(crate) use quality::{corner_quality, least_quality_inside};

/// Formulation of eight-node hexahedra; all other elements have displacements only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Formulation {
    /// With nine condensed incompatible modes, without locking in bending ([`Shape::Hex8`], as Abaqus' C3D8I).
    #[default]
    IncompatibleModes,
    /// With displacements only and 2 x 2 x 2 points: locks in bending; for comparison with other programs (C3D8, stdBrick).
    Displacement,
}

/// Distribution of the mass over the nodes of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Inertia {
    /// ∫ρ N_i N_j by the element's integration points: exact in bricks; by CalculiX's rules in tetrahedra and wedges.
    #[default]
    Consistent,
    /// Diagonal of the consistent matrix, scaled to the element's mass (Hinton, Rock and Zienkiewicz, Earthquake Eng.
    /// Struct. Dyn. 4:245, 1976, doi:10.1002/eqe.4290040305).
    Lumped,
}

/// Stiffness and mass of one element with n nodes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ElementMatrices {
    /// Stiffness, 3n x 3n, symmetric, row by row; degree of freedom 3i + a is displacement a of node i.
    pub stiffness: Vec<f64>,
    /// Mass, n x n, the same in each direction: nodes i and j are coupled by `mass[i * n + j]`.
    pub mass: Vec<f64>,
}

impl ElementMatrices {
    /// Computes stiffness and mass for an element of the given shape and node `positions` (one per node, in the order of [`Shape`]).
    ///
    /// # Errors
    /// [`Error::Element`], with `label`, for an element whose Jacobian is not positive at all integration points.
    ///
    /// ```
    /// use iwan_fem::{ElementMatrices, Formulation, Inertia, Material, mesh::Shape};
    /// let cube: Vec<[f64; 3]> = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
    ///     .map(|p| p.map(f64::from)).to_vec();
    /// let material = Material::new(1.0, 0.0, 8.0)?;
    /// let options = (Formulation::default(), Inertia::Lumped);
    /// let of = ElementMatrices::of(1, Shape::Hex8, options, &material, &cube)?;
    /// assert!((of.mass[0] - 1.0).abs() < 1e-14); // an eighth of the mass at each corner
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn of(
        label: u64,
        shape: Shape,
        (formulation, inertia): (Formulation, Inertia),
        material: &Material,
        positions: &[[f64; 3]],
    ) -> Result<Self, Error> {
        let mut matrices = Self::default();
        matrices
            .compute(shape, (formulation, inertia), material, positions)
            .map_err(|no_volume| no_volume.in_element(label))?;
        Ok(matrices)
    }

    /// [`Self::of`] in memory that is reused.
    pub(crate) fn compute(
        &mut self,
        shape: Shape,
        (formulation, inertia): (Formulation, Inertia),
        material: &Material,
        positions: &[[f64; 3]],
    ) -> Result<(), NoVolume> {
        let n = shape.nodes();
        assert_eq!(positions.len(), n, "an element of this shape has {n} nodes");
        for (matrix, length) in [(&mut self.stiffness, 9 * n * n), (&mut self.mass, n * n)] {
            matrix.clear();
            matrix.resize(length, 0.0);
        }
        let out = (self.stiffness.as_mut_slice(), self.mass.as_mut_slice());
        match (shape, formulation) {
            (Shape::Hex8, Formulation::IncompatibleModes) => {
                hex8_incompatible::matrices(material, positions, out)
            }
            (Shape::Hex8, Formulation::Displacement) => hex8::matrices(material, positions, out),
            (Shape::Hex20, _) => hex20::matrices(material, positions, out),
            (Shape::Tet4, _) => tet4::matrices(material, positions, out),
            (Shape::Tet10, _) => tet10::matrices(material, positions, out),
            (Shape::Wedge6, _) => wedge6::matrices(material, positions, out),
            (Shape::Wedge15, _) => wedge15::matrices(material, positions, out),
        }?;
        if inertia == Inertia::Lumped {
            lump(&mut self.mass, n);
        }
        Ok(())
    }
}

/// Keeps the diagonal only, scaled so that its sum is that of all entries.
fn lump(mass: &mut [f64], n: usize) {
    let total: f64 = mass.iter().sum();
    let diagonal: f64 = mass.iter().step_by(n + 1).sum();
    for (index, entry) in mass.iter_mut().enumerate() {
        *entry *= if index % (n + 1) == 0 { total / diagonal } else { 0.0 };
    }
}
