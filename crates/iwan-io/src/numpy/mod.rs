//! NumPy's formats: one array (NPY), several in a zip archive (NPZ).

mod npy;
mod npz;

pub(crate) use npy::{MAGIC, parse as parse_npy};
pub(crate) use npz::parse as parse_npz;
