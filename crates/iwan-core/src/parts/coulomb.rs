//! Dry friction between rigid bodies.

use crate::error::{Error, check};

/// Coulomb friction: a force of constant size against the velocity; at rest, the force that holds the mode, up to that size.
/// Mass-normalised.
///
/// The part is a slider without a spring: at rest it does not move at all, where an Iwan joint creeps. A motion of amplitude a loses D = 4
/// F a in one cycle. A free decay on a linear spring k loses the amplitude 4 F/k in every cycle, until it stops within F/k of the middle
/// (J. P. Den Hartog, Forced vibrations with combined Coulomb and viscous friction, Trans. ASME 53:107, 1931).
///
/// ```
/// use iwan_core::Coulomb;
/// let friction = Coulomb::new(2.0)?;
/// assert_eq!(friction.dissipation(0.1), 0.8);
/// # Ok::<(), iwan_core::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coulomb {
    force: f64,
}

impl Coulomb {
    /// Friction of the size `force` >= 0 (mass^½·length/s²).
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the parameter's name.
    pub fn new(force: f64) -> Result<Self, Error> {
        check("force", force, force >= 0.0, "must be a finite number >= 0").map(|force| Self { force })
    }

    /// Size F of the force.
    #[must_use]
    pub const fn size(&self) -> f64 {
        self.force
    }

    /// Energy lost in one cycle of amplitude `a`: 4 F |a|, whatever the frequency.
    #[must_use]
    pub fn dissipation(&self, a: f64) -> f64 {
        4.0 * self.force * libm::fabs(a)
    }
}
