//! The summary of a command's results: one JSON object for files and programs, one text for the terminal.

use std::path::Path;

use serde::Serialize;

use crate::failure::VERSION;
use crate::shown::json;

/// The summary of a command's results. Its fields are the keys of the JSON object; the session puts `version` before them and `files` behind them,
/// and on standard output also `folder`.
pub(crate) trait Summary: Serialize {
    /// What the page shows, in the words of the last note on standard error.
    const SHOWN: &'static str = "figures";

    /// Warnings that the computation found; they are printed once the results are written, and with `--strict` any of them is a failure.
    fn warnings(&self) -> &[String] {
        &[]
    }

    /// Wall-clock time, s, for a summary that shows it on standard output only, so that the file is the same at every run.
    fn seconds(&self) -> Option<f64> {
        None
    }

    /// The text for the terminal.
    fn text(&self) -> String;
}

/// A summary with the keys that the session adds.
#[derive(Serialize)]
struct Whole<'a, S> {
    version: &'static str,
    #[serde(flatten)]
    summary: &'a S,
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    files: &'a [String],
    /// The folder of the files; on standard output only, so that the folder may be moved.
    #[serde(skip_serializing_if = "Option::is_none")]
    folder: Option<&'a Path>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds: Option<f64>,
}

/// The summary as JSON for its file.
pub(super) fn written(summary: &impl Summary, files: &[String]) -> String {
    json(&Whole { version: VERSION, summary, files, folder: None, seconds: None })
}

/// The summary as JSON for other programs, which have no folder of files.
pub(crate) fn alone(summary: &impl Summary) -> String {
    written(summary, &[])
}

/// The summary as JSON for standard output.
pub(super) fn printed(summary: &impl Summary, files: &[String], folder: &Path) -> String {
    json(&Whole { version: VERSION, summary, files, folder: Some(folder), seconds: summary.seconds() })
}
