//! What `switchid diagnose` says first of each record, beside the reference.

use super::answer::{Diagnosis, MIDDLE};
use super::binary::{Binary, Failure};
use super::figure::Figure;
use super::reference::Record;
use super::score::{is_right, median, worst};
use super::table::{self, fixed, several, short, table};
use crate::error::Error;
use serde::Serialize;

/// A record's first answer.
#[derive(Debug, Serialize)]
pub struct Row {
    record: String,
    verdict: String,
    effect: Option<String>,
    tie: Vec<String>,
    period: [Option<f64>; 2],
    before: [Option<f64>; 3],
    before_reference: [f64; 3],
    after: [Option<f64>; 3],
    after_reference: Option<f64>,
    ratio: Option<f64>,
    p_value: Option<f64>,
    explained: Option<f64>,
    left: Option<String>,
    timing: Option<String>,
    right: bool,
    /// The effect named is the reference's best, or leaves no more than a tenth more; rightly none counts.
    best: bool,
    /// Something can be claimed of the record.
    claimable: bool,
    /// The effect is named with a std above its coefficient.
    unknown: bool,
    crashed: bool,
    failure: Option<String>,
    seconds: f64,
}

/// Diagnoses a record, whose file is `data`, under the model to begin with.
///
/// # Errors
/// [`Error::Start`], [`Error::File`].
pub fn measure(binary: &Binary, record: &Record, data: &str) -> Result<Row, Error> {
    binary.write("model.toml", &record.model())?;
    let answer = binary.ask(&["diagnose", data, "--model", "model.toml"])?;
    let (read, failure) = match answer.document {
        Ok(document) => (Diagnosis::read(&document), None),
        Err(failure) => (Diagnosis::default(), Some(failure)),
    };
    Ok(Row::of(record, read, failure, answer.seconds))
}

impl Row {
    fn of(record: &Record, read: Diagnosis, failure: Option<Failure>, seconds: f64) -> Row {
        let after_reference = read.effect.as_ref().and_then(|effect| record.effects.get(effect)).copied();
        Row {
            record: record.name.clone(),
            right: is_right(&record.right, &read.verdict, read.effect.as_deref(), &read.tie),
            best: is_best(record, &read),
            claimable: !record.right.is_empty(),
            ratio: read.after[MIDDLE].zip(after_reference).map(|(ours, reference)| ours / reference),
            unknown: read.coefficient.is_some_and(|[value, std]| super::score::is_unknown(value, std)),
            verdict: read.verdict,
            effect: read.effect,
            tie: read.tie,
            period: [read.period, Some(record.period)],
            before: read.before,
            before_reference: record.errors,
            after: read.after,
            after_reference,
            p_value: read.p_value,
            explained: read.explained,
            left: read.left,
            timing: read.timing,
            crashed: failure.as_ref().is_some_and(|failure| failure.crashed),
            failure: failure.map(|failure| failure.text),
            seconds,
        }
    }

    /// Whether the program crashed.
    pub fn crashed(&self) -> bool {
        self.crashed
    }

    /// Whether the effect is named with a std above its coefficient.
    pub fn is_unknown(&self) -> bool {
        self.unknown
    }

    /// The record's name and the CPU time of its diagnosis, s.
    pub fn cost(&self) -> (&str, f64) {
        (&self.record, self.seconds)
    }

    fn cells(&self) -> Vec<String> {
        let of = |ours: String, reference: String| format!("{ours} ({reference})");
        let reference = self.before_reference.map(Some);
        vec![
            self.record.clone(),
            if self.verdict.is_empty() { table::NONE.into() } else { self.verdict.clone() },
            table::text(self.effect.as_deref()),
            if self.tie.is_empty() { table::NONE.into() } else { self.tie.join(", ") },
            of(short(self.period[0]), short(self.period[1])),
            of(several(&self.before), several(&reference)),
            of(several(&self.after), fixed(self.after_reference, 3)),
            fixed(self.ratio, 2),
            self.p_value.map_or(table::NONE.into(), |p| format!("{p:.1e}")),
            fixed(self.explained, 2),
            table::text(self.timing.as_deref()),
            if self.right { "right" } else { "wrong" }.into(),
            if self.best { "yes" } else { "no" }.into(),
            fixed(Some(self.seconds), 2),
        ]
    }

    /// What stands below the table: why there is no answer, or what the answer leaves.
    fn remark(&self) -> Option<String> {
        let remark = self.failure.as_ref().or(self.left.as_ref())?;
        Some(format!("- {}: {}{remark}\n", self.record, if self.crashed { "CRASHED: " } else { "" }))
    }
}

/// Error ÷ the reference's with its best effect up to which another effect is as good.
const AS_GOOD: f64 = 1.1;

fn is_best(record: &Record, read: &Diagnosis) -> bool {
    let Some(effect) = &read.effect else { return record.right.is_empty() && !read.verdict.is_empty() };
    let leaves = |error: f64| read.after[MIDDLE].is_some_and(|after| after <= AS_GOOD * error);
    record.best.as_ref().is_some_and(|best| best.effect == *effect || leaves(best.error))
}

const HEADINGS: &str = "record | verdict | effect | tie | T₀, s (reference) | error before at 0.1/0.3/1 T₀ (reference) \
    | after (reference at 0.3 T₀) | ratio | p | explained | timing | first answer | best effect | CPU, s";

/// The answers as a table.
pub fn text(rows: &[Row]) -> String {
    let cells: Vec<Vec<String>> = rows.iter().map(Row::cells).collect();
    table(HEADINGS, &cells) + "\n" + &rows.iter().filter_map(Row::remark).collect::<String>()
}

/// Wrong first answers that the floor allows, of twelve.
const ALLOWED: usize = 1;

/// Best effects other than the reference's that the floor allows, of twelve.
const UNLIKE: usize = 3;

/// Right answers, and errors beside the reference's.
pub fn figures(rows: &[Row], records: usize) -> Vec<Figure> {
    let right = rows.iter().filter(|row| row.right).count() as f64;
    let ratios: Vec<f64> = rows.iter().filter_map(|row| row.ratio).collect();
    let all = rows.len() as f64;
    let floor = if rows.len() == records { all - ALLOWED as f64 } else { all };
    let ratio = |which: &str| format!("held-out error ÷ the reference's, {which} of {}", ratios.len());
    let mut figures = vec![Figure::at_least(&format!("first answer right, of {all}"), Some(right), floor, all)];
    let best = rows.iter().filter(|row| row.best).count() as f64;
    let name = format!("best effect is the reference's, or within {AS_GOOD} of its error, of {all}");
    let floor = if rows.len() == records { all - UNLIKE as f64 } else { 0.0 };
    figures.push(Figure::at_least(&name, Some(best), floor, all));
    if rows.iter().any(|row| row.claimable) {
        figures.push(Figure::at_most(&ratio("median"), median(&ratios), 1.15, 1.0));
        figures.push(Figure::at_most(&ratio("worst"), worst(&ratios), 1.5, 1.2));
    }
    figures
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::real::reference::records;

    fn row(effect: &str, error: f64) -> Row {
        let record = records().unwrap().into_iter().find(|record| record.name == "emps_train").unwrap();
        let after = [None, Some(error), None];
        let read = Diagnosis { verdict: "missing".into(), effect: Some(effect.into()), after, ..Diagnosis::default() };
        Row::of(&record, read, None, 0.5)
    }

    #[test]
    fn an_answer_stands_beside_the_reference_of_the_same_effect() {
        let right = row("coulomb_friction", 0.045);
        assert!(right.right && (right.ratio.unwrap() - 1.25).abs() < 1e-12);
        let wrong = row("quadratic_damping", 0.079);
        assert!(!wrong.right && wrong.ratio == Some(1.0));
        let figures = figures(&[right, wrong], 12);
        assert_eq!(
            (figures[0].value, figures[0].is_missed()),
            (Some(1.0), true),
            "a part of the records: all must be right"
        );
        assert_eq!(figures[1].value, Some(1.0), "drag leaves more than twice what friction does");
        assert_eq!((figures[2].value, figures[3].value), (Some(1.125), Some(1.25)));
        assert_eq!(row("cubic_damping", 0.1).ratio, None, "the reference does not have it");
    }

    #[test]
    fn one_wrong_answer_of_all_is_allowed() {
        let rows = [row("coulomb_friction", 0.036), row("cubic_damping", 0.1)];
        assert!(!figures(&rows, 2)[0].is_missed());
    }
}
