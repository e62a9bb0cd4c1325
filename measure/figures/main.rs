//! The table of figures: `cargo xtask figures [SEEDS] [SCENARIO]`.
//!
//! Every built-in scenario through the library, without noise and with sensor noise 0.01 (the publication's two noise
//! cases with theirs), over many seeds. The first is the documented scenario; the others draw stages, excitation and
//! noise anew. e is eq. (8) at the end of every stage, delays count from the switch, and in a record of one stage from
//! its start.
//!
//! With `--against-limits [FIRST..END] [ROW] [--threads N]` the figures of DESIGN §7 beside what any method could reach
//! ([`against_limits`]).

mod against_limits;
mod follow;
mod measure;
mod threads;

use follow::Figures;
use measure::measure;
use switchid::simulate::{Builtin, Scenario};

/// Why a figure could not be measured.
type Failure = Box<dyn std::error::Error + Send + Sync>;

const SEEDS: u64 = 50;
const THREADS: usize = 2;
const HEAD: &str =
    "| scenario | noise | e, median | e, worst | detection, s | worst | tracking, s | worst | missed | false |
|---|---|---|---|---|---|---|---|---|---|";

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1).peekable();
    if arguments.next_if(|argument| argument == "--against-limits").is_some() {
        return against_limits::run(arguments);
    }
    let seeds = arguments.next().map_or(Ok(SEEDS), |text| text.parse())?;
    let chosen = arguments.next().map(|name| Builtin::from_id(&name)).transpose()?;
    println!("{HEAD}");
    for builtin in Builtin::ALL.into_iter().filter(|builtin| chosen.is_none_or(|chosen| chosen == *builtin)) {
        for noise in noises(builtin) {
            let run = |seed: u64| measure(builtin, &scenario(builtin, seed).with_noise(noise));
            let runs = threads::run(0..seeds, THREADS, run)?;
            println!("{}", row(builtin, noise, &runs));
        }
    }
    Ok(())
}

/// The noise cases keep the noise that is theirs.
fn noises(builtin: Builtin) -> Vec<f64> {
    let own = builtin.scenario().noise.q;
    if own > 0.0 { vec![own] } else { vec![0.0, 0.01] }
}

fn scenario(builtin: Builtin, seed: u64) -> Scenario {
    if seed == 0 { builtin.scenario() } else { builtin.random(seed) }
}

fn row(builtin: Builtin, noise: f64, runs: &[Figures]) -> String {
    let stages = || runs.iter().flat_map(|run| &run.stages);
    let single = builtin.scenario().stages.len() == 1;
    let errors = stages().map(|stage| stage.error).collect();
    let detections = stages().filter_map(|stage| stage.detection).collect();
    let tracked = stages().filter(|stage| single || stage.detection.is_some()).map(|stage| stage.tracking).collect();
    format!(
        "| {} | {noise} | {} | {} | {} | {} | {} |",
        builtin.id(),
        spread(errors, |value| format!("{value:.1e}")),
        spread(detections, |value| format!("{value:.3}")),
        spread(tracked, |value| format!("{value:.2}")),
        runs.iter().map(Figures::missed).sum::<usize>(),
        runs.iter().map(|run| run.false_alarms).sum::<usize>(),
    )
}

/// Median and worst, as two cells.
fn spread(mut values: Vec<f64>, text: impl Fn(f64) -> String) -> String {
    values.sort_by(f64::total_cmp);
    match values.last() {
        Some(worst) => format!("{} | {}", text(values[values.len() / 2]), text(*worst)),
        None => "– | –".into(),
    }
}
