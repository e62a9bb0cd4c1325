//! Figures 4 and 8 of the publication: e against noise and length of record, of both methods, beside the limit.
//!
//! One run of ours over the longest record gives e at every length; the published method identifies from a first window
//! of each length.

mod claims;
mod section;
mod view;

use super::Failure;
use super::figure::{Figure, Section};
use super::follow::{error, sample};
use super::plant::Plant;
use serde::{Deserialize, Serialize};
use switchid::identify::{Identifier, Method, Settings};
use switchid::simulate::{Reading, Scenario, record};

/// Std of the sensor noise. Without noise one seed is enough.
pub const NOISES: [f64; 8] = [0.0, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2];

/// Lengths of record, in natural periods, besides the publication's intervals.
const PERIODS: [f64; 8] = [0.25, 0.375, 0.5, 0.7, 1.0, 1.4, 2.0, 4.0];

/// Record behind the longest length: the published method spreads its work over the samples after its window, s.
const AFTER: f64 = 2.0;

/// Seeds of one noise lie this far from those of the next, so that no two rows share their draws.
const APART: u64 = 1000;

/// e against noise and length of record.
pub struct Accuracy;

/// A noisy record of a plant.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    plant: Plant,
    noise: f64,
    seed: u64,
}

/// e of eq. (8) at each of [`lengths`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    ours: Vec<f64>,
    published: Vec<f64>,
}

/// Every length of record at which e is read, s, in growing order.
pub fn lengths(plant: Plant) -> Vec<f64> {
    let mut all: Vec<f64> = PERIODS.iter().map(|periods| periods * plant.period()).chain(plant.intervals()).collect();
    all.sort_by(f64::total_cmp);
    all
}

impl Figure for Accuracy {
    const NAME: &'static str = "accuracy";
    type Point = Point;
    type Outcome = Errors;

    fn points(seeds: u64) -> Vec<Point> {
        let numbered = |plant: Plant| (0..).zip(NOISES).map(move |(number, noise)| (plant, noise, APART * number));
        let seeded = |(plant, noise, first): (Plant, f64, u64)| {
            let count = if noise == 0.0 { 1 } else { seeds };
            (first..first + count).map(move |seed| Point { plant, noise, seed })
        };
        Plant::ALL.into_iter().flat_map(numbered).flat_map(seeded).collect()
    }

    fn measure(point: &Point) -> Result<Errors, Failure> {
        let lengths = lengths(point.plant);
        let longest = lengths.last().copied().unwrap_or_default();
        let scenario = point.plant.single(longest + AFTER, point.noise, point.seed);
        let readings = record(&scenario)?;
        let published = |length: &f64| published(point.plant, &scenario, &readings, *length);
        Ok(Errors {
            ours: ours(point.plant, &scenario, &readings, &lengths)?,
            published: lengths.iter().map(published).collect::<Result<_, _>>()?,
        })
    }

    fn section(measured: &[(Point, Errors)]) -> Result<Section, Failure> {
        section::section(measured)
    }
}

fn ours(plant: Plant, scenario: &Scenario, readings: &[Reading], lengths: &[f64]) -> Result<Vec<f64>, Failure> {
    let mut identifier = Identifier::new(&plant.model(), Settings::default())?;
    let mut rest = readings;
    let mut errors = Vec::new();
    for length in lengths {
        let (own, later) = rest.split_at(rest.partition_point(|reading| reading.t <= length + 1e-9));
        own.iter().try_for_each(|reading| identifier.step(sample(reading)))?;
        errors.push(error(identifier.coefficients(), &scenario.terms, &scenario.stages[0].coefficients));
        rest = later;
    }
    Ok(errors)
}

/// The published method with its first window as long as that, until it has a law.
fn published(plant: Plant, scenario: &Scenario, readings: &[Reading], length: f64) -> Result<f64, Failure> {
    let settings =
        Settings { method: Method::Publication, initial_window: length, max_window: length, ..Settings::default() };
    let mut identifier = Identifier::new(&plant.model(), settings)?;
    for reading in readings {
        identifier.step(sample(reading))?;
        if identifier.output().identified_time.is_some() {
            break;
        }
    }
    Ok(error(identifier.coefficients(), &scenario.terms, &scenario.stages[0].coefficients))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_methods_are_read_at_every_length() {
        let point = Point { plant: Plant::Duffing, noise: 0.0, seed: 0 };
        let found = Accuracy::measure(&point).unwrap();
        let lengths = lengths(Plant::Duffing);
        assert_eq!((found.ours.len(), found.published.len()), (lengths.len(), lengths.len()));
        let last = lengths.len() - 1;
        assert!(found.ours[last] < 1e-6 && found.published[last] < 1e-6, "{found:?}");
        assert!(found.ours[0] > found.ours[last]);
        assert!(lengths.windows(2).all(|pair| pair[0] < pair[1]) && lengths[last] == 30.0);
    }
}
