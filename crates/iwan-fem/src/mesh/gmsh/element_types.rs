//! Element types of Gmsh.

use super::super::topology::Shape;

/// What is done with an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Use {
    /// An element of the mesh.
    Element(Shape),
    /// Points, edges and faces: their nodes belong to the sets of their physical groups.
    Set,
    /// Refused, with the remedy.
    Refused(&'static str),
}

/// A type of element.
#[derive(Debug, Clone, Copy)]
pub(super) struct ElementType {
    number: i32,
    pub(super) name: &'static str,
    pub(super) nodes: usize,
    pub(super) role: Use,
}

const HEXAHEDRA: Use = Use::Refused(
    "only hexahedra of 8 or 20 nodes are computed with: make the volumes transfinite (or extrude) with Recombine",
);
const INCOMPLETE: Use = Use::Refused("set Mesh.SecondOrderIncomplete = 1 in Gmsh for hexahedra of 20 nodes");

const fn entry(number: i32, name: &'static str, nodes: usize, role: Use) -> ElementType {
    ElementType { number, name, nodes, role }
}

static TYPES: &[ElementType] = &[
    entry(1, "2-node line", 2, Use::Set),
    entry(2, "3-node triangle", 3, Use::Set),
    entry(3, "4-node quadrangle", 4, Use::Set),
    entry(4, "4-node tetrahedron", 4, HEXAHEDRA),
    entry(5, "8-node hexahedron", 8, Use::Element(Shape::Hex8)),
    entry(6, "6-node prism", 6, HEXAHEDRA),
    entry(7, "5-node pyramid", 5, HEXAHEDRA),
    entry(8, "3-node line", 3, Use::Set),
    entry(9, "6-node triangle", 6, Use::Set),
    entry(10, "9-node quadrangle", 9, INCOMPLETE),
    entry(11, "10-node tetrahedron", 10, HEXAHEDRA),
    entry(12, "27-node hexahedron", 27, INCOMPLETE),
    entry(13, "18-node prism", 18, HEXAHEDRA),
    entry(14, "14-node pyramid", 14, HEXAHEDRA),
    entry(15, "1-node point", 1, Use::Set),
    entry(16, "8-node quadrangle", 8, Use::Set),
    entry(17, "20-node hexahedron", 20, Use::Element(Shape::Hex20)),
    entry(18, "15-node prism", 15, HEXAHEDRA),
    entry(19, "13-node pyramid", 13, HEXAHEDRA),
];

/// The type with this number; none for those of third and higher order.
pub(super) fn find(number: i32) -> Option<&'static ElementType> {
    TYPES.iter().find(|known| known.number == number)
}

/// Gmsh's place of each node of [`Shape::Hex20`]: its mid-edge nodes follow the edges 0-1, 0-3, 0-4, 1-2, 1-5, 2-3, 2-6,
/// 3-7, 4-5, 4-7, 5-6, 6-7.
pub(super) const HEX20: [usize; 20] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15];
