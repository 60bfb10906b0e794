//! `*PART`, `*ASSEMBLY` and `*INSTANCE`: one part in its own place is read as if it stood alone.

use super::super::error::MeshError;
use super::keyword::Keyword;
use super::lines::Lines;

const REMEDY: &str = "write the model without parts and assemblies (in Abaqus/CAE: Model, Edit Attributes, \"Do not use \
    parts and assemblies in input files\")";

/// How many parts and instances there were.
#[derive(Debug, Default)]
pub(super) struct Parts {
    parts: usize,
    instances: usize,
}

impl Parts {
    /// Counts, and refuses what would need numbering or moving.
    pub(super) fn keyword(&mut self, lines: &mut Lines, keyword: &Keyword) -> Result<(), MeshError> {
        match keyword.name.as_str() {
            "PART" => self.parts += 1,
            "INSTANCE" => self.instances += 1,
            _ => {}
        }
        if self.parts > 1 || self.instances > 1 {
            let found = format!("*{}, the second of its kind,", keyword.name);
            return Err(keyword.refused(lines.source, &found, REMEDY));
        }
        match lines.next_data() {
            Some(line) if keyword.name == "INSTANCE" => {
                let place = format!("line {}", line.number);
                Err(lines.source.unsupported(place, "an instance that is moved or turned", REMEDY))
            }
            Some(line) => {
                let place = format!("line {}", line.number);
                let expected = format!("a keyword: *{} takes no data", keyword.name);
                Err(lines.source.malformed(place, line.quoted(), expected))
            }
            None => Ok(()),
        }
    }
}
