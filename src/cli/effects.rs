//! `switchid effects`: the catalogue.

use super::error::CommandError;
use super::output;
use crate::law::{Catalogue, Entry, InnerUnit, Sign};
use clap::Args;
use serde::Serialize;
use std::fmt::Write;

const EXAMPLE: &str = r#"Examples:
  switchid effects
  switchid effects coulomb_friction
  switchid effects --json

In a model an effect stands under [terms] by its id, with "fit", "maybe" or a number; one with inner parameters also as
  stribeck_friction = { coefficient = "fit", speed = 0.05 }
Effects of your own are formulas in q, qd, F and t under [effects], named in [terms] or tried by `switchid diagnose`:
  [terms]
  tip_drag = { coefficient = "fit", v = 0.1 }   # v: where the search for it begins
  [effects.tip_drag]
  expression = "abs(qd/v)^0.5*qd""#;

/// List the catalogue of physical effects
#[derive(Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Arguments {
    /// One effect, with all that is known of it
    effect: Option<String>,
    /// Print one JSON document instead of text
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    effects: Vec<EffectReport>,
}

#[derive(Serialize)]
struct EffectReport {
    id: &'static str,
    equation: &'static str,
    inner: Vec<InnerReport>,
    /// Of the coefficient, for q in m and F in N; null where that is not known.
    unit: Option<String>,
    /// `positive` or `any`.
    sign: &'static str,
    residual: &'static str,
    reason: &'static str,
    reference: &'static str,
    look_alikes: &'static [&'static str],
}

#[derive(Serialize)]
struct InnerReport {
    name: &'static str,
    unit: &'static str,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), CommandError> {
    let asked = |entry: &&Entry| arguments.effect.as_ref().is_none_or(|effect| effect == entry.id);
    let entries: Vec<&Entry> = Catalogue::ENTRIES.iter().filter(asked).collect();
    if let (Some(effect), true) = (&arguments.effect, entries.is_empty()) {
        return Err(super::add::unknown(effect, &[]));
    }
    match (arguments.json, &entries[..]) {
        (true, _) => output::print_json(&Report { effects: entries.into_iter().map(report).collect() }),
        (false, [entry]) if arguments.effect.is_some() => output::print(&described(entry)),
        _ => output::print(&table(&entries)),
    }
}

fn report(entry: &Entry) -> EffectReport {
    EffectReport {
        id: entry.id,
        equation: entry.equation,
        inner: inner(entry),
        unit: unit(entry),
        sign: sign(entry),
        residual: entry.residual,
        reason: entry.reason,
        reference: entry.reference,
        look_alikes: entry.look_alikes,
    }
}

fn inner(entry: &Entry) -> Vec<InnerReport> {
    let unit = |unit: InnerUnit| match unit {
        InnerUnit::Coordinate => "of q",
        InnerUnit::Velocity => "of q̇",
        InnerUnit::Time => "s",
        InnerUnit::AngularFrequency => "rad/s",
        InnerUnit::WaveNumber => "1/of q",
        InnerUnit::Number => "1",
    };
    entry.inner().iter().map(|inner| InnerReport { name: inner.name, unit: unit(inner.unit) }).collect()
}

/// The coefficient's unit where q is in m and F in N.
fn unit(entry: &Entry) -> Option<String> {
    use crate::law::{Quantity, Units};
    let units = Units::forced(Some(Quantity::Length), Some(Quantity::Speed), Some(Quantity::Force));
    units.coefficient(entry.term).map(|unit| unit.symbol)
}

fn sign(entry: &Entry) -> &'static str {
    match entry.sign {
        Sign::Positive => "positive",
        Sign::Any => "any",
    }
}

fn table(entries: &[&Entry]) -> String {
    let mut text =
        format!("{:<30} {:<34} {:<10} {:<10} inner parameters\n", "effect", "on the left-hand side", "unit", "sign");
    for entry in entries {
        let inner: Vec<&str> = entry.inner().iter().map(|inner| inner.name).collect();
        let unit = unit(entry).unwrap_or_default();
        let line =
            format!("{:<30} {:<34} {unit:<10} {:<10} {}", entry.id, entry.equation, sign(entry), inner.join(", "));
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text + "\nunits where q is in m and F in N; `switchid effects ID` says what one looks like\n"
}

fn described(entry: &Entry) -> String {
    let mut text = format!("{}: {}\n{}\n{}\n", entry.id, entry.equation, entry.reason, entry.residual);
    let _ = writeln!(text, "sign of the coefficient: {}; unit: {}", sign(entry), unit(entry).unwrap_or("–".into()));
    for inner in inner(entry) {
        let _ = writeln!(text, "inner parameter {}, in units {}", inner.name, inner.unit);
    }
    if !entry.look_alikes.is_empty() {
        let _ = writeln!(text, "easily taken for: {}", entry.look_alikes.join(", "));
    }
    text + entry.reference + "\n"
}
