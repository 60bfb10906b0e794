//! Values that users make: joint laws, pulses, modes. They are immutable, hashable and picklable, and their `repr` is an expression for an
//! equal value.

pub(crate) mod joint_face;
pub(crate) mod joint_laws;
pub(crate) mod pulse;
pub(crate) mod parts;
pub(crate) mod mode_curves;
pub(crate) mod mode;
