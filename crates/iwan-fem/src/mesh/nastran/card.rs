//! Cards: a name and fields, over one or several lines, in small, large or free fields.

use super::super::error::MeshError;
use super::super::file::{FileBytes, quote};

/// A card.
#[derive(Debug, Clone)]
pub(super) struct Card<'a> {
    /// Name in capitals, without the star that marks large fields.
    pub(super) name: String,
    /// Number of the line of the name, counted from 1.
    pub(super) line: usize,
    /// The fields after the name, eight per line.
    pub(super) fields: Vec<&'a str>,
}

/// Numbers of the sets that the case control selects.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Selected {
    pub(super) spc: Option<i64>,
    pub(super) mpc: Option<i64>,
}

/// The cards of a file, one after another.
pub(super) struct Cards<'a> {
    source: FileBytes<'a>,
    lines: Vec<(usize, &'a str)>,
    at: usize,
    pub(super) selected: Selected,
}

impl<'a> Cards<'a> {
    /// Takes lines without comments; the lines before `BEGIN BULK` tell which sets are selected.
    pub(super) fn new(source: FileBytes<'a>) -> Self {
        let text = source.bytes.split(|b| *b == b'\n').enumerate();
        let line = |(index, bytes): (usize, &'a [u8])| {
            // Comments may contain any bytes; elsewhere a character that is not ASCII cannot be part of a number and is reported there.
            let line = std::str::from_utf8(bytes)
                .unwrap_or_else(|e| std::str::from_utf8(&bytes[..e.valid_up_to()]).unwrap_or_default());
            let line = line.split('$').next().unwrap_or_default().trim_end();
            (!line.trim().is_empty()).then_some((index + 1, line))
        };
        let lines: Vec<(usize, &str)> = text.filter_map(line).collect();
        let begin = lines.iter().position(|(_, line)| {
            let mut words = line.split_whitespace();
            words.next().is_some_and(|w| w.eq_ignore_ascii_case("BEGIN"))
                && words.next().is_some_and(|w| w.to_uppercase().starts_with("BULK"))
        });
        let mut cards =
            Self { source, lines, at: begin.map_or(0, |at| at + 1), selected: Selected::default() };
        for (_, line) in &cards.lines[..begin.unwrap_or(0)] {
            let Some((name, value)) = line.split_once('=') else { continue };
            let value = value.trim().parse().ok();
            match name.trim().to_uppercase().as_str() {
                "SPC" => cards.selected.spc = value,
                "MPC" => cards.selected.mpc = value,
                _ => {}
            }
        }
        cards
    }

    /// The next card; none at `ENDDATA` and at the end of the file.
    pub(super) fn next(&mut self) -> Result<Option<Card<'a>>, MeshError> {
        let Some(&(number, line)) = self.lines.get(self.at) else { return Ok(None) };
        self.at += 1;
        let mut fields = Vec::new();
        let name = split(line, &mut fields);
        let name = name.trim().trim_end_matches('*').trim().to_uppercase();
        let name: String = name.chars().take(20).collect();
        if name == "ENDDATA" {
            self.at = self.lines.len();
            return Ok(None);
        }
        if name.is_empty() || name.starts_with('+') {
            let found = quote(line.as_bytes(), 40);
            return Err(self.source.malformed(
                self.source.at_line(number),
                found,
                "a card: a name in the first field",
            ));
        }
        while let Some((_, next)) = self.lines.get(self.at).filter(|(_, next)| continues(next)) {
            split(next, &mut fields);
            self.at += 1;
        }
        Ok(Some(Card { name, line: number, fields }))
    }
}

/// Whether a line continues the card above it.
fn continues(line: &str) -> bool {
    let first = line.split(',').next().unwrap_or_default();
    let first = if line.contains(',') { first.trim() } else { part(line, 0, 8).trim() };
    first.is_empty() || first.starts_with('+') || first.starts_with('*')
}

/// Adds the fields of a line, and returns the first one, which is the name. A line of large fields holds four fields, half of a card's
/// eight.
fn split<'a>(line: &'a str, fields: &mut Vec<&'a str>) -> &'a str {
    if line.contains(',') {
        let mut all = line.split(',').map(str::trim);
        let name = all.next().unwrap_or_default();
        let most = if name.contains('*') { 4 } else { 8 };
        let before = fields.len();
        fields.extend(all.take(most));
        fields.resize(before + most, "");
        return name;
    }
    let name = part(line, 0, 8);
    let (count, width) = if name.contains('*') { (4, 16) } else { (8, 8) };
    fields.extend((0..count).map(|k| part(line, 8 + k * width, width).trim()));
    name
}

/// Columns of a line; empty beyond the end of the line or at characters of several bytes.
fn part(line: &str, from: usize, width: usize) -> &str {
    line.get(from..(from + width).min(line.len())).unwrap_or_default()
}

impl<'a> Card<'a> {
    pub(super) fn place(&self, source: FileBytes) -> String {
        source.at_line(self.line)
    }

    /// Field number `at`, counted from 0 after the name; empty if there is none.
    pub(super) fn field(&self, at: usize) -> &'a str {
        self.fields.get(at).copied().unwrap_or_default()
    }

    pub(super) fn malformed(
        &self,
        source: FileBytes,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> MeshError {
        source.malformed(format!("{}, {}", self.place(source), self.name), found, expected)
    }

    pub(super) fn unsupported(
        &self,
        source: FileBytes,
        found: impl Into<String>,
        remedy: impl Into<String>,
    ) -> MeshError {
        source.unsupported(self.place(source), found, remedy)
    }

    /// A whole number; `default` if the field is empty.
    pub(super) fn integer(
        &self,
        source: FileBytes,
        at: usize,
        default: Option<i64>,
    ) -> Result<i64, MeshError> {
        let text = self.field(at);
        let value = if text.is_empty() { default } else { text.parse().ok() };
        value.ok_or_else(|| self.malformed(source, format!("{text:?} in field {}", at + 2), "a whole number"))
    }

    /// A number of a node, element, property, and so on, which must be > 0.
    pub(super) fn label(&self, source: FileBytes, at: usize) -> Result<u64, MeshError> {
        let value = self.integer(source, at, None)?;
        u64::try_from(value).ok().filter(|value| *value > 0).ok_or_else(|| {
            self.malformed(source, format!("{value} in field {}", at + 2), "a whole number > 0")
        })
    }

    /// A finite number; `default` if the field is empty.
    pub(super) fn real(&self, source: FileBytes, at: usize, default: Option<f64>) -> Result<f64, MeshError> {
        let text = self.field(at);
        let value = if text.is_empty() { default } else { real(text) };
        value
            .ok_or_else(|| self.malformed(source, format!("{text:?} in field {}", at + 2), "a finite number"))
    }

    /// Digits from 1 to 6 as components; an empty field and 0 mean no component.
    pub(super) fn components(&self, source: FileBytes, at: usize) -> Result<[bool; 6], MeshError> {
        let mut components = [false; 6];
        for digit in self.field(at).chars().filter(|digit| *digit != '0') {
            let index = digit.to_digit(10).filter(|d| (1..=6).contains(d)).ok_or_else(|| {
                let found = format!("{:?} in field {}", self.field(at), at + 2);
                self.malformed(source, found, "digits from 1 to 6")
            })?;
            components[index as usize - 1] = true;
        }
        Ok(components)
    }
}

/// A number in the forms that Nastran accepts: `1.5`, `1.5-3`, `1.5E-3`, `1.5D-3`.
pub(super) fn real(text: &str) -> Option<f64> {
    let plain = text.to_ascii_lowercase().replace('d', "e");
    let value = plain.parse::<f64>().ok().or_else(|| {
        let sign = plain
            .char_indices()
            .skip(1)
            .find(|(at, c)| matches!(c, '+' | '-') && !plain[..*at].ends_with('e'))?
            .0;
        format!("{}e{}", &plain[..sign], &plain[sign..]).parse().ok()
    });
    value.filter(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reals_without_a_letter_for_the_exponent() {
        assert_eq!(real("7.48-4"), Some(7.48e-4));
        assert_eq!(real("-2.8+7"), Some(-2.8e7));
        assert_eq!(real("1.D3"), Some(1000.0));
        assert_eq!(real(".5"), Some(0.5));
        assert_eq!((real("1.0x"), real("nan"), real("-")), (None, None, None));
    }
}
