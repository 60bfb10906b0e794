//! The text of a scenario with its name, for messages that say where.

use std::path::{Path, PathBuf};

use crate::failure::Failure;

/// A scenario file is a page or two; tabulated densities make it longer, but never this long.
const LARGEST: u64 = 16 << 20;

/// A named text.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    /// Name for messages: the path as the user wrote it.
    pub(crate) name: String,
    /// The text.
    pub(crate) text: String,
    /// Folder to which paths in the text are relative.
    pub(crate) folder: PathBuf,
}

impl Source {
    /// A text that does not come from a file of the user's.
    pub(crate) fn built_in(name: &str, text: &str) -> Self {
        Self { name: name.into(), text: text.into(), folder: PathBuf::from(".") }
    }

    /// Reads a file: text of a sensible size, not empty.
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let name = path.display().to_string();
        let fail = |what: String, remedy: &str| Failure::input(format!("{name}: {what}"), remedy);
        let unreadable = |e| {
            fail(format!("cannot be read: {e}"), "check the path; `iwan scenario paper-modal` prints a start")
        };
        let meta = std::fs::metadata(path).map_err(unreadable)?;
        if meta.is_dir() {
            return Err(fail("is a folder".into(), "give the scenario file (.toml) inside it"));
        }
        if meta.len() > LARGEST {
            return Err(fail(
                "is too large for a scenario (over 16 MB)".into(),
                "give the scenario file (.toml)",
            ));
        }
        let bytes = std::fs::read(path).map_err(unreadable)?;
        let binary = "save it as plain text (UTF-8); `iwan scenario paper-modal` prints a start";
        let text = String::from_utf8(bytes).map_err(|e| {
            let at = e.utf8_error().valid_up_to();
            fail(format!("is not a text file (byte {at} is not UTF-8)"), binary)
        })?;
        if text.contains('\0') {
            return Err(fail("is not a text file (it holds zero bytes)".into(), binary));
        }
        if text.trim().is_empty() {
            return Err(fail("is empty".into(), "`iwan scenario paper-modal` prints a file to start from"));
        }
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        Ok(Self { name, text, folder })
    }

    /// A failure at a byte offset, as `name:line:column: message`.
    pub(crate) fn failure(&self, offset: usize, message: &str, remedy: &str) -> Failure {
        let (line, column) = self.place(offset);
        Failure::input(format!("{}:{line}:{column}: {message}", self.name), remedy)
    }

    /// Line and column, both from 1, of a byte offset.
    fn place(&self, offset: usize) -> (usize, usize) {
        let before = self.text.get(..offset).unwrap_or(&self.text);
        let start = before.rfind('\n').map_or(0, |n| n + 1);
        (before.matches('\n').count() + 1, before[start..].chars().count() + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_lines_and_characters_from_one() {
        let source = Source::built_in("x.toml", "a = 1\nb\u{e4} = 2\n");
        assert_eq!(source.place(0), (1, 1));
        assert_eq!(source.place(6), (2, 1));
        assert_eq!(source.place(9), (2, 3));
        assert_eq!(source.place(999), (3, 1));
    }
}
