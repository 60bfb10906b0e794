//! Contents of a mesh file besides elements and sets: constraints, point masses, and materials.

/// A freedom of a node: displacement along (0 to 2) or rotation about (3 to 5) x, y, z.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Freedom {
    /// Index into [`Mesh::positions`](super::Mesh::positions).
    pub node: usize,
    /// Component, 0 to 5.
    pub component: usize,
}

/// Three orthogonal directions of components.
pub type Directions = [[f64; 3]; 3];

/// The global axes.
pub const GLOBAL: Directions = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// One of the nodes whose mean motion a reference node follows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Weighted {
    /// Index of the node.
    pub node: usize,
    /// Weight > 0.
    pub weight: f64,
    /// Which of the node's displacements, along the directions of the constraint, enter the mean.
    pub components: [bool; 3],
}

/// A linear relation between motions, for small motion.
#[derive(Debug, Clone, PartialEq)]
pub enum Rule {
    /// Σ c u = 0; the freedom of the first term is eliminated if possible (Abaqus `*EQUATION`, Nastran MPC).
    Equation(Vec<(Freedom, f64)>),
    /// These displacements and rotations are zero. Rotations of nodes that have none are ignored.
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
    /// A reference node follows the rigid motion that fits the motion of weighted nodes best, by least squares (RBE3, distributing
    /// coupling).
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
    /// A node follows a weighted sum of other nodes: the point of a face on which it lies (for ties between meshes that do not match).
    Interpolated {
        /// Index of the node.
        node: usize,
        /// Nodes with the values of their shape functions.
        of: Vec<(usize, f64)>,
    },
}

/// A constraint with its name for error messages.
#[derive(Debug, Clone, PartialEq)]
pub struct Constraint {
    /// Name: the keyword, with the name or place in the file.
    pub name: String,
    /// The relation that the constraint demands.
    pub rule: Rule,
}

impl Constraint {
    /// Indices of all nodes of the constraint, in no particular order.
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

/// A point mass with inertia at a node (Nastran CONM2, Abaqus `*MASS` and `*ROTARY INERTIA`).
#[derive(Debug, Clone, PartialEq)]
pub struct PointMass {
    /// Name, for error messages.
    pub name: String,
    /// Index of the node.
    pub node: usize,
    /// Mass >= 0.
    pub mass: f64,
    /// Vector from the node to the centre of mass.
    pub offset: [f64; 3],
    /// Inertia about the centre of mass, symmetric: on the diagonal ∫(y² + z²) dm, off it -∫xy dm.
    pub inertia: [[f64; 3]; 3],
}

/// A material with the set of elements that have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Name of the element set.
    pub elements: String,
    /// Young's modulus, Poisson's ratio, mass density.
    pub constants: [f64; 3],
    /// Name of the material in the file.
    pub material: String,
}
