//! The paper's beam with its discrete joints, and its responses to blows.

mod paper_beam;
mod top_face;
mod filter_quality;
mod runs;
mod beam_under_blows;

pub use beam_under_blows::BeamUnderBlows;
pub use filter_quality::FilterQuality;
pub use paper_beam::{PaperBeam, letter};
pub use runs::ReductionError;

pub(crate) use runs::{BASIS, FULL, WITHOUT_ATTACHMENTS};
pub(crate) use top_face::top_nodes;
