//! The only place that prints: results to stdout, everything else to stderr.

use std::io::Write;

use crate::failure::Failure;

/// Prints a result to stdout. A reader that has gone (`iwan ... | head`) is no failure.
pub(crate) fn result(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(Failure::Computation(format!("cannot write to standard output: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a line to stderr; when that is closed there is nobody to tell.
pub(crate) fn message(text: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{text}");
}
