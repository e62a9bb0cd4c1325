//! Random FMI calls on our FMUs' binaries: `cargo xtask fuzz [--sequences N] [--seed S]`.
//!
//! A sequence makes an instance and calls it as a master does, as a careless one does, and as none would: wrong phases,
//! readings of every kind, states that are freed, foreign, changed or cut short. Chunks of sequences run in processes
//! of their own; one that dies, or a status that FMI does not have, is told with the seed that repeats it.

mod sequence;
mod subject;

use clap::Parser;
use indicatif::ProgressBar;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use subject::Subject;

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Sequences in a process: what goes wrong in one may show in a later one.
const CHUNK: u64 = 1000;

/// Random FMI calls on our FMUs' binaries
#[derive(Clone, Debug, Parser)]
struct Arguments {
    /// Sequences of calls
    #[arg(long, default_value_t = 10_000)]
    sequences: u64,
    /// Seed of all sequences
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Processes at a time
    #[arg(long, default_value_t = 2)]
    threads: usize,
    /// Folder of the built libraries
    #[arg(long, default_value = "target/release")]
    libraries: PathBuf,
    /// Run these sequences in this process: the first one's number
    #[arg(long, hide = true)]
    from: Option<u64>,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::parse();
    match arguments.from {
        Some(from) => run(&arguments, from),
        None => watch(&arguments),
    }
}

/// Runs sequences in this process, the number of each told before it begins.
fn run(arguments: &Arguments, from: u64) -> Result<(), Failure> {
    let subjects = Subject::all(&arguments.libraries)?;
    let mut calls = 0;
    for number in from..from + arguments.sequences {
        let mut generator = ChaCha8Rng::seed_from_u64(arguments.seed);
        generator.set_stream(number);
        let subject = &subjects[number as usize % subjects.len()];
        calls += sequence::run(subject, &mut generator).map_err(|what| format!("sequence {number}: {what}"))?;
    }
    println!("{calls}");
    Ok(())
}

/// Runs all sequences in processes, and narrows down what fails.
fn watch(arguments: &Arguments) -> Result<(), Failure> {
    let starts: Vec<u64> = (0..arguments.sequences).step_by(CHUNK as usize).collect();
    let bar = ProgressBar::new(starts.len() as u64);
    let chunk = |from: &u64| {
        let calls = child(arguments, *from, CHUNK.min(arguments.sequences - from));
        bar.inc(1);
        calls.map_err(|_| failing(arguments, *from))
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads).build()?;
    let outcomes: Vec<Result<u64, String>> = pool.install(|| starts.par_iter().map(chunk).collect());
    bar.finish_and_clear();
    let calls: u64 = outcomes.iter().flatten().sum();
    let failed: Vec<String> = outcomes.into_iter().filter_map(Result::err).collect();
    println!("{} sequences, {calls} calls, {} chunks failed", arguments.sequences, failed.len());
    failed.iter().for_each(|what| println!("{what}"));
    if failed.is_empty() { Ok(()) } else { Err("the FMUs do not bear all calls".into()) }
}

/// The calls of a process that ran so many sequences.
fn child(arguments: &Arguments, from: u64, count: u64) -> Result<u64, String> {
    let mut command = Command::new(std::env::current_exe().map_err(|error| error.to_string())?);
    command.arg("--libraries").arg(&arguments.libraries).stderr(Stdio::piped());
    let numbers = [("--from", from), ("--sequences", count), ("--seed", arguments.seed)];
    for (name, value) in numbers {
        command.args([name, &value.to_string()]);
    }
    let output = command.output().map_err(|error| error.to_string())?;
    let said = String::from_utf8_lossy(&output.stderr);
    let last = said.lines().last().unwrap_or_default();
    match output.status.success() {
        true => String::from_utf8_lossy(&output.stdout).trim().parse().map_err(|_| "no count of calls".into()),
        false => Err(format!("{}: {last}", output.status)),
    }
}

/// The first sequence of a chunk that fails alone, or the chunk.
fn failing(arguments: &Arguments, from: u64) -> String {
    let alone = |number: u64| child(arguments, number, 1).err().map(|what| (number, what));
    let seed = arguments.seed;
    match (from..from + CHUNK).find_map(alone) {
        Some((number, what)) => format!("--seed {seed} --from {number} --sequences 1: {what}"),
        None => format!("--seed {seed} --from {from} --sequences {CHUNK}: only together"),
    }
}
