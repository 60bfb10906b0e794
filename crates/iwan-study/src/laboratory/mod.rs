//! The laboratory's side (the paper's Sec. 4): hits on the truth, a linear modal test of the softest of them, and mode 1 taken out of each as the paper does.
//!
//! SI units. The truth is configuration B, whose first mode lies in the paper's band. Sensors at 54 points of the top face,
//! a hammer with one more at the tip, white sensor noise, and a suspension that takes what a viscous modal damper takes.

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
