//! `iwan.Structure`: modes, quasi-static curves and transients of a structure with its discrete joints.

pub(crate) mod structure;
pub(crate) mod written;
pub(crate) mod static_curves;
pub(crate) mod blow;
pub(crate) mod steady;
pub(crate) mod update;
