//! The meaning of the unknowns of the equations.

use crate::algebra::Site;

/// The meaning of one unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unknown {
    /// Displacement of a node (index into the mesh) along x, y or z (0, 1, 2).
    Displacement {
        /// Index of the node.
        node: usize,
        /// Axis.
        axis: usize,
    },
    /// Rotation of a node about x, y or z (0, 1, 2): of a row of given matrices, or of the reference node of a constraint.
    Rotation {
        /// Index of the node.
        node: usize,
        /// Axis.
        axis: usize,
    },
    /// A generalised coordinate of given matrices.
    Generalised {
        /// Its row in the matrices, from 0.
        row: usize,
    },
    /// Motion of the reference point of a joint's rigid patch: displacements (0 to 2) and rotations (3 to 5).
    Reference {
        /// Index of the joint.
        joint: usize,
        /// Component.
        component: usize,
    },
    /// Slip of a joint, which is an unknown itself.
    Slip {
        /// Index of the slip.
        slip: usize,
    },
}

/// Meaning and position of an unknown, for the order of elimination and for rigid motions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    pub(crate) unknown: Unknown,
    /// Position and group; unknowns of one node or reference point share a group.
    pub(crate) site: Site,
}

impl Place {
    /// Value of this unknown in a small rigid motion of the structure: displacement along (0 to 2) or rotation about (3 to 5) an axis
    /// through `centre`.
    pub(crate) fn rigid(&self, motion: usize, centre: [f64; 3]) -> f64 {
        let (axis, rotation) = match self.unknown {
            Unknown::Displacement { axis, .. } => (axis, None),
            Unknown::Reference { component, .. } if component < 3 => (component, None),
            Unknown::Reference { component, .. } => (0, Some(component)),
            Unknown::Rotation { axis, .. } => (0, Some(axis + 3)),
            Unknown::Slip { .. } | Unknown::Generalised { .. } => return 0.0,
        };
        if let Some(component) = rotation {
            return f64::from(u8::from(component == motion));
        }
        if motion < 3 {
            return f64::from(u8::from(axis == motion));
        }
        let r: [f64; 3] = std::array::from_fn(|a| self.site.position[a] - centre[a]);
        let mut spin = [0.0; 3];
        spin[motion - 3] = 1.0;
        cross(spin, r)[axis]
    }
}

/// Index of the first unknown of each triple of displacements along x, y and z of one node or reference point, ascending.
pub(crate) fn triples(places: &[Place]) -> Vec<u32> {
    let axis = |place: &Place| match place.unknown {
        Unknown::Displacement { axis, .. } => Some(axis),
        Unknown::Reference { component, .. } => Some(component),
        Unknown::Slip { .. } | Unknown::Rotation { .. } | Unknown::Generalised { .. } => None,
    };
    let triple = |three: &[Place]| {
        three.iter().enumerate().all(|(a, p)| axis(p) == Some(a) && p.site.group == three[0].site.group)
    };
    (0..places.len()).filter(|&j| places[j..].get(..3).is_some_and(triple)).map(|j| j as u32).collect()
}

/// Cross product a x b.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
