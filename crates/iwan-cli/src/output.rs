//! The only place that prints: results to stdout, everything else to stderr.

use std::io::Write;

use iwan_machine::{Kind, brief, harmless};

use crate::failure::Failure;

/// Prints a result to stdout. It is no failure where the reader has closed the pipe (`iwan ... | head`).
pub(crate) fn result(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(harmless(text).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::computation(format!("cannot write to standard output: {error}"))
                .of(Kind::Unwritable))
        }
        _ => Ok(()),
    }
}

/// Prints a line to stderr. Where stderr is closed, the message is lost.
pub(crate) fn message(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{}", harmless(&brief(text)));
}
