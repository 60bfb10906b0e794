//! Gmsh MSH 4.1 and 2.2, ASCII and binary (Gmsh reference manual, "MSH file format").
//!
//! The sections `$PhysicalNames`, `$Entities`, `$Nodes` and `$Elements` are read, others are passed over. The reader is our own because the
//! one crate for the format stops with a panic on some input and does not read physical groups.

mod cursor;
mod element_types;
mod groups;
mod reader;
mod nodes;
mod elements;
mod version_two;

use super::error::{MeshError, MeshWarning};
use super::file::{FileBytes, MeshFile, quote};
use cursor::{Cursor, Version};
use reader::{PassedOver, Reader};

/// Mesh and remarks of a MSH file.
pub(super) fn parse(source: FileBytes) -> Result<MeshFile, MeshError> {
    let mut cursor = Cursor::open(source)?;
    let mut reader = Reader::new(source.bytes.len());
    while let Some((name, offset)) = cursor.section()? {
        reader.section(&mut cursor, &name, offset)?;
    }
    reader.finish(&cursor)
}

impl Reader {
    fn section(&mut self, cursor: &mut Cursor, name: &str, offset: usize) -> Result<(), MeshError> {
        match name {
            "PhysicalNames" => self.groups.names(cursor)?,
            "Entities" => self.groups.entities(cursor)?,
            "PartitionedEntities" => {
                let remedy = "save the mesh without partitions (in Gmsh: Mesh, Delete partition)";
                return Err(cursor.source.unsupported(cursor.place_at(offset), "a partitioned mesh", remedy));
            }
            "Nodes" => {
                self.once(cursor, name, offset, self.nodes.is_some())?;
                self.nodes = Some(match cursor.version() {
                    Version::Four => nodes::read(cursor, &mut self.mesh)?,
                    Version::Two => version_two::nodes(cursor, &mut self.mesh)?,
                });
            }
            "Elements" => {
                self.once(cursor, name, offset, self.elements_seen)?;
                self.elements_seen = true;
                match cursor.version() {
                    Version::Four => elements::read(cursor, self)?,
                    Version::Two => version_two::elements(cursor, self)?,
                }
            }
            _ => {
                match self.passed_over.iter_mut().find(|seen| seen.name == name) {
                    Some(seen) => seen.times += 1,
                    None => self.passed_over.push(PassedOver { name: name.into(), offset, times: 1 }),
                }
                return cursor.skip_section(name);
            }
        }
        cursor.end_section(name)
    }

    fn once(&self, cursor: &Cursor, name: &str, offset: usize, seen: bool) -> Result<(), MeshError> {
        if seen {
            let remedy = "merge the meshes in Gmsh and save one file";
            return Err(cursor.source.unsupported(
                cursor.place_at(offset),
                format!("a second ${name}"),
                remedy,
            ));
        }
        if name == "Elements" && self.nodes.is_none() {
            let place = cursor.place_at(offset);
            return Err(cursor.source.malformed(place, "$Elements before $Nodes", "$Nodes first"));
        }
        Ok(())
    }

    fn finish(mut self, cursor: &Cursor) -> Result<MeshFile, MeshError> {
        for (seen, name) in [(self.nodes.is_some(), "$Nodes"), (self.elements_seen, "$Elements")] {
            if !seen {
                return Err(cursor.source.malformed("the whole file", format!("no section {name}"), name));
            }
        }
        let mut warnings = self.groups.finish(&mut self.node_sets, &mut self.element_sets);
        for PassedOver { name, offset, times } in self.passed_over {
            let name = format!("section {}", quote(name.as_bytes(), 40));
            warnings.push(MeshWarning::PassedOver { name, place: cursor.place_at(offset), times });
        }
        self.mesh.node_sets = self.node_sets.finish();
        self.mesh.element_sets = self.element_sets.finish();
        Ok(MeshFile::plain(self.mesh, warnings))
    }
}
