//! The JSON of `switchid diagnose`, read tolerantly: what a build does not say is none.

use serde_json::Value;

/// What is read of a diagnosis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnosis {
    /// `missing`, `adequate` or `unexplained`.
    pub verdict: String,
    /// The effect named.
    pub effect: Option<String>,
    /// The stated tie in which it stands; empty where it stands alone.
    pub tie: Vec<String>,
    /// Held-out errors without and with the effect named, over windows of 0.1, 0.3 and 1 T₀.
    pub before: [Option<f64>; 3],
    /// With it.
    pub after: [Option<f64>; 3],
    /// Coefficient of the effect named, and its std.
    pub coefficient: Option<[f64; 2]>,
    /// Its chance.
    pub p_value: Option<f64>,
    /// Share of the error energy that the answer takes away.
    pub explained: Option<f64>,
    /// What remains, in words.
    pub left: Option<String>,
    /// T₀, s.
    pub period: Option<f64>,
    /// Delays of F and q̇, in words.
    pub timing: Option<String>,
}

/// Position of the windows of 0.3 T₀ among the three lengths.
pub const MIDDLE: usize = 1;

impl Diagnosis {
    /// Reads the document.
    pub fn read(document: &Value) -> Diagnosis {
        let effect = document["effect"].as_str().map(String::from);
        let candidates = list(&document["candidates"]);
        let named = candidates.iter().find(|one| effect.is_some() && one["effect"].as_str() == effect.as_deref());
        let first = named.or(candidates.first());
        let errors = |key: &str, one: Option<&Value>| errors(document, one, key);
        let number = |key: &str| named.and_then(|one| one[key].as_f64());
        Diagnosis {
            verdict: document["verdict"].as_str().unwrap_or_default().into(),
            tie: tie(document, effect.as_deref()),
            before: errors("before", first),
            after: named.map_or([None; 3], |named| errors("after", Some(named))),
            coefficient: number("coefficient").zip(number("std")).map(|(value, std)| [value, std]),
            p_value: number("p_value"),
            explained: document["explained"].as_f64(),
            left: document["left"].as_str().map(String::from),
            period: document["period"].as_f64(),
            timing: timing(&document["timing"]),
            effect,
        }
    }
}

/// The errors of the three window lengths: the document's `errors[]`, the candidate's own, or that at 0.3 T₀ alone.
fn errors(document: &Value, candidate: Option<&Value>, key: &str) -> [Option<f64>; 3] {
    let own = candidate.map_or(&Value::Null, |candidate| &candidate["errors"]);
    let mut rows = [&document["errors"], own].into_iter().map(list).find(|rows| rows.len() == 3).unwrap_or_default();
    rows.sort_by(|a, b| f64::total_cmp(&length(a), &length(b)));
    match <[Value; 3]>::try_from(rows) {
        Ok(rows) => rows.map(|row| row[key].as_f64()),
        Err(_) => [None, candidate.and_then(|candidate| candidate[format!("error_{key}")].as_f64()), None],
    }
}

fn length(row: &Value) -> f64 {
    row["window"].as_f64().unwrap_or(f64::INFINITY)
}

/// The group of indistinguishable effects that holds the one named, or the first group where none is named.
fn tie(document: &Value, effect: Option<&str>) -> Vec<String> {
    let groups: Vec<Vec<String>> = list(&document["indistinguishable"]).iter().map(names).collect();
    let holds = |group: &Vec<String>| effect.is_none_or(|effect| group.iter().any(|id| id == effect));
    groups.into_iter().find(holds).unwrap_or_default()
}

/// The elements of an array; none where there is no array.
pub fn list(value: &Value) -> Vec<Value> {
    value.as_array().cloned().unwrap_or_default()
}

fn names(group: &Value) -> Vec<String> {
    list(group).iter().filter_map(|id| id.as_str().map(String::from)).collect()
}

/// `F 7.0 ms, qd 0.5 ms`: a delay is a number, or a value beside its std.
fn timing(timing: &Value) -> Option<String> {
    let value = |key: &str| {
        let entry = &timing[key];
        let parts = [entry, &entry["value"], &entry["delay"], &entry[0]];
        parts.into_iter().find_map(Value::as_f64)
    };
    let delay = |channel: &str| Some(format!("{channel} {:.2} ms", 1e3 * value(&format!("{channel}_delay"))?));
    let delays: Vec<String> = ["F", "qd"].into_iter().filter_map(delay).collect();
    (!delays.is_empty()).then(|| delays.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn all_keys_are_read() {
        let read = Diagnosis::read(&json!({
            "verdict": "missing", "effect": "b", "explained": 0.78, "left": "4 % faster than 20 Hz", "period": 2.0,
            "candidates": [{"effect": "b", "coefficient": 2.0, "std": 0.5, "p_value": null}],
            "indistinguishable": [["x", "y"], ["b", "c"]],
            "errors": [
                {"window": 2.0, "before": 0.3, "after": 0.03}, {"window": 0.2, "before": 0.1, "after": 0.01},
                {"window": 0.6, "before": 0.2, "after": 0.02}],
            "timing": {"F_delay": {"value": 0.007, "std": 0.001}, "qd_delay": 0.0005}
        }));
        assert_eq!((read.effect.as_deref(), read.tie.join(" ")), (Some("b"), "b c".into()));
        assert_eq!(read.before, [Some(0.1), Some(0.2), Some(0.3)], "sorted by the windows' length");
        assert_eq!(read.after, [Some(0.01), Some(0.02), Some(0.03)]);
        assert_eq!((read.coefficient, read.p_value), (Some([2.0, 0.5]), None));
        assert_eq!(read.timing.as_deref(), Some("F 7.00 ms, qd 0.50 ms"));
        assert_eq!((read.explained, read.period), (Some(0.78), Some(2.0)));
    }

    #[test]
    fn what_a_build_does_not_say_is_none() {
        let candidates = json!([{"effect": "a", "error_before": 0.3, "error_after": 0.2}]);
        let read = Diagnosis::read(&json!({"verdict": "unexplained", "effect": null, "candidates": candidates}));
        assert_eq!(read.before, [None, Some(0.3), None]);
        assert_eq!(read.after, [None; 3], "nothing is named");
        assert_eq!((read.tie.len(), read.timing, read.left), (0, None, None));
        let named = Diagnosis::read(&json!({"verdict": "missing", "effect": "a", "candidates": candidates}));
        assert_eq!(named.after[MIDDLE], Some(0.2));
    }
}
