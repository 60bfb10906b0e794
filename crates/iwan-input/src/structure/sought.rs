//! The parameters of a structure file that an update may seek: joints with four-parameter laws, and parts of the stiffness by name. The
//! parameters found become changes of the file.

use std::sync::Arc;

use iwan_core::FourParameter;
use iwan_fem::Correction;

use super::file::StructureFile;
use super::out::Changes;
use crate::written_law::WrittenLaw;

impl StructureFile {
    /// Joints whose laws can be sought: those whose slips share one four-parameter law, each with its number and law. The others keep their
    /// laws; their names are returned second.
    ///
    /// ```
    /// use iwan_input::{StructureFile, built_in_structure};
    /// let file = StructureFile::read(&built_in_structure("paper-a")?)?;
    /// let (laws, kept) = file.laws_to_seek();
    /// assert_eq!((laws.len(), laws[0].1.f_s(), kept.len()), (4, 300.0, 0));
    /// # Ok::<(), iwan_input::InputError>(())
    /// ```
    #[must_use]
    pub fn laws_to_seek(&self) -> (Vec<(usize, FourParameter)>, Vec<String>) {
        let (mut laws, mut kept) = (Vec::new(), Vec::new());
        for (number, joint) in self.structure.joints.iter().enumerate() {
            let written: Vec<Option<&WrittenLaw>> = joint
                .slips
                .iter()
                .filter_map(|slip| slip.law.as_ref())
                .map(|law| {
                    self.laws.iter().find(|known| Arc::ptr_eq(&known.law, law)).map(|known| &known.written)
                })
                .collect();
            let first = written.first().copied().flatten();
            let same = written.iter().all(|law| *law == first);
            match first {
                Some(WrittenLaw::FourParameter { k_t, f_s, chi, beta }) if same => {
                    if let Ok(law) = FourParameter::new(*k_t, *f_s, *chi, *beta) {
                        laws.push((number, law));
                    }
                }
                Some(_) => kept.push(format!(
                    "joint \"{}\" keeps its law: only joints with one four-parameter law in all directions are sought",
                    joint.name
                )),
                None => {}
            }
        }
        (laws, kept)
    }

    /// The part of the linear stiffness with this name: an element set with a material of its own, a lump, or `material` for all other
    /// elements.
    ///
    /// ```
    /// use iwan_fem::Correction;
    /// use iwan_input::{StructureFile, built_in_structure};
    /// let file = StructureFile::read(&built_in_structure("paper-a")?)?;
    /// assert_eq!(file.part("material"), Some(Correction::GeneralMaterial));
    /// assert_eq!(file.part("air"), None);
    /// # Ok::<(), iwan_input::InputError>(())
    /// ```
    #[must_use]
    pub fn part(&self, name: &str) -> Option<Correction> {
        let structure = &self.structure;
        let of_material =
            structure.materials.iter().position(|(set, _)| set == name).map(Correction::Material);
        let of_lump = structure.lumps.iter().position(|lump| lump.name == name).map(Correction::Springs);
        let general = (name == "material").then_some(Correction::GeneralMaterial);
        of_material.or(of_lump).or(general)
    }

    /// Names of all parts of the linear stiffness.
    #[must_use]
    pub fn parts(&self) -> Vec<String> {
        let sets = self.structure.materials.iter().map(|(set, _)| set.clone());
        let lumps = self.structure.lumps.iter().map(|lump| lump.name.clone());
        std::iter::once("material".to_owned()).chain(sets).chain(lumps).collect()
    }

    /// The parameters found, as changes of the file: laws with the numbers of their joints, and factors on parts of the stiffness.
    ///
    /// ```
    /// use iwan_core::FourParameter;
    /// use iwan_fem::Correction;
    /// use iwan_input::{StructureFile, built_in_structure, updated_structure};
    /// let text = built_in_structure("paper-a")?;
    /// let file = StructureFile::read(&text)?;
    /// let law = FourParameter::new(2e5, 250.0, -0.4, 0.1).map_err(|e| e.to_string())?;
    /// let changes = file.changes([(0, law)], [(Correction::GeneralMaterial, 1.5)]);
    /// assert_eq!((changes.laws.len(), changes.material), (1, Some(1.5)));
    /// assert!(updated_structure(&text, &changes)?.contains("f_s = 250.0"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn changes(
        &self,
        laws: impl IntoIterator<Item = (usize, FourParameter)>,
        factors: impl IntoIterator<Item = (Correction, f64)>,
    ) -> Changes {
        let structure = &self.structure;
        let mut changes = Changes::default();
        for (joint, law) in laws {
            let (k_t, f_s, chi, beta) = (law.k_t(), law.f_s(), law.chi(), law.beta());
            let law = WrittenLaw::FourParameter { k_t, f_s, chi, beta };
            changes.laws.push((structure.joints[joint].name.clone(), law));
        }
        for (part, factor) in factors {
            match part {
                Correction::GeneralMaterial => changes.material = Some(factor),
                Correction::Material(n) => changes.materials.push((structure.materials[n].0.clone(), factor)),
                Correction::Springs(n) => changes.lumps.push((structure.lumps[n].name.clone(), factor)),
            }
        }
        changes
    }
}
