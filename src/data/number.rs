//! Numbers as instruments write them.

/// What stands before the decimals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Decimal {
    Point,
    Comma,
}

/// The number of a cell; none where it is no number. `nan` and `inf` are numbers that are not finite.
pub(super) fn number(text: &str, decimal: Decimal) -> Option<f64> {
    match decimal {
        Decimal::Point => plain(text),
        Decimal::Comma if text.contains(',') => plain(&without_groups(text)?.replacen(',', ".", 1)),
        Decimal::Comma if text.contains('.') => None,
        Decimal::Comma => plain(text),
    }
}

/// `1.234,5` is 1234,5: points stand between groups of three.
fn without_groups(text: &str) -> Option<String> {
    let (whole, decimals) = text.split_once(',')?;
    let mut groups = whole.split('.').skip(1);
    let grouped = groups.all(|group| group.len() == 3) && !decimals.contains('.');
    grouped.then(|| text.replace('.', ""))
}

fn plain(text: &str) -> Option<f64> {
    text.parse().ok().or_else(|| unusual(text))
}

/// Fortran's `1.0D+02`, a typographic minus, and the `0.5 sec` of MATLAB's durations.
fn unusual(text: &str) -> Option<f64> {
    if let Some(seconds) = text.strip_suffix(" sec") {
        return seconds.parse().ok();
    }
    let usual = text.replace('−', "-").replace(['D', 'd'], "e");
    if usual == text { None } else { usual.parse().ok() }
}

#[cfg(test)]
mod tests {
    use super::{Decimal::*, number};

    #[test]
    fn numbers_are_read_with_either_mark() {
        assert_eq!(number("-1.5e-3", Point), Some(-1.5e-3));
        assert_eq!(number("1,5", Comma), Some(1.5));
        assert_eq!(number("-1.234,5E+2", Comma), Some(-123450.0));
        assert_eq!(number("1.0D+02", Point), Some(100.0));
        assert_eq!(number("−2", Comma), Some(-2.0));
        assert_eq!([number("0.5 sec", Point), number("0,5 sec", Comma)], [Some(0.5), Some(0.5)]);
        for (text, decimal) in [("1,5", Point), ("1.5", Comma), ("1.23,5", Comma), ("1,5,2", Comma), ("", Point)] {
            assert_eq!(number(text, decimal), None, "{text}");
        }
    }
}
