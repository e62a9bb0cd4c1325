//! Switches that come fast: what is detected, what is identified, and whether what is said is true.

mod section;

use super::Failure;
use super::figure::{Figure, Section};
use super::follow::{Run, follow};
use super::limit;
use super::plant::Plant;
use serde::{Deserialize, Serialize};
use switchid::identify::{Identifier, Method, Settings};
use switchid::simulate::record;

/// Time from switch to switch, natural periods.
const SPACINGS: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];

/// Std of the sensor noise.
const NOISES: [f64; 2] = [0.01, 0.1];

/// Switches of a record.
const SWITCHES: usize = 12;

/// Rapid switching.
pub struct Rapid;

/// A noisy record with switches at equal distances, each to a law that was not there before.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    plant: Plant,
    noise: f64,
    /// Natural periods.
    spacing: f64,
    seed: u64,
}

/// Both methods on a record, and what was possible.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    ours: Run,
    published: Run,
    limits: Vec<limit::Delays>,
}

impl Figure for Rapid {
    const NAME: &'static str = "rapid";
    type Point = Point;
    type Outcome = Outcome;

    fn points(seeds: u64) -> Vec<Point> {
        let records = seeds.div_ceil(6);
        let of = |plant: Plant, noise: f64, spacing: f64| {
            (0..records).map(move |seed| Point { plant, noise, spacing, seed })
        };
        settings().flat_map(|(plant, noise, spacing)| of(plant, noise, spacing)).collect()
    }

    fn measure(point: &Point) -> Result<Outcome, Failure> {
        let Point { plant, noise, spacing, seed } = *point;
        let scenario = plant.rapid(spacing * plant.period(), SWITCHES, noise, seed);
        let readings = record(&scenario)?;
        let run = |method: Method| {
            let settings = Settings { method, ..Settings::default() };
            follow(&mut Identifier::new(&plant.model(), settings)?, &scenario, &readings)
        };
        Ok(Outcome {
            ours: run(Method::Default)?,
            published: run(Method::Publication)?,
            limits: limit::delays(&scenario, &readings, Settings::default().false_alarm_interval)?,
        })
    }

    fn section(measured: &[(Point, Outcome)]) -> Result<Section, Failure> {
        Ok(section::section(measured))
    }
}

/// Plants, noises and spacings, every one with every other.
fn settings() -> impl Iterator<Item = (Plant, f64, f64)> {
    let noises = Plant::ALL.into_iter().flat_map(|plant| NOISES.into_iter().map(move |noise| (plant, noise)));
    noises.flat_map(|(plant, noise)| SPACINGS.into_iter().map(move |spacing| (plant, noise, spacing)))
}
