//! `[[material]]` and `[elements]` of a structure file.

use iwan_fem::mesh::{Mesh, Section as MeshSection};
use iwan_fem::{Error, Formulation, Inertia, Material, Structure};
use iwan_machine::Kind;

use super::sets::known;
use crate::error::InputError;
use crate::section::{Section, plain};
use crate::text::InputText;

/// Keys of a material.
pub(super) const MATERIAL_KEYS: &[&str] = &["elements", "young", "poisson", "density"];
/// Keys of `[elements]`.
pub(super) const ELEMENT_KEYS: &[&str] = &["formulation", "mass"];

/// A structure of the mesh with its materials and element formulations. Materials of the mesh file are used only where the structure file
/// gives none at all.
pub(super) fn read(
    source: &InputText,
    top: &Section<'_>,
    mesh: Mesh,
    sections: &[MeshSection],
) -> Result<Structure, InputError> {
    let (mut general, mut special) = (None, Vec::new());
    if top.tables("material")?.is_empty() {
        for section in sections {
            special.push((section.elements.clone(), of_file(top, section)?));
        }
    }
    for (index, place) in top.tables("material")?.into_iter().enumerate() {
        let title = format!("material {}", index + 1);
        let section = Section::new(source, title, place, MATERIAL_KEYS)?;
        let material = material(&section)?;
        if section.optional_text("elements")?.is_some() {
            special.push((known(&section, "elements", "element", &mesh.element_sets)?, material));
        } else if general.replace(material).is_some() {
            let message = "a second material without `elements`: only one can be that of all other elements";
            return Err(section.failure("young", message, "add elements = \"SET\" to one of them"));
        }
    }
    let material = match general {
        Some(material) => material,
        None => covering(top, &mesh, &special)?,
    };
    let mut structure = Structure::new(mesh, material);
    structure.materials = special;
    if let Some(place) = top.optional_table("elements")? {
        let section = Section::new(source, "[elements]", place, ELEMENT_KEYS)?;
        let formulations = [
            ("incompatible-modes", Formulation::IncompatibleModes),
            ("displacement", Formulation::Displacement),
        ];
        let masses = [("consistent", Inertia::Consistent), ("lumped", Inertia::Lumped)];
        structure.formulation = section.choice("formulation", &formulations)?.unwrap_or_default();
        structure.inertia = section.choice("mass", &masses)?.unwrap_or_default();
    }
    Ok(structure)
}

/// A material of the mesh file.
fn of_file(top: &Section<'_>, section: &MeshSection) -> Result<Material, InputError> {
    let [young, poisson, density] = section.constants;
    Material::new(young, poisson, density).map_err(|error| {
        let message = format!("material {} of the mesh file: {error}", section.material);
        top.failure("mesh", &message, "correct it there, or give [[material]] here")
    })
}

fn material(section: &Section<'_>) -> Result<Material, InputError> {
    let number = |key| section.number(key);
    Material::new(number("young")?, number("poisson")?, number("density")?).map_err(|error| match error {
        Error::OutOfRange { name, value, allowed } => section
            .failure(
                name,
                &format!("{name} = {} is out of range: {allowed}", plain(value)),
                &format!("give {name} a value in that range, in the units of the mesh"),
            )
            .of(Kind::Value),
        error => section.failure("young", &error.to_string(), "correct the material"),
    })
}

/// The first material, if the materials of element sets cover all elements.
fn covering(top: &Section<'_>, mesh: &Mesh, special: &[(String, Material)]) -> Result<Material, InputError> {
    let mut without = vec![true; mesh.elements.len()];
    for element in special.iter().filter_map(|(set, _)| mesh.element_sets.get(set)).flatten() {
        without[*element] = false;
    }
    let bare = without.iter().position(|without| *without);
    match (special.first(), bare) {
        (Some((_, material)), None) => Ok(*material),
        (None, _) => {
            let remedy = "add [[material]] with young, poisson and density";
            Err(top.failure("material", "there is no material", remedy))
        }
        (_, Some(element)) => {
            let count = without.iter().filter(|w| **w).count();
            let label = mesh.elements[element].label;
            let message = format!("{count} elements have no material, the first is element {label}");
            let remedy = "add a [[material]] without `elements`: it is that of all other elements";
            Err(top.failure("material", &message, remedy))
        }
    }
}
