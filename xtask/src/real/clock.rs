//! CPU time of a child: what a run takes on one core, however busy the others are.

use std::time::Instant;

/// Clock ticks per second in `/proc`: part of Linux's interface to programs.
const TICKS: f64 = 100.0;

/// Runs something that starts a child and waits for it; the child's CPU time, s, or where the system does not tell it
/// the time that passed.
pub fn timed<T>(run: impl FnOnce() -> T) -> (T, f64) {
    let (start, began) = (children(), Instant::now());
    let result = run();
    let passed = began.elapsed().as_secs_f64();
    let seconds = start.zip(children()).map_or(passed, |(start, end)| end - start);
    (result, seconds)
}

/// CPU time of all children that ended, s.
fn children() -> Option<f64> {
    ticks(&std::fs::read_to_string("/proc/self/stat").ok()?)
}

/// `cutime` + `cstime` of proc_pid_stat(5), s: fields 16 and 17, counted behind the program's name in parentheses.
fn ticks(stat: &str) -> Option<f64> {
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    let field = |number: usize| fields.get(number - 3)?.parse::<f64>().ok();
    Some((field(16)? + field(17)?) / TICKS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_of_children_stands_behind_the_name() {
        let stat = "12 (a ) name) S 1 12 12 0 -1 4194560 500 600 0 0 7 8 250 50 20 0 1 0 100 0 0";
        assert_eq!(ticks(stat), Some(3.0));
        assert_eq!(ticks("nothing"), None);
    }
}
