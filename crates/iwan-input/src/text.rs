//! The text of an input file with its name, for messages with line and column.

use std::fmt::Write as _;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use iwan_machine::{Kind, is_harmful, lacking};

use crate::error::InputError;

/// Largest size of an input file in bytes. An input file is a page or two; tabulated densities make it longer, but never as long as this. A
/// longer file is most likely a record or a mesh given by mistake, and is refused before it is read, a pipe after as many bytes.
const LARGEST: u64 = 16_000_000;

/// A named text.
#[derive(Debug, Clone)]
pub struct InputText {
    /// Name for messages: the path as the user wrote it.
    pub name: String,
    /// The text.
    pub text: String,
    /// Folder to which paths in the text are relative.
    pub folder: PathBuf,
}

impl InputText {
    /// A text that does not come from a user's file.
    #[must_use]
    pub fn built_in(name: &str, text: &str) -> Self {
        Self { name: name.into(), text: text.into(), folder: PathBuf::from(".") }
    }

    /// Reads a file, which must be text of a sensible size and not empty. `word` says in messages what is read ("scenario"), `example`
    /// names the built-in file to start from.
    ///
    /// # Errors
    /// [`InputError`] for a file that cannot be read or is no text.
    pub fn read(path: &Path, word: &str, example: &str) -> Result<Self, InputError> {
        let name = path.display().to_string();
        let fail = |what: String, remedy: &str| InputError::new(format!("{name}: {what}"), remedy);
        let start = format!("`iwan scenario {example}` prints a start");
        let unreadable = |e: std::io::Error| {
            let remedy = lacking(&e).map_or_else(|| format!("check the path; {start}"), str::to_owned);
            fail(format!("cannot be read: {e}"), &remedy).of(Kind::Unreadable)
        };
        let give = format!("give the {word} file (.toml)");
        let meta = std::fs::metadata(path).map_err(unreadable)?;
        if meta.is_dir() {
            return Err(fail("is a folder".into(), &format!("{give} inside it")).of(Kind::Unreadable));
        }
        let bytes = iwan_machine::read_file_within(path, LARGEST).map_err(|e| match e.kind() {
            ErrorKind::FileTooLarge => fail(format!("is too large for a {word} (over 16 MB)"), &give),
            _ => unreadable(e),
        })?;
        let binary = format!("save it as plain text (UTF-8); {start}");
        let text = String::from_utf8(bytes).map_err(|e| {
            let at = e.utf8_error().valid_up_to();
            fail(format!("is not a text file (byte {at} is not UTF-8)"), &binary)
        })?;
        if text.contains('\0') {
            return Err(fail("is not a text file (it holds zero bytes)".into(), &binary));
        }
        if text.trim().is_empty() {
            return Err(fail(
                "is empty".into(),
                &format!("`iwan scenario {example}` prints a file to start from"),
            ));
        }
        let text = text.strip_prefix('\u{feff}').map(str::to_string).unwrap_or(text);
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        Ok(Self { name, text, folder })
    }

    /// An error at a byte offset, with the message `name:line:column: message`.
    #[must_use]
    pub fn failure(&self, offset: usize, message: &str, remedy: &str) -> InputError {
        let (line, column) = self.place(offset);
        InputError::new(format!("{}:{line}:{column}: {message}", self.name), remedy)
    }

    /// Line and column, both counted from 1, of a byte offset.
    fn place(&self, offset: usize) -> (usize, usize) {
        let before = self.text.get(..offset).unwrap_or(&self.text);
        let start = before.rfind('\n').map_or(0, |n| n + 1);
        (before.matches('\n').count() + 1, before[start..].chars().count() + 1)
    }
}

/// A text as a basic string of TOML, in quotes.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if is_harmful(c) => {
                let _ = write!(out, "\\u{:04X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_lines_and_characters_from_one() {
        let source = InputText::built_in("x.toml", "a = 1\nb\u{e4} = 2\n");
        assert_eq!(source.place(0), (1, 1));
        assert_eq!(source.place(6), (2, 1));
        assert_eq!(source.place(9), (2, 3));
        assert_eq!(source.place(999), (3, 1));
    }
}
