//! The limits as text and as JSON.

use super::super::output::Pairs;
use super::super::words::{noise, percent, quantity, seconds};
use super::found::Limits;
use crate::law::{Hold, Term, equation, unit_of};
use crate::limits::Detection;
use serde::Serialize;
use std::fmt::Write;

/// The JSON document.
#[derive(Serialize)]
pub(super) struct Report {
    coefficients: Pairs,
    coefficient_std: Pairs,
    relative_error: Option<f64>,
    shortest_record: Option<f64>,
    shortest_record_after_switch: Option<f64>,
    detection_delay: Option<f64>,
    detection: Option<DetectionReport>,
    unidentifiable: Vec<String>,
    dropped: Vec<String>,
    noise: Pairs,
    /// null where F is what the law gives.
    hold: Option<&'static str>,
    record: f64,
}

#[derive(Serialize)]
struct DetectionReport {
    change: Pairs,
    level: f64,
    median: Option<f64>,
    smallest: Option<f64>,
    largest: Option<f64>,
    tried: usize,
    seen: usize,
}

impl Report {
    pub(super) fn of(found: &Limits) -> Report {
        let names = |terms: Vec<Term>| terms.into_iter().map(|term| term.name()).collect();
        let law = found.law.terms().iter().zip(found.law.coefficients());
        Report {
            coefficients: Pairs(law.map(|(term, value)| (term.name(), *value)).collect()),
            coefficient_std: Pairs(std(found).filter_map(|(term, _, std)| Some((term.name(), std?))).collect()),
            relative_error: found.bound.relative_error,
            shortest_record: found.bound.shortest_record,
            shortest_record_after_switch: found.after_switch,
            detection_delay: found.detection.as_ref().and_then(|detection| detection.at_start),
            detection: found.detection.as_ref().map(|detection| DetectionReport::of(found, detection)),
            unidentifiable: found.bound.open.iter().map(|terms| together(terms)).collect(),
            dropped: names(found.dropped()),
            noise: Pairs(found.noise.iter().map(|(channel, std)| ((*channel).into(), *std)).collect()),
            hold: found.hold.map(Hold::id),
            record: duration(found),
        }
    }
}

impl DetectionReport {
    fn of(found: &Limits, detection: &Detection) -> DetectionReport {
        DetectionReport {
            change: Pairs(found.asked.change.iter().map(|(term, value)| (term.name(), *value)).collect()),
            level: found.level,
            median: detection.median,
            smallest: detection.smallest,
            largest: detection.largest,
            tried: detection.tried,
            seen: detection.seen,
        }
    }
}

/// Sought terms, their coefficients, and the smallest std where there is one.
fn std<'a>(found: &'a Limits) -> impl Iterator<Item = (Term, f64, Option<f64>)> + 'a {
    let (terms, values) = (found.law.terms(), found.law.coefficients());
    let sought = found.law.sought().iter().zip(&found.bound.std);
    sought.map(|(index, std)| (terms[*index], values[*index], *std))
}

/// The smallest std of each coefficient that is determined, ÷ its value, with both in words.
pub(super) fn bars(found: &Limits) -> Vec<(String, f64, String)> {
    let known = std(found).filter_map(|(term, value, std)| Some((term, value, std?)));
    known
        .map(|(term, value, std)| {
            (term.name(), 100.0 * (std / value).abs(), quantity(value, std, unit_of(term, &found.input.units)))
        })
        .collect()
}

fn together(terms: &[Term]) -> String {
    let names: Vec<String> = terms.iter().map(|term| term.name()).collect();
    if names.len() > 1 { names.join(" and ") + " together" } else { names.concat() }
}

fn duration(found: &Limits) -> f64 {
    let t = found.recording.t();
    t[t.len() - 1] - t[0]
}

/// What a user reads: the answers first, then the table.
pub(super) fn text(found: &Limits) -> String {
    let mut text = coefficients(found) + "\n" + &shortest(found) + "\n";
    if let Some(detection) = &found.detection {
        text = text + &switch(found, detection) + "\n";
    }
    text + "\n" + &table(found) + &notes(found)
}

/// The first line.
fn coefficients(found: &Limits) -> String {
    let record = format!("{} s of record", seconds(duration(found)));
    match found.bound.relative_error {
        Some(error) => format!(
            "coefficients: no method errs less than e = {error:.2e} ({} rms) on these {record}",
            percent(error.sqrt())
        ),
        None => format!("coefficients: these {record} do not determine all of them, whatever the method"),
    }
}

/// The second line.
fn shortest(found: &Limits) -> String {
    let time =
        |time: Option<f64>| time.map_or_else(|| "never on this record".into(), |time| format!("from {time:.3} s on"));
    let from = time(found.bound.shortest_record);
    match found.hold {
        None => format!("known to 5 % rms: {from}"),
        Some(_) => format!(
            "known to 5 % rms: {from}; with the state at the start known, as after a switch, {}",
            time(found.after_switch)
        ),
    }
}

/// The third line.
fn switch(found: &Limits, detection: &Detection) -> String {
    let old = |term: Term| {
        let position = found.law.terms().iter().position(|own| *own == term);
        position.map_or(0.0, |index| found.law.coefficients()[index])
    };
    let change = |(term, new): &(Term, f64)| format!("{} {:.4} → {new}", term.name(), old(*term));
    let changes: Vec<String> = found.asked.change.iter().map(change).collect();
    format!("switch ({}): {}", changes.join(", "), seen(detection))
}

/// When the switch is seen, from its instants over the record's first half.
fn seen(detection: &Detection) -> String {
    let Detection { at_start, median, smallest: Some(smallest), largest, tried, seen } = detection else {
        return "not seen within this record, wherever in its first half it comes".into();
    };
    let start = match at_start {
        Some(delay) => format!("seen after {delay:.4} s where it comes at the record's start"),
        None => "not seen within this record where it comes at its start".into(),
    };
    match (median, largest) {
        (Some(median), Some(largest)) => format!(
            "{start}; over {tried} instants of its first half the median is {median:.4} s, from {smallest:.4} s to {largest:.4} s"
        ),
        _ => format!(
            "{start}; seen before the record ends at {seen} of {tried} instants of its first half, after {smallest:.4} s at the soonest"
        ),
    }
}

fn table(found: &Limits) -> String {
    let forced = found.recording.channels().excitation;
    let pairs: Vec<(Term, f64)> =
        found.law.terms().iter().copied().zip(found.law.coefficients().iter().copied()).collect();
    let law: Vec<_> = pairs.iter().map(|(term, value)| (*term, *value, None)).collect();
    let mut text = format!("law: {}\n", equation(&law, forced));
    for (index, (term, value)) in pairs.into_iter().enumerate() {
        let row = found.law.sought().iter().position(|sought| *sought == index);
        let line = match row.map(|row| found.bound.std[row]) {
            None => format!("{} (known)", quantity(value, 0.0, unit_of(term, &found.input.units))),
            Some(None) => "not determined".into(),
            Some(Some(std)) => {
                let known = quantity(value, std, unit_of(term, &found.input.units));
                format!("{known}  {}", percent((std / value).abs()))
            }
        };
        let _ = writeln!(text, "  {:<20} {line}", term.name());
    }
    text
}

/// What the limits rest on, and what was left out.
fn notes(found: &Limits) -> String {
    let between = match found.hold {
        None => "F is the output, the motion counts as known".into(),
        Some(hold) => format!("between samples: {hold}"),
    };
    let mut text = format!("sensor noise (std): {}; {between}\n", noise(&found.noise, &found.input.units));
    for open in &found.bound.open {
        let _ = writeln!(text, "nothing on this record determines {}", together(open));
    }
    let dropped: Vec<String> = found.dropped().into_iter().map(|term| term.name()).collect();
    if !dropped.is_empty() {
        let _ = writeln!(text, "left out, since the record does not speak for them: {}", dropped.join(", "));
    }
    if found.numbers_only {
        text += "the model has numbers only: all of them count as sought\n";
    }
    if found.detection.is_some() {
        let _ = writeln!(
            text,
            "a switch counts as seen at {:.1} nats: a false alarm in {} s",
            found.level, found.asked.false_alarm_interval
        );
    }
    text
}
