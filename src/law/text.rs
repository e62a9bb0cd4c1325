//! A law on one line, as an engineer writes it.

use super::term::Term;

/// Writes `1.000 q̈ + 0.300 q̇ + 4.00 q + 2.00 q³ = F`; coefficients have as many digits as their std supports, 2
/// significant ones at least. Terms whose coefficient is 0 are left out; `forced` puts `F` on the right, else 0.
pub fn equation(terms: &[(Term, f64, Option<f64>)], forced: bool) -> String {
    let mut line = String::new();
    let (inertia, others): (Vec<_>, Vec<_>) =
        terms.iter().filter(|(_, value, _)| *value != 0.0).partition(|(term, ..)| *term == Term::Inertia);
    for &(term, value, std) in inertia.into_iter().chain(others) {
        let sign = if value < 0.0 { "− " } else { "+ " };
        if !line.is_empty() {
            line.push(' ');
            line.push_str(sign);
        } else if value < 0.0 {
            line.push('−');
        }
        line.push_str(&significant(value.abs(), std));
        let symbol = term.symbol();
        if !symbol.is_empty() {
            line.push(' ');
            line.push_str(&symbol);
        }
    }
    if line.is_empty() {
        line.push('0');
    }
    line.push_str(if forced { " = F" } else { " = 0" });
    line
}

/// `value` ≥ 0 with 2 to 6 significant digits, down to the second one of its std where that is known.
fn significant(value: f64, std: Option<f64>) -> String {
    let digits = match std {
        Some(std) if std > 0.0 && value > 0.0 => {
            let [value, std] = [value, std].map(|number| number.log10().floor() as i32);
            (value - std + 2).clamp(2, 6)
        }
        _ => 4,
    };
    let exponent = if value > 0.0 { value.log10().floor() as i32 } else { 0 };
    if (-4..7).contains(&exponent) {
        let decimals = (digits - 1 - exponent).max(0) as usize;
        format!("{value:.decimals$}")
    } else {
        let decimals = (digits - 1).max(0) as usize;
        format!("{value:.decimals$e}")
    }
}
