//! A reduced structure whose joints and stiffness can be changed without the mesh.
//!
//! In the coordinates of the reduced model the mass is 1 and the stuck stiffness is Λ. Another joint stiffness adds (K_T' - K_T) b bᵀ for
//! each slip, another material (c - 1) Vᵀ K_m V; both are small dense matrices. The basis of modes and attachment vectors stays that of the
//! structure as given, so frequencies are too high by an error of second order in the part of the new modes that the basis does not
//! contain.

use std::fmt;

use faer::Mat;

use crate::algebra::dot;
use crate::element::Material;
use crate::error::Error;
use crate::matrices::Assembled;
use crate::structure::{Law, Structure};
use crate::transient::Reduced;

/// A part of the linear stiffness that may be wrong by a factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Correction {
    /// Young's modulus of all elements that belong to no named material.
    GeneralMaterial,
    /// Young's modulus of the material with this index in [`Structure::materials`].
    Material(usize),
    /// Springs to the ground of the lump with this index in [`Structure::lumps`].
    Springs(usize),
}

impl Correction {
    /// The structure with this part of the stiffness doubled.
    fn doubled(self, structure: &Structure) -> Option<Structure> {
        let mut structure = structure.clone();
        let stiffer = |m: &Material| Material::new(2.0 * m.young(), m.poisson(), m.density()).ok();
        match self {
            Self::GeneralMaterial => structure.material = stiffer(&structure.material)?,
            Self::Material(index) => {
                let (_, material) = structure.materials.get_mut(index)?;
                *material = stiffer(material)?;
            }
            Self::Springs(index) => {
                let lump = structure.lumps.get_mut(index)?;
                lump.stiffness = lump.stiffness.map(|k| 2.0 * k);
            }
        }
        Some(structure)
    }
}

/// A reduced structure with the quantities that may be changed.
#[derive(Clone)]
pub struct Adjustable {
    /// Λ of the coordinates that strain the structure, 1/s².
    pub(super) eigenvalues: Vec<f64>,
    /// Number of rigid motions, which come before these coordinates.
    pub(super) zero: usize,
    /// Number of coordinates that are modes, rigid motions included; the others are attachment vectors.
    modes: usize,
    /// Laws of the slips that have one.
    pub(super) laws: Vec<Law>,
    names: Vec<String>,
    /// b by slip and coordinate.
    pub(super) participation: Vec<Vec<f64>>,
    /// Vᵀ K_m V of each part that may be corrected.
    pub(super) corrections: Vec<Mat<f64>>,
}

impl fmt::Debug for Adjustable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Adjustable")
            .field("eigenvalues", &self.eigenvalues)
            .field("slips", &self.names)
            .finish_non_exhaustive()
    }
}

impl Adjustable {
    /// The adjustable form of a reduced model, with the parts of the stiffness that may be corrected.
    ///
    /// # Errors
    /// [`Error::Analysis`] for a part that the structure does not have, or for matrices in place of elements; errors of
    /// [`Structure::assemble`].
    ///
    /// ```
    /// use iwan_fem::{Adjustable, Basis, Correction, mesh::beam::Configuration, paper};
    /// let assembled = paper::structure(Configuration::A, 1)?.assemble()?;
    /// let reduced = assembled.reduce(20, Basis::default())?;
    /// let adjustable = Adjustable::new(&reduced, &[Correction::GeneralMaterial])?;
    /// // With one material, all frequencies of the structure without joints are proportional to the square root of its modulus.
    /// let stiffer = adjustable.at(&[], &[], &[1.21])?;
    /// assert!(stiffer.mode(6)?.omega_squared() > 1.15 * reduced.eigenvalues()[6]);
    /// assert_eq!(adjustable.slips().len(), 8);
    /// # Ok::<(), iwan_fem::Error>(())
    /// ```
    pub fn new(reduced: &Reduced<'_>, corrections: &[Correction]) -> Result<Self, Error> {
        let assembled = reduced.assembled();
        let zero = reduced.modes().zero_modes();
        let kept: Vec<usize> = (zero..reduced.coordinates()).collect();
        let slips: Vec<_> =
            assembled.slips().iter().filter_map(|slip| Some((slip, slip.law.clone()?))).collect();
        let row = |unknown: usize| kept.iter().map(|&k| reduced.column(k)[unknown]).collect();
        let corrections = corrections
            .iter()
            .map(|correction| projected(assembled, reduced, &kept, *correction))
            .collect::<Result<Vec<_>, _>>()?;
        Ok(Self {
            eigenvalues: kept.iter().map(|&k| reduced.eigenvalues()[k]).collect(),
            zero,
            modes: reduced.modes().len(),
            participation: slips.iter().map(|(slip, _)| row(slip.unknown)).collect(),
            names: slips.iter().map(|(slip, _)| slip.name.clone()).collect(),
            laws: slips.into_iter().map(|(_, law)| law).collect(),
            corrections,
        })
    }

    /// Names of the slips with a law.
    #[must_use]
    pub fn slips(&self) -> &[String] {
        &self.names
    }

    /// Slip in a stuck mode; the index `mode` counts all modes, zero modes included. 0 for a rigid motion.
    #[must_use]
    pub fn participation(&self, slip: usize, mode: usize) -> f64 {
        mode.checked_sub(self.zero).map_or(0.0, |k| self.participation[slip][k])
    }

    /// Coordinate of a stuck mode, whose index counts all modes.
    pub(super) fn coordinate(&self, mode: usize) -> Result<usize, Error> {
        let elastic = (self.zero..self.modes).contains(&mode);
        mode.checked_sub(self.zero).filter(|_| elastic).ok_or_else(|| Error::Analysis {
            analysis: "curves of an adjusted structure",
            finding: format!("mode {mode} is not an elastic mode of the reduced model"),
            remedy: "reduce the structure to more modes, or choose one behind the zero modes",
        })
    }
}

/// Vᵀ K_m V of one part of the stiffness.
fn projected(
    assembled: &Assembled,
    reduced: &Reduced<'_>,
    kept: &[usize],
    correction: Correction,
) -> Result<Mat<f64>, Error> {
    let structure = assembled.structure();
    let of_matrices = structure.given.is_some() && !matches!(correction, Correction::Springs(_));
    let doubled = correction.doubled(structure).filter(|_| !of_matrices).ok_or_else(|| Error::Analysis {
        analysis: "correction of the stiffness",
        finding: format!("the structure has no part {correction:?}"),
        remedy: "name a material of its elements or springs that it has",
    })?;
    let doubled = doubled.assemble()?.stuck_stiffness();
    let part = doubled.plus(-1.0, &assembled.stuck_stiffness());
    let images: Vec<Vec<f64>> = kept.iter().map(|&k| part.times(reduced.column(k))).collect();
    let entry = |i: usize, j: usize| dot(reduced.column(kept[i]), &images[j]);
    Ok(Mat::from_fn(kept.len(), kept.len(), |i, j| 0.5 * (entry(i, j) + entry(j, i))))
}
