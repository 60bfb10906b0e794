//! A shaker's test, handed over by other programs (the Python package): read, fitted and drawn as `iwan fit --sweep --backbone` does with files.

use std::path::PathBuf;

use iwan_ident::identify::Identification;
use iwan_ident::sweeps::SteadyFit;
use iwan_ident::{Error, Parameter};

use crate::fit::{Content, Measurement, Results, RingDowns, Scaling, ShakerTest, read_columns};
use crate::session::alone;

/// Where a measurement comes from.
#[derive(Debug, Clone)]
pub enum SweepSource {
    /// A file: text, MATLAB, NumPy, or functions of a universal file.
    File(PathBuf),
    /// Columns of equal length with their names, as a file would hold them.
    Columns {
        /// Name of the source in messages.
        name: String,
        /// Name and values of each column.
        columns: Vec<(String, Vec<f64>)>,
    },
}

/// The kind of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SweepKind {
    /// Stepped-sine responses.
    Response,
    /// Frequency and damping ratio against amplitude.
    Backbone,
}

/// A shaker's test of one mode, as it was read.
#[derive(Debug, Clone)]
pub struct SweepTest(ShakerTest);

impl SweepTest {
    /// Reads measurements of a mode with the modal mass `mass` (none: the measurements are modal quantities already). `levels` are the forces of a
    /// universal file's functions, in the order of the file; `ring_downs` are the names of records and what was identified in them.
    ///
    /// # Errors
    /// A message in words where a source is no measurement: file, column, entry and what the user can do.
    pub fn read(
        sources: Vec<(SweepKind, SweepSource)>,
        mass: Option<f64>,
        levels: &[f64],
        ring_downs: Option<(Vec<String>, &Identification)>,
    ) -> Result<Self, String> {
        let scaling = Scaling { mass: mass.unwrap_or(1.0), levels };
        let measurements = sources
            .into_iter()
            .map(|(kind, source)| measurement(kind, source, scaling))
            .collect::<Result<_, _>>()?;
        let ring_downs = ring_downs.map(|(files, found)| RingDowns {
            files,
            mode: "mode 1".into(),
            likelihood: found.likelihood.clone(),
            informed: found.informed(),
        });
        Ok(Self(ShakerTest { measurements, ring_downs, mass }))
    }

    /// Fits one mode to everything; parameters of `hold` keep their values.
    ///
    /// # Errors
    /// Those of [`iwan_ident::sweeps::fit_steady`].
    pub fn fit(&self, hold: &[(Parameter, f64)]) -> Result<SteadyFit, Error> {
        self.0.fit(hold)
    }

    /// The report of `iwan fit` as self-contained HTML.
    ///
    /// # Errors
    /// A message in words: a mode that cannot be driven at the measured levels.
    pub fn page(&self, fit: &SteadyFit) -> Result<String, String> {
        Results::new(&self.0, fit).map(|results| results.page).map_err(|failure| failure.to_string())
    }

    /// `fit.json` of `iwan fit`.
    ///
    /// # Errors
    /// As [`page`](Self::page).
    pub fn json(&self, fit: &SteadyFit) -> Result<String, String> {
        Results::new(&self.0, fit)
            .map(|results| alone(&results.summary))
            .map_err(|failure| failure.to_string())
    }
}

fn measurement(kind: SweepKind, source: SweepSource, scaling: Scaling<'_>) -> Result<Measurement, String> {
    let content = match source {
        SweepSource::File(path) => read_columns(&path).map(|content| (path.display().to_string(), content)),
        SweepSource::Columns { name, columns } => Ok((name, Content::Columns(columns))),
    };
    let found = content.and_then(|(file, content)| match kind {
        SweepKind::Response => Measurement::response(file, content, scaling),
        SweepKind::Backbone => Measurement::backbone(file, content, scaling),
    });
    found.map_err(|failure| failure.to_string())
}
