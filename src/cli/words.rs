//! Numbers as text is given them: shares, chances, values with their std.

use crate::diagnose::Law;
pub(super) use crate::law::numerals::{digits, number, seconds};
use crate::law::{Catalogue, Expression, SiUnit, Term, Units, unit_of};
use std::fmt::Write;

/// `19 %`, `4.5 %`, `0.32 %`, `0.0021 %`.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        percent if percent >= 10.0 => format!("{percent:.0} %"),
        percent if percent >= 1.0 => format!("{percent:.1} %"),
        percent if percent >= 0.1 => format!("{percent:.2} %"),
        percent if percent >= 1e-4 => format!("{} %", digits(percent, 2)),
        0.0 => "0 %".into(),
        percent => format!("{percent:.1e} %"),
    }
}

/// A probability; below what a double holds, a bound.
pub(super) fn chance(probability: f64) -> String {
    match probability {
        p if p < 1e-300 => "< 1e-300".into(),
        p if p < 1e-2 => format!("{p:.1e}"),
        p => format!("{p:.2}"),
    }
}

/// An argument as a shell takes it.
pub(super) fn quoted(argument: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./:@=+,%^".contains(c);
    match !argument.is_empty() && argument.chars().all(is_plain) {
        true => argument.into(),
        false => format!("'{}'", argument.replace('\'', r"'\''")),
    }
}

/// `(20.35 ± 0.05) N`, `20.35 ± 0.05` where the unit is not known.
pub(super) fn quantity(value: f64, std: f64, unit: Option<String>) -> String {
    let number = number(value, std);
    match unit.filter(|unit| unit != "1") {
        None => number,
        Some(unit) if number.starts_with('(') || !number.contains('±') => format!("{number} {unit}"),
        Some(unit) => format!("({number}) {unit}"),
    }
}

/// `q 0.0100 m, qd 0.00995 m/s`: std of the sensors' noise by channel.
pub(super) fn noise(std: &[(impl AsRef<str>, f64)], units: &Units) -> String {
    let unit = |channel: &str| match channel {
        "q" => units.displacement(),
        "qd" => units.velocity(),
        _ => units.excitation(),
    };
    let one = |channel: &str, std: f64| match unit(channel).filter(|unit| unit.symbol != "1") {
        Some(unit) => format!("{channel} {} {}", digits(std, 3), unit.symbol),
        None => format!("{channel} {}", digits(std, 3)),
    };
    std.iter().map(|(channel, std)| one(channel.as_ref(), *std)).collect::<Vec<_>>().join(", ")
}

/// What stands behind an effect's coefficient: the catalogue's equation, the user's formula.
pub(super) fn effect_of(term: Term, law: &Law) -> String {
    match (term, Catalogue::of(term)) {
        (Term::Expression(own), _) => {
            law.expressions.get(own.place()).map_or_else(|| term.name(), |own| own.text().into())
        }
        (_, Some(entry)) => entry.equation.into(),
        _ => term.symbol(),
    }
}

/// `gap 0.21 m`: a term's inner parameters with their units, those of a formula without.
pub(super) fn inner(term: Term, own: &[Expression], units: &Units) -> Vec<String> {
    let described = term.effect().map_or(&[][..], |effect| effect.inner());
    let unit = |index: usize| described.get(index).and_then(|parameter| units.inner(parameter.unit));
    let named = term.inner_named(own).into_iter().enumerate();
    named.map(|(index, (name, value))| format!("{name} {}{}", digits(value, 4), spaced(unit(index)))).collect()
}

/// A unit with a space before it; nothing where there is none.
fn spaced(unit: Option<SiUnit>) -> String {
    unit.filter(|unit| unit.symbol != "1").map_or_else(String::new, |unit| format!(" {}", unit.symbol))
}

/// A law's terms with their coefficients, a line each, and what stands behind those with inner parameters.
pub(super) fn numbers(law: &Law, units: &Units) -> String {
    let mut text = String::new();
    for ((term, value), std) in law.terms.iter().zip(&law.coefficients).zip(&law.std) {
        let name = Catalogue::name_of(*term);
        let _ = writeln!(text, "  {name:<28} {:>30}", quantity(*value, *std, unit_of(*term, units)));
        text += &with_inner(*term, &law.expressions, units);
    }
    text
}

/// `    with gap 0.21 m` on a line of its own; empty where a term has no inner parameters.
pub(super) fn with_inner(term: Term, own: &[Expression], units: &Units) -> String {
    let inner = inner(term, own, units);
    if inner.is_empty() { String::new() } else { format!("    with {}\n", inner.join(", ")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_with_blanks_and_quotes_are_quoted() {
        assert_eq!(["a/b.csv@0:5", "run 3.csv", "q's"].map(quoted), ["a/b.csv@0:5", "'run 3.csv'", r"'q'\''s'"]);
    }

    #[test]
    fn units_belong_to_value_and_std() {
        let unit = |symbol: &str| Some(symbol.to_string());
        assert_eq!(quantity(20.3456, 0.0512, unit("N")), "(20.346 ± 0.051) N");
        assert_eq!(quantity(5.376e-6, 2.1e-9, unit("kg")), "(5.3760 ± 0.0021)e-6 kg");
        assert_eq!([quantity(95.0, 12.0, None), quantity(0.3, 0.0, unit("N s/m"))], ["95 ± 12", "0.3 N s/m"]);
    }

    #[test]
    fn shares_and_chances_are_short() {
        let shares = [0.19, 0.045, 0.0032, 2.1e-5, 2.1e-9, 0.0].map(percent);
        assert_eq!(shares, ["19 %", "4.5 %", "0.32 %", "0.0021 %", "2.1e-7 %", "0 %"]);
        assert_eq!([0.0, 3.2e-45, 0.25].map(chance), ["< 1e-300", "3.2e-45", "0.25"]);
    }
}
