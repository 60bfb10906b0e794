//! Abaqus input: nodes, hexahedra and sets (Abaqus Keywords Reference; CalculiX reads the same).
//!
//! `*NODE`, `*ELEMENT`, `*NSET` and `*ELSET` are read, `*INCLUDE` and whatever would need another file is refused, other
//! keywords are passed over with a remark. One part with one instance in its own place is read as if it stood alone.

mod definitions;
mod elements;
mod keyword;
mod lines;
mod nodes;
mod parts;

use std::collections::BTreeMap;

use super::error::{MeshError, MeshWarning};
use super::labels::Labels;
use super::read::MeshFile;
use super::source::Source;
use super::{Element, Mesh};
use definitions::{Definition, Kind};
use keyword::Keyword;
use lines::Lines;
use parts::Parts;

/// Everything read so far.
#[derive(Default)]
struct Reader {
    positions: Vec<[f64; 3]>,
    node_labels: Vec<u64>,
    /// Byte of the line of each node.
    node_lines: Vec<usize>,
    elements: Vec<Element>,
    /// Byte of the line of each element.
    element_lines: Vec<usize>,
    definitions: Vec<Definition>,
    parts: Parts,
    passed_over: BTreeMap<String, (usize, usize)>,
    formulations: BTreeMap<&'static str, (usize, &'static str)>,
}

/// Mesh and remarks of an Abaqus input file.
pub(super) fn parse(source: Source) -> Result<MeshFile, MeshError> {
    let mut lines = Lines::new(source);
    let mut reader = Reader::default();
    while let Some(line) = lines.next() {
        if !line.is_keyword() {
            let place = format!("line {}", line.number);
            return Err(source.malformed(place, line.quoted(), "a keyword (*NAME)"));
        }
        let keyword = Keyword::parse(&mut lines, line)?;
        reader.keyword(&mut lines, &keyword)?;
    }
    reader.finish(source)
}

impl Reader {
    fn keyword(&mut self, lines: &mut Lines, keyword: &Keyword) -> Result<(), MeshError> {
        match keyword.name.as_str() {
            "NODE" => self.nodes(lines, keyword),
            "ELEMENT" => self.elements(lines, keyword),
            "NSET" => self.set(lines, keyword, Kind::Nodes),
            "ELSET" => self.set(lines, keyword, Kind::Elements),
            "INCLUDE" => Err(keyword.refused(
                lines.source,
                "*INCLUDE, another file,",
                "put the text of that file into this one in place of the line",
            )),
            "PART" | "END PART" | "ASSEMBLY" | "END ASSEMBLY" | "INSTANCE" | "END INSTANCE" => {
                self.parts.keyword(lines, keyword)
            }
            name => {
                let seen = self.passed_over.entry(name.to_string()).or_insert((keyword.line, 0));
                seen.1 += 1;
                while lines.next_data().is_some() {}
                Ok(())
            }
        }
    }

    fn finish(self, source: Source) -> Result<MeshFile, MeshError> {
        let twice = |what: &str, (label, first, second): (u64, usize, usize), lines: &[usize]| {
            let (first, second) = (source.line(lines[first]), source.line(lines[second]));
            let found = format!("{what} {label}, which stands in line {first} already");
            let expected = format!("a number of its own for every {what}");
            source.malformed(format!("line {second}"), found, expected)
        };
        let nodes = Labels::new(self.node_labels.iter().copied());
        let nodes = nodes.map_err(|double| twice("node", double, &self.node_lines))?;
        let elements = Labels::new(self.elements.iter().map(|e| e.label));
        let elements = elements.map_err(|double| twice("element", double, &self.element_lines))?;
        let mut mesh = Mesh { positions: self.positions, node_labels: self.node_labels, ..Mesh::default() };
        mesh.elements = self.elements;
        elements::resolve(source, &mut mesh.elements, &self.element_lines, &nodes)?;
        definitions::resolve(source, &mut mesh, &self.definitions, &nodes, &elements)?;
        let passed_over = self.passed_over.into_iter().map(|(name, (line, times))| MeshWarning::PassedOver {
            name: format!("*{name}"),
            place: format!("line {line}"),
            times,
        });
        let formulations = self.formulations.into_iter().map(|(found, (line, read_as))| {
            MeshWarning::Formulation { place: format!("line {line}"), found: found.into(), read_as }
        });
        let warnings = formulations.chain(passed_over).collect();
        Ok(MeshFile { mesh, warnings })
    }
}
