//! Where a mode is and how fast it moves.

/// Displacement and velocity of a mode at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Displacement q (mass^½·length).
    pub displacement: f64,
    /// Velocity q', the same per second.
    pub velocity: f64,
}

impl Motion {
    /// Held at a displacement, without velocity.
    #[must_use]
    pub const fn held_at(displacement: f64) -> Self {
        Self { displacement, velocity: 0.0 }
    }
}
