//! What rapid switching says.

use super::super::figure::{Claim, Picture, Section, split_table};
use super::super::follow::{RIGHT, Run, Stage};
use super::super::lines::{limit, line};
use super::super::plant::Plant;
use super::super::statistics::{factor, mean, median, percent, quantile, share, small};
use super::{NOISES, Outcome, Point, SPACINGS, settings};
use switchid::report::{Axis, Panel};

/// Switches within half a period defeat a method that identifies fewer than this share of the laws.
const DEFEATED: f64 = 0.5;

/// A share of the laws that is nearly all of them.
const NEARLY_ALL: f64 = 0.9;

/// Share of a Gaussian within two standard deviations.
const WITHIN_TWO: f64 = 0.954;

type Who = fn(&Outcome) -> &Run;

const OURS: Who = |outcome| &outcome.ours;
const PUBLISHED: Who = |outcome| &outcome.published;

/// Columns of [`HEAD`] that name a setting.
const KEYS: usize = 3;
/// Column of [`HEAD`] at which a page breaks it.
const BREAK: usize = 11;
const HEAD: [&str; 16] = [
    "plant",
    "σ",
    "every",
    "switches",
    "detected",
    "identified",
    "could be",
    "median e",
    "stale",
    "wrong",
    "worst e",
    "validated: z²",
    "z within 2",
    "told",
    "told: z²",
    "z within 2",
];

/// Records of one setting.
struct Group<'a>(Vec<&'a Outcome>);

pub fn section(measured: &[(Point, Outcome)]) -> Section {
    let rows = |who: Who| {
        let row = move |(plant, noise, spacing): (Plant, f64, f64)| {
            let group = Group::of(measured, plant, noise, spacing);
            let names = [plant.name().into(), format!("{noise}"), format!("{spacing} T₀")];
            names.into_iter().chain(group.cells(who, spacing * plant.period())).collect()
        };
        let rows: Vec<Vec<String>> = settings().map(row).collect();
        split_table(KEYS, BREAK, &HEAD, &rows)
    };
    let text = format!(
        "{}\n\nAfter eight natural periods T₀ of a first law, twelve switches at equal distances, each to a law drawn anew. *Identified*: e < 0.05² at \
         the end of the stage. *Could be*: the limit of the tracking delay is shorter than the stage. *Stale*: share of all \
         time at which the method says `valid` of a law that has ended and no alarm was raised since; *wrong*: share at which it says so of a law after \
         the switch's own alarm, and e is above 0.05²; *worst e* is of those. *Told*: share of the coefficients that have a std at the end of \
         a stage. z is the error of a coefficient ÷ its stated std: z² should average 1, and {} of all |z| lie below 2. *Validated*: the coefficients \
         last called valid in each stage after its alarm; *told*: all that have a std at its end, its switch detected or not. A law of ours \
         must be stable while its record grows by a tenth before switches from it are looked for: one that comes sooner is taken into the law, and \
         until the record since is long enough for another, what is told is of a record with two laws and more.\n\n**Ours**\n\n{}\n**Published method**\n\n{}",
        fails(measured),
        percent(WITHIN_TWO),
        rows(OURS),
        rows(PUBLISHED)
    );
    let pictures = Plant::ALL.map(|plant| picture(plant, measured)).to_vec();
    Section { title: "Rapid switching", text, pictures, claims: vec![half_a_period(measured)] }
}

/// Where ours fails, and how: by plant and noise the spacing from which it identifies nearly all laws, against the
/// possible one.
fn fails(measured: &[(Point, Outcome)]) -> String {
    let from = |plant: Plant, noise: f64, value: &dyn Fn(&Group, f64) -> f64| {
        let nearly_all = |spacing: &&f64| {
            value(&Group::of(measured, plant, noise, **spacing), **spacing * plant.period()) >= NEARLY_ALL
        };
        let spacings: Vec<&f64> = SPACINGS.iter().rev().take_while(nearly_all).collect();
        spacings.last().map_or("at none of these".into(), |spacing| format!("from {spacing} T₀ on"))
    };
    let settings = Plant::ALL.into_iter().flat_map(|plant| NOISES.into_iter().map(move |noise| (plant, noise)));
    let sentence = |(plant, noise): (Plant, f64)| {
        let ours = from(plant, noise, &|group, _| group.identified(OURS));
        let possible = from(plant, noise, &|group, length| group.possible(length));
        format!("- {}, σ = {noise}: ours {ours}, possible {possible}.\n", plant.name())
    };
    let sentences: String = settings.map(sentence).collect();
    let wrong = measured.iter().flat_map(|(_, outcome)| &outcome.ours.stages[1..]);
    let (wrong, stale): (Vec<f64>, Vec<f64>) = wrong.map(|stage| (stage.wrong, stage.stale)).unzip();
    format!(
        "Time between switches at which at least {} of the laws are identified before they end:\n\n{sentences}\nOver all of these records ours \
         calls a wrong law `valid` for {:.1} % of the time after an alarm, and one that has ended for {:.1} %.",
        percent(NEARLY_ALL),
        100.0 * mean(&wrong).unwrap_or_default(),
        100.0 * mean(&stale).unwrap_or_default()
    )
}

impl<'a> Group<'a> {
    fn of(measured: &'a [(Point, Outcome)], plant: Plant, noise: f64, spacing: f64) -> Group<'a> {
        let wanted = |point: &Point| point.plant == plant && point.noise == noise && point.spacing == spacing;
        Group(measured.iter().filter(|(point, _)| wanted(point)).map(|(_, outcome)| outcome).collect())
    }

    /// Every stage that a switch began.
    fn stages(&self, who: Who) -> Vec<&'a Stage> {
        self.0.iter().flat_map(|outcome| &who(outcome).stages[1..]).collect()
    }

    fn detected(&self, who: Who) -> f64 {
        share(&self.stages(who), |stage| stage.detection.is_some())
    }

    fn identified(&self, who: Who) -> f64 {
        share(&self.stages(who), |stage| stage.error < RIGHT)
    }

    /// Share of the laws that any method could know before they end.
    fn possible(&self, length: f64) -> f64 {
        let limits: Vec<_> = self.0.iter().flat_map(|outcome| &outcome.limits).collect();
        share(&limits, |limit| limit.tracking.is_some_and(|tracking| tracking < length))
    }

    fn cells(&self, who: Who, length: f64) -> Vec<String> {
        let stages = self.stages(who);
        let of = |value: fn(&Stage) -> f64| -> Vec<f64> { stages.iter().map(|stage| value(stage)).collect() };
        let scores =
            |of: fn(&Stage) -> &[f64]| -> Vec<f64> { stages.iter().flat_map(|stage| of(stage)).copied().collect() };
        let [validated, stated] = [scores(|stage| &stage.normalised), scores(|stage| &stage.stated)].map(coverage);
        let worst = quantile(&of(|stage| stage.worst), 1.0).filter(|worst| *worst > 0.0);
        let own = vec![
            stages.len().to_string(),
            percent(self.detected(who)),
            percent(self.identified(who)),
            percent(self.possible(length)),
            small(median(&of(|stage| stage.error))),
            percent(mean(&of(|stage| stage.stale)).unwrap_or_default()),
            percent(mean(&of(|stage| stage.wrong)).unwrap_or_default()),
            small(worst),
        ];
        let told = percent(mean(&of(|stage| stage.told)).unwrap_or_default());
        own.into_iter().chain(validated).chain([told]).chain(stated).collect()
    }
}

/// Mean square of normalised errors, and the share of them within two std.
fn coverage(scores: Vec<f64>) -> [String; 2] {
    let squares: Vec<f64> = scores.iter().map(|z| z * z).collect();
    let within = (!scores.is_empty()).then(|| share(&scores, |z| z.abs() < 2.0));
    [factor(mean(&squares)), within.map_or("–".into(), percent)]
}

fn picture(plant: Plant, measured: &[(Point, Outcome)]) -> Picture {
    let points = |noise: f64, value: fn(&Group, f64) -> f64| {
        let of = move |spacing: f64| value(&Group::of(measured, plant, noise, spacing), spacing * plant.period());
        SPACINGS.into_iter().map(move |spacing| (spacing, Some(100.0 * of(spacing))))
    };
    let panel = |noise: f64| Panel {
        title: format!("σ = {noise}"),
        x: Axis::log("time between switches, natural periods").over(SPACINGS[0], SPACINGS[SPACINGS.len() - 1]),
        y: Axis::of("% of the laws").over(0.0, 100.0),
        layers: vec![
            line("ours: identified", points(noise, |group, _| group.identified(OURS))),
            line("published: identified", points(noise, |group, _| group.identified(PUBLISHED))),
            line("ours: detected", points(noise, |group, _| group.detected(OURS))),
            limit("could be identified", points(noise, |group, length| group.possible(length))),
        ],
    };
    Picture {
        name: format!("{}-rapid", plant.id()),
        caption: format!("{}: what is detected and identified when switches come fast", plant.name()),
        panels: NOISES.map(panel).to_vec(),
    }
}

fn half_a_period(measured: &[(Point, Outcome)]) -> Claim {
    let group = |plant: Plant| Group::of(measured, plant, NOISES[0], SPACINGS[1]);
    let defeated = |who: Who| Plant::ALL.into_iter().all(|plant| group(plant).identified(who) < DEFEATED);
    let evidence = Plant::ALL.map(|plant| {
        let group = group(plant);
        let [ours, published] = [OURS, PUBLISHED].map(|who| percent(group.identified(who)));
        let possible = percent(group.possible(SPACINGS[1] * plant.period()));
        format!(
            "{}, switches every half period, σ = {}: {published} of the laws identified (published), {ours} (ours), {possible} possible; detected by ours {}",
            plant.name(),
            NOISES[0],
            percent(group.detected(OURS))
        )
    });
    Claim {
        claim: "switches within half a natural period defeat it",
        published: defeated(PUBLISHED),
        ours: defeated(OURS),
        evidence: evidence.join("; "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_std_that_is_too_small_shows_in_both_figures() {
        assert_eq!(coverage(vec![1.0, -1.0, 1.0, -1.0]), ["1.00", "100 %"]);
        assert_eq!(coverage(vec![10.0, -10.0, 1.0, 1.0]), ["50", "50 %"]);
        assert_eq!(coverage(Vec::new()), ["–", "–"]);
    }
}
