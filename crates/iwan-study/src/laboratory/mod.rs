//! The synthetic laboratory (the paper's Sec. 4): hits on the truth model, a linear modal test of the softest hits, and mode 1 isolated from each hit
//! as the paper does it.
//!
//! All quantities are in SI units. The truth is configuration B, whose first mode lies in the paper's band. There are sensors at 54 points of the top
//! face, a hammer with one more sensor at the tip, white sensor noise, and a suspension that acts as viscous modal damping.

mod noise;
mod bench;
mod modal_test;
mod hit;
mod table_4;
mod evaluation;
mod summary;

pub use bench::HITS;
pub use evaluation::{Laboratory, Table3Row};
pub use hit::{DrawnSensor, Hit, ViscousTerm};
pub use modal_test::{FoundMode, ModalTest};
pub use summary::{HitSummary, LaboratorySummary};
pub use table_4::Table4Row;
