//! Numbers as text is given them: shares, chances, values with their std.

use crate::diagnose::Law;
use crate::law::{Catalogue, Term};

/// Most decimals that a value is given: what is left of 16 digits for a value of some thousands.
const MOST: i32 = 12;

/// `19 %`, `4.5 %`, `0.32 %`, `2.1e-3 %`.
pub(super) fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        percent if percent >= 10.0 => format!("{percent:.0} %"),
        percent if percent >= 1.0 => format!("{percent:.1} %"),
        percent if percent >= 0.1 => format!("{percent:.2} %"),
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

/// `20.35 ± 0.05`: as many digits as the std supports, two of its own.
pub(super) fn number(value: f64, std: f64) -> String {
    if std <= 0.0 || !std.is_finite() || value == 0.0 {
        return format!("{value:.4e}");
    }
    let last = std.log10().floor() as i32 - 1;
    let exponent = value.abs().max(std).log10().floor() as i32;
    if (-4..6).contains(&exponent) && last > -9 {
        let decimals = (-last).max(0) as usize;
        return format!("{value:.decimals$} ± {std:.decimals$}");
    }
    if exponent - last > MOST {
        let most = MOST as usize;
        return format!("{value:.most$e} ± {std:.1e}");
    }
    let decimals = (exponent - last).max(0) as usize;
    let scale = 10f64.powi(exponent);
    format!("({:.decimals$} ± {:.decimals$})e{exponent}", value / scale, std / scale)
}

/// What stands behind an effect's coefficient: the catalogue's equation, the user's formula.
pub(super) fn effect_of(term: Term, law: &Law) -> String {
    match (term, Catalogue::of(term)) {
        (Term::Expression(index), _) => {
            law.expressions.get(usize::from(index)).map_or_else(|| term.name(), |own| own.text().into())
        }
        (_, Some(entry)) => entry.equation.into(),
        _ => term.symbol(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_have_the_digits_of_their_std() {
        for (value, std, text) in [
            (20.3456, 0.0512, "20.346 ± 0.051"),
            (-3.93, 0.4, "-3.93 ± 0.40"),
            (95.0, 12.0, "95 ± 12"),
            (5.376e-6, 2.1e-9, "(5.3760 ± 0.0021)e-6"),
            (1.5e9, 2e7, "(1.500 ± 0.020)e9"),
            (0.8477312848794, 3.1e-16, "8.477312848794e-1 ± 3.1e-16"),
        ] {
            assert_eq!(number(value, std), text);
        }
    }

    #[test]
    fn shares_and_chances_are_short() {
        assert_eq!([0.19, 0.045, 0.0032, 2.1e-5, 0.0].map(percent), ["19 %", "4.5 %", "0.32 %", "2.1e-3 %", "0 %"]);
        assert_eq!([0.0, 3.2e-45, 0.25].map(chance), ["< 1e-300", "3.2e-45", "0.25"]);
    }
}
