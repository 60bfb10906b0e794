//! What stands in the band of a mode and is not of it: a second mode, harmonics of a stronger one, the mains, and other tones.

mod mains;
mod tone;
mod intruders;
mod second_line;

pub use intruders::Intruder;
