//! Ctrl-C and progress of work that runs without the GIL.

use pyo3::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::time::{Duration, Instant};

/// Interval at which Python is asked whether to go on, and told how far the work is.
const EVERY: Duration = Duration::from_millis(50);

/// Asks Python now and then whether to go on.
pub struct Pulse {
    progress: Option<Py<PyAny>>,
    last: Instant,
    error: Option<PyErr>,
}

/// Panic that unwinds out of work whose progress is only told, never answered.
struct Interrupted;

impl Pulse {
    /// `progress` is called with the part done, 0 to 1.
    pub fn new(progress: Option<Py<PyAny>>) -> Self {
        Self { progress, last: Instant::now(), error: None }
    }

    /// Tests whether to go on; tells the part done.
    pub fn beat(&mut self, done: f64) -> bool {
        if self.error.is_none() && self.last.elapsed() >= EVERY {
            self.last = Instant::now();
            self.error = Python::attach(|py| self.ask(py, done)).err();
        }
        self.error.is_none()
    }

    fn ask(&self, py: Python<'_>, done: f64) -> PyResult<()> {
        py.check_signals()?;
        self.progress.as_ref().map_or(Ok(()), |progress| progress.call1(py, (done,)).map(drop))
    }

    /// Error of Python when it did not want to go on.
    pub fn error(&mut self) -> Option<PyErr> {
        self.error.take()
    }

    /// Does work that tells its progress and cannot be told to stop: on Ctrl-C it is left by
    /// unwinding.
    ///
    /// # Errors
    /// What Python said when it did not want to go on.
    pub fn run<T>(mut self, work: impl FnOnce(&mut dyn FnMut(f64)) -> T) -> PyResult<T> {
        let mut tell = |done: f64| {
            if !self.beat(done) {
                // Not a panic: no hook runs and nothing is printed.
                resume_unwind(Box::new(Interrupted));
            }
        };
        let done = catch_unwind(AssertUnwindSafe(|| work(&mut tell)));
        match (done, self.error.take()) {
            (_, Some(error)) => Err(error),
            (Ok(done), None) => Ok(done),
            (Err(payload), None) => resume_unwind(payload),
        }
    }
}
