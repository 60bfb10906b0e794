//! Texts as they may be shown. Names and cells of files occur in what is printed and written, and control characters among them would move
//! the cursor of a terminal, colour the screen or rename the window: they are shown as codes, `\u{1b}` in text and `\u001b` in JSON. So
//! they are where nothing is a terminal, because what is written into a file is shown on one later.

use std::path::Path;

use iwan_machine::{coded, is_harmful};
use serde::Serialize;

/// A path for messages and tables, in one line.
pub(crate) fn path(path: &Path) -> String {
    coded(&path.to_string_lossy(), is_harmful, |c| c.escape_default().to_string()).into()
}

/// A value as a JSON text. JSON itself codes the control characters of ASCII only.
pub(crate) fn json(value: &impl Serialize) -> String {
    // What is printed holds numbers, texts and lists, whose serialisation cannot fail.
    let mut text = serde_json::to_string_pretty(value).unwrap_or_default();
    text.push('\n');
    coded(&text, |c| is_harmful(c) && c != '\n', |c| format!("\\u{:04x}", u32::from(c))).into()
}
