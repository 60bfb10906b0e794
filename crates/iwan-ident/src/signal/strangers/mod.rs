//! What stands in the band of a mode and is not of it: harmonics of a stronger mode, and the mains.

mod mains;
mod intruders;

pub use intruders::Intruder;
