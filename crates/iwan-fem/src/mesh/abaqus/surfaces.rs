//! Surfaces (`*SURFACE`): faces of elements, or nodes.

use std::collections::BTreeMap;

use super::super::error::MeshError;
use super::super::face::Face;
use super::super::file::FileBytes;
use super::super::topology::Mesh;
use super::definition::{Pending, SurfaceText};
use super::sets::Named;

/// A surface whose elements and nodes were looked up.
#[derive(Debug, Clone, Default)]
pub(super) struct Surface {
    /// Faces, ascending; empty for a surface of nodes.
    pub(super) faces: Vec<Face>,
    /// Nodes, ascending: those of the faces, or those that the file lists.
    pub(super) nodes: Vec<usize>,
}

/// Finds surfaces by name.
pub(super) struct Surfaces<'a> {
    source: FileBytes<'a>,
    instances: &'a [String],
    texts: BTreeMap<String, &'a Pending>,
}

impl<'a> Surfaces<'a> {
    pub(super) fn new(source: FileBytes<'a>, instances: &'a [String], texts: &'a [SurfaceText]) -> Self {
        let texts = texts.iter().map(|surface| (surface.name.to_uppercase(), &surface.text)).collect();
        Self { source, instances, texts }
    }

    /// Faces and nodes of the surface that has this name within an instance; none if no surface has this name.
    pub(super) fn find(
        &self,
        mesh: &Mesh,
        named: &Named,
        name: &str,
        instance: usize,
    ) -> Result<Option<Surface>, MeshError> {
        let own = instance.checked_sub(1).map(|at| format!("{}.{name}", self.instances[at]).to_uppercase());
        let text = own.and_then(|own| self.texts.get(&own)).or_else(|| self.texts.get(&name.to_uppercase()));
        text.map(|text| self.resolved(mesh, named, text)).transpose()
    }

    fn resolved(&self, mesh: &Mesh, named: &Named, text: &Pending) -> Result<Surface, MeshError> {
        let (source, keyword) = (self.source, &text.keyword);
        keyword.only(source, &["NAME", "TYPE", "INTERNAL", "TRIM", "INSTANCE"])?;
        let kind = keyword.value("TYPE").unwrap_or("ELEMENT").to_ascii_uppercase();
        let mut surface = Surface::default();
        for row in &text.rows {
            let field = |at: usize| row.fields.get(at).map(String::as_str).unwrap_or_default();
            let place = || source.at_line(row.line);
            match kind.as_str() {
                "NODE" => {
                    let nodes = nodes(named, field(0), text.within).ok_or_else(|| {
                        source.malformed(
                            place(),
                            format!("{:?}", field(0)),
                            "a node or a node set defined above",
                        )
                    })?;
                    surface.nodes.extend(nodes);
                }
                "ELEMENT" => {
                    let elements = elements(named, field(0), text.within).ok_or_else(|| {
                        let expected = "an element or an element set defined above";
                        source.malformed(place(), format!("{:?}", field(0)), expected)
                    })?;
                    let added = sides(mesh, &elements, field(1)).ok_or_else(|| {
                        source.unsupported(
                            place(),
                            format!("the face {:?}", field(1)),
                            "give S1 to S6, or leave it out for all outer faces",
                        )
                    })?;
                    surface.faces.extend(added);
                }
                other => {
                    let found = format!("a surface of TYPE={other}");
                    return Err(keyword.refused(source, &found, "give TYPE=ELEMENT or TYPE=NODE"));
                }
            }
        }
        surface.faces.sort_unstable();
        surface.faces.dedup();
        surface.nodes.extend(surface.faces.iter().flat_map(|face| face.nodes(mesh)));
        surface.nodes.sort_unstable();
        surface.nodes.dedup();
        Ok(surface)
    }
}

/// Nodes of a set, or the node with this number; ascending.
pub(super) fn nodes(named: &Named, text: &str, instance: usize) -> Option<Vec<usize>> {
    let set = named.nodes.members(text, instance).map(|members| {
        let mut members = members.to_vec();
        members.sort_unstable();
        members.dedup();
        members
    });
    set.or_else(|| named.nodes.numbered(text, instance).map(|node| vec![node]))
}

fn elements(named: &Named, text: &str, instance: usize) -> Option<Vec<usize>> {
    let set = named.elements.members(text, instance).map(<[usize]>::to_vec);
    set.or_else(|| named.elements.numbered(text, instance).map(|element| vec![element]))
}

/// Sides S1 to S6 of the elements. Without a name, those faces of the elements that are outer faces of the mesh; none for another name or a
/// side that an element lacks.
fn sides(mesh: &Mesh, elements: &[usize], name: &str) -> Option<Vec<Face>> {
    if name.is_empty() {
        let mut own = elements.to_vec();
        own.sort_unstable();
        let every: Vec<usize> = (0..mesh.positions.len()).collect();
        let outer = mesh.faces_within(&every).into_iter();
        return Some(outer.filter(|face| own.binary_search(&face.element).is_ok()).collect());
    }
    let side = name.strip_prefix(['S', 's'])?.parse::<usize>().ok()?.checked_sub(1)?;
    let of = |element: &usize| {
        let there = side < mesh.elements[*element].shape.faces().count();
        there.then_some(Face { element: *element, side })
    };
    elements.iter().map(of).collect()
}
