//! What `switchid identify` prints with Coulomb friction among the terms, beside the reference's coefficients.

use super::answer::list;
use super::binary::Binary;
use super::figure::Figure;
use super::reference::{Law, Record};
use super::score::agree;
use super::table::{self, fixed, short, table};
use crate::error::Error;
use serde::Serialize;
use serde_json::Value;

/// Std by which a coefficient may differ from the reference's.
const WITHIN: f64 = 3.0;

/// Std ÷ value below which a coefficient counts as told, where the reference's two window lengths agree.
const TOLD: f64 = 1.0 / 3.0;

/// A record's law.
#[derive(Debug, Serialize)]
pub struct Row {
    record: String,
    law: Option<String>,
    stages: usize,
    same_form: bool,
    coefficients: Vec<Coefficient>,
    crashed: bool,
    failure: Option<String>,
    seconds: f64,
}

/// A coefficient beside the reference's.
#[derive(Clone, Debug, PartialEq, Serialize)]
struct Coefficient {
    term: String,
    value: Option<f64>,
    std: Option<f64>,
    reference: Vec<f64>,
    /// |value − reference| ÷ std.
    distance: Option<f64>,
    /// Std ÷ |value|.
    relative_std: Option<f64>,
    /// Whether the reference's two window lengths agree, so that the record tells the coefficient.
    agree: Option<bool>,
}

/// Identifies the law with friction from a record, whose file is `data`; none where the reference has no such law.
///
/// # Errors
/// [`Error::Start`], [`Error::File`].
pub fn measure(binary: &Binary, record: &Record, data: &str) -> Result<Option<Row>, Error> {
    let Some(reference) = &record.law else { return Ok(None) };
    binary.write("friction.toml", &record.model_with_friction())?;
    let answer = binary.ask(&["identify", data, "--model", "friction.toml"])?;
    let (document, failure) = match answer.document {
        Ok(document) => (document, None),
        Err(failure) => (Value::Null, Some(failure)),
    };
    let stages = list(&document["stages"]);
    let stage = principal(&stages);
    Ok(Some(Row {
        record: record.name.clone(),
        law: stage["law"].as_str().map(String::from),
        stages: stages.len(),
        same_form: reference.same_form,
        coefficients: coefficients(stage, reference),
        crashed: failure.as_ref().is_some_and(|failure| failure.crashed),
        failure: failure.map(|failure| failure.text),
        seconds: answer.seconds,
    }))
}

/// The longest stage that has a law; the longest where none has.
fn principal(stages: &[Value]) -> &Value {
    let length =
        |stage: &Value| stage["end"].as_f64().zip(stage["start"].as_f64()).map_or(0.0, |(end, start)| end - start);
    let rank = |stage: &&Value| (stage["law"].is_string(), length(stage));
    let larger = |a: &&Value, b: &&Value| rank(a).partial_cmp(&rank(b)).unwrap_or(std::cmp::Ordering::Equal);
    stages.iter().max_by(larger).unwrap_or(&Value::Null)
}

fn coefficients(stage: &Value, reference: &Law) -> Vec<Coefficient> {
    let one = |(term, reference): (&String, &Vec<f64>)| {
        let [value, std] = ["coefficients", "std"].map(|key| stage[key][term.as_str()].as_f64());
        let target = reference.first().copied();
        Coefficient {
            term: term.clone(),
            distance: value.zip(std).zip(target).map(|((value, std), target)| (value - target).abs() / std),
            relative_std: value.zip(std).map(|(value, std)| std / value.abs()),
            agree: agree(reference),
            value,
            std,
            reference: reference.clone(),
        }
    };
    reference.coefficients.iter().map(one).collect()
}

impl Coefficient {
    /// Within [`WITHIN`] std of the reference, and told where the reference's window lengths agree; withheld where they
    /// do not.
    fn is_right(&self) -> bool {
        let withheld = self.value.is_none() && self.agree == Some(false);
        if withheld {
            return true;
        }
        let near = self.distance.is_some_and(|distance| distance <= WITHIN);
        let told = self.relative_std.is_some_and(|share| share < TOLD);
        near && (told || self.agree != Some(true))
    }

    fn cells(&self, row: &Row, is_first: bool) -> Vec<String> {
        let law = row.law.as_ref().or(row.failure.as_ref());
        let once = |text: String| if is_first { text } else { String::new() };
        vec![
            once(row.record.clone()),
            once(format!("{} ({})", table::text(law.map(String::as_str)), row.stages)),
            self.term.clone(),
            format!("{} ± {}", short(self.value), short(self.std)),
            self.reference.iter().map(|value| short(Some(*value))).collect::<Vec<_>>().join(", "),
            fixed(self.distance, 1),
            fixed(self.relative_std, 2),
            self.agree.map_or(table::NONE.into(), |agree| if agree { "yes" } else { "no" }.into()),
            if self.is_right() { "right" } else { "wrong" }.into(),
            once(fixed(Some(row.seconds), 2)),
        ]
    }
}

impl Row {
    /// Whether the program crashed.
    pub fn crashed(&self) -> bool {
        self.crashed
    }

    fn cells(&self) -> impl Iterator<Item = Vec<String>> {
        self.coefficients.iter().enumerate().map(|(index, coefficient)| coefficient.cells(self, index == 0))
    }
}

const HEADINGS: &str = "record | law (stages) | term | coefficient | reference at 0.3 T₀, 1 T₀ | differs by, std \
    | std ÷ value | reference agrees to a tenth | coefficient is | CPU, s";

/// The laws as a table.
pub fn text(rows: &[Row]) -> String {
    table(HEADINGS, &rows.iter().flat_map(Row::cells).collect::<Vec<_>>())
}

/// Laws printed, and coefficients that are right.
pub fn figures(rows: &[Row]) -> Vec<Figure> {
    let count = rows.len() as f64;
    let laws = rows.iter().filter(|row| row.law.is_some()).count() as f64;
    let same_form: Vec<&Row> = rows.iter().filter(|row| row.same_form).collect();
    let all: Vec<&Row> = rows.iter().collect();
    vec![
        Figure::at_least(&format!("identify: laws printed, of {count}"), Some(laws), count, count),
        Figure::at_least("identify: share of coefficients right", share(&all), 0.9, 1.0),
        Figure::shown("identify: the same where the reference's law has the same form", share(&same_form)),
    ]
}

fn share(rows: &[&Row]) -> Option<f64> {
    let all: Vec<&Coefficient> = rows.iter().flat_map(|row| &row.coefficients).collect();
    let right = all.iter().filter(|coefficient| coefficient.is_right()).count();
    (!all.is_empty()).then(|| right as f64 / all.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::collections::BTreeMap;

    fn one(value: f64, std: f64, reference: &[f64]) -> Coefficient {
        let law = Law { same_form: true, coefficients: BTreeMap::from([("qd".to_string(), reference.to_vec())]) };
        let stage = json!({"coefficients": {"qd": value}, "std": {"qd": std}});
        coefficients(&stage, &law).remove(0)
    }

    #[test]
    fn a_coefficient_is_near_and_told() {
        assert!(one(200.0, 4.0, &[195.0, 193.0]).is_right());
        assert!(!one(220.0, 4.0, &[195.0, 193.0]).is_right(), "six std away");
        assert!(!one(220.0, 100.0, &[195.0, 193.0]).is_right(), "not told, though the record tells it");
        assert!(one(-0.02, 0.03, &[-0.011, -0.016]).is_right(), "the record does not tell it");
        assert!(one(60.0, 30.0, &[65.3]).is_right());
    }

    #[test]
    fn a_coefficient_that_is_not_printed_is_wrong() {
        let law = Law { same_form: true, coefficients: BTreeMap::from([("qd".to_string(), vec![1.0])]) };
        let absent = coefficients(&Value::Null, &law);
        assert!(!absent[0].is_right() && absent[0].distance.is_none());
    }

    #[test]
    fn a_coefficient_may_be_withheld_that_the_reference_does_not_agree_on_itself() {
        let law =
            |reference: &[f64]| Law { same_form: true, coefficients: [("qd".to_string(), reference.to_vec())].into() };
        assert!(coefficients(&Value::Null, &law(&[-0.011, -0.016]))[0].is_right());
        assert!(!coefficients(&Value::Null, &law(&[195.0, 193.0]))[0].is_right());
    }

    #[test]
    fn the_longest_stage_with_a_law_speaks() {
        let stages = [
            json!({"start": 0.0, "end": 1.0, "law": "a"}),
            json!({"start": 1.0, "end": 3.0, "law": "b"}),
            json!({"start": 3.0, "end": 9.0, "law": null}),
        ];
        assert_eq!(principal(&stages)["law"], "b");
        assert_eq!(principal(&stages[2..])["end"], 9.0);
        assert!(principal(&[]).is_null());
    }
}
