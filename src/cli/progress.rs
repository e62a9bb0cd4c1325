//! A bar on the terminal for runs of over a second.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::time::{Duration, Instant};

/// Counts steps; shows itself on a terminal after a second, and nowhere else.
pub(super) struct Progress {
    bar: ProgressBar,
    started: Instant,
    shown: bool,
}

/// Steps between two looks at the clock: of steps of 10 µs, 100 a second.
const STRIDE: usize = 1024;

impl Progress {
    /// A bar of `total` steps.
    pub(super) fn new(total: usize) -> Progress {
        let bar = ProgressBar::with_draw_target(Some(total as u64), ProgressDrawTarget::hidden());
        let style = ProgressStyle::with_template("{bar:40} {percent} %  {eta} left")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        Progress { bar: bar.with_style(style), started: Instant::now(), shown: false }
    }

    /// `step` steps are done.
    pub(super) fn reached(&mut self, step: usize) {
        if !step.is_multiple_of(STRIDE) {
            return;
        }
        if !self.shown && self.started.elapsed() > Duration::from_secs(1) {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            self.shown = true;
        }
        self.bar.set_position(step as u64);
    }

    /// Takes the bar away.
    pub(super) fn finish(self) {
        self.bar.finish_and_clear();
    }
}

/// A sign of life on the terminal while something runs whose end is not known.
pub(super) struct Waiting;

impl Waiting {
    /// Runs `work`; after a second a terminal shows for how long it has been `doing` it.
    pub(super) fn on<T>(doing: &'static str, work: impl FnOnce() -> T) -> T {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
        let style = ProgressStyle::with_template("{spinner} {msg} {elapsed}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        bar.set_message(doing);
        bar.enable_steady_tick(Duration::from_secs(1));
        let result = work();
        bar.finish_and_clear();
        result
    }
}
