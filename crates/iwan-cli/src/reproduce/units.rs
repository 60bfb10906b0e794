//! Units of modal quantities, as axes and heads of tables have them.

/// Displacement of the beam and its modal models (pounds-force, inches, seconds).
pub(super) const DISPLACEMENT: &str = "\u{221a}(lbf\u{b7}in)\u{b7}s";
/// Force, and acceleration, of the same.
pub(super) const FORCE: &str = "\u{221a}(lbf\u{b7}in)/s";
/// Energy of the same.
pub(super) const ENERGY: &str = "lbf\u{b7}in";
/// Force, and acceleration, in the laboratory (SI).
pub(super) const ACCELERATION: &str = "\u{221a}kg\u{b7}m/s\u{b2}";
