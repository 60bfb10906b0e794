//! Values that users make: joint laws, pulses, modes. Frozen, hashable, picklable, with a `repr` that reads back.

pub(crate) mod joint_face;
pub(crate) mod joint_laws;
pub(crate) mod pulse;
pub(crate) mod parts;
pub(crate) mod mode_curves;
pub(crate) mod mode;
