//! The loop of switch and re-identification that never ends: the published method under nine settings and noises, ours
//! beside it.

use super::Failure;
use super::figure::{Claim, Figure, Section, table};
use super::follow::{RIGHT, Run, follow};
use super::plant::Plant;
use super::statistics::{percent, share};
use serde::{Deserialize, Serialize};
use switchid::identify::{Identifier, Method, Settings};
use switchid::simulate::{Builtin, Scenario, record};

/// Std of the sensor noise.
const NOISES: [f64; 5] = [0.0, 0.01, 0.05, 0.1, 0.2];

/// Half of the record: one law before the switch, one after it, s.
const HALF: f64 = 30.0;

/// Interval, T (s) and threshold of the published method; the first is as published.
const SETTINGS: [[f64; 3]; 8] = [
    [1.0, 0.5, 0.05],
    [6.0, 0.5, 0.05],
    [1.0, 2.0, 0.05],
    [1.0, 0.5, 0.5],
    [6.0, 2.0, 0.05],
    [6.0, 0.5, 0.5],
    [1.0, 2.0, 0.5],
    [6.0, 2.0, 0.5],
];

/// The setting with all three raised.
const RAISED: usize = SETTINGS.len() - 1;

/// This many alarms on a record of one switch are a loop.
const LOOP: f64 = 5.0;

/// A setting serves a noise where it is right on this share of the records.
const SERVES: f64 = 0.9;

/// The published method's settings against noise.
pub struct Loops;

/// A noisy record with one switch, and who looks at it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    noise: f64,
    /// Number of the published method's setting; `None` for ours.
    setting: Option<usize>,
    seed: u64,
}

impl Figure for Loops {
    const NAME: &'static str = "loops";
    type Point = Point;
    type Outcome = Run;

    fn points(seeds: u64) -> Vec<Point> {
        let settings = || (0..SETTINGS.len()).map(Some).chain([None]);
        let of_noise = |noise: f64| {
            let count = if noise == 0.0 { 1 } else { seeds.div_ceil(2) };
            settings().flat_map(move |setting| (0..count).map(move |seed| Point { noise, setting, seed }))
        };
        NOISES.into_iter().flat_map(of_noise).collect()
    }

    fn measure(point: &Point) -> Result<Run, Failure> {
        let scenario = scenario(point);
        let settings = point.setting.map_or_else(Settings::default, published);
        let mut identifier = Identifier::new(&Plant::Duffing.model(), settings)?;
        follow(&mut identifier, &scenario, &record(&scenario)?)
    }

    fn section(measured: &[(Point, Run)]) -> Result<Section, Failure> {
        let text = format!(
            "Duffing under its sine, {HALF} s of one law and {HALF} s of another. Each cell: mean number of alarms, of which one is right, \
             and the share of records where all is right: the switch detected, no other alarm, e < 0.05² at the end of \
             both laws.\n\n{}",
            settings_table(measured)
        );
        let claims = vec![needs_more(measured), adapting(measured)];
        Ok(Section { title: "Interval, T and threshold against noise", text, pictures: Vec::new(), claims })
    }
}

fn scenario(point: &Point) -> Scenario {
    let documented = Builtin::DuffingSine.scenario();
    let mut stages = documented.stages[..2].to_vec();
    stages[1].start = HALF;
    Scenario { stages, duration: 2.0 * HALF, ..Plant::Duffing.switched(point.noise, point.seed) }
}

fn published(setting: usize) -> Settings {
    let [initial_window, deviation_interval, deviation_threshold] = SETTINGS[setting];
    let method = Method::Publication;
    Settings { method, initial_window, deviation_interval, deviation_threshold, ..Settings::default() }
}

fn runs(measured: &[(Point, Run)], setting: Option<usize>, noise: f64) -> Vec<&Run> {
    let wanted = |point: &Point| point.setting == setting && point.noise == noise;
    measured.iter().filter(|(point, _)| wanted(point)).map(|(_, run)| run).collect()
}

fn is_right(run: &Run) -> bool {
    run.false_alarms == 0 && run.stages[1].detection.is_some() && run.stages.iter().all(|stage| stage.error < RIGHT)
}

fn right(measured: &[(Point, Run)], setting: Option<usize>, noise: f64) -> f64 {
    share(&runs(measured, setting, noise), |run| is_right(run))
}

fn alarms(measured: &[(Point, Run)], setting: Option<usize>, noise: f64) -> f64 {
    let runs = runs(measured, setting, noise);
    let count = |run: &&Run| run.false_alarms + usize::from(run.stages[1].detection.is_some());
    runs.iter().map(count).sum::<usize>() as f64 / runs.len().max(1) as f64
}

fn settings_table(measured: &[(Point, Run)]) -> String {
    let name = |setting: Option<usize>| match setting.map(|setting| SETTINGS[setting]) {
        None => "ours, default".into(),
        Some([interval, t, threshold]) => format!("published: {interval} s, T = {t} s, {threshold}"),
    };
    let cell = |setting: Option<usize>, noise: f64| {
        format!("{:.1}, {}", alarms(measured, setting, noise), percent(right(measured, setting, noise)))
    };
    let row = |setting: Option<usize>| {
        let cells = NOISES.into_iter().map(|noise| cell(setting, noise));
        [name(setting)].into_iter().chain(cells).collect()
    };
    let noises = NOISES.map(|noise| format!("σ = {noise}"));
    let head: Vec<&str> = ["interval, T, threshold"].into_iter().chain(noises.iter().map(String::as_str)).collect();
    table(&head, (0..SETTINGS.len()).map(Some).chain([None]).map(row))
}

fn needs_more(measured: &[(Point, Run)]) -> Claim {
    let noisy = NOISES[3];
    let [as_published, raised] = [Some(0), Some(RAISED)].map(|setting| alarms(measured, setting, noisy));
    let ours = alarms(measured, None, noisy);
    Claim {
        claim: "more noise needs a longer interval, a longer T and a higher threshold, else the loop \"switch, re-identify\" never ends",
        published: as_published > LOOP && raised < LOOP,
        ours: ours > LOOP,
        evidence: format!(
            "alarms on a record with one switch, σ = {noisy}: {as_published:.1} as published, {raised:.1} with all three raised, {ours:.1} ours"
        ),
    }
}

fn adapting(measured: &[(Point, Run)]) -> Claim {
    let served =
        |setting: Option<usize>| NOISES.into_iter().filter(|noise| right(measured, setting, *noise) >= SERVES).count();
    let best = (0..SETTINGS.len()).map(|setting| served(Some(setting))).max().unwrap_or_default();
    let ours = served(None);
    let all = NOISES.len();
    Claim {
        claim: "adapting T and threshold automatically is important",
        published: best < all,
        ours: best < ours,
        evidence: format!(
            "of {all} noises the best fixed setting serves {best} (right on {} of the records), ours, which adapts, {ours}",
            percent(SERVES)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_above_the_threshold_loops_and_is_not_right() {
        let measured: Vec<(Point, Run)> = [(0.0, Some(0)), (0.1, Some(0)), (0.0, None)]
            .into_iter()
            .map(|(noise, setting)| {
                let point = Point { noise, setting, seed: 0 };
                (point, Loops::measure(&point).unwrap())
            })
            .collect();
        assert!(alarms(&measured, Some(0), 0.1) > LOOP && right(&measured, Some(0), 0.1) == 0.0);
        for setting in [Some(0), None] {
            assert_eq!((alarms(&measured, setting, 0.0), right(&measured, setting, 0.0)), (1.0, 1.0));
        }
    }
}
