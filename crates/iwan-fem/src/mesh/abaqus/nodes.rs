//! `*NODE`.

use std::fmt::Display;

use super::super::error::MeshError;
use super::super::source::{Source, quote};
use super::Reader;
use super::definitions::{Definition, Kind};
use super::keyword::Keyword;
use super::lines::{Line, Lines};

impl Reader {
    /// Reads numbers and positions; coordinates left out are zero.
    pub(super) fn nodes(&mut self, lines: &mut Lines, keyword: &Keyword) -> Result<(), MeshError> {
        keyword.only(lines.source, &["NSET"])?;
        let first = self.node_labels.len();
        while let Some(line) = lines.next_data() {
            let mut fields = line.fields();
            let label =
                whole(lines.source, &line, fields.next().unwrap_or_default(), "the number of a node")?;
            let mut position = [0.0; 3];
            for (value, (field, axis)) in position.iter_mut().zip(fields.by_ref().zip(["x", "y", "z"])) {
                if !field.is_empty() {
                    *value = number(lines.source, &line, field, format_args!("{axis} of node {label}"))?;
                }
            }
            // Direction cosines of shell normals may follow; they mean nothing to solids.
            self.positions.push(position);
            self.node_labels.push(label);
            self.node_lines.push(line.offset);
        }
        if let Some(name) = keyword.value("NSET") {
            let added = (first..self.node_labels.len()).map(|index| self.node_labels[index]).collect();
            self.definitions.push(Definition::of(Kind::Nodes, name, keyword.line, added));
        }
        Ok(())
    }
}

/// A whole number > 0.
pub(super) fn whole(source: Source, line: &Line, field: &[u8], what: impl Display) -> Result<u64, MeshError> {
    let value = std::str::from_utf8(field).ok().and_then(|text| text.parse().ok()).filter(|n| *n > 0);
    value.ok_or_else(|| {
        let expected = format!("{what}: a whole number > 0");
        source.malformed(format!("line {}", line.number), quote(field, 40), expected)
    })
}

/// A finite number; `D` for the exponent is understood.
fn number(source: Source, line: &Line, field: &[u8], what: impl Display) -> Result<f64, MeshError> {
    let text = std::str::from_utf8(field).unwrap_or("no text");
    let value = text.parse().or_else(|_| text.to_ascii_lowercase().replacen('d', "e", 1).parse::<f64>());
    value.ok().filter(|value| value.is_finite()).ok_or_else(|| {
        let expected = format!("{what}: a finite number");
        source.malformed(format!("line {}", line.number), quote(field, 40), expected)
    })
}
