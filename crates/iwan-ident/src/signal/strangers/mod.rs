//! Components in the band of a mode that do not belong to it: a second mode, harmonics of a stronger one, the mains, and other tones.

mod mains;
mod tone;
mod intruders;
mod second_line;

pub use intruders::Intruder;
