//! Long work without the interpreter's lock: it can be stopped by Ctrl-C, reports progress, and uses threads.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use iwan_machine::threads::{begin, together};
use pyo3::prelude::*;

use crate::exchange::errors::computation;

/// Time between two checks for signals and reports of progress: with it, Ctrl-C is handled well within 0.2 s.
const PATIENCE: Duration = Duration::from_millis(40);

/// State that the work and the thread that waits for it share.
#[derive(Debug, Clone, Default)]
pub(crate) struct Control(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    abandoned: Arc<AtomicBool>,
    done: AtomicUsize,
}

impl Control {
    /// Whether to stop: the caller no longer waits, and nobody needs the result.
    pub(crate) fn stop(&self) -> ControlFlow<()> {
        if self.0.abandoned.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    /// A flag that is set when the work is to stop.
    pub(crate) fn flag(&self) -> &Arc<AtomicBool> {
        &self.0.abandoned
    }

    /// Reports how many pieces are done, and returns whether to stop.
    pub(crate) fn report(&self, done: usize) -> ControlFlow<()> {
        self.0.done.fetch_max(done, Ordering::Relaxed);
        self.stop()
    }
}

/// Runs `work` with the interpreter's lock released.
///
/// Work that may last goes to a thread of its own while this one watches for signals: an exception raised by a
/// signal handler, such as `KeyboardInterrupt`, is passed on at once, and the work is told to stop.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    lasting: bool,
    work: impl FnOnce(&Control) -> T + Send + 'static,
) -> PyResult<T> {
    if lasting { watched(py, None, work) } else { py.detach(|| sheltered(|| work(&Control::default()))) }
}

/// Runs long work, and calls `progress` with the number of pieces done, at intervals and at the end.
pub(crate) fn watched<T: Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Control) -> T + Send + 'static,
) -> PyResult<T> {
    let (sender, receiver) = channel();
    let control = Control::default();
    let told = control.clone();
    // If sending fails, nobody waits for the result any more.
    let begun = begin("iwan", move || drop(sender.send(sheltered(|| work(&told)))));
    // Where no thread can be started, the work is done on this thread, and signals are handled only when it has ended.
    if let Err(work) = begun {
        py.detach(work);
    }
    let tell = || {
        progress
            .map_or(Ok(()), |progress| progress.call1((control.0.done.load(Ordering::Relaxed),)).map(drop))
    };
    let result = wait(py, &Mutex::new(receiver), || py.check_signals().and_then(|()| tell()));
    match result {
        Ok(Some(result)) => tell().and(result),
        Ok(None) => Err(fault("the work ended without a result")),
        Err(signal) => {
            control.0.abandoned.store(true, Ordering::Relaxed);
            Err(signal)
        }
    }
}

/// Runs work; a panic, which is a fault in this program, becomes an `iwan.ComputationError` that `except Exception` catches.
fn sheltered<T>(work: impl FnOnce() -> T) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(work)).map_err(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        fault(text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message"))
    })
}

fn fault(what: &str) -> PyErr {
    computation(format!("a fault in this program, please report it: {what}"))
}

/// Waits for a result, and calls `look_round` between checks; none when the sender was dropped without a result.
fn wait<T: Send>(
    py: Python<'_>,
    receiver: &Mutex<Receiver<T>>,
    look_round: impl Fn() -> PyResult<()>,
) -> PyResult<Option<T>> {
    loop {
        match py.detach(|| lock(receiver).recv_timeout(PATIENCE)) {
            Ok(result) => return Ok(Some(result)),
            Err(RecvTimeoutError::Timeout) => look_round()?,
            Err(RecvTimeoutError::Disconnected) => return Ok(None),
        }
    }
}

/// Applies `f` to each item on up to `threads` threads; the results are in the order of the items. None when told to stop.
pub(crate) fn each<T: Send, U: Send>(
    items: Vec<T>,
    threads: usize,
    control: &Control,
    f: impl Fn(T) -> U + Sync,
) -> Option<Vec<U>> {
    let results: Mutex<Vec<Option<U>>> = Mutex::new(items.iter().map(|_| None).collect());
    let most = threads.clamp(1, items.len().max(1));
    let (queue, done) = (Mutex::new(items.into_iter().enumerate()), AtomicUsize::new(0));
    let serve = || {
        while control.report(done.load(Ordering::Relaxed)).is_continue() {
            let Some((i, item)) = lock(&queue).next() else { return };
            let result = f(item);
            lock(&results)[i] = Some(result);
            done.fetch_add(1, Ordering::Relaxed);
        }
    };
    together(most, &serve);
    let _ = control.report(done.into_inner());
    results.into_inner().unwrap_or_else(PoisonError::into_inner).into_iter().collect()
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
