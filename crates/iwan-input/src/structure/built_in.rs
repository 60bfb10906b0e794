//! The built-in structures.

use crate::error::InputError;
use crate::text::InputText;

/// Name, purpose and text of the built-in structures.
pub const BUILT_IN_STRUCTURES: &[(&str, &str, &str)] = &[
    (
        "paper-a",
        "the paper's beam as a finite-element structure: uniform mesh, rigid patches",
        include_str!("../../structures/paper-a.toml"),
    ),
    (
        "paper-b",
        "the same with the mesh and the averaging patches that meet the paper's Table 2",
        include_str!("../../structures/paper-b.toml"),
    ),
];

/// A built-in structure by its name.
///
/// # Errors
/// [`InputError`] that lists the known names.
pub fn built_in_structure(name: &str) -> Result<InputText, InputError> {
    let found = BUILT_IN_STRUCTURES.iter().find(|(known, ..)| *known == name);
    found.map(|(name, _, text)| InputText::built_in(name, text)).ok_or_else(|| {
        let names: Vec<&str> = BUILT_IN_STRUCTURES.iter().map(|(known, ..)| *known).collect();
        let message = format!("there is no built-in structure \"{name}\"");
        InputError::new(message, format!("choose from {}", names.join(", ")))
    })
}
