//! Texts as they may be shown. Names and cells of files occur in what is printed and written, and control characters among them would move
//! the cursor of a terminal, colour the screen or rename the window: they are shown as codes, `\u{1b}` in text and `\u001b` in JSON. So
//! they are where nothing is a terminal, because what is written into a file is shown on one later.

use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

use iwan_machine::is_harmful;
use serde::Serialize;

/// Largest number of characters of a line of a message, and how many of them are its end, where the remedy stands.
const LONGEST: usize = 1000;
const END: usize = 300;
/// Digits of a number that is shown as it is: a double has no more than 17 that mean something, and a number of 40 is no slip of formatting.
const DIGITS: usize = 40;
/// Digits that are shown of a longer one.
const KEPT: usize = 20;

/// A text; line ends and tabs stay.
pub(crate) fn harmless(text: &str) -> Cow<'_, str> {
    coded(text, |c| is_harmful(c) && !matches!(c, '\n' | '\t'), |c| c.escape_default().to_string())
}

/// A message of which each line is short, whatever the file holds that it quotes: its begin and its end, and numbers of hundreds of digits cut.
pub(crate) fn brief(text: &str) -> String {
    let line = |line: &str| {
        let line = without_long_numbers(line);
        let count = line.chars().count();
        if count <= LONGEST {
            return line.into_owned();
        }
        let begin: String = line.chars().take(LONGEST - END).collect();
        let end: String = line.chars().skip(count - END).collect();
        format!("{begin} ... {end}")
    };
    text.split('\n').map(line).collect::<Vec<_>>().join("\n")
}

/// A text in which digits beyond the twentieth of a number are left out, and their count is given.
pub(crate) fn without_long_numbers(text: &str) -> Cow<'_, str> {
    let mut out = String::new();
    let (mut rest, mut copied) = (text, false);
    while let Some(begin) = rest.find(|c: char| c.is_ascii_digit()) {
        let digits = rest[begin..].find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len() - begin);
        let shown = if digits > DIGITS { KEPT } else { digits };
        out.push_str(&rest[..begin + shown]);
        if shown < digits {
            copied = true;
            let _ = write!(out, "...({digits} digits)");
        }
        rest = &rest[begin + digits..];
    }
    out.push_str(rest);
    if copied { out.into() } else { text.into() }
}

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

fn coded(text: &str, harmful: impl Fn(char) -> bool, code: impl Fn(char) -> String) -> Cow<'_, str> {
    if !text.contains(&harmful) {
        return text.into();
    }
    text.chars().map(|c| if harmful(c) { code(c) } else { c.to_string() }).collect::<String>().into()
}
