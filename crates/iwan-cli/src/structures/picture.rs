//! The picture of a mesh with its parts in different colours.

use iwan_fem::mesh::Mesh;
use maud::{Markup, html};

use crate::page::solid::{Colour, Solid};

/// Most outer faces or dots in all pictures of a page together. Half of the faces look at the viewer and take 75 bytes each: 1.5 MB, which a browser
/// opens without a pause. A larger mesh is not drawn where it would be an illustration only.
pub(crate) const MOST_FACES: usize = 40_000;

/// Colours for the parts of a mesh, pale so that shading shows on them; a seventh part has the first colour again.
const PARTS: [Colour; 6] = [
    [176.0, 196.0, 214.0],
    [230.0, 190.0, 130.0],
    [160.0, 205.0, 180.0],
    [220.0, 170.0, 190.0],
    [205.0, 205.0, 150.0],
    [190.0, 180.0, 220.0],
];

/// The picture of the mesh; nothing where the mesh has more pieces than [`MOST_FACES`].
pub(crate) fn illustration(solid: &Solid<'_>, mesh: &Mesh) -> Markup {
    html! { @if solid.pieces() <= MOST_FACES { (mesh_picture(solid, mesh)) } }
}

/// The mesh with its element sets in colours.
pub(crate) fn mesh_picture(solid: &Solid<'_>, mesh: &Mesh) -> Markup {
    let mut part = vec![0; mesh.elements.len()];
    for (index, set) in mesh.element_sets.values().enumerate() {
        for element in set {
            part[*element] = index;
        }
    }
    let names: Vec<&String> = mesh.element_sets.keys().collect();
    let all = if mesh.elements.is_empty() { "The nodes." } else { "The mesh." };
    html! {
        figure {
            (solid.draw(None, "the mesh", &|element, _| PARTS[part.get(element).map_or(0, |part| part % PARTS.len())]))
            p.caption {
                @if names.is_empty() { (all) } @else { "The mesh; element sets in colours: " }
                @for (n, name) in names.iter().enumerate() {
                    @let [r, g, b] = PARTS[n % PARTS.len()];
                    span.key style=(format!("background:rgb({r},{g},{b})")) {} (name) " "
                }
            }
        }
    }
}
