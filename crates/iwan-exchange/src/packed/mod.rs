//! Matrices in binary containers: NumPy and MATLAB.

pub(crate) mod numbers;
pub(crate) mod netcdf;
pub(crate) mod npy;
pub(crate) mod npz;
pub(crate) mod mat;
