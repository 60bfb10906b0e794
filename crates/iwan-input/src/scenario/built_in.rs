//! The built-in scenarios, and the schema of scenario files.

use crate::text::InputText;

/// A built-in scenario.
#[derive(Debug)]
pub struct BuiltIn {
    /// Name on the command line.
    pub name: &'static str,
    /// What the scenario shows, in one line.
    pub about: &'static str,
    /// The text of the file.
    pub text: &'static str,
}

/// All built-in scenarios, the default first.
static ALL: &[BuiltIn] = &[
    BuiltIn {
        name: "paper-modal",
        about: "the beam of Deaner et al. (2015): three modal Iwan oscillators, hammer blow at the tip",
        text: include_str!("../../scenarios/paper-modal.toml"),
    },
    BuiltIn {
        name: "coupled",
        about: "the same beam, configuration A: three modes that share one joint",
        text: include_str!("../../scenarios/coupled.toml"),
    },
];

/// JSON Schema (draft 2020-12) of scenario files.
pub const SCHEMA: &str = include_str!("../../schema/scenario.schema.json");

/// All built-in scenarios, the default first; structures are in [`BUILT_IN_STRUCTURES`](crate::BUILT_IN_STRUCTURES).
#[must_use]
pub fn built_in() -> &'static [BuiltIn] {
    ALL
}

impl BuiltIn {
    /// The text with the scenario's name, ready to be read.
    #[must_use]
    pub fn source(&self) -> InputText {
        InputText::built_in(self.name, self.text)
    }
}
