//! e ÷ limit, and whether the stated std are honest.
//!
//! Normalised errors (θ − θ*)² ÷ std² of a coefficient over N seeds are χ² with N degrees of freedom: their mean must
//! lie in an interval that all coefficients of a case together leave once in a hundred times.

use super::Asked;
use super::recorded::{Library, Recorded, law, sensors};
use crate::Failure;
use switchid::identify::{Identifier, Sample, Settings};
use switchid::law::Term;
use switchid::limits::{Start, bound};
use switchid::simulate::Builtin;

/// Chance that any of the coefficients leaves its interval.
const FAMILY_WISE: f64 = 0.01;

const CASES: [(Builtin, f64, Library); 6] = [
    (Builtin::DuffingNoise, 0.01, Library::Given),
    (Builtin::DuffingNoise, 0.1, Library::Given),
    (Builtin::DuffingNoise, 0.1, Library::Maybe),
    (Builtin::VanDerPolNoise, 0.05, Library::Given),
    (Builtin::VanDerPolNoise, 0.05, Library::Fit),
    (Builtin::VanDerPolNoise, 0.05, Library::Maybe),
];

/// At the end of one record.
struct End {
    error: f64,
    limit: f64,
    /// (θ − θ*)² ÷ std² by term; none for a term that the law does not have.
    normalised: Vec<(Term, Option<f64>)>,
}

/// Prints the cases.
pub fn run(asked: &Asked) -> Result<(), Failure> {
    println!("| record | σ | terms | mean e | mean limit | ratio | (θ − θ*)² ÷ std², mean by term | allowed |");
    println!("|---|---|---|---|---|---|---|---|");
    for (builtin, noise, library) in CASES {
        let label = format!("{} | {noise} | {}", builtin.id(), library.id());
        if !asked.wants(&label) {
            continue;
        }
        let ends = asked.each(|seed| end(builtin, noise, library, seed))?;
        println!("| {label} | {} |", cells(&ends));
    }
    Ok(())
}

/// The limit is that of the terms which the law must have: with "maybe", the plant's own.
fn end(builtin: Builtin, noise: f64, library: Library, seed: u64) -> Result<End, Failure> {
    let scenario = builtin.random(seed).with_noise(noise);
    let recorded = Recorded::of(&scenario)?;
    let limited = if library == Library::Maybe { Library::Given } else { library };
    let limit_law = law(&limited.model(builtin), &scenario, 0)?;
    let course = recorded.course(0..recorded.readings.len());
    let limit = bound(&limit_law, &[course], sensors(&scenario), Start::Unknown)?;
    let model = library.model(builtin);
    let truth = law(&model, &scenario, 0)?;
    let mut identifier = Identifier::new(&model, Settings::default())?;
    for reading in &recorded.readings {
        identifier.step(Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation })?;
    }
    let found = identifier.coefficients();
    let errors = || found.iter().zip(truth.coefficients()).map(|(found, truth)| (found.value - truth).powi(2));
    let size: f64 = truth.coefficients().iter().map(|value| value * value).sum();
    let normalised = found.iter().zip(errors()).map(|(found, error)| {
        let std = found.std.filter(|std| *std > 0.0);
        (found.term, std.map(|std| error / (std * std)))
    });
    Ok(End {
        error: errors().sum::<f64>() / size,
        limit: limit.relative_error.ok_or("the record does not determine the law")?,
        normalised: normalised.collect(),
    })
}

fn cells(ends: &[End]) -> String {
    let mean = |value: fn(&End) -> f64| ends.iter().map(value).sum::<f64>() / ends.len().max(1) as f64;
    let (error, limit) = (mean(|end| end.error), mean(|end| end.limit));
    let means: Vec<(Term, f64, usize)> =
        (0..ends.first().map_or(0, |end| end.normalised.len())).map(|index| mean_square(ends, index)).collect();
    let seldom = ends.len() / 20;
    let kept = || means.iter().filter(|(.., count)| *count > seldom);
    let text: Vec<String> = kept().map(|(term, mean, _)| format!("{}: {mean:.2}", term.name())).collect();
    let [low, high] = interval(ends.len() as f64, FAMILY_WISE / kept().count().max(1) as f64);
    let ratio = error / limit;
    format!("{error:.2e} | {limit:.2e} | {ratio:.2} | {} | {low:.2} – {high:.2}", text.join(", "))
}

fn mean_square(ends: &[End], index: usize) -> (Term, f64, usize) {
    let squares: Vec<f64> = ends.iter().filter_map(|end| end.normalised[index].1).collect();
    (ends[0].normalised[index].0, squares.iter().sum::<f64>() / squares.len().max(1) as f64, squares.len())
}

/// Interval of χ²_N ÷ N that is left with this chance (Wilson and Hilferty, *PNAS* 17 (1931), 684).
fn interval(count: f64, chance: f64) -> [f64; 2] {
    let width = normal_quantile(0.5 * chance) * (2.0 / (9.0 * count)).sqrt();
    [-width, width].map(|width| (1.0 - 2.0 / (9.0 * count) + width).powi(3))
}

/// x with P(N > x) = chance (Abramowitz and Stegun, 26.2.23; within 4.5e-4).
fn normal_quantile(chance: f64) -> f64 {
    let t = (-2.0 * chance.ln()).sqrt();
    let above = 2.515517 + t * (0.802853 + t * 0.010328);
    t - above / (1.0 + t * (1.432788 + t * (0.189269 + t * 0.001308)))
}
