//! What any method could reach on the records of the study: [`switchid::limits`] about the plants' own motions.

use super::Failure;
use super::plant::Plant;
use serde::{Deserialize, Serialize};
use switchid::law::{Drive, Motion, State, Term};
use switchid::limits::{Course, Law, Sensors, Start, bound, detection, level};
use switchid::simulate::{self, Reading, Scenario, record};

/// Std at which the limits of e are computed: they grow with its square.
const STD: f64 = 0.01;

/// Lengths of motion in which a change is sought, s: the longer only if the shorter does not show it.
const SIGHTS: [f64; 4] = [0.3, 1.2, 5.0, 20.0];

/// Longest record in which the limit of the tracking delay is sought, s.
const LONGEST: f64 = 12.0;

/// Limits of one switch, s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Delays {
    /// Of its detection; `None` where the stage ends before.
    pub detection: Option<f64>,
    /// Until the true terms' e can be below 0.05², the state at the switch known; `None` where the stage ends before.
    pub tracking: Option<f64>,
}

/// Limits of e after records of these lengths, s, of the plant's unswitched scenario with sensor noise of std 1: of its
/// own terms, or of all that its model has.
///
/// # Errors
/// A plant or a law that cannot move.
pub fn errors(plant: Plant, lengths: &[f64], whole_model: bool) -> Result<Vec<f64>, Failure> {
    let longest = lengths.iter().copied().fold(0.0, f64::max);
    let scenario = plant.single(longest, 0.0, 0);
    let truth: Vec<(Term, f64)> = pairs(&scenario, 0);
    let law = if whole_model { completed(plant, &truth)? } else { all_sought(&truth)? };
    let course = course(&scenario, &record(&scenario)?, 0, scenario.initial);
    let of = |length: &f64| {
        let part = shortened(&course, *length);
        let found = bound(&law, &[part], Sensors([Some(STD); 2]), Start::Unknown)?;
        Ok(found.relative_error.map_or(f64::INFINITY, |error| error / STD.powi(2)))
    };
    lengths.iter().map(of).collect()
}

/// Limits of every switch of a scenario with noise; its readings are given.
///
/// # Errors
/// A plant or a law that cannot move.
pub fn delays(scenario: &Scenario, readings: &[Reading], false_alarm_interval: f64) -> Result<Vec<Delays>, Failure> {
    let sensors = Sensors([Some(scenario.noise.q), Some(scenario.noise.qd)]);
    let level = level(false_alarm_interval, scenario.excitation.sample_time);
    let mut plant = simulate::Plant::new(scenario.clone())?;
    let mut found = Vec::new();
    for (index, start) in scenario.switch_times().into_iter().enumerate() {
        plant.advance_to(start)?;
        let course = course(scenario, readings, index + 1, plant.truth().state);
        let [old, new] = [index, index + 1].map(|stage| all_sought(&pairs(scenario, stage)));
        found.push(switch(&old?, &new?, &course, sensors, level)?);
    }
    Ok(found)
}

fn switch(old: &Law, new: &Law, course: &Course, sensors: Sensors, level: f64) -> Result<Delays, Failure> {
    let mut seen = None;
    for length in SIGHTS {
        let part = shortened(course, length);
        seen = detection(old, new, &[part], sensors, level)?.at_start;
        if seen.is_some() {
            break;
        }
    }
    let known = bound(new, &[shortened(course, LONGEST)], sensors, Start::Known)?;
    Ok(Delays { detection: seen, tracking: known.shortest_record })
}

fn pairs(scenario: &Scenario, stage: usize) -> Vec<(Term, f64)> {
    scenario.terms.iter().copied().zip(scenario.stages[stage].coefficients.iter().copied()).collect()
}

fn all_sought(pairs: &[(Term, f64)]) -> Result<Law, Failure> {
    Ok(Law::new(pairs, &(0..pairs.len()).collect::<Vec<_>>())?)
}

/// The law with every term of the plant's model, 0 where the plant does not have it.
fn completed(plant: Plant, truth: &[(Term, f64)]) -> Result<Law, Failure> {
    let value = |term: Term| truth.iter().find(|(own, _)| *own == term).map_or(0.0, |(_, value)| *value);
    let pairs: Vec<(Term, f64)> = plant.model().terms.iter().map(|entry| (entry.term, value(entry.term))).collect();
    all_sought(&pairs)
}

/// The motion of a stage from its start, which may lie between two readings, to the last reading before its end.
fn course(scenario: &Scenario, readings: &[Reading], stage: usize, state: State) -> Course {
    let start = scenario.stages[stage].start;
    let end = scenario.stages.get(stage + 1).map_or(f64::INFINITY, |next| next.start);
    let first = readings.partition_point(|reading| reading.t <= start);
    let last = readings.partition_point(|reading| reading.t < end);
    let t = std::iter::once(start).chain(readings[first..last].iter().map(|reading| reading.t)).collect();
    let drives = readings[first - 1..last - 1].iter().map(|reading| Drive::Held(reading.excitation)).collect();
    let motion = Motion::new(&scenario.terms, &scenario.stages[stage].coefficients);
    Course::own(&motion, state, t, drives)
}

/// Its beginning.
fn shortened(course: &Course, length: f64) -> Course {
    let count = course.t.partition_point(|t| *t <= course.t[0] + length + 1e-9);
    Course {
        t: course.t[..count].to_vec(),
        drives: course.drives[..count - 1].to_vec(),
        states: course.states[..count].to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_course_of_a_stage_is_the_motion_of_its_readings() {
        let scenario = Plant::Duffing.switched(0.0, 1);
        let readings = record(&scenario).unwrap();
        let mut plant = simulate::Plant::new(scenario.clone()).unwrap();
        plant.advance_to(scenario.stages[1].start).unwrap();
        let course = course(&scenario, &readings, 1, plant.truth().state);
        assert!(course.t[1] - course.t[0] < 1e-3 + 1e-9 && course.t[0] == scenario.stages[1].start);
        let reading = readings.iter().find(|reading| reading.t == course.t[5000]).unwrap();
        assert!((course.states[5000].q - reading.q).abs() < 1e-6, "{reading:?}");
    }

    /// FACTS of the plant: 1.0e-4 after 5 s, 2.8e-5 after 12 s at σ = 0.1.
    #[test]
    fn limits_fall_with_the_record_and_more_terms_cost() {
        let limits = errors(Plant::Duffing, &[5.0, 12.0], false).unwrap();
        assert!((limits[0] * 0.01 / 1.0e-4 - 1.0).abs() < 0.1 && (limits[1] * 0.01 / 2.8e-5 - 1.0).abs() < 0.1);
        let own = errors(Plant::VanDerPol, &[16.0], false).unwrap();
        assert!(errors(Plant::VanDerPol, &[16.0], true).unwrap()[0] > 2.0 * own[0]);
    }

    #[test]
    fn more_noise_shows_a_switch_later() {
        let limits = |noise: f64| {
            let scenario = Plant::Duffing.switched(noise, 1);
            let scenario =
                Scenario { duration: scenario.stages[2].start, stages: scenario.stages[..2].to_vec(), ..scenario };
            delays(&scenario, &record(&scenario).unwrap(), 1e6).unwrap()[0]
        };
        let (little, much) = (limits(0.01), limits(0.1));
        assert!(little.detection < much.detection && little.tracking < much.tracking, "{little:?} {much:?}");
        assert!(little.detection.unwrap() > 0.0 && little.tracking > little.detection);
    }
}
