//! Defects and remarks that a check of a mesh can find, with their texts.

use std::fmt;

/// A defect: it makes a computation impossible or wrong. Numbers of elements and nodes are those of the mesh file.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Defect {
    /// Elements whose nodes are listed in the wrong orientation.
    Inverted {
        /// Elements.
        elements: Vec<u64>,
    },
    /// Elements with a determinant of the Jacobian that is not positive at a corner.
    BadCorner {
        /// Element and the node at its worst corner.
        corners: Vec<(u64, u64)>,
    },
    /// Elements whose Jacobian determinant is not positive inside, or that have an edge without length.
    Collapsed {
        /// Elements.
        elements: Vec<u64>,
    },
    /// Elements that have a node twice.
    RepeatedNode {
        /// Element and node.
        elements: Vec<(u64, u64)>,
    },
    /// Elements with the same nodes.
    SameNodes {
        /// Pairs of elements.
        pairs: Vec<(u64, u64)>,
    },
    /// Nodes that belong to no element.
    Orphans {
        /// Nodes.
        nodes: Vec<u64>,
    },
    /// Nodes of one part at the same place.
    Coincident {
        /// Pairs of nodes.
        pairs: Vec<(u64, u64)>,
    },
    /// A part that neither elements nor ties or joints connect with the rest of the structure.
    Unconnected {
        /// Number of elements of the part.
        elements: usize,
        /// Number of one of its elements.
        element: u64,
        /// A node of the part and a node of another part at the same place, if there are any.
        touching: Option<(u64, u64)>,
    },
    /// A tie or joint that cannot work.
    Link {
        /// Name of the tie or joint.
        name: String,
        /// What is wrong.
        reason: String,
        /// What helps.
        remedy: &'static str,
    },
    /// A set that does not exist.
    MissingSet {
        /// The item that refers to the set.
        user: String,
        /// `node` or `element`.
        kind: &'static str,
        /// Name of the set.
        name: String,
        /// Names of the sets that exist.
        known: Vec<String>,
    },
    /// A set without members.
    EmptySet {
        /// The item that refers to the set.
        user: String,
        /// `node` or `element`.
        kind: &'static str,
        /// Name of the set.
        name: String,
    },
    /// No elements at all.
    Empty,
    /// A given matrix that cannot belong to a structure.
    Matrix {
        /// `stiffness` or `mass`.
        matrix: &'static str,
        /// The row, with its node and component, in the numbering of the file.
        row: String,
        /// What is wrong, with values.
        reason: String,
        /// What helps.
        remedy: &'static str,
    },
}

/// A remark: something that is allowed, but seldom intended.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Remark {
    /// Elements whose shape is far from a brick.
    Distorted {
        /// Element and its least scaled Jacobian determinant (1 for a brick).
        elements: Vec<(u64, f64)>,
    },
    /// Four-node tetrahedra.
    Stiff {
        /// Number of such elements.
        count: usize,
        /// Number of the first of them.
        element: u64,
    },
    /// Nodes of two parts at the same place which no tie or joint connects.
    Touching {
        /// Pairs of nodes.
        pairs: Vec<(u64, u64)>,
    },
    /// A tie or joint that may work differently from what the user expects.
    Link {
        /// Name of the tie or joint.
        name: String,
        /// What is unusual.
        reason: String,
    },
}

/// What a check found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Findings {
    /// Findings that make a computation impossible or wrong.
    pub defects: Vec<Defect>,
    /// Findings that are allowed, but seldom intended.
    pub remarks: Vec<Remark>,
}

impl Findings {
    /// All defects as one text, one per line; none for a sound mesh.
    #[must_use]
    pub fn message(&self) -> Option<String> {
        let lines: Vec<String> = self.defects.iter().map(ToString::to_string).collect();
        (!lines.is_empty()).then(|| lines.join("\n"))
    }
}

/// The first ten items, and the number of further ones.
pub(super) fn list<T>(items: &[T], show: impl Fn(&T) -> String) -> String {
    // Ten items fit into a line or two of a terminal.
    const SHOWN: usize = 10;
    let mut text = items.iter().take(SHOWN).map(show).collect::<Vec<_>>().join(", ");
    if items.len() > SHOWN {
        text = format!("{text} and {} more", items.len() - SHOWN);
    }
    text
}

fn numbers(items: &[u64]) -> String {
    list(items, u64::to_string)
}

fn pairs(items: &[(u64, u64)]) -> String {
    list(items, |(a, b)| format!("{a} and {b}"))
}

/// `element 7` or `elements 7, 8`.
fn counted<T>(word: &str, items: &[T], listed: &str) -> String {
    if items.len() == 1 { format!("{word} {listed}") } else { format!("{word}s {listed}") }
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Inverted { elements } => write!(
                f,
                "inverted {}: the nodes run the wrong way round; swap the two faces in the order of the nodes, or mirror the geometry back",
                counted("element", elements, &numbers(elements))
            ),
            Self::BadCorner { corners } => write!(
                f,
                "folded {}: the Jacobian determinant is not positive at that corner; move the node, or mesh anew there",
                counted("element", corners, &list(corners, |(e, n)| format!("{e} at node {n}")))
            ),
            Self::Collapsed { elements } => write!(
                f,
                "collapsed {}: without volume, or the Jacobian determinant is not positive inside; move its nodes apart, or delete it",
                counted("element", elements, &numbers(elements))
            ),
            Self::RepeatedNode { elements } => write!(
                f,
                "collapsed {}: a node occurs twice; wedges and pyramids written as hexahedra are not read: mesh with true hexahedra",
                counted("element", elements, &list(elements, |(e, n)| format!("{e} (node {n})")))
            ),
            Self::SameNodes { pairs: found } => {
                write!(f, "elements with the same nodes: {}; delete one of each pair", pairs(found))
            }
            Self::Orphans { nodes } => write!(
                f,
                "{} without an element; delete what is left over, or check that all elements were exported",
                counted("node", nodes, &numbers(nodes))
            ),
            Self::Coincident { pairs: found } => write!(
                f,
                "nodes of one part at the same place: {}; merge them (a slit that is meant needs a joint between its sides)",
                pairs(found)
            ),
            Self::Unconnected { elements, element, touching } => {
                write!(
                    f,
                    "the part of {elements} elements around element {element} is connected with nothing; "
                )?;
                match touching {
                    Some((a, b)) => write!(
                        f,
                        "its node {a} is at the place of node {b}: merge the nodes, or add a tie or joint there"
                    ),
                    None => f.write_str("add a tie or joint, or leave the part out"),
                }
            }
            Self::Link { name, reason, remedy } => write!(f, "{name}: {reason}; {remedy}"),
            Self::MissingSet { user, kind, name, known } if known.is_empty() => {
                write!(
                    f,
                    "{user}: there is no {kind} set `{name}`: the mesh has no {kind} sets; name them when meshing"
                )
            }
            Self::MissingSet { user, kind, name, known } => {
                write!(
                    f,
                    "{user}: there is no {kind} set `{name}`; choose one of {}",
                    list(known, String::clone)
                )
            }
            Self::EmptySet { user, kind, name } => {
                write!(
                    f,
                    "{user}: the {kind} set `{name}` has no members; choose another, or fill it when meshing"
                )
            }
            Self::Matrix { matrix, row, reason, remedy } => write!(f, "{matrix}, {row}: {reason}; {remedy}"),
            Self::Empty => f.write_str("the mesh has no elements; export the volumes with their hexahedra"),
        }
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Distorted { elements } => write!(
                f,
                "badly distorted {} (least scaled Jacobian determinant; 1 is a brick): results there are poor",
                counted("element", elements, &list(elements, |(e, j)| format!("{e} ({j:.2})")))
            ),
            Self::Stiff { count, element } => write!(
                f,
                "{count} elements are tetrahedra of 4 nodes (the first is {element}): much too stiff in bending, frequencies come out too \
                 high; mesh with tetrahedra of 10 nodes, or show that a finer mesh gives the same"
            ),
            Self::Touching { pairs: found } => write!(
                f,
                "nodes of two parts at the same place which no tie or joint connects: {}; they move apart freely, contact is not computed",
                pairs(found)
            ),
            Self::Link { name, reason } => write!(f, "{name}: {reason}"),
        }
    }
}
