//! Abaqus input: nodes, hexahedra and sets (Abaqus Keywords Reference; CalculiX reads the same).
//!
//! `*NODE`, `*SYSTEM`, `*ELEMENT`, `*NSET` and `*ELSET` are read. Keywords that are known to leave the model as it is are passed over
//! with a remark; all others are refused by name, unless the user wants them to be ignored. One part with one instance in its own place is read as if it stood alone.

mod lines;
mod fields;
mod keyword;
mod known;
mod definition;
mod parts;
mod system;
mod reader;
mod nodes;
mod elements;
mod sets;

use super::error::{MeshError, MeshWarning};
use super::file::{FileBytes, MeshFile};
use super::labels::{Labels, Twice};
use super::topology::Mesh;
use definition::SetKind;
use keyword::Keyword;
use lines::Lines;
use reader::{PassedOver, ReadAs, Reader};

/// Mesh and remarks of an Abaqus input file.
///
/// `ignored` are names of keywords that are passed over although they change the model.
pub(super) fn parse(source: FileBytes, ignored: &[String]) -> Result<MeshFile, MeshError> {
    let mut lines = Lines::new(source);
    let ignored = ignored.iter().map(|name| keyword::name(name.as_bytes())).collect();
    let mut reader = Reader { ignored, ..Reader::default() };
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
            name if self.ignored.iter().any(|ignored| ignored == name) => {
                let first = PassedOver { line: keyword.line, times: 0 };
                self.passed_over.entry(name.to_string()).or_insert(first).times += 1;
                while lines.next_data().is_some() {}
                Ok(())
            }
            "NODE" => self.nodes(lines, keyword),
            "SYSTEM" => {
                self.axes = system::read(lines, keyword)?;
                Ok(())
            }
            "ELEMENT" => self.elements(lines, keyword),
            "NSET" => self.set(lines, keyword, SetKind::Nodes),
            "ELSET" => self.set(lines, keyword, SetKind::Elements),
            "INCLUDE" => Err(keyword.refused(
                lines.source,
                "*INCLUDE, another file,",
                "put the text of that file into this one in place of the line",
            )),
            "PART" | "END PART" | "ASSEMBLY" | "END ASSEMBLY" | "INSTANCE" | "END INSTANCE" => {
                self.parts.keyword(lines, keyword)
            }
            name => {
                if !known::is_harmless(name) {
                    let found = format!("*{name}, which may change the model,");
                    return Err(keyword.refused(lines.source, &found, &known::remedy(name)));
                }
                let first = PassedOver { line: keyword.line, times: 0 };
                self.passed_over.entry(name.to_string()).or_insert(first).times += 1;
                while lines.next_data().is_some() {}
                Ok(())
            }
        }
    }

    fn finish(self, source: FileBytes) -> Result<MeshFile, MeshError> {
        let twice = |what: &str, Twice { label, first, second }: Twice, lines: &[usize]| {
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
        sets::resolve(source, &mut mesh, &self.definitions, &nodes, &elements)?;
        let passed_over = self.passed_over.into_iter().map(|(name, PassedOver { line, times })| {
            let place = format!("line {line}");
            if self.ignored.contains(&name) {
                MeshWarning::Ignored { name: format!("*{name}"), place, times }
            } else {
                MeshWarning::PassedOver { name: format!("*{name}"), place, times }
            }
        });
        let formulations = self.formulations.into_iter().map(|(found, ReadAs { line, read_as })| {
            MeshWarning::Formulation { place: format!("line {line}"), found: found.into(), read_as }
        });
        let warnings = formulations.chain(passed_over).collect();
        Ok(MeshFile { mesh, warnings })
    }
}
