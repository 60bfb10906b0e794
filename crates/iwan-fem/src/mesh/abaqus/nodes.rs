//! `*NODE`.

use super::super::error::MeshError;
use super::definition::{Definition, SetKind};
use super::fields::{number, whole};
use super::keyword::Keyword;
use super::lines::Lines;
use super::reader::Reader;
use super::system::coordinates;

impl Reader {
    /// Reads numbers and positions; coordinates left out are zero.
    pub(super) fn nodes(&mut self, lines: &mut Lines, keyword: &Keyword) -> Result<(), MeshError> {
        keyword.only(lines.source, &["NSET", "SYSTEM"])?;
        let coordinates = coordinates(lines, keyword)?;
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
            self.positions.push(self.axes.global(coordinates.rectangular(position)));
            self.node_labels.push(label);
            self.node_lines.push(line.offset);
        }
        if let Some(name) = keyword.value("NSET") {
            let added = (first..self.node_labels.len()).map(|index| self.node_labels[index]).collect();
            self.definitions.push(Definition::of(SetKind::Nodes, name, keyword.line, added));
        }
        Ok(())
    }
}
