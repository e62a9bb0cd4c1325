//! The benchmark of hidden effects: `cargo xtask effects [--help]`.
//!
//! Every effect of the catalogue hidden in turn, pairs of them, complete models, and effects that the catalogue does
//! not have, at several strengths and noises; excitation, channels, scales and all numbers are drawn from the seed. A
//! problem that the record cannot show, even to one who knows the truth, is counted apart. With `--sensors slow`
//! or `fast` a usual rig measures in place of ideal sensors. With `--misses` every wrong answer is printed with what
//! repeats it.

mod arguments;
mod benchmark;
mod table;

use arguments::Arguments;
use benchmark::{Outcome, Secret, Setting, draw, judge};
use clap::{Parser, ValueEnum};
use rayon::prelude::*;
use table::Table;

type Failure = Box<dyn std::error::Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let arguments = Arguments::parse();
    let settings = arguments.settings();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads).build()?;
    let outcomes: Vec<Option<Outcome>> =
        pool.install(|| settings.par_iter().map(|setting| run(setting, &arguments)).collect());
    let pairs = settings.iter().zip(&outcomes);
    print!("{}", Table::new(pairs.filter_map(|(setting, outcome)| Some((setting, outcome.as_ref()?)))));
    let failed = outcomes.iter().filter(|outcome| outcome.is_none()).count();
    println!("\n{} problems; {failed} settings have no bounded motion", outcomes.len() - failed);
    Ok(())
}

fn run(setting: &Setting, arguments: &Arguments) -> Option<Outcome> {
    let problem = draw(setting)?;
    let outcome = judge(setting, &problem);
    if arguments.all || (arguments.misses && !outcome.is_right() && outcome.visible) {
        let Outcome { answer, seconds, words, .. } = &outcome;
        println!("{}\n    {}\n    {answer:?} in {seconds:.1} s: {words}\n", repeat(setting), problem.words);
    }
    Some(outcome)
}

/// What repeats one problem.
fn repeat(setting: &Setting) -> String {
    let Setting { secret, strength, noise, sensors, switch, samples, seed, draw } = setting;
    let effect = match secret {
        Secret::Missing(ids) => ids.join("+"),
        other => other.name(),
    };
    let sensors = sensors.to_possible_value().map_or(String::new(), |value| value.get_name().to_string());
    let switch = if *switch == 0.0 { String::new() } else { format!(" --switch {switch}") };
    format!(
        "--effect \"{effect}\" --strength {strength} --noise {noise} --sensors {sensors}{switch} --samples {samples} \
         --seed {seed} --only {draw}"
    )
}
