//! All tests of iwan-ident in one program: linked once, and run side by side.

mod law_records;
mod shared_records;

mod curve_fit;
mod envelope_ends;
mod free_form;
mod freevib;
mod identification;
mod neighbours;
mod shared_joints;
mod sweeps;
mod synthetic_truth;
mod treated_records;
mod troubled_records;
mod what_is_told;
mod which_law;
