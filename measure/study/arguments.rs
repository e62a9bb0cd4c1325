//! The command line of the study.

use clap::Parser;
use std::path::PathBuf;

/// Measures and draws what docs/study.md shows.
#[derive(Clone, Debug, Parser)]
#[command(
    after_help = "cargo xtask study                     everything\ncargo xtask study --only rapid        one figure, its text on the terminal"
)]
pub struct Arguments {
    /// Records at each setting of the figures of e; the others take as many as go with it
    #[arg(long, default_value_t = 50)]
    pub seeds: u64,
    /// Records at a time; 0: as many as there are cores
    #[arg(long, default_value_t = 0)]
    pub threads: usize,
    /// One figure only: accuracy, loops, delays, alarms, rapid, cost. Its text goes to the terminal, the page stays as
    /// it is
    #[arg(long)]
    pub only: Option<String>,
    /// Folder of the pictures; the page stands beside it, under its name
    #[arg(long, default_value = "docs/study")]
    pub out: PathBuf,
    /// Folder of the measured points: what is there already is not measured again
    #[arg(long, default_value = "target/study")]
    pub points: PathBuf,
}
