//! Without noise: how many samples a switch takes to be seen, from the first at which it moves q̈ by 1 % of its RMS.

use super::Asked;
use super::recorded::{Library, Recorded, law};
use super::spread::Spread;
use crate::Failure;
use crate::follow::follow;
use switchid::identify::{Identifier, Settings};
use switchid::law::Motion;
use switchid::limits::Law;
use switchid::simulate::{Builtin, Scenario};

const PLANTS: [Builtin; 4] =
    [Builtin::DuffingSine, Builtin::DuffingWhite, Builtin::VanDerPolSine, Builtin::VanDerPolWhite];

/// Share of the RMS of q̈ by which a switch must move it.
const MOVED: f64 = 0.01;

/// Prints the number of samples by plant and library.
pub fn run(asked: &Asked) -> Result<(), Failure> {
    println!("| record | terms | switches | samples, median | worst | missed | false |");
    println!("|---|---|---|---|---|---|---|");
    for builtin in PLANTS {
        for library in [Library::Given, Library::Maybe] {
            let label = format!("{} | {}", builtin.id(), library.id());
            if !asked.wants(&label) {
                continue;
            }
            let runs = asked.each(|seed| samples(builtin, library, &builtin.random(seed)))?;
            let spread = Spread::of(runs.iter().flat_map(|(samples, _)| samples.iter().copied()));
            let missed = runs.iter().flat_map(|(samples, _)| samples).filter(|samples| samples.is_infinite()).count();
            let false_alarms: usize = runs.iter().map(|(_, count)| count).sum();
            println!("| {label} | {} | {} | {missed} | {false_alarms} |", spread.count(), spread.cells());
        }
    }
    Ok(())
}

fn samples(builtin: Builtin, library: Library, scenario: &Scenario) -> Result<(Vec<f64>, usize), Failure> {
    let recorded = Recorded::of(scenario)?;
    let mut identifier = Identifier::new(&library.model(builtin), Settings::default())?;
    let figures = follow(&mut identifier, scenario, recorded.readings.iter().copied())?;
    let mut found = Vec::new();
    for (index, stage) in figures.stages.iter().enumerate().skip(1) {
        let detected = scenario.stages[index].start + stage.detection.unwrap_or(f64::INFINITY);
        let moved = moved(builtin, scenario, &recorded, index)?;
        found.extend(moved.map(|moved| ((detected - moved) / scenario.excitation.sample_time).round().max(0.0)));
    }
    Ok((found, figures.false_alarms))
}

/// The first time at which the old and the new law's q̈ differ by [`MOVED`] of its RMS in the stage before.
fn moved(builtin: Builtin, scenario: &Scenario, recorded: &Recorded, stage: usize) -> Result<Option<f64>, Failure> {
    let model = Library::Given.model(builtin);
    let (old, new) = (law(&model, scenario, stage - 1)?, law(&model, scenario, stage)?);
    let before = recorded.course(recorded.stage(scenario, stage - 1));
    let states = || before.states.iter().zip(&before.drives);
    let squares: f64 = states().map(|(state, drive)| motion(&old).acceleration(*state, drive.at(0.5)).powi(2)).sum();
    let rms = (squares / before.drives.len() as f64).sqrt();
    let after = recorded.course(recorded.stage(scenario, stage));
    let differs = |k: &usize| {
        let [old, new] = [&old, &new].map(|law| motion(law).acceleration(after.states[*k], after.drives[*k].at(0.5)));
        (new - old).abs() > MOVED * rms
    };
    Ok((0..after.drives.len()).find(differs).map(|k| after.t[k]))
}

fn motion(law: &Law) -> Motion<'_> {
    Motion::new(law.terms(), law.coefficients())
}
