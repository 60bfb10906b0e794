//! Progress on the terminal, and Ctrl-C.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::failure::Failure;

/// Set by Ctrl-C (and by termination).
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Parts of the bar.
const PARTS: f64 = 1000.0;

/// From now on Ctrl-C is noticed between two pieces of work, so that no half result stays behind.
pub(crate) fn catch_interrupts() {
    // It can only fail when a handler is set already, or the system has no signals: then Ctrl-C just kills.
    let _ = ctrlc::set_handler(|| INTERRUPTED.store(true, Ordering::Relaxed));
}

/// Fails when Ctrl-C was pressed.
pub(crate) fn check_interrupt() -> Result<(), Failure> {
    if INTERRUPTED.load(Ordering::Relaxed) { Err(Failure::Interrupted) } else { Ok(()) }
}

/// A progress bar on a terminal, silence elsewhere.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// A bar with a title.
    pub(crate) fn new(title: &'static str, quiet: bool) -> Self {
        let hidden = quiet || !std::io::stderr().is_terminal();
        let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(PARTS as u64), target);
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} %  {eta} left") {
            bar.set_style(style);
        }
        Self { bar: bar.with_message(title) }
    }

    /// Shows the share done; breaks off after Ctrl-C.
    pub(crate) fn report(&self, share: f64) -> ControlFlow<()> {
        self.bar.set_position((share * PARTS) as u64);
        if INTERRUPTED.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
