//! Shaker's tests for other programs: files and columns read as `iwan fit --sweep --backbone` reads them.

use std::path::PathBuf;

use iwan_ident::sweeps::SteadyData;

use crate::fit::{Content, Measurement, Scaling, read_columns};

/// Where a measurement comes from.
#[derive(Debug, Clone)]
pub enum SweepSource {
    /// A file: text, MATLAB, NumPy, or functions of a universal file.
    File(PathBuf),
    /// Columns of equal length by name, as a file would have them.
    Columns {
        /// What messages call it.
        name: String,
        /// The columns.
        columns: Vec<(String, Vec<f64>)>,
    },
}

/// What a measurement is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SweepKind {
    /// Stepped-sine responses.
    Response,
    /// Frequency and damping ratio against amplitude.
    Backbone,
}

/// The measurement, mass-normalised by the modal mass `mass`; `levels` are the forces of a universal file's functions, in their order.
///
/// # Errors
/// Why it is none, in words: file, column, entry and what helps.
pub fn sweep_data(
    source: SweepSource,
    kind: SweepKind,
    mass: f64,
    levels: &[f64],
) -> Result<SteadyData, String> {
    let scaling = Scaling { mass, levels };
    let content = match source {
        SweepSource::File(path) => read_columns(&path).map(|content| (path.display().to_string(), content)),
        SweepSource::Columns { name, columns } => Ok((name, Content::Columns(columns))),
    };
    let found = content.and_then(|(file, content)| match kind {
        SweepKind::Response => Measurement::response(file, content, scaling),
        SweepKind::Backbone => Measurement::backbone(file, content, scaling),
    });
    found.map(|measurement| measurement.data).map_err(|failure| failure.to_string())
}
