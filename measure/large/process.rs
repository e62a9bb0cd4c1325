//! Memory and processor time of a process, as Linux tells them.

use super::Failure;
use rustix::time::{ClockId, clock_gettime};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// How often a process is asked for its largest resident set, which only ever grows.
const ASKED: Duration = Duration::from_millis(5);

/// Ticks of /proc in a second, the same on all of its machines.
const TICKS: f64 = 100.0;

/// What a process took.
pub struct Cost {
    /// Largest resident set, bytes.
    pub peak: f64,
    /// Processor time, s.
    pub time: f64,
    /// Time on the wall, s.
    pub wall: f64,
}

/// Processor time of this process so far, s.
pub fn own_time() -> f64 {
    let time = clock_gettime(ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// Runs a command to its end.
pub fn cost(command: &mut Command) -> Result<Cost, Failure> {
    let (before, begun) = (time_of_children()?, Instant::now());
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
    let mut peak = 0.0;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        peak = resident(child.id()).unwrap_or(peak);
        std::thread::sleep(ASKED);
    };
    let wall = begun.elapsed().as_secs_f64();
    if !status.success() {
        return Err(format!("{command:?} ended with {status}").into());
    }
    Ok(Cost { peak, time: time_of_children()? - before, wall })
}

/// Largest resident set of a process that still runs, bytes.
fn resident(process: u32) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(1024.0 * line.trim().strip_suffix(" kB")?.trim().parse::<f64>().ok()?)
}

/// Processor time of all children that have ended, s.
fn time_of_children() -> Result<f64, Failure> {
    let stat = std::fs::read_to_string("/proc/self/stat")?;
    let (_, behind) = stat.rsplit_once(')').ok_or("/proc/self/stat has no name")?;
    // user and system time are the 16th and 17th field, the first behind the name being the third
    let ticks: Vec<f64> = behind.split_whitespace().skip(13).take(2).filter_map(|field| field.parse().ok()).collect();
    Ok(ticks.iter().sum::<f64>() / TICKS)
}
