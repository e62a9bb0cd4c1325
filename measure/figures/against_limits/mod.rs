//! Figures beside what any method could reach:
//! `cargo xtask figures --against-limits [FIRST..END] [ROW] [--only TEXT] [--threads N]`.
//!
//! Every row draws its scenarios and its noise from the seeds FIRST to END − 1, so that a row can be measured piece by
//! piece; with `--only TEXT` those of its cases alone whose label holds the text.
//!
//! | row | what it prints |
//! |---|---|
//! | `errors` | mean e ÷ limit of e, and the mean square of every coefficient's error ÷ its stated std |
//! | `noise` | relative error of the sensors' noise after 4 s |
//! | `switches` | (detection delay − 3 ms) ÷ its limit, tracking delay ÷ its limit, missed, false |
//! | `single` | the same where one coefficient alone changes, by 10 to 50 % |
//! | `alarms` | alarms in ten minutes without a switch, default interval |
//! | `rate` | the same with an interval of 60 s |
//! | `clean` | without noise: samples from a switch's moving q̈ by 1 % of its RMS to its alarm |

mod alarms;
mod clean;
mod disturbed;
mod errors;
mod noise;
mod recorded;
mod spread;
mod switches;

use super::Failure;
use std::ops::Range;

/// Which seeds, on how many threads.
pub struct Asked {
    /// Seeds.
    pub seeds: Range<u64>,
    /// Threads.
    pub threads: usize,
    /// What a case's label must hold.
    pub only: String,
}

impl Asked {
    /// Whether the case of this label is asked for.
    pub fn wants(&self, label: &str) -> bool {
        label.contains(&self.only)
    }

    /// Measures every seed.
    pub fn each<T: Send>(&self, measure: impl Fn(u64) -> Result<T, Failure> + Sync) -> Result<Vec<T>, Failure> {
        super::threads::run(self.seeds.clone(), self.threads, measure)
    }
}

type Row = fn(&Asked) -> Result<(), Failure>;

const ROWS: [(&str, Row); 7] = [
    ("errors", errors::run),
    ("noise", noise::run),
    ("switches", switches::all_at_once),
    ("single", switches::one_alone),
    ("alarms", alarms::default_interval),
    ("rate", alarms::one_a_minute),
    ("clean", clean::run),
];

/// Prints the rows asked for, all where none is named.
pub fn run(arguments: impl Iterator<Item = String>) -> Result<(), Failure> {
    let mut asked = Asked { seeds: 1000..1020, threads: 1, only: String::new() };
    let mut chosen: Vec<(&str, Row)> = Vec::new();
    let mut arguments = arguments;
    while let Some(argument) = arguments.next() {
        if argument == "--threads" {
            asked.threads = arguments.next().ok_or("--threads needs a number")?.parse()?;
        } else if argument == "--only" {
            asked.only = arguments.next().ok_or("--only needs a text")?;
        } else if let Some((first, end)) = argument.split_once("..") {
            asked.seeds = first.parse()?..end.parse()?;
        } else {
            let names = ROWS.map(|(name, _)| name).join(", ");
            let unknown = || format!("there is no row \"{argument}\": the rows are {names}");
            chosen.push(*ROWS.iter().find(|(name, _)| *name == argument).ok_or_else(unknown)?);
        }
    }
    let rows = if chosen.is_empty() { ROWS.to_vec() } else { chosen };
    for (name, row) in rows {
        println!("\n{name}, seeds {}..{}\n", asked.seeds.start, asked.seeds.end);
        row(&asked)?;
    }
    Ok(())
}
