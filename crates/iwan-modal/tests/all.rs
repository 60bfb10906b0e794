//! All tests of iwan-modal in one program: linked once, and run side by side.

mod support;

mod decays;
mod doubts;
mod promises;
mod synthetic;
