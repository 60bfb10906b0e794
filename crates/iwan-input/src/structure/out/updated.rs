//! A structure file with other joint laws and factors on its stiffness; all else stays as it was written.

use std::ops::Range;

use crate::error::InputError;
use crate::section::Section;
use crate::text::{InputText, quoted};
use crate::written_law::WrittenLaw;

/// Changes to be made in a structure file.
#[derive(Debug, Clone, Default)]
pub struct Changes {
    /// Laws with the name of their joint: each slip of the joint that has a law gets the new one.
    pub laws: Vec<(String, WrittenLaw)>,
    /// Factor on `young` of the material that has no key `elements`.
    pub material: Option<f64>,
    /// Factors on `young`, with the name of the material's element set.
    pub materials: Vec<(String, f64)>,
    /// Factors on `stiffness`, with the name of the lump.
    pub lumps: Vec<(String, f64)>,
}

/// The text of a structure file with these changes. It may be put into any folder: the path of its mesh becomes absolute.
///
/// # Errors
/// [`InputError`] where the text is no structure file, where a law is a table of its own rather than `law = { ... }`, or where the
/// structure consists of matrices, whose paths are relative.
///
/// ```
/// use iwan_input::{Changes, InputText, StructureFile, WrittenLaw, built_in_structure, updated_structure};
/// let law = WrittenLaw::FourParameter { k_t: 2e5, f_s: 250.0, chi: -0.4, beta: 0.1 };
/// let changes = Changes { laws: vec![("left link".into(), law)], material: Some(1.5), ..Changes::default() };
/// let text = updated_structure(&built_in_structure("paper-a")?, &changes)?;
/// assert!(text.contains("{ k_t = 200000.0, f_s = 250.0, chi = -0.4, beta = 0.1 }") && text.contains("young = 42000000.0"));
/// assert!(StructureFile::read(&InputText::built_in("updated", &text)).is_ok());
/// # Ok::<(), iwan_input::InputError>(())
/// ```
pub fn updated_structure(source: &InputText, changes: &Changes) -> Result<String, InputError> {
    let document = source.document("paper-a")?;
    let top = Section::any(source, "the structure", document.top());
    if top.has("matrices") {
        let message = "its paths are relative to this file, and are not rewritten";
        return Err(top.failure("matrices", message, "enter the values of update.json by hand"));
    }
    let mut edits: Vec<(Range<usize>, String)> = Vec::new();
    if let Some(place) = top.optional_table("mesh")? {
        let mesh = Section::any(source, "[mesh]", place);
        if let (true, Some(span)) = (mesh.is_text("path"), mesh.span("path")) {
            let path = source.folder.join(mesh.text("path")?);
            let absolute = std::path::absolute(&path).unwrap_or(path);
            edits.push((span, quoted(&absolute.display().to_string())));
        }
    }
    joints(source, &top, changes, &mut edits)?;
    for place in top.tables("material")? {
        let material = Section::any(source, "a material", place);
        let factor = match material.optional_text("elements")? {
            Some(set) => changes.materials.iter().find(|(name, _)| *name == set).map(|(_, factor)| *factor),
            None => changes.material,
        };
        if let (Some(factor), Some(span)) = (factor, material.span("young")) {
            edits.push((span, number(factor * material.number("young")?)));
        }
    }
    for place in top.tables("lump")? {
        let lump = Section::any(source, "a lump", place);
        let name = lump.text("name")?;
        let factor = changes.lumps.iter().find(|(known, _)| *known == name).map(|(_, factor)| *factor);
        if let (Some(factor), Some(span)) = (factor, lump.span("stiffness")) {
            let values: Vec<String> = lump.numbers("stiffness")?.iter().map(|k| number(factor * k)).collect();
            edits.push((span, format!("[{}]", values.join(", "))));
        }
    }
    edits.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
    let mut text = source.text.clone();
    for (span, new) in edits {
        text.replace_range(span, &new);
    }
    Ok(text)
}

fn joints(
    source: &InputText,
    top: &Section<'_>,
    changes: &Changes,
    edits: &mut Vec<(Range<usize>, String)>,
) -> Result<(), InputError> {
    for place in top.tables("joint")? {
        let joint = Section::any(source, "a joint", place);
        let name = joint.text("name")?;
        let Some((_, law)) = changes.laws.iter().find(|(known, _)| *known == name) else { continue };
        let WrittenLaw::FourParameter { k_t, f_s, chi, beta } = law else { continue };
        for place in joint.tables("slip")? {
            let slip = Section::any(source, format!("a slip of joint \"{name}\""), place);
            let Some(span) = slip.span("law") else { continue };
            if !source.text[span.clone()].starts_with('{') {
                let message = "the law is a table of its own";
                return Err(slip.failure("law", message, "write it as law = { k_t = ..., ... } in one line"));
            }
            let values = [("k_t", k_t), ("f_s", f_s), ("chi", chi), ("beta", beta)];
            let pairs = values.map(|(key, value)| format!("{key} = {}", number(*value)));
            edits.push((span, format!("{{ {} }}", pairs.join(", "))));
        }
    }
    Ok(())
}

/// A number with all its bits, and with the decimal point that TOML requires of a number that is no integer.
fn number(value: f64) -> String {
    format!("{value:?}")
}
