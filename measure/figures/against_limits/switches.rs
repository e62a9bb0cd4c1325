//! Detection and tracking delays beside their limits, missed switches and false alarms.

use super::Asked;
use super::recorded::{Library, Recorded, law, sensors};
use super::spread::Spread;
use crate::Failure;
use crate::follow::{Figures, follow};
use switchid::identify::{Identifier, Settings};
use switchid::limits::{Start, bound, detection, level};
use switchid::simulate::{Builtin, Scenario};

const PLANTS: [Builtin; 4] =
    [Builtin::DuffingSine, Builtin::DuffingWhite, Builtin::VanDerPolSine, Builtin::VanDerPolWhite];

const NOISES: [f64; 3] = [0.001, 0.01, 0.1];

/// What any method needs besides the evidence, s.
const ALLOWED: f64 = 3e-3;

/// A switch whose limit is above is none that must be seen, s.
const SEEN_WITHIN: f64 = 1.0;

/// Of one switch, or of the first stage.
struct Delay {
    detection: Option<Ratio>,
    tracking: Ratio,
}

/// A delay and its limit, s; infinite where there is none.
#[derive(Clone, Copy)]
struct Ratio {
    delay: f64,
    limit: f64,
}

/// Stages as the built-in scenarios draw them.
pub fn all_at_once(asked: &Asked) -> Result<(), Failure> {
    run(asked, |builtin, seed| builtin.random(seed))
}

/// Stage by stage one coefficient alone changes, by 10 to 50 % either way; what drives the plant goes on.
pub fn one_alone(asked: &Asked) -> Result<(), Failure> {
    run(asked, one_changed)
}

fn one_changed(builtin: Builtin, seed: u64) -> Scenario {
    let mut scenario = builtin.random(seed);
    for index in 1..scenario.stages.len() {
        let before = scenario.stages[index - 1].clone();
        let chosen = (seed as usize + index) % before.coefficients.len();
        let factor = [1.1, 1.2, 1.5, 1.0 / 1.1, 1.0 / 1.2, 1.0 / 1.5][(seed as usize * 5 + index) % 6];
        let stage = &mut scenario.stages[index];
        (stage.amplitude, stage.omega) = (before.amplitude, before.omega);
        stage.coefficients = before.coefficients;
        stage.coefficients[chosen] *= factor;
    }
    scenario
}

fn run(asked: &Asked, draw: fn(Builtin, u64) -> Scenario) -> Result<(), Failure> {
    println!(
        "| record | terms | σ | switches | (detection − 3 ms) ÷ limit, median | worst | tracking ÷ limit, median | worst | missed | false |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for builtin in PLANTS {
        for library in [Library::Given, Library::Maybe] {
            for noise in NOISES {
                let label = format!("{} | {} | {noise}", builtin.id(), library.id());
                if !asked.wants(&label) {
                    continue;
                }
                let runs = asked.each(|seed| delays(builtin, library, &draw(builtin, seed).with_noise(noise)))?;
                println!("| {label} | {} |", cells(&runs));
            }
        }
    }
    Ok(())
}

fn delays(builtin: Builtin, library: Library, scenario: &Scenario) -> Result<(Vec<Delay>, usize), Failure> {
    let recorded = Recorded::of(scenario)?;
    let mut identifier = Identifier::new(&library.model(builtin), Settings::default())?;
    let figures = follow(&mut identifier, scenario, recorded.readings.iter().copied())?;
    let stages = 0..scenario.stages.len();
    let delays = stages.map(|stage| delay(builtin, scenario, &recorded, &figures, stage));
    let false_alarms = figures.false_alarms;
    Ok((delays.collect::<Result<_, Failure>>()?, false_alarms))
}

/// Limits are those of the plant's own terms.
fn delay(
    builtin: Builtin,
    scenario: &Scenario,
    recorded: &Recorded,
    figures: &Figures,
    stage: usize,
) -> Result<Delay, Failure> {
    let model = Library::Given.model(builtin);
    let course = recorded.course(recorded.stage(scenario, stage));
    let (new, sensors) = (law(&model, scenario, stage)?, sensors(scenario));
    let found = &figures.stages[stage];
    let seen = match found.detection {
        None => None,
        Some(delay) => {
            let old = law(&model, scenario, stage - 1)?;
            let settings = Settings::default();
            let level = level(settings.false_alarm_interval, settings.sample_time);
            let limit = detection(&old, &new, std::slice::from_ref(&course), sensors, level)?.at_start;
            Some(Ratio { delay, limit: limit.unwrap_or(f64::INFINITY) })
        }
    };
    let shortest = bound(&new, &[course], sensors, Start::Unknown)?.shortest_record;
    let tracking = Ratio { delay: found.tracking, limit: shortest.unwrap_or(f64::INFINITY) };
    Ok(Delay { detection: seen, tracking })
}

fn cells(runs: &[(Vec<Delay>, usize)]) -> String {
    let switches = || runs.iter().flat_map(|(delays, _)| delays).filter_map(|delay| Some((delay.detection?, delay)));
    let must_be_seen = || switches().filter(|(detection, _)| detection.limit < SEEN_WITHIN);
    let seen = || must_be_seen().filter(|(detection, _)| detection.delay.is_finite());
    let detections = seen().map(|(detection, _)| (detection.delay - ALLOWED) / detection.limit);
    let trackable = seen().map(|(_, delay)| delay.tracking).filter(|tracking| tracking.limit.is_finite());
    let trackings = trackable.map(|tracking| tracking.delay / tracking.limit);
    let missed = must_be_seen().filter(|(detection, _)| detection.delay.is_infinite()).count();
    let false_alarms: usize = runs.iter().map(|(_, count)| count).sum();
    format!(
        "{} | {} | {} | {missed} | {false_alarms}",
        switches().count(),
        Spread::of(detections).cells(),
        Spread::of(trackings).cells()
    )
}
