//! Keyword lines, `*NAME, PARAMETER=VALUE, FLAG`.

use super::super::error::MeshError;
use super::super::file::{FileBytes, quote};
use super::lines::{Line, Lines};

/// A keyword with its parameters, from all lines that a comma continues.
#[derive(Debug, Clone)]
pub(super) struct Keyword {
    /// Name in capitals, with single blanks between words and without the star.
    pub(super) name: String,
    /// Number of the line, counted from 1.
    pub(super) line: usize,
    parameters: Vec<(String, Option<String>)>,
}

impl Keyword {
    /// Reads the keyword that begins in `line`.
    pub(super) fn parse(lines: &mut Lines, line: Line) -> Result<Self, MeshError> {
        let mut fields = line.fields();
        let name = name(fields.next().unwrap_or_default());
        let mut parameters: Vec<_> = fields.map(parameter).collect();
        let mut last = line;
        while last.continues() {
            let Some(next) = lines.next_data() else {
                let place = last.place(lines.source);
                return Err(lines.source.malformed(place, "a comma at the end", "a line that continues it"));
            };
            parameters.extend(next.fields().map(parameter));
            last = next;
        }
        parameters.retain(|(name, _)| !name.is_empty());
        Ok(Self { name, line: line.number, parameters })
    }

    /// Place of the keyword in the file, for messages.
    pub(super) fn place(&self, source: FileBytes) -> String {
        source.at_line(self.line)
    }

    pub(super) fn refused(&self, source: FileBytes, found: &str, remedy: &str) -> MeshError {
        source.unsupported(self.place(source), found, remedy)
    }

    /// Whether the keyword has the parameter, with or without a value.
    pub(super) fn has(&self, name: &str) -> bool {
        self.parameters.iter().any(|p| p.0 == name)
    }

    /// Value of a parameter.
    pub(super) fn value(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|p| p.0 == name).and_then(|p| p.1.as_deref())
    }

    /// Value of a mandatory parameter; an error if the value is missing.
    pub(super) fn required(&self, source: FileBytes, name: &str) -> Result<&str, MeshError> {
        self.value(name).filter(|value| !value.is_empty()).ok_or_else(|| {
            source.malformed(
                self.place(source),
                format!("*{} without {name}", self.name),
                format!("{name}=..."),
            )
        })
    }

    /// Refuses parameters other than `known`, because they would change the meaning of the data.
    pub(super) fn only(&self, source: FileBytes, known: &[&str]) -> Result<(), MeshError> {
        let Some((name, _)) = self.parameters.iter().find(|p| !known.contains(&p.0.as_str())) else {
            return Ok(());
        };
        let found = format!("parameter {} of *{}", quote(name.as_bytes(), 40), self.name);
        let remedy = format!("write the data out without it; read are {}", known.join(", "));
        Err(self.refused(source, &found, &remedy))
    }
}

/// Name of a keyword: in capitals, with single blanks and without the star.
pub(super) fn name(bytes: &[u8]) -> String {
    // No keyword is longer than 60 characters; the cut keeps messages about other text short.
    words(bytes).trim_start_matches('*').trim().chars().take(60).collect()
}

/// Text in capitals, with single blanks between words.
fn words(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes).to_uppercase();
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn parameter(field: &[u8]) -> (String, Option<String>) {
    match field.iter().position(|b| *b == b'=') {
        Some(at) => (words(&field[..at]), Some(label(&field[at + 1..]))),
        None => (words(field), None),
    }
}

/// Label as the file writes it, without quotes.
pub(super) fn label(bytes: &[u8]) -> String {
    let bytes = bytes.trim_ascii();
    let bytes = bytes.strip_prefix(b"\"").and_then(|b| b.strip_suffix(b"\"")).unwrap_or(bytes);
    String::from_utf8_lossy(bytes).into_owned()
}
