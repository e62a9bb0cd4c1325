//! Messages to the host, through its variadic callback only.

use crate::ctypes::{CallbackFunctions, ERROR, OK, Status, WARNING};
use std::ffi::CString;

/// A kind of message; the packager declares them as LogCategories.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// What happened in the simulation; only where logging is on.
    Event,
    /// Something the user should know; the simulation goes on.
    Warning,
    /// Why a call failed.
    Error,
}

impl Category {
    /// Every category, with its FMI name and what it holds.
    pub const ALL: [(Category, &'static str, &'static str); 3] = [
        (Category::Event, "logEvents", "What happened: law found, switch detected"),
        (Category::Warning, "logStatusWarning", "What the user should know: skipped samples"),
        (Category::Error, "logStatusError", "Why a call failed, and what would mend it"),
    ];

    /// Its FMI name.
    pub fn name(self) -> &'static str {
        Category::ALL[self as usize].1
    }

    fn status(self) -> Status {
        match self {
            Category::Event => OK,
            Category::Warning => WARNING,
            Category::Error => ERROR,
        }
    }
}

/// Beginnings of the same that are all said.
const ONSETS: u64 = 10;

/// The way to the host's log, with what it wants to hear. A recurring warning is said the 1st, 10th, 100th … time, one
/// that tells of something that began the first ten times too.
pub struct Log {
    callbacks: CallbackFunctions,
    instance: CString,
    enabled: [bool; 3],
    recurring: Vec<(&'static str, u64)>,
}

impl Log {
    /// A log under that instance name; warnings and errors are always on until the host mutes them.
    pub fn new(callbacks: CallbackFunctions, instance: CString, logging_on: bool) -> Log {
        Log { callbacks, instance, enabled: [logging_on, true, true], recurring: Vec::new() }
    }

    /// `fmi2SetDebugLogging`: on with names turns on these alone, off with names turns these off; without a name, or
    /// with `logAll`, all are meant, but warnings and errors stay on.
    pub fn enable(&mut self, on: bool, categories: &[String]) {
        if categories.is_empty() || categories.iter().any(|name| name == "logAll") {
            self.enabled = [on, true, true];
            return;
        }
        for (category, name, _) in Category::ALL {
            let named = categories.iter().any(|asked| asked == name);
            let enabled = &mut self.enabled[category as usize];
            *enabled = if on { named } else { *enabled && !named };
        }
    }

    /// Says something.
    pub fn say(&self, category: Category, message: &str) {
        if self.enabled[category as usize] {
            self.send(category, message);
        }
    }

    /// Warns of something that may happen in every step; `key` tells it from other such warnings.
    pub fn warn_rarely(&mut self, key: &'static str, message: impl FnOnce() -> String) {
        let count = self.count(key);
        if is_power_of_ten(count) {
            let times = if count == 1 { String::new() } else { format!(" ({count} times so far)") };
            self.say(Category::Warning, &format!("{}{times}", message()));
        }
    }

    /// Warns of something that began, and may begin again and again; `key` tells it from other such warnings.
    pub fn warn_of_onset(&mut self, key: &'static str, message: impl FnOnce() -> String) {
        let count = self.count(key);
        if count <= ONSETS || is_power_of_ten(count) {
            let times = if count <= ONSETS { String::new() } else { format!(" (for the {count}th time)") };
            self.say(Category::Warning, &format!("{}{times}", message()));
        }
    }

    fn count(&mut self, key: &'static str) -> u64 {
        match self.recurring.iter_mut().find(|(known, _)| *known == key) {
            Some((_, count)) => {
                *count += 1;
                *count
            }
            None => {
                self.recurring.push((key, 1));
                1
            }
        }
    }

    /// Forgets which warnings were said.
    pub fn forget(&mut self) {
        self.recurring.clear();
    }

    fn send(&self, category: Category, message: &str) {
        let Some(logger) = self.callbacks.logger else { return };
        let name = c_text(category.name());
        let format = c_text(&message.replace('%', "%%"));
        // SAFETY: the host promises a printf-like logger; every text ends with a zero byte and outlives the call, and
        // the format asks for no arguments.
        unsafe {
            logger(
                self.callbacks.component_environment,
                self.instance.as_ptr(),
                category.status(),
                name.as_ptr(),
                format.as_ptr(),
            );
        }
    }
}

/// A time as a reader wants it, s: to the nanosecond, without what rounding left behind.
pub fn seconds(t: f64) -> f64 {
    format!("{t:.9}").parse().unwrap_or(t)
}

fn is_power_of_ten(count: u64) -> bool {
    let mut power = 1;
    while power < count {
        power *= 10;
    }
    power == count
}

/// The text as C reads it; an inner zero byte would end it early and becomes a space.
pub fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::seconds;

    #[test]
    fn times_are_rounded_to_the_nanosecond() {
        for (t, shown) in [(0.1 + 0.2, "0.3"), (1e-3 * 1234567.0, "1234.567"), (-2.0, "-2"), (1e12, "1000000000000")] {
            assert_eq!(seconds(t).to_string(), shown);
        }
        assert!(seconds(f64::NAN).is_nan());
    }
}
