//! Materials of element sets, from `*MATERIAL` with `*ELASTIC` and `*DENSITY`, and `*SOLID SECTION`.

use std::collections::BTreeMap;

use super::super::super::constraint::Section;
use super::super::super::error::MeshError;
use super::super::definition::Pending;
use super::lookup::Lookup;

/// Young's modulus and Poisson's ratio, and the density, as far as the file gives them.
#[derive(Debug, Clone, Copy, Default)]
struct Constants {
    elastic: Option<[f64; 2]>,
    density: Option<f64>,
}

/// Reads the materials of element sets. A section is left to the structure file if its material is not isotropic, depends on temperature,
/// or has no density.
pub(super) fn read(lookup: &Lookup, pending: &[Pending]) -> Result<Vec<Section>, MeshError> {
    let (mut materials, mut current): (BTreeMap<String, Constants>, _) = (BTreeMap::new(), None);
    for text in pending {
        let keyword = &text.keyword;
        match keyword.name.as_str() {
            "MATERIAL" => {
                let name = keyword.required(lookup.source, "NAME")?.to_uppercase();
                current = Some(name.clone());
                materials.entry(name).or_default();
            }
            "ELASTIC" | "DENSITY" => {
                let (Some(name), Some(row)) = (&current, text.rows.first()) else { continue };
                let isotropic =
                    keyword.value("TYPE").is_none_or(|t| t.to_ascii_uppercase().starts_with("ISO"));
                let constants = materials.entry(name.clone()).or_default();
                if keyword.name == "DENSITY" {
                    constants.density = Some(lookup.number(row, 0, "the density")?);
                } else if isotropic && text.rows.len() == 1 {
                    constants.elastic = Some([
                        lookup.number(row, 0, "Young's modulus")?,
                        lookup.number(row, 1, "Poisson's ratio")?,
                    ]);
                }
            }
            _ => {}
        }
    }
    let sections = pending.iter().filter(|text| text.keyword.name == "SOLID SECTION");
    let mut found = Vec::new();
    for text in sections {
        let keyword = &text.keyword;
        let (Some(set), Some(material)) = (keyword.value("ELSET"), keyword.value("MATERIAL")) else {
            continue;
        };
        let Some(Constants { elastic: Some([young, poisson]), density: Some(density) }) =
            materials.get(&material.to_uppercase())
        else {
            continue;
        };
        let Some(elements) = lookup.named.elements.spelled(set, text.within) else {
            let expected = "an element set of this file";
            return Err(lookup.source.malformed(
                keyword.place(lookup.source),
                format!("ELSET={set}"),
                expected,
            ));
        };
        let constants = [*young, *poisson, *density];
        found.push(Section { elements, constants, material: material.into() });
    }
    Ok(found)
}
