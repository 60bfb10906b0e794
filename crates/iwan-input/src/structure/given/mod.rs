//! `[matrices]`: structures whose stiffness and mass another program assembled, and what refers to their rows.

mod matrix_file;
mod row_map;
mod combinations;
mod recovery;
mod matrices;

pub(super) use combinations::Combinations;
#[cfg(test)]
pub(super) use matrices::MATRICES_KEYS;
pub(super) use matrices::read;
