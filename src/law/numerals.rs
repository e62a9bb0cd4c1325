//! Numbers as every message gives them: as many digits as they deserve, without exponents where they are of everyday
//! size.

/// Most decimals that a value is given: what is left of 16 digits for a value of some thousands.
const MOST: i32 = 12;

/// Characters of a number that is told as it is given.
const SHORT: usize = 8;

/// A number that no std comes with: so many significant digits.
pub(crate) fn digits(value: f64, count: usize) -> String {
    let text = format!("{value:.*e}", count - 1);
    let exponent = text.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()).unwrap_or(0);
    match (-6..6).contains(&exponent) {
        true => format!("{value:.*}", (count as i32 - 1 - exponent).max(0) as usize),
        false => text,
    }
}

/// A time without the digits that only its binary form has, s.
pub(crate) fn seconds(t: f64) -> String {
    let text = format!("{t:.9}");
    text.trim_end_matches('0').trim_end_matches('.').into()
}

/// `20.35 ± 0.05`: as many digits as the std supports, two of its own. A number that is held has no std.
pub(crate) fn number(value: f64, std: f64) -> String {
    if std <= 0.0 || !std.is_finite() {
        let text = value.to_string();
        return if text.len() <= SHORT { text } else { digits(value, 6) };
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
            (0.0, 0.012, "0.000 ± 0.012"),
            (0.3, 0.0, "0.3"),
        ] {
            assert_eq!(number(value, std), text);
        }
    }

    #[test]
    fn numbers_without_a_std_have_the_digits_asked_for() {
        let told = [0.01, 0.009996, -1234.5, 0.0, 1.5e-9].map(|value| digits(value, 3));
        assert_eq!(told, ["0.0100", "0.0100", "-1234", "0.00", "1.50e-9"]);
        assert_eq!([29.997999999999593, 0.0, -5.0, 120.0].map(seconds), ["29.998", "0", "-5", "120"]);
    }
}
