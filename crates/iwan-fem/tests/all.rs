//! All tests of iwan-fem in one program: linked once, and run side by side.

mod common;
mod solids;

mod adjusted_curves;
mod checkpoints;
mod constraints;
mod convergence;
mod elements;
mod given;
mod mesh_any_bytes;
mod mesh_check;
mod mesh_files;
mod mesh_skins;
mod modes;
mod nastran_files;
mod peers;
mod quasi_static;
mod structures;
mod transients;
mod vtu_files;
