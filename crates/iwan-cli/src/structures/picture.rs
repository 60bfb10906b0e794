//! The picture of a mesh with its parts in colours.

use iwan_fem::mesh::Mesh;
use maud::{Markup, html};

use crate::page::solid::{Colour, Solid};

/// Pale colours for the parts of a mesh.
const PARTS: [Colour; 6] = [
    [176.0, 196.0, 214.0],
    [230.0, 190.0, 130.0],
    [160.0, 205.0, 180.0],
    [220.0, 170.0, 190.0],
    [205.0, 205.0, 150.0],
    [190.0, 180.0, 220.0],
];

/// The mesh with its element sets in colours.
pub(crate) fn mesh_picture(solid: &Solid<'_>, mesh: &Mesh) -> Markup {
    let mut part = vec![0; mesh.elements.len()];
    for (index, set) in mesh.element_sets.values().enumerate() {
        for element in set {
            part[*element] = index;
        }
    }
    let names: Vec<&String> = mesh.element_sets.keys().collect();
    html! {
        figure {
            (solid.draw(None, "the mesh", &|element, _| PARTS[part[element] % PARTS.len()]))
            p.caption {
                @if names.is_empty() { "The mesh." } @else { "The mesh; element sets in colours: " }
                @for (n, name) in names.iter().enumerate() {
                    @let [r, g, b] = PARTS[n % PARTS.len()];
                    span.key style=(format!("background:rgb({r},{g},{b})")) {} (name) " "
                }
            }
        }
    }
}
