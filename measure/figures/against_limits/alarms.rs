//! Alarms without a switch.

use super::Asked;
use super::recorded::Library;
use crate::Failure;
use crate::follow::follow;
use switchid::identify::{Identifier, Settings};
use switchid::simulate::{Builtin, record};

const PLANTS: [Builtin; 4] =
    [Builtin::DuffingSine, Builtin::DuffingWhite, Builtin::VanDerPolSine, Builtin::VanDerPolWhite];

/// Length of the record of one seed, s.
const SECONDS: f64 = 600.0;

const NOISE: f64 = 0.01;

/// With the interval that nobody set.
pub fn default_interval(asked: &Asked) -> Result<(), Failure> {
    run(asked, Settings::default())
}

/// With an interval of 60 s.
pub fn one_a_minute(asked: &Asked) -> Result<(), Failure> {
    run(asked, Settings { false_alarm_interval: 60.0, ..Settings::default() })
}

fn run(asked: &Asked, settings: Settings) -> Result<(), Failure> {
    println!("| record | terms | σ | minutes | alarms | by seed |");
    println!("|---|---|---|---|---|---|");
    for builtin in PLANTS {
        for library in [Library::Given, Library::Maybe] {
            let label = format!("{} | {} | {NOISE}", builtin.id(), library.id());
            if !asked.wants(&label) {
                continue;
            }
            let counts = asked.each(|seed| count(builtin, library, settings, seed))?;
            let minutes = counts.len() as f64 * SECONDS / 60.0;
            let total: usize = counts.iter().sum();
            println!("| {label} | {minutes} | {total} | {counts:?} |");
        }
    }
    Ok(())
}

fn count(builtin: Builtin, library: Library, settings: Settings, seed: u64) -> Result<usize, Failure> {
    let mut scenario = builtin.random(seed).with_noise(NOISE);
    scenario.stages.truncate(1);
    scenario.duration = SECONDS;
    let mut identifier = Identifier::new(&library.model(builtin), settings)?;
    Ok(follow(&mut identifier, &scenario, record(&scenario)?)?.false_alarms)
}
