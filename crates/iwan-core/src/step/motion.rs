//! Displacement and velocity of a mode.

/// Displacement and velocity of a mode at one instant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Displacement q (mass^½·length).
    pub displacement: f64,
    /// Velocity q' (mass^½·length/s).
    pub velocity: f64,
}

impl Motion {
    /// The motion at rest at the given displacement.
    #[must_use]
    pub const fn held_at(displacement: f64) -> Self {
        Self { displacement, velocity: 0.0 }
    }
}
