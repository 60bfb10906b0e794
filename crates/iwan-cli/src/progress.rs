//! Bar on the terminal, and Ctrl-C.

use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use iwan_machine::Kind;
use iwan_machine::threads::begin;

use crate::failure::Failure;
use crate::output;

/// Set by Ctrl-C (and by termination).
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Parts of the bar, which counts in whole numbers: no terminal is wide enough to show more.
const PARTS: f64 = 1000.0;

/// Time between two looks at whether Ctrl-C was pressed, and between two pictures of the spinner: short enough to seem
/// immediate, and twenty looks a second cost nothing.
const TICK: Duration = Duration::from_millis(50);

/// Whether a command runs.
static RUNNING: AtomicBool = AtomicBool::new(false);

/// Held while files become visible and while a command says how it ended: in between it is not broken off.
static ENDING: Mutex<()> = Mutex::new(());

/// What is removed where the command itself has no time for it.
static STAGED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// How long a command may take to notice Ctrl-C by itself; then it is ended. People call less than 0.2 s at once.
const PATIENCE: Duration = Duration::from_millis(120);

/// What goes when Ctrl-C ends the process.
pub(crate) fn staged(folder: &Path) {
    *locked(&STAGED) = Some(folder.to_path_buf());
}

/// From now on Ctrl-C is noticed between two pieces of work, so that no half result stays behind. Work that does not look up in
/// time, as the writing of a long file, ends with the process, and what is [`staged`] is removed.
pub(crate) fn catch_interrupts() {
    RUNNING.store(true, Ordering::Relaxed);
    // It can only fail when a handler is set already, or the system has no signals or no thread: then Ctrl-C just kills.
    let _ = ctrlc::set_handler(|| {
        INTERRUPTED.store(true, Ordering::Relaxed);
        std::thread::sleep(PATIENCE);
        let _ending = ending();
        if RUNNING.load(Ordering::Relaxed) {
            // A file may be made while others are removed.
            let staged = locked(&STAGED).take();
            if let Some(path) = &staged {
                (0..3).for_each(|_| drop(std::fs::remove_dir_all(path)));
            }
            output::message(&Failure::Interrupted.to_string());
            std::process::exit(Failure::Interrupted.code().into());
        }
    });
}

/// From here to the drop of what is returned the command is not broken off.
pub(crate) fn ending() -> MutexGuard<'static, ()> {
    locked(&ENDING)
}

/// The command has ended, and said how.
pub(crate) fn ended() {
    RUNNING.store(false, Ordering::Relaxed);
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Fails when Ctrl-C was pressed.
pub(crate) fn check_interrupt() -> Result<(), Failure> {
    if INTERRUPTED.load(Ordering::Relaxed) { Err(Failure::Interrupted) } else { Ok(()) }
}

/// A progress bar on a terminal, silence elsewhere.
#[derive(Debug)]
pub(crate) struct Bar {
    bar: ProgressBar,
    quiet: bool,
}

/// What shows progress from another thread.
#[derive(Debug, Clone)]
pub(crate) struct Teller {
    bar: ProgressBar,
    quiet: bool,
}

impl Teller {
    /// Shows the share done; breaks off after Ctrl-C.
    pub(crate) fn report(&self, share: f64) -> ControlFlow<()> {
        self.bar.set_position((share * PARTS) as u64);
        if INTERRUPTED.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Says something above the bar.
    pub(crate) fn say(&self, text: &str) {
        if !self.quiet {
            self.bar.suspend(|| output::message(text));
        }
    }
}

impl Bar {
    /// A bar with a title.
    pub(crate) fn new(title: &'static str, quiet: bool) -> Self {
        let hidden = quiet || !std::io::stderr().is_terminal();
        let target = if hidden { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(Some(PARTS as u64), target);
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} %  {eta} left") {
            bar.set_style(style);
        }
        Self { bar: bar.with_message(title), quiet }
    }

    /// A sign of life for work that cannot say how far it is.
    pub(crate) fn busy(title: &'static str, quiet: bool) -> Self {
        let progress = Self::new(title, quiet);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}, {elapsed}") {
            progress.bar.set_style(style);
        }
        progress
    }

    /// Does the work beside this thread, which breaks off after Ctrl-C whether the work has ended or not: it goes with
    /// the process.
    pub(crate) fn wait<R: Send + 'static>(
        &self,
        work: impl FnOnce() -> R + Send + 'static,
    ) -> Result<R, Failure> {
        let (sender, receiver) = std::sync::mpsc::channel();
        // Without a receiver nobody waits for the result.
        let begun = begin("iwan", move || drop(sender.send(work())));
        // Where no thread can be had, the work is done here, and Ctrl-C is seen when it has ended.
        if let Err(work) = begun {
            work();
        }
        loop {
            match receiver.recv_timeout(TICK) {
                Ok(result) => return Ok(result),
                Err(std::sync::mpsc::RecvTimeoutError::Timeout) => check_interrupt()?,
                Err(std::sync::mpsc::RecvTimeoutError::Disconnected) => {
                    return Err(
                        Failure::computation("a fault in this program: please report it").of(Kind::Fault)
                    );
                }
            }
            self.bar.tick();
        }
    }

    /// For work on another thread.
    pub(crate) fn teller(&self) -> Teller {
        Teller { bar: self.bar.clone(), quiet: self.quiet }
    }

    /// Shows the share done; breaks off after Ctrl-C.
    pub(crate) fn report(&self, share: f64) -> ControlFlow<()> {
        self.teller().report(share)
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
