//! The blows on the beam and its modal models (the paper's Sec. 3), and the length of their records.

use iwan_core::Pulse;

/// Peak forces of the blows, lbf: from micro-slip in every joint to macro-slip during most of a record (Sec. 3).
pub const LEVELS: [f64; 6] = [1.0, 10.0, 100.0, 1000.0, 5000.0, 10_000.0];

/// Duration of a blow, s.
pub const BLOW: f64 = 1.6e-3;

/// Time step, s. The paper's scheme lengthens the period by the share (ω dt)²/12: 1.6e-4 for mode 3 at 696 Hz, and less for the lower modes. The
/// truth and the modal models are integrated by the same scheme at the same step, so that this error cancels where the two are compared.
pub const DT: f64 = 1e-5;

/// Number of steps: 0.2 s, 26 cycles of mode 1.
pub const STEPS: usize = 20_000;

/// A blow at the tip: a haversine of this peak force.
///
/// ```
/// use iwan_study::blows::{BLOW, blow};
/// assert!((blow(1000.0).at(0.5 * BLOW) - 1000.0).abs() < 1e-9);
/// assert_eq!(blow(1000.0).at(2.0 * BLOW), 0.0);
/// ```
#[must_use]
pub const fn blow(peak: f64) -> Pulse<'static> {
    Pulse::Haversine { amplitude: peak, duration: BLOW }
}
