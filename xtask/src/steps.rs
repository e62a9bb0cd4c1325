//! Progress: each step is announced with the time since the start, and its own time when it is done.

use crate::error::Error;
use std::time::Instant;

/// The steps of one chore.
pub struct Steps {
    start: Instant,
    total: usize,
    done: usize,
    failed: Vec<String>,
}

impl Steps {
    /// Starts the clock of a chore of `total` steps.
    pub fn new(total: usize) -> Steps {
        Steps { start: Instant::now(), total, done: 0, failed: Vec::new() }
    }

    /// Runs a step that the following ones need.
    ///
    /// # Errors
    /// What the step returns.
    pub fn run<T>(&mut self, name: &str, step: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
        self.done += 1;
        self.say(&format!("{}/{} {name} …", self.done, self.total));
        let began = Instant::now();
        let result = step();
        let mark = if result.is_ok() { "✓" } else { "✗" };
        self.say(&format!("{}/{} {name} {mark} ({:.1} s)", self.done, self.total, began.elapsed().as_secs_f64()));
        result
    }

    /// Runs a step that the following ones do not need: a failure is shown and kept for [`Steps::finish`].
    pub fn check(&mut self, name: &str, step: impl FnOnce() -> Result<(), Error>) {
        if let Err(error) = self.run(name, step) {
            eprintln!("{error}");
            self.failed.push(name.to_string());
        }
    }

    /// Ends the chore.
    ///
    /// # Errors
    /// [`Error::Steps`] when a checked step failed.
    pub fn finish(self) -> Result<(), Error> {
        if self.failed.is_empty() {
            self.say("done");
            return Ok(());
        }
        Err(Error::Steps { failed: self.failed, total: self.total })
    }

    fn say(&self, text: &str) {
        eprintln!("[{:6.1} s] {text}", self.start.elapsed().as_secs_f64());
    }
}
