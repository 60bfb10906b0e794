//! The progress bar on the terminal, and the handling of Ctrl-C.

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

/// Set by Ctrl-C, and by a signal to terminate.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Steps of the bar, which counts in whole numbers: no terminal is wide enough to show more.
const PARTS: f64 = 1000.0;

/// Time between two checks of whether Ctrl-C was pressed, and between two frames of the spinner: short enough to seem immediate, and twenty checks a
/// second cost nothing.
const TICK: Duration = Duration::from_millis(50);

/// Whether a command is running.
static RUNNING: AtomicBool = AtomicBool::new(false);

/// Locked while files become visible and while a command reports how it ended; Ctrl-C does not end the process meanwhile.
static ENDING: Mutex<()> = Mutex::new(());

/// Folder that the handler of Ctrl-C removes where the command has no time to remove it.
static STAGED: Mutex<Option<PathBuf>> = Mutex::new(None);

/// Time within which a command may notice Ctrl-C by itself; after it the handler ends the process. Users perceive less than 0.2 s as immediate.
const PATIENCE: Duration = Duration::from_millis(120);

/// Names the folder that is removed where Ctrl-C ends the process.
pub(crate) fn staged(folder: &Path) {
    *locked(&STAGED) = Some(folder.to_path_buf());
}

/// From now on work notices Ctrl-C between two steps, so that no half result is left. Work that does not check in time, such as the writing of a long
/// file, ends with the process, and the [`staged`] folder is removed.
pub(crate) fn catch_interrupts() {
    // A file that grows beyond `ulimit -f` must be an error of the write, which leaves nothing, and not the end of the process.
    #[cfg(unix)]
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, std::sync::Arc::default());
    // This fails only where a handler is set already, or the system has no signals or no thread: then Ctrl-C kills the process as usual.
    let _ = ctrlc::set_handler(|| {
        INTERRUPTED.store(true, Ordering::Relaxed);
        std::thread::sleep(PATIENCE);
        end(&Failure::Interrupted, &|| {});
    });
}

/// Ends the process with this failure, and with what `last` still has to say, unless the command has ended meanwhile.
pub(crate) fn end(failure: &Failure, last: &dyn Fn()) {
    let _ending = ending();
    if RUNNING.load(Ordering::Relaxed) {
        // The folder is removed three times over, because the command may still create a file while others are removed.
        let staged = locked(&STAGED).take();
        if let Some(path) = &staged {
            (0..3).for_each(|_| drop(std::fs::remove_dir_all(path)));
        }
        output::message(&failure.to_string());
        last();
        std::process::exit(failure.code().into());
    }
}

/// Until the returned guard is dropped, Ctrl-C does not end the process.
pub(crate) fn ending() -> MutexGuard<'static, ()> {
    locked(&ENDING)
}

/// Marks that a command is running.
pub(crate) fn begun() {
    RUNNING.store(true, Ordering::Relaxed);
}

/// Marks that the command has ended and has reported how: from now on Ctrl-C leaves the process alone.
pub(crate) fn ended() {
    RUNNING.store(false, Ordering::Relaxed);
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns an error where Ctrl-C was pressed.
pub(crate) fn check_interrupt() -> Result<(), Failure> {
    if INTERRUPTED.load(Ordering::Relaxed) { Err(Failure::Interrupted) } else { Ok(()) }
}

/// A progress bar on a terminal; nothing elsewhere.
#[derive(Debug)]
pub(crate) struct Bar {
    bar: ProgressBar,
    quiet: bool,
}

/// A handle that shows progress from another thread.
#[derive(Debug, Clone)]
pub(crate) struct Teller {
    bar: ProgressBar,
    quiet: bool,
}

impl Teller {
    /// Shows the share done, 0 to 1; asks the work to stop after Ctrl-C.
    pub(crate) fn report(&self, share: f64) -> ControlFlow<()> {
        self.bar.set_position((share * PARTS) as u64);
        if INTERRUPTED.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Prints a message above the bar.
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

    /// A spinner, for work that cannot tell how far it is.
    pub(crate) fn busy(title: &'static str, quiet: bool) -> Self {
        let progress = Self::new(title, quiet);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg}, {elapsed}") {
            progress.bar.set_style(style);
        }
        progress
    }

    /// Does the work on another thread and waits for it. After Ctrl-C this returns an error at once, even where the work has not ended: that thread
    /// ends with the process.
    pub(crate) fn wait<R: Send + 'static>(
        &self,
        work: impl FnOnce() -> R + Send + 'static,
    ) -> Result<R, Failure> {
        let (sender, receiver) = std::sync::mpsc::channel();
        // Where the receiver has gone, nobody waits for the result, and it is dropped.
        let begun = begin("iwan", move || drop(sender.send(work())));
        // Where the system gives no thread, the work is done on this one, and Ctrl-C is noticed when the work has ended.
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

    /// A handle to the bar for work on another thread.
    pub(crate) fn teller(&self) -> Teller {
        Teller { bar: self.bar.clone(), quiet: self.quiet }
    }

    /// Shows the share done, 0 to 1; asks the work to stop after Ctrl-C.
    pub(crate) fn report(&self, share: f64) -> ControlFlow<()> {
        self.teller().report(share)
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
