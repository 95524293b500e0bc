//! Work that takes long, beside an interpreter that stays alive.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

/// How often signals are looked at and progress is told.
const LOOK: Duration = Duration::from_millis(50);

/// Stack of the thread that works (bytes): as large as that of the first one of a program.
const STACK: usize = 8 << 20;

/// What some work makes on a thread of its own, without the lock of the interpreter. Meanwhile signals are looked at, and `tell` is
/// called with the lock; where either raises, the flag is set that stops the work, and what was raised is the second of the two.
///
/// # Errors
/// Where no thread can be had.
pub fn beside<T: Send>(
    py: Python<'_>,
    interrupt: &AtomicBool,
    mut tell: impl FnMut(Python<'_>) -> PyResult<()>,
    work: impl FnOnce() -> T + Send,
) -> PyResult<(T, Option<PyErr>)> {
    thread::scope(|scope| {
        let (done, told) = mpsc::channel();
        let work = move || {
            // Somebody is waiting to the end.
            let _ = done.send(work());
        };
        let worker = thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work)?;
        let mut told = told;
        let mut raised = None;
        loop {
            let told = &mut told;
            match py.detach(move || told.recv_timeout(LOOK)) {
                Ok(made) => return Ok((made, raised)),
                Err(RecvTimeoutError::Timeout) if raised.is_none() => {
                    raised = py.check_signals().and_then(|()| tell(py)).err();
                    if raised.is_some() {
                        interrupt.store(true, Ordering::Relaxed);
                    }
                }
                Err(RecvTimeoutError::Timeout) => {}
                // It has panicked.
                Err(RecvTimeoutError::Disconnected) => match py.detach(|| worker.join()) {
                    Err(panic) => resume_unwind(panic),
                    Ok(()) => unreachable!("work that is done has been told"),
                },
            }
        }
    })
}
