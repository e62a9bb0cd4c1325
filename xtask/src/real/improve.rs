//! The staircase of `switchid improve` on each record.

use super::answer::list;
use super::binary::Binary;
use super::figure::Figure;
use super::reference::Record;
use super::score::{is_unknown, median, rises};
use super::table::{self, fixed, table};
use crate::error::Error;
use serde::Serialize;
use serde_json::Value;

/// A record's staircase.
#[derive(Debug, Serialize)]
pub struct Row {
    record: String,
    steps: Vec<Step>,
    verdict: String,
    rises: usize,
    /// Error after two effects ÷ the reference's.
    ratio: Option<f64>,
    crashed: bool,
    failure: Option<String>,
    seconds: f64,
}

/// A step of a staircase.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Step {
    /// The effect added; none in the first step.
    effect: Option<String>,
    /// Held-out error at 0.3 T₀.
    error: Option<f64>,
    /// A coefficient that the step brought has a std above it.
    unknown: bool,
}

/// Improves the model to begin with on a record, whose file is `data`.
///
/// # Errors
/// [`Error::Start`], [`Error::File`].
pub fn measure(binary: &Binary, record: &Record, data: &str) -> Result<Row, Error> {
    binary.write("model.toml", &record.model())?;
    let answer = binary.ask(&["improve", data, "--model", "model.toml", "-o", "better.toml", "--force"])?;
    let (document, failure) = match answer.document {
        Ok(document) => (document, None),
        Err(failure) => (Value::Null, Some(failure)),
    };
    let steps = steps(&document);
    Ok(Row {
        record: record.name.clone(),
        ratio: after_two(&steps).zip(record.then).map(|(ours, reference)| ours / reference),
        rises: rises(&steps.iter().map(|step| step.error).collect::<Vec<_>>()),
        steps,
        verdict: document["verdict"].as_str().unwrap_or_default().into(),
        crashed: failure.as_ref().is_some_and(|failure| failure.crashed),
        failure: failure.map(|failure| failure.text),
        seconds: answer.seconds,
    })
}

/// Held-out error after two effects, or as many as there are.
fn after_two(steps: &[Step]) -> Option<f64> {
    steps.iter().take(1 + TWO).next_back()?.error
}

/// Effects after which the reference says its "then".
const TWO: usize = 2;

fn steps(document: &Value) -> Vec<Step> {
    let steps = list(&document["steps"]);
    let before = |index: usize| index.checked_sub(1).map(|index| &steps[index]["std"]);
    let step = |(index, step): (usize, &Value)| Step {
        effect: step["effect"].as_str().map(String::from),
        error: step["error"].as_f64(),
        unknown: before(index).is_some_and(|before| brings_unknown(step, before)),
    };
    steps.iter().enumerate().map(step).collect()
}

/// Whether a coefficient that the step before did not have has a std above it.
fn brings_unknown(step: &Value, before: &Value) -> bool {
    let stds = step["std"].as_object().into_iter().flatten().filter(|(term, _)| before[term.as_str()].is_null());
    stds.map(|(term, std)| (&step["coefficients"][term], std))
        .any(|(value, std)| value.as_f64().zip(std.as_f64()).is_none_or(|(value, std)| is_unknown(value, std)))
}

impl Row {
    /// Whether the program crashed.
    pub fn crashed(&self) -> bool {
        self.crashed
    }

    /// Effects named with a std above their coefficient.
    pub fn unknown(&self) -> usize {
        self.steps.iter().filter(|step| step.unknown).count()
    }

    fn cells(&self) -> Vec<String> {
        let verdict = if self.verdict.is_empty() { table::NONE.into() } else { self.verdict.clone() };
        let counts = [self.rises, self.unknown()].map(|count| count.to_string());
        let [rises, unknown] = counts;
        let ratio = fixed(self.ratio, 2);
        vec![self.record.clone(), self.staircase(), ratio, rises, unknown, verdict, fixed(Some(self.seconds), 2)]
    }

    /// `0.197 → coulomb_friction 0.036`, a coefficient that is not known with "?".
    fn staircase(&self) -> String {
        let failure = self.failure.as_ref().map(|failure| format!("no answer: {failure}"));
        let step = |step: &Step| {
            let mark = if step.unknown { "?" } else { "" };
            let error = fixed(step.error, 3);
            step.effect.as_ref().map_or_else(|| error.clone(), |effect| format!("{effect}{mark} {error}"))
        };
        failure.unwrap_or_else(|| self.steps.iter().map(step).collect::<Vec<_>>().join(" → "))
    }
}

const HEADINGS: &str = "record | held-out error at 0.3 T₀ | after two ÷ reference | steps that raise it | std above coefficient | verdict at the end | CPU, s";

/// The staircases as a table.
pub fn text(rows: &[Row]) -> String {
    table(HEADINGS, &rows.iter().map(Row::cells).collect::<Vec<_>>())
}

/// Steps that raise the error, and what two effects leave beside the reference's.
pub fn figures(rows: &[Row]) -> Vec<Figure> {
    let rises: usize = rows.iter().map(|row| row.rises).sum();
    let ratios: Vec<f64> = rows.iter().filter_map(|row| row.ratio).collect();
    let name = format!("held-out error after two effects ÷ the reference's, median of {}", ratios.len());
    let two = (!ratios.is_empty()).then(|| Figure::at_most(&name, median(&ratios), 1.2, 1.0));
    let rises = Figure::at_most("steps that raise the held-out error", Some(rises as f64), 0.0, 0.0);
    [rises].into_iter().chain(two).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_staircase_is_read_with_what_each_step_brought() {
        let steps = steps(&json!({"steps": [
            {"effect": null, "error": 0.3, "coefficients": {"qd": 1.0}, "std": {"qd": 5.0}},
            {"effect": "a", "error": 0.2, "coefficients": {"qd": 1.0, "a": -9.0}, "std": {"qd": 5.0, "a": 1.0}},
            {"effect": "b", "error": 0.4, "coefficients": {"a": 1.0, "b": -9.0}, "std": {"a": 0.1, "b": 823.0}},
            {"effect": "c", "coefficients": {"c": 1.0}, "std": {"c": null}}]}));
        let unknown: Vec<bool> = steps.iter().map(|step| step.unknown).collect();
        assert_eq!(unknown, [false, false, true, true], "the model's own coefficients are not the step's");
        assert_eq!(steps[3], Step { effect: Some("c".into()), error: None, unknown: true });
        let errors: Vec<Option<f64>> = steps.iter().map(|step| step.error).collect();
        assert_eq!(rises(&errors), 1);
        assert_eq!((after_two(&steps), after_two(&steps[..2]), after_two(&[])), (Some(0.4), Some(0.2), None));
    }
}
