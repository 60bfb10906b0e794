//! Steps: the motion of a mode with a joint, computed from sample to sample, from event to event, or by its slow amplitude and phase.

mod motion;
mod oscillator;
mod modal_law;
mod pulse;
mod response;
mod newmark;
mod slider_newmark;
mod energy;
mod slow;
mod averaging;
mod parts_newmark;
mod events;

pub use averaging::Averaging;
pub(crate) use energy::Works;
pub use energy::{EnergyBalance, JointEnergy};
pub use events::EventDriven;
pub use modal_law::ModalLaw;
pub use motion::Motion;
pub use newmark::Newmark;
pub use oscillator::{Oscillator, ResidualStiffness};
pub use parts_newmark::{PartsEnd, WithParts};
pub use pulse::Pulse;
pub use response::Samples;
pub(crate) use response::force_at;
pub use slow::AmplitudePhase;
pub(crate) use slow::{Rates, SlowMotion};
