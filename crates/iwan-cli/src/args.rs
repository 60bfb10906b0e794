//! Options that several commands share, and how values on the command line are read. Doc comments are the help text.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum, ValueHint};
use iwan_machine::threads::at_once;

/// Options of every computing command.
#[derive(Debug, Args)]
pub(crate) struct Common {
    /// Print the summary, or the error, as one JSON object
    #[arg(long)]
    pub(crate) json: bool,
    /// No progress, notes or warnings on standard error; errors still appear
    #[arg(long, short)]
    pub(crate) quiet: bool,
    /// Exit with 1 where a warning about the results is given, such as a tolerance that is not met; the results are written all the same
    #[arg(long)]
    pub(crate) strict: bool,
    /// Number of threads [default: all cores]; the results do not depend on it
    #[arg(long, value_name = "N")]
    pub(crate) threads: Option<NonZeroUsize>,
}

impl Common {
    /// Number of threads to use.
    pub(crate) fn thread_count(&self) -> usize {
        self.threads.map_or_else(at_once, NonZeroUsize::get)
    }
}

/// Where long work is kept while it is done.
#[derive(Debug, Args)]
pub(crate) struct Keeping {
    /// Folder that keeps what is done of long work: after kill -9, Ctrl-C or a loss of power the same command goes on from there and ends with the
    /// same bits. It is made where there is none, and removed at the end
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    pub(crate) checkpoint: Option<PathBuf>,
}

/// Formats of the response.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Text, for everything
    Csv,
    /// NumPy's archive of arrays
    Npz,
    /// Apache Parquet
    Parquet,
}

impl Format {
    /// File name of a table in this format: `stem` with the format's extension.
    pub(crate) fn file(self, stem: &str) -> String {
        let extension = match self {
            Self::Csv => "csv",
            Self::Npz => "npz",
            Self::Parquet => "parquet",
        };
        format!("{stem}.{extension}")
    }
}

/// Reads a finite number.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err("must be a finite number".into()),
    }
}

/// Reads a finite number > 0.
pub(crate) fn positive(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|x| *x > 0.0).ok_or_else(|| "must be a finite number > 0".into())
}
