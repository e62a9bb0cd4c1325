//! Detection and tracking delays against noise, of both methods, beside what was possible.

pub mod group;

use super::Failure;
use super::figure::{Figure, Picture, Section, split_table};
use super::follow::{Run, follow};
use super::limit::{self, Delays as Limits};
use super::lines::{limit, line};
use super::plant::Plant;
use super::statistics::median_delay;
use group::{BREAK, Group, HEAD, OURS, PUBLISHED};
use serde::{Deserialize, Serialize};
use switchid::identify::{Identifier, Method, Settings};
use switchid::report::{Axis, Layer, Panel};
use switchid::simulate::record;

/// Std of the sensor noise.
const NOISES: [f64; 6] = [0.001, 0.003, 0.01, 0.03, 0.1, 0.2];

/// Delays against noise.
pub struct Delays;

/// A noisy record with random switches.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    pub plant: Plant,
    pub noise: f64,
    pub false_alarm_interval: f64,
    pub seed: u64,
}

/// Both methods on a record, and what was possible.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    ours: Run,
    published: Run,
    limits: Vec<Limits>,
    /// Length of the record, s.
    duration: f64,
}

/// Records of five to seven laws that give one switch a seed and more.
pub fn records(seeds: u64) -> std::ops::Range<u64> {
    0..seeds.div_ceil(4)
}

/// Runs both methods over a point's record and asks for its limits.
///
/// # Errors
/// A plant that does not move.
pub fn measure(point: &Point) -> Result<Outcome, Failure> {
    let scenario = point.plant.switched(point.noise, point.seed);
    let readings = record(&scenario)?;
    let run = |method: Method| {
        let settings = Settings { method, false_alarm_interval: point.false_alarm_interval, ..Settings::default() };
        follow(&mut Identifier::new(&point.plant.model(), settings)?, &scenario, &readings)
    };
    Ok(Outcome {
        ours: run(Method::Default)?,
        published: run(Method::Publication)?,
        limits: limit::delays(&scenario, &readings, point.false_alarm_interval)?,
        duration: scenario.duration,
    })
}

impl Figure for Delays {
    const NAME: &'static str = "delays";
    type Point = Point;
    type Outcome = Outcome;

    fn points(seeds: u64) -> Vec<Point> {
        let false_alarm_interval = Settings::default().false_alarm_interval;
        let of = |plant: Plant, noise: f64| {
            records(seeds).map(move |seed| Point { plant, noise, false_alarm_interval, seed })
        };
        Plant::ALL.into_iter().flat_map(|plant| NOISES.into_iter().flat_map(move |noise| of(plant, noise))).collect()
    }

    fn measure(point: &Point) -> Result<Outcome, Failure> {
        measure(point)
    }

    fn section(measured: &[(Point, Outcome)]) -> Result<Section, Failure> {
        let rows = Plant::ALL.into_iter().flat_map(|plant| NOISES.into_iter().map(move |noise| (plant, noise)));
        let row = |(plant, noise): (Plant, f64)| {
            let group = Group::of(measured, |point| point.plant == plant && point.noise == noise);
            [plant.name().into(), format!("{noise}")].into_iter().chain(group.cells()).collect()
        };
        let head: Vec<&str> = ["plant", "σ"].into_iter().chain(HEAD).collect();
        let rows: Vec<Vec<String>> = rows.map(row).collect();
        let text = format!(
            "Laws drawn at random, each coefficient changing by a tenth or more, for 12 to 25 s each, under a sine. Detection: from the switch to the \
             first alarm of the stage. Tracking: from the switch until e stays below 0.05²; none where it never does. The limit of a detection knows \
             both laws, that of tracking the true terms, the law before and the state at the switch. (delay − 3 ms) ÷ limit is taken switch by switch. \
             A dash: never, in half of the cases or in the worst. What the published method detects in noise is the loop of its alarms: see its \
             false ones.\n\n{}",
            split_table(2, 2 + BREAK, &head, &rows)
        );
        let pictures = Plant::ALL.map(|plant| picture(plant, measured)).to_vec();
        Ok(Section { title: "Delays against noise", text, pictures, claims: Vec::new() })
    }
}

/// Medians against noise: detections left, trackings right.
fn picture(plant: Plant, measured: &[(Point, Outcome)]) -> Picture {
    let group = |noise: f64| Group::of(measured, |point| point.plant == plant && point.noise == noise);
    let points = |delay: fn(&Group) -> Option<f64>| NOISES.into_iter().map(move |noise| (noise, delay(&group(noise))));
    let panel = |title: &str, [from, to]: [f64; 2], layers: Vec<Layer>| Panel {
        title: title.into(),
        x: Axis::log("σ of the sensor noise").over(0.001, 0.2),
        y: Axis::log("median delay, s").over(from, to),
        layers,
    };
    let detection = vec![
        line("ours", points(|group| median_delay(&group.detections(OURS)))),
        line("published", points(|group| median_delay(&group.detections(PUBLISHED)))),
        limit("limit", points(|group| median_delay(&group.limits(|limit| limit.detection)))),
    ];
    let tracking = vec![
        line("ours", points(|group| median_delay(&group.trackings(OURS)))),
        line("published", points(|group| median_delay(&group.trackings(PUBLISHED)))),
        limit("limit", points(|group| median_delay(&group.limits(|limit| limit.tracking)))),
    ];
    Picture {
        name: format!("{}-delays", plant.id()),
        caption: format!(
            "{}: delays against noise; a method without a point tracks less than half of its laws",
            plant.name()
        ),
        panels: vec![panel("detection", [0.003, 3.0], detection), panel("tracking", [0.3, 30.0], tracking)],
    }
}
