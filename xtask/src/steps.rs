//! Progress: each step is announced with the time since the start, and its own time when it is done.

use crate::error::Error;
use std::panic::resume_unwind;
use std::thread::{JoinHandle, spawn};
use std::time::{Duration, Instant};

/// The steps of one chore.
pub struct Steps {
    start: Instant,
    total: usize,
    done: usize,
    failed: Vec<String>,
}

/// A step that goes on beside the following ones.
pub struct Beside {
    name: String,
    numbered: String,
    thread: JoinHandle<(Result<(), Error>, Duration)>,
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
        let name = self.announce(name);
        let began = Instant::now();
        let result = step();
        self.say_end(&name, result.is_ok(), began.elapsed());
        result
    }

    /// Runs a step that the following ones do not need: a failure is shown and kept for [`Steps::finish`].
    pub fn check(&mut self, name: &str, step: impl FnOnce() -> Result<(), Error>) {
        let result = self.run(name, step);
        self.keep(name, result);
    }

    /// Begins a step that may go on beside the following ones, which leave a processor idle at times.
    pub fn begin(&mut self, name: &str, step: impl FnOnce() -> Result<(), Error> + Send + 'static) -> Beside {
        let (name, numbered) = (name.to_string(), self.announce(name));
        let timed = || {
            let began = Instant::now();
            (step(), began.elapsed())
        };
        Beside { name, numbered, thread: spawn(timed) }
    }

    /// Waits for the end of such a step: a failure is shown and kept as that of [`Steps::check`].
    pub fn wait(&mut self, step: Beside) {
        let (result, took) = step.thread.join().unwrap_or_else(|panic| resume_unwind(panic));
        self.say_end(&step.numbered, result.is_ok(), took);
        self.keep(&step.name, result);
    }

    fn keep(&mut self, name: &str, result: Result<(), Error>) {
        if let Err(error) = result {
            eprintln!("{error}");
            self.failed.push(name.to_string());
        }
    }

    /// Says that a step begins; its name with its number.
    fn announce(&mut self, name: &str) -> String {
        self.done += 1;
        let name = format!("{}/{} {name}", self.done, self.total);
        self.say(&format!("{name} …"));
        name
    }

    fn say_end(&self, name: &str, succeeded: bool, took: Duration) {
        let mark = if succeeded { "✓" } else { "✗" };
        self.say(&format!("{name} {mark} ({:.1} s)", took.as_secs_f64()));
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
