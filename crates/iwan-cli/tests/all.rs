//! All tests of iwan-cli in one program: linked once, and run side by side.

#[path = "common/beam.rs"]
mod beam;
mod common;
#[path = "common/hits.rs"]
mod hits_of_bench;
#[path = "../../iwan-modal/tests/support/mod.rs"]
mod support;

mod bad_input;
mod coupled_fit;
mod envelope;
mod errors;
mod fit;
mod help;
mod hostile;
mod limits;
mod modal;
mod modal_input;
mod records;
mod reproduce;
mod shown;
mod simulate;
mod steady;
mod stream;
mod strict;
mod structures;
mod trust;
mod update;
mod whole_way;
mod written_models;
