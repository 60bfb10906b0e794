//! A node and a direction there.

/// Node and direction of a response or a force; directions are 0 (none), ±1 to ±3 along x, y, z, ±4 to ±6 about them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct NodalDirection {
    /// Node.
    pub node: i64,
    /// Direction.
    pub direction: i64,
}
