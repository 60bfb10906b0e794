//! `INCLUDE` with its file name; and tabs, which stand for blanks up to the next column divisible by eight.

use std::borrow::Cow;
use std::path::PathBuf;

use super::super::file::Include;

/// The form `INCLUDE 'FILE'`.
pub(in crate::mesh) const INCLUDE: Include =
    Include { word: "INCLUDE", form: "INCLUDE 'FILE' on one line", is_one: is_include, input };

fn is_include(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    line.get(..7).is_some_and(|word| word.eq_ignore_ascii_case(b"INCLUDE"))
        && line.get(7).is_some_and(|next| next.is_ascii_whitespace() || matches!(next, b'\'' | b'"' | b'='))
}

/// The file name: the text between quotes, or after the word.
fn input(line: &[u8]) -> Option<PathBuf> {
    let rest = std::str::from_utf8(line.trim_ascii().get(7..)?).ok()?.trim().trim_start_matches('=').trim();
    let name = match rest.chars().next()? {
        quote @ ('\'' | '"') => rest[1..].split_once(quote)?.0,
        _ => rest.split('$').next()?.trim(),
    };
    (!name.is_empty()).then(|| PathBuf::from(name))
}

/// The text with each tab replaced by blanks.
pub(super) fn without_tabs(bytes: &[u8]) -> Cow<'_, [u8]> {
    if !bytes.contains(&b'\t') {
        return Cow::Borrowed(bytes);
    }
    let (mut out, mut column) = (Vec::with_capacity(bytes.len()), 0_usize);
    for &byte in bytes {
        match byte {
            b'\t' => {
                let next = (column / 8 + 1) * 8;
                out.resize(out.len() + next - column, b' ');
                column = next;
            }
            b'\n' => {
                out.push(byte);
                column = 0;
            }
            _ => {
                out.push(byte);
                column += 1;
            }
        }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tabs_reach_to_the_next_of_eight_columns() {
        assert_eq!(&*without_tabs(b"GRID\t1\t\t0.\n\t2"), b"GRID    1               0.\n        2");
    }

    #[test]
    fn files_are_named_with_and_without_quotes() {
        for line in ["include 'a b.bdf' $ more", "INCLUDE \"a b.bdf\"", "INCLUDE a b.bdf $ c"] {
            assert!(is_include(line.as_bytes()));
            assert_eq!(input(line.as_bytes()), Some(PathBuf::from("a b.bdf")), "{line}");
        }
        assert!(!is_include(b"INCLUDED 1") && input(b"INCLUDE 'open").is_none());
    }
}
