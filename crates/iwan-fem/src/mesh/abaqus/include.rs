//! Form of `*INCLUDE`, which names another file.

use std::path::PathBuf;

use super::super::file::Include;
use super::keyword::label;

/// `*INCLUDE, INPUT=FILE`.
pub(in crate::mesh) const INCLUDE: Include =
    Include { word: "*INCLUDE", form: "*INCLUDE, INPUT=FILE on one line", is_one: is_include, input };

fn is_include(line: &[u8]) -> bool {
    let line = line.trim_ascii();
    let word = line.strip_prefix(b"*").map(<[u8]>::trim_ascii_start).unwrap_or_default();
    word.get(..7).is_some_and(|word| word.eq_ignore_ascii_case(b"INCLUDE"))
        && word.get(7).is_none_or(|next| *next == b',' || next.is_ascii_whitespace())
}

/// Value of the parameter INPUT.
fn input(line: &[u8]) -> Option<PathBuf> {
    line.split(|b| *b == b',').find_map(|field| {
        let at = field.iter().position(|b| *b == b'=')?;
        field[..at]
            .trim_ascii()
            .eq_ignore_ascii_case(b"INPUT")
            .then(|| PathBuf::from(label(&field[at + 1..])))
    })
}
