//! What the lines above a table say of its sampling: `Sample rate: 1000 Hz`, `dt = 0.001 s`.

use super::dialect::{Dialect, lines};
use super::number::number;
use crate::law::{Quantity, Unit};

/// Words for samples per second.
const RATES: [&str; 9] = [
    "sample rate",
    "sampling rate",
    "samplerate",
    "sampling frequency",
    "sample frequency",
    "abtastrate",
    "abtastfrequenz",
    "fs",
    "rate",
];

/// Words for the distance of two samples.
const STEPS: [&str; 10] = [
    "sample time",
    "sampling time",
    "sample interval",
    "sampling interval",
    "sample period",
    "abtastzeit",
    "delta_x",
    "delta t",
    "dt",
    "ts",
];

/// The distance of two samples that the preamble names, s.
pub(super) fn rate(text: &str, dialect: &Dialect) -> Option<f64> {
    let end = dialect.header.unwrap_or(dialect.first);
    let above = lines(text).take_while(|line| line.number < end);
    above.filter_map(|line| step(line.text, dialect)).next()
}

fn step(line: &str, dialect: &Dialect) -> Option<f64> {
    let line = line.trim().trim_start_matches(['#', '%', '!', '/']).trim();
    let lower = line.to_lowercase();
    let is_rate = RATES.iter().find(|word| names(&lower, word)).map(|word| (word, true));
    let (word, is_rate) =
        is_rate.or_else(|| STEPS.iter().find(|word| names(&lower, word)).map(|word| (word, false)))?;
    let rest = line.get(word.len()..)?;
    let bracket = rest.split(['[', '(']).nth(1).and_then(|rest| rest.split([']', ')']).next());
    let value = |text: &str| number(text, dialect.decimal).filter(|value| *value > 0.0 && value.is_finite());
    let mut words =
        rest.split(|c: char| c.is_whitespace() || matches!(c, ':' | '=' | ';' | '\t' | '[' | ']' | '(' | ')'));
    let (found, unit) = (words.by_ref().find_map(value)?, words.find(|word| !word.is_empty()).or(bracket));
    match is_rate {
        true => Some(1.0 / (found * hertz(unit.unwrap_or("Hz"))?)),
        false => Some(found * seconds(unit.unwrap_or("s"))?),
    }
}

/// Whether a line begins with that word.
fn names(line: &str, word: &str) -> bool {
    line.strip_prefix(word).is_some_and(|rest| !rest.starts_with(char::is_alphanumeric))
}

/// Hertz of a unit of frequency.
pub(super) fn hertz(unit: &str) -> Option<f64> {
    match unit.to_lowercase().as_str() {
        "hz" | "s/s" | "1/s" | "sps" => Some(1.0),
        "khz" | "ks/s" | "ksps" => Some(1e3),
        "mhz" | "ms/s" => Some(1e6),
        _ => None,
    }
}

/// Seconds of a unit of time.
pub(super) fn seconds(unit: &str) -> Option<f64> {
    let unit = if unit == "sec" { "s" } else { unit };
    Unit::parse(unit).filter(|unit| unit.quantity == Quantity::Time).map(|unit| unit.factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preamble_tells_the_rate() {
        let of =
            |line: &str| rate(&format!("{line}\nq;F\n1,5;2\n2,5;3\n"), &Dialect::of("q;F\n1,5;2\n2,5;3\n").unwrap());
        for (line, step) in [
            ("Sample rate: 1000 Hz", 1e-3),
            ("# fs = 2 kHz", 5e-4),
            ("Abtastrate [Hz];500", 2e-3),
            ("dt=0,001", 1e-3),
            ("Sampling interval: 5 ms", 5e-3),
        ] {
            let dialect = Dialect { header: Some(2), ..Dialect::of("q;F\n1,5;2\n2,5;3\n").unwrap() };
            let found = rate(&format!("{line}\nq;F\n1,5;2\n2,5;3\n"), &dialect).unwrap();
            assert!((found - step).abs() < 1e-12, "{line}: {found}");
        }
        assert_eq!(of("Operator: fs"), None);
    }
}
