//! What a command says about its results: one JSON object for files and programs, one text for the terminal.

use std::path::Path;

use serde::Serialize;

use crate::failure::VERSION;

/// The summary of what a command found. Its fields are the keys of the JSON object; the session puts `version` before them
/// and `files` behind them, and on standard output `folder`.
pub(crate) trait Summary: Serialize {
    /// What the page shows, as the last note on standard error calls it.
    const SHOWN: &'static str = "figures";

    /// What the user should look at, where the computation found it; said once the results are there.
    fn warnings(&self) -> &[String] {
        &[]
    }

    /// Wall-clock time, s, where it stands on standard output only, so that the file is the same every time.
    fn seconds(&self) -> Option<f64> {
        None
    }

    /// The text for the terminal.
    fn text(&self) -> String;
}

/// A summary with what the session adds.
#[derive(Serialize)]
struct Whole<'a, S> {
    version: &'static str,
    #[serde(flatten)]
    summary: &'a S,
    #[serde(skip_serializing_if = "<[String]>::is_empty")]
    files: &'a [String],
    /// Where the files are: on standard output only, so that the folder may be moved.
    #[serde(skip_serializing_if = "Option::is_none")]
    folder: Option<&'a Path>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seconds: Option<f64>,
}

/// The summary as it stands in its file.
pub(super) fn written(summary: &impl Summary, files: &[String]) -> String {
    json(&Whole { version: VERSION, summary, files, folder: None, seconds: None })
}

/// The summary as other programs get it, who have no folder of files.
pub(crate) fn alone(summary: &impl Summary) -> String {
    written(summary, &[])
}

/// The summary as standard output shows it.
pub(super) fn printed(summary: &impl Summary, files: &[String], folder: &Path) -> String {
    json(&Whole { version: VERSION, summary, files, folder: Some(folder), seconds: summary.seconds() })
}

fn json(whole: &impl Serialize) -> String {
    // Numbers, texts and lists: serialisation cannot fail.
    let mut text = serde_json::to_string_pretty(whole).unwrap_or_default();
    text.push('\n');
    text
}
