//! All tests of iwan-input in one program: linked once, and run side by side.

mod coupled_modes;
mod given_matrices;
