//! Where a ring-down begins.

/// A turning point of the motion: the model's ring-down starts from rest there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TurningPoint {
    /// Displacement q, mass-normalised.
    pub displacement: f64,
    /// Time from the first sample, s: before it when negative.
    pub time: f64,
}
