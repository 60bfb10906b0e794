//! NumPy's formats: one array (NPY), several in a zip archive (NPZ).

mod array;
mod npy;
mod npz;

pub use array::{NPY_MAGIC, NumpyArray};
pub(crate) use npy::parse as parse_npy;
pub use npz::numpy_members;
pub(crate) use npz::parse as parse_npz;
