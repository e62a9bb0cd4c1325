//! The same measurement over many seeds, on several threads.

use super::Failure;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// Measures every seed; the results in the order of the seeds.
pub fn run<T: Send>(
    seeds: Range<u64>,
    threads: usize,
    measure: impl Fn(u64) -> Result<T, Failure> + Sync,
) -> Result<Vec<T>, Failure> {
    let (next, done) = (AtomicU64::new(seeds.start), Mutex::new(Vec::new()));
    let work = || -> Result<(), Failure> {
        loop {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= seeds.end {
                return Ok(());
            }
            let figures = measure(seed)?;
            done.lock().map_err(|_| "a thread ended early")?.push((seed, figures));
        }
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        threads.into_iter().try_for_each(|thread| thread.join().map_err(|_| "a thread ended early")?)
    })?;
    let mut done = done.into_inner().map_err(|_| "a thread ended early")?;
    done.sort_by_key(|(seed, _)| *seed);
    Ok(done.into_iter().map(|(_, figures)| figures).collect())
}
