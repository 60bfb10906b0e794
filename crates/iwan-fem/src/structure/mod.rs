//! The user's description of a structure: a mesh, materials, bolted interfaces, supports, masses and springs; and the check whether it can
//! be computed.

mod interface;
mod given;
mod kept;
mod description;

pub mod check;
pub mod paper;

pub use description::{Lump, Structure, Support};
pub use given::{Given, Recovered, RelativeSlip, Row};
pub use interface::{Interface, Joint, Law, Patch, Slip};
pub use kept::{Kept, KeptModes};
