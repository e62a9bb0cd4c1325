//! Records of one setting, summed up.

use super::super::follow::{Run, Stage};
use super::super::limit::Delays as Limits;
use super::super::statistics::{factor, longest_delay, median_delay, seconds};
use super::{Outcome, Point};

/// What an alarm that depends on one sample costs at least: that sample, and the time until it is taken, s.
const LEAST: f64 = 3e-3;

/// Column of [`HEAD`] at which a page breaks it.
pub const BREAK: usize = 7;

/// The head of [`Group::cells`].
pub const HEAD: [&str; 15] = [
    "switches",
    "detection, s: ours",
    "worst",
    "limit",
    "(delay − 3 ms) ÷ limit",
    "worst",
    "published",
    "missed: ours",
    "published",
    "false: ours",
    "published",
    "tracking, s",
    "limit",
    "tracked: ours",
    "published",
];

/// The head of [`Group::own_cells`].
pub const OWN_HEAD: [&str; 9] =
    ["switches", "detection, s: median", "worst", "limit", "÷ limit", "worst", "missed", "false", "record, h"];

/// One of the two methods.
pub type Who = fn(&Outcome) -> &Run;

/// The default method.
pub const OURS: Who = |outcome| &outcome.ours;
/// The published one.
pub const PUBLISHED: Who = |outcome| &outcome.published;

/// Records of one setting.
pub struct Group<'a>(Vec<&'a Outcome>);

impl<'a> Group<'a> {
    /// The outcomes whose point is wanted.
    pub fn of(measured: &'a [(Point, Outcome)], wanted: impl Fn(&Point) -> bool) -> Group<'a> {
        Group(measured.iter().filter(|(point, _)| wanted(point)).map(|(_, outcome)| outcome).collect())
    }

    /// Every stage that a switch began.
    fn stages(&self, who: Who) -> impl Iterator<Item = &'a Stage> {
        self.0.iter().flat_map(move |outcome| &who(outcome).stages[1..])
    }

    /// Delay of every detection.
    pub fn detections(&self, who: Who) -> Vec<Option<f64>> {
        self.stages(who).map(|stage| stage.detection).collect()
    }

    /// Delay of every tracking.
    pub fn trackings(&self, who: Who) -> Vec<Option<f64>> {
        self.stages(who).map(|stage| stage.tracking).collect()
    }

    /// One of the limits of every switch.
    pub fn limits(&self, which: fn(&Limits) -> Option<f64>) -> Vec<Option<f64>> {
        self.0.iter().flat_map(|outcome| &outcome.limits).map(which).collect()
    }

    /// (delay − 3 ms) ÷ limit of every switch that has a limit.
    fn ratios(&self) -> Vec<Option<f64>> {
        let pairs = self.detections(OURS).into_iter().zip(self.limits(|limit| limit.detection));
        let ratio = |(delay, limit): (Option<f64>, Option<f64>)| {
            let limit = limit?;
            Some(delay.map(|delay| (delay - LEAST).max(0.0) / limit))
        };
        pairs.filter_map(ratio).collect()
    }

    fn missed(&self, who: Who) -> String {
        self.stages(who).filter(|stage| stage.detection.is_none()).count().to_string()
    }

    fn false_alarms(&self, who: Who) -> String {
        self.0.iter().map(|outcome| who(outcome).false_alarms).sum::<usize>().to_string()
    }

    fn tracked(&self, who: Who) -> String {
        let all = self.trackings(who);
        format!("{} of {}", all.iter().flatten().count(), all.len())
    }

    /// Both methods, under [`HEAD`].
    pub fn cells(&self) -> Vec<String> {
        let [ours, published] = [OURS, PUBLISHED].map(|who| self.detections(who));
        vec![
            ours.len().to_string(),
            seconds(median_delay(&ours)),
            seconds(longest_delay(&ours)),
            seconds(median_delay(&self.limits(|limit| limit.detection))),
            factor(median_delay(&self.ratios())),
            factor(longest_delay(&self.ratios())),
            seconds(median_delay(&published)),
            self.missed(OURS),
            self.missed(PUBLISHED),
            self.false_alarms(OURS),
            self.false_alarms(PUBLISHED),
            seconds(median_delay(&self.trackings(OURS))),
            seconds(median_delay(&self.limits(|limit| limit.tracking))),
            self.tracked(OURS),
            self.tracked(PUBLISHED),
        ]
    }

    /// Our detections, under [`OWN_HEAD`].
    pub fn own_cells(&self) -> Vec<String> {
        let delays = self.detections(OURS);
        let hours = self.0.iter().map(|outcome| outcome.duration).sum::<f64>() / 3600.0;
        vec![
            delays.len().to_string(),
            seconds(median_delay(&delays)),
            seconds(longest_delay(&delays)),
            seconds(median_delay(&self.limits(|limit| limit.detection))),
            factor(median_delay(&self.ratios())),
            factor(longest_delay(&self.ratios())),
            self.missed(OURS),
            self.false_alarms(OURS),
            format!("{hours:.2}"),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(delays: &[Option<f64>], false_alarms: usize) -> Run {
        let stage = |detection: Option<f64>| Stage {
            detection,
            tracking: None,
            validated: None,
            error: 1.0,
            worst: 0.0,
            wrong: 0.0,
            stale: 0.0,
            normalised: Vec::new(),
            stated: Vec::new(),
            told: 0.0,
        };
        Run { stages: [None].iter().chain(delays).map(|delay| stage(*delay)).collect(), false_alarms }
    }

    fn limit(detection: Option<f64>) -> Limits {
        Limits { detection, tracking: Some(1.0) }
    }

    #[test]
    fn ratios_are_taken_switch_by_switch_and_a_missed_one_is_the_worst() {
        let ours = run(&[Some(0.103), Some(0.053), None, Some(9.0)], 2);
        let limits = vec![limit(Some(0.1)), limit(Some(0.02)), limit(Some(0.5)), limit(None)];
        let outcome = Outcome { published: run(&[None; 4], 0), ours, limits, duration: 1800.0 };
        let group = Group(vec![&outcome]);
        let ratios: Vec<Option<f64>> = group.ratios();
        assert_eq!(ratios.len(), 3);
        assert!((ratios[0].unwrap() - 1.0).abs() < 1e-9 && (ratios[1].unwrap() - 2.5).abs() < 1e-9);
        let cells = group.own_cells();
        assert_eq!(cells[0..3], ["4", "0.103", "–"]);
        assert_eq!(cells[4..], ["2.50", "–", "1", "2", "0.50"]);
        assert_eq!(group.cells()[14], "0 of 4");
    }
}
