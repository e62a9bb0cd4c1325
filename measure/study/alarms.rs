//! Detection delay against the false-alarm interval.

use super::Failure;
use super::delays::group::{Group, OURS, OWN_HEAD};
use super::delays::{Outcome, Point, measure, records};
use super::figure::{Figure, Picture, Section, table};
use super::lines::{limit, line};
use super::plant::Plant;
use super::statistics::median_delay;
use switchid::report::{Axis, Panel};

/// Std of the sensor noise.
const NOISE: f64 = 0.03;

/// False-alarm intervals, s.
const INTERVALS: [f64; 5] = [60.0, 1e3, 1e4, 1e6, 1e8];

/// Delays against the false-alarm interval.
pub struct Alarms;

impl Figure for Alarms {
    const NAME: &'static str = "alarms";
    type Point = Point;
    type Outcome = Outcome;

    fn points(seeds: u64) -> Vec<Point> {
        let of = |false_alarm_interval: f64| {
            records(seeds).map(move |seed| Point { plant: Plant::Duffing, noise: NOISE, false_alarm_interval, seed })
        };
        INTERVALS.into_iter().flat_map(of).collect()
    }

    fn measure(point: &Point) -> Result<Outcome, Failure> {
        measure(point)
    }

    fn section(measured: &[(Point, Outcome)]) -> Result<Section, Failure> {
        let group = |interval: f64| Group::of(measured, |point| point.false_alarm_interval == interval);
        let row = |interval: f64| [format!("{interval:.0e}")].into_iter().chain(group(interval).own_cells()).collect();
        let head: Vec<&str> = ["interval, s"].into_iter().chain(OWN_HEAD).collect();
        let text = format!(
            "The same Duffing records, σ = {NOISE}, with other values of `false_alarm_interval`. The decision threshold is its \
             logarithm: four decades of rarer false alarms cost little. ÷ limit is (delay − 3 ms) ÷ limit, switch by switch.\n\n{}",
            table(&head, INTERVALS.into_iter().map(row))
        );
        let points = |delay: fn(&Group) -> Option<f64>| {
            INTERVALS.into_iter().map(move |interval| (interval, delay(&group(interval))))
        };
        let panel = Panel {
            title: format!("Duffing, σ = {NOISE}"),
            x: Axis::log("false-alarm interval, s").over(10.0, 1e8),
            y: Axis::of("median detection delay, s").over(0.0, 0.08),
            layers: vec![
                line("ours", points(|group| median_delay(&group.detections(OURS)))),
                limit("limit", points(|group| median_delay(&group.limits(|limit| limit.detection)))),
            ],
        };
        let caption = "Detection delay against the mean time between two false alarms that is allowed".into();
        let pictures = vec![Picture { name: "false-alarms".into(), caption, panels: vec![panel] }];
        Ok(Section { title: "Delay against the false-alarm interval", text, pictures, claims: Vec::new() })
    }
}
