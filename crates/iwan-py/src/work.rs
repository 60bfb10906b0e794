//! Long work without the interpreter's lock, and Ctrl-C.

use std::ops::ControlFlow;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::prelude::*;

/// How often signals are looked at: Ctrl-C is honoured well within 0.2 s.
const PATIENCE: Duration = Duration::from_millis(40);

/// Set when the caller has gone and the work is for nobody.
#[derive(Debug, Clone, Default)]
pub(crate) struct Abandoned(Arc<AtomicBool>);

impl Abandoned {
    /// Whether to stop.
    pub(crate) fn stop(&self) -> ControlFlow<()> {
        if self.0.load(Ordering::Relaxed) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

/// Runs `work` with the interpreter's lock released.
///
/// Work that may last goes to a thread of its own while this one watches for signals: an exception raised by a
/// signal handler, such as `KeyboardInterrupt`, is passed on at once, and the work is told to stop.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    lasting: bool,
    work: impl FnOnce(&Abandoned) -> T + Send + 'static,
) -> PyResult<T> {
    let abandoned = Abandoned::default();
    if !lasting {
        return Ok(py.detach(|| work(&abandoned)));
    }
    let (sender, receiver) = channel();
    let told = abandoned.clone();
    let worker = std::thread::Builder::new().name("iwan".into()).spawn(move || {
        // Without a receiver nobody waits for the result.
        let _ = sender.send(work(&told));
    })?;
    // A receiver is not shared between threads; it only has to be usable from this one.
    let receiver = std::sync::Mutex::new(receiver);
    loop {
        let waited = py.detach(|| {
            receiver.lock().unwrap_or_else(std::sync::PoisonError::into_inner).recv_timeout(PATIENCE)
        });
        match waited {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(signal) = py.check_signals() {
                    abandoned.0.store(true, Ordering::Relaxed);
                    return Err(signal);
                }
            }
            Err(RecvTimeoutError::Disconnected) => match worker.join() {
                Err(panic) => resume_unwind(panic),
                Ok(()) => unreachable!("the worker sends before it ends"),
            },
        }
    }
}
