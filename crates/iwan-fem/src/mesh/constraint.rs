//! What a mesh file says beside its elements: constraints, masses at points, and materials.

/// Displacement along (0 to 2) or rotation about (3 to 5) x, y, z of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Freedom {
    /// Index into [`Mesh::positions`](super::Mesh::positions).
    pub node: usize,
    /// Component, 0 to 5.
    pub component: usize,
}

/// Three directions at right angles, in which components are counted.
pub type Directions = [[f64; 3]; 3];

/// The global axes.
pub const GLOBAL: Directions = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A node among those whose mean a reference follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weighted {
    /// Index of the node.
    pub node: usize,
    /// Weight > 0.
    pub weight: f64,
    /// Which of its displacements along the directions of the constraint count.
    pub components: [bool; 3],
}

/// How motions depend on each other, linear at small motion.
#[derive(Debug, Clone, PartialEq)]
pub enum Rule {
    /// Σ c u = 0; the first term is eliminated where that is possible (Abaqus `*EQUATION`, Nastran MPC).
    Equation(Vec<(Freedom, f64)>),
    /// These displacements and rotations are zero. Rotations of nodes that have none do not matter.
    Held(Vec<Freedom>),
    /// Nodes follow the rigid motion of a reference node, which has rotations of its own (RBE2, kinematic coupling, rigid body):
    /// u = u_ref + θ x r in the chosen components, and θ where the node has rotations.
    Rigid {
        /// Index of the reference node.
        reference: usize,
        /// Indices of the nodes that follow.
        nodes: Vec<usize>,
        /// Which of their six components follow.
        components: [bool; 6],
        /// Directions of the components.
        directions: Directions,
    },
    /// A reference node follows the rigid motion that fits those of weighted nodes best, by least squares (RBE3, distributing coupling).
    Mean {
        /// Index of the reference node.
        reference: usize,
        /// Which of its six components follow.
        components: [bool; 6],
        /// Nodes with weights.
        nodes: Vec<Weighted>,
        /// Directions of the components.
        directions: Directions,
    },
    /// A node follows the sum of others: the point of a face on which it lies (ties between meshes that do not match).
    Interpolated {
        /// Index of the node.
        node: usize,
        /// Nodes with the values of their shape functions.
        of: Vec<(usize, f64)>,
    },
}

/// A constraint with the name that errors carry.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// Keyword and name or place in the file.
    pub name: String,
    /// What it demands.
    pub rule: Rule,
}

impl Constraint {
    /// Indices of all nodes it mentions, in no order.
    ///
    /// ```
    /// use iwan_fem::mesh::{Constraint, Rule};
    /// let on_a_face = Rule::Interpolated { node: 7, of: vec![(1, 0.25), (2, 0.75)] };
    /// let tie = Constraint { name: "tie `a`".into(), rule: on_a_face };
    /// assert_eq!(tie.nodes(), [7, 1, 2]);
    /// ```
    #[must_use]
    pub fn nodes(&self) -> Vec<usize> {
        match &self.rule {
            Rule::Equation(terms) => terms.iter().map(|(freedom, _)| freedom.node).collect(),
            Rule::Held(freedoms) => freedoms.iter().map(|freedom| freedom.node).collect(),
            Rule::Rigid { reference, nodes, .. } => {
                std::iter::once(*reference).chain(nodes.iter().copied()).collect()
            }
            Rule::Mean { reference, nodes, .. } => {
                std::iter::once(*reference).chain(nodes.iter().map(|n| n.node)).collect()
            }
            Rule::Interpolated { node, of } => {
                std::iter::once(*node).chain(of.iter().map(|(other, _)| *other)).collect()
            }
        }
    }
}

/// A rigid body without extent at a node (Nastran CONM2, Abaqus `*MASS` and `*ROTARY INERTIA`).
#[derive(Debug, Clone, PartialEq)]
pub struct PointMass {
    /// Name for errors.
    pub name: String,
    /// Index of the node.
    pub node: usize,
    /// Mass >= 0.
    pub mass: f64,
    /// From the node to the centre of mass.
    pub offset: [f64; 3],
    /// Inertia about the centre of mass, symmetric: on the diagonal ∫(y² + z²) dm, off it -∫xy dm.
    pub inertia: [[f64; 3]; 3],
}

/// A material and the set of elements that have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Name of the element set.
    pub elements: String,
    /// Young's modulus, Poisson's ratio, mass density.
    pub constants: [f64; 3],
    /// Material as the file names it.
    pub material: String,
}
