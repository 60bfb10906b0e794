//! All tests of iwan-core in one program: linked once, and run side by side.

mod common;

mod coupled;
mod decay;
mod five_parameter;
mod golden;
mod histories;
mod laws;
mod mended;
mod mode_curves;
mod one_harmonic;
mod parts;
mod parts_in_time;
mod steady_loops;
mod steppers;
mod trial;
