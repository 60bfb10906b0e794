//! Units of modal quantities, as texts for axes and table heads.

/// Modal displacement of the beam and its modal models (pounds-force, inches, seconds).
pub(super) const DISPLACEMENT: &str = "\u{221a}(lbf\u{b7}in)\u{b7}s";
/// Modal force and modal acceleration in the same units.
pub(super) const FORCE: &str = "\u{221a}(lbf\u{b7}in)/s";
/// Energy in the same units.
pub(super) const ENERGY: &str = "lbf\u{b7}in";
/// Modal force and modal acceleration in the laboratory (SI).
pub(super) const ACCELERATION: &str = "\u{221a}kg\u{b7}m/s\u{b2}";
