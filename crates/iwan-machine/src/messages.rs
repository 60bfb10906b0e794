//! Messages as they may be shown: of bounded length, and without characters that a terminal obeys.

use std::borrow::Cow;
use std::fmt::Write;

use super::names::is_harmful;

/// Largest number of characters of a line of a message, and how many of them are its end, where the remedy stands.
const LONGEST: usize = 1000;
const END: usize = 300;
/// Digits of a number that is shown as it is: a double has no more than 17 that mean something, and a number of 40 is no slip of formatting.
const DIGITS: usize = 40;
/// Digits that are shown of a longer one.
const KEPT: usize = 20;

/// A text in which the characters that do harm on a terminal are written as their codes; line ends and tabs stay.
///
/// ```
/// assert_eq!(iwan_machine::harmless("\u{1b}[2J\n"), "\\u{1b}[2J\n");
/// ```
#[must_use]
pub fn harmless(text: &str) -> Cow<'_, str> {
    coded(text, |c| is_harmful(c) && !matches!(c, '\n' | '\t'), |c| c.escape_default().to_string())
}

/// A message of which each line is short, whatever the file holds that it quotes: its begin and its end, and numbers of hundreds of digits cut.
///
/// ```
/// let message = iwan_machine::brief(&format!("step = {}: too long", "9".repeat(300)));
/// assert_eq!(message, "step = 99999999999999999999...(300 digits): too long");
/// assert!(iwan_machine::brief(&"x".repeat(100_000)).len() < 1100);
/// ```
#[must_use]
pub fn brief(text: &str) -> String {
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

/// A text in which digits beyond the twentieth of a number of more than forty are left out, and their count is given.
#[must_use]
pub fn without_long_numbers(text: &str) -> Cow<'_, str> {
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

/// A text in which a code stands for each character that is called harmful.
pub fn coded(text: &str, harmful: impl Fn(char) -> bool, code: impl Fn(char) -> String) -> Cow<'_, str> {
    if !text.contains(&harmful) {
        return text.into();
    }
    text.chars().map(|c| if harmful(c) { code(c) } else { c.to_string() }).collect::<String>().into()
}
