//! Figures over many seeds: means, medians, quantiles, and how they are written.

/// Arithmetic mean; `None` of nothing.
pub fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// The smallest value that at least `share` of all values do not exceed; `None` of nothing.
pub fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rank = (share * sorted.len() as f64).ceil().max(1.0) as usize;
    sorted.get(rank - 1).copied()
}

/// The middle value; `None` of nothing.
pub fn median(values: &[f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// Median of delays of which some never end: `None` where at least half of them do not, or where there are none.
pub fn median_delay(delays: &[Option<f64>]) -> Option<f64> {
    delay_quantile(delays, 0.5)
}

/// The longest of all delays; `None` where one never ends, or where there are none.
pub fn longest_delay(delays: &[Option<f64>]) -> Option<f64> {
    delay_quantile(delays, 1.0)
}

fn delay_quantile(delays: &[Option<f64>], share: f64) -> Option<f64> {
    let all: Vec<f64> = delays.iter().map(|delay| delay.unwrap_or(f64::INFINITY)).collect();
    quantile(&all, share).filter(|delay| delay.is_finite())
}

/// Share of the values for which something holds; 0 of nothing.
pub fn share<T>(values: &[T], holds: impl Fn(&T) -> bool) -> f64 {
    values.iter().filter(|value| holds(value)).count() as f64 / values.len().max(1) as f64
}

/// Whether every value is below the one before it.
pub fn falls(values: &[f64]) -> bool {
    values.windows(2).all(|pair| pair[1] < pair[0])
}

/// A small number: `2.8e-5`; a dash for none.
pub fn small(value: impl Into<Option<f64>>) -> String {
    match value.into() {
        None => "–".into(),
        Some(0.0) => "0".into(),
        Some(value) => format!("{value:.1e}"),
    }
}

/// Seconds to the millisecond; a dash for never.
pub fn seconds(value: impl Into<Option<f64>>) -> String {
    value.into().map_or("–".into(), |value| format!("{value:.3}"))
}

/// A share in per cent.
pub fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// A factor: `1.35`, `12`, `4.0e4`; a dash for none.
pub fn factor(value: impl Into<Option<f64>>) -> String {
    match value.into() {
        None => "–".into(),
        Some(value) if value >= 1e3 => format!("{value:.1e}"),
        Some(value) if value >= 10.0 => format!("{value:.0}"),
        Some(value) => format!("{value:.2}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_count_from_below() {
        let values = [5.0, 1.0, 4.0, 2.0, 3.0];
        assert_eq!([0.0, 0.2, 0.5, 0.9, 1.0].map(|share| quantile(&values, share).unwrap()), [1.0, 1.0, 3.0, 5.0, 5.0]);
        assert_eq!((median(&[]), mean(&[]), mean(&values)), (None, None, Some(3.0)));
    }

    #[test]
    fn what_never_ends_counts_as_longest() {
        let delays = [Some(2.0), None, Some(1.0)];
        assert_eq!((median_delay(&delays), longest_delay(&delays)), (Some(2.0), None));
        assert_eq!(median_delay(&[None, None, Some(1.0)]), None);
        assert_eq!(longest_delay(&delays[2..]), Some(1.0));
    }

    #[test]
    fn shares_and_falls() {
        assert_eq!(share(&[1, 2, 3, 4], |value| *value > 3), 0.25);
        assert_eq!(share(&[0; 0], |_| true), 0.0);
        assert!(falls(&[3.0, 2.0, 1.0]) && !falls(&[3.0, 2.0, 2.0]));
    }
}
