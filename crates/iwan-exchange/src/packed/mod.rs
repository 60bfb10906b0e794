//! Matrices in binary containers: netCDF, NumPy's and MATLAB's.

pub(crate) mod netcdf;
pub(crate) mod npy;
pub(crate) mod npz;
pub(crate) mod mat;

use iwan_io::ReadError;

use crate::error::ExchangeError;
use crate::source::Source;

/// An error of iwan-io, as an error of a file of matrices.
fn translated(source: &Source, error: ReadError) -> ExchangeError {
    match error {
        ReadError::Malformed { place, found, expected, .. } => source.malformed(place, found, expected),
        ReadError::Unsupported { place, found, remedy, .. } => source.unsupported(place, found, remedy),
        ReadError::CutShort { place, what, promised, found, .. } => {
            source.malformed(place, format!("{found} {what} before the end"), promised.to_string())
        }
        other => source.malformed("the whole file", other.to_string(), "a whole file of its format"),
    }
}
