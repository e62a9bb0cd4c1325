//! Tables as the documents have them, and numbers in them.

/// What stands for a number that is not there.
pub const NONE: &str = "–";

/// A table: headings separated by "|", rows of as many cells.
pub fn table(headings: &str, rows: &[Vec<String>]) -> String {
    let count = headings.split('|').count();
    let head = format!("| {} |\n|{}\n", headings, "---|".repeat(count));
    rows.iter().fold(head, |text, row| text + &format!("| {} |\n", row.join(" | ")))
}

/// A number with that many digits behind the point.
pub fn fixed(value: Option<f64>, digits: usize) -> String {
    value.map_or(NONE.into(), |value| format!("{value:.digits$}"))
}

/// A number of three digits.
pub fn short(value: Option<f64>) -> String {
    let text = |value: f64| match value.abs() {
        size if size == 0.0 || (1e-3..1e4).contains(&size) => {
            let digits = if size >= 100.0 { 0 } else { (2 - size.max(1e-3).log10().floor() as i32).max(0) as usize };
            format!("{value:.digits$}")
        }
        _ => format!("{value:.2e}"),
    };
    value.map_or(NONE.into(), text)
}

/// Several numbers: `.197/.199/.220`.
pub fn several(values: &[Option<f64>]) -> String {
    values.iter().map(|value| fixed(*value, 3)).collect::<Vec<_>>().join("/")
}

/// A text, or the dash.
pub fn text(value: Option<&str>) -> String {
    value.unwrap_or(NONE).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_three_digits() {
        let shown = [93.6, 0.0447, 195.0, 2.151e-6, -9.0, 123456.0, 0.5].map(|value| short(Some(value)));
        assert_eq!(shown, ["93.6", "0.0447", "195", "2.15e-6", "-9.00", "1.23e5", "0.500"]);
        assert_eq!((short(None), several(&[Some(0.5), None])), ("–".into(), "0.500/–".into()));
    }

    #[test]
    fn a_table_has_as_many_rules_as_headings() {
        let text = table("a | b", &[vec!["1".into(), "2".into()]]);
        assert_eq!(text, "| a | b |\n|---|---|\n| 1 | 2 |\n");
    }
}
