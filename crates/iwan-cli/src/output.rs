//! The only place that prints: results to stdout, everything else to stderr.

use std::borrow::Cow;
use std::io::Write;

use iwan_machine::Kind;

use crate::failure::Failure;

/// Prints a result to stdout. It is no failure where the reader has closed the pipe (`iwan ... | head`).
pub(crate) fn result(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let shown = if std::io::IsTerminal::is_terminal(&out) { harmless(text) } else { text.into() };
    match out.write_all(shown.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::computation(format!("cannot write to standard output: {error}"))
                .of(Kind::Unwritable))
        }
        _ => Ok(()),
    }
}

/// Prints a line to stderr. Where stderr is closed, the message is lost.
pub(crate) fn message(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", harmless(text));
}

/// Text for a terminal. Names and cells of files occur in it, and their control characters would move the cursor, colour the screen or rename the
/// window: they are shown as codes. Line ends and tabs stay.
fn harmless(text: &str) -> Cow<'_, str> {
    let harmful = |c: char| c.is_control() && !matches!(c, '\n' | '\t') || HIDDEN.contains(&c);
    if !text.contains(harmful) {
        return text.into();
    }
    let shown = |c: char| if harmful(c) { c.escape_default().to_string() } else { c.to_string() };
    text.chars().map(shown).collect::<String>().into()
}

/// Characters that change the direction of writing, by which one name can be made to look like another (Unicode UAX 9).
const HIDDEN: [char; 9] = [
    '\u{202a}', '\u{202b}', '\u{202c}', '\u{202d}', '\u{202e}', '\u{2066}', '\u{2067}', '\u{2068}',
    '\u{2069}',
];
