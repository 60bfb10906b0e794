//! Reader of `*NODE`.

use super::super::error::MeshError;
use super::definition::{Definition, SetKind};
use super::fields::{number, whole};
use super::keyword::Keyword;
use super::lines::Lines;
use super::reader::{Reader, number_of, within};
use super::system::coordinates;

impl Reader {
    /// Reads the numbers and positions of nodes; an omitted coordinate is zero.
    pub(super) fn nodes(&mut self, lines: &mut Lines, keyword: &Keyword) -> Result<(), MeshError> {
        keyword.only(lines.source, &["NSET", "SYSTEM"])?;
        let coordinates = coordinates(lines, keyword)?;
        let (own, axes) = (self.within(), self.axes);
        let body = self.body();
        let first = body.node_labels.len();
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
            // Direction cosines of shell normals may follow the coordinates; solid elements do not use them.
            body.positions.push(axes.global(coordinates.rectangular(position)));
            body.node_labels.push(within(own, label));
            body.node_lines.push(line.offset);
        }
        if let Some(name) = keyword.value("NSET") {
            let added = body.node_labels[first..].iter().map(|label| number_of(*label)).collect();
            let name = self.named(name);
            let definition = Definition::of(SetKind::Nodes, &name, keyword.line, added, own);
            self.body().definitions.push(definition);
        }
        Ok(())
    }
}
