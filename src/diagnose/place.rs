//! Where along the motion a candidate removes error.

use super::errors::Left;

/// Where a candidate removes error: the third of the motion, by speed or by displacement, that holds most of what goes away.
pub(super) fn place(before: &[Left], after: &[Left]) -> Option<String> {
    let removed: Vec<f64> = before.iter().zip(after).map(|(before, after)| before.squared - after.squared).collect();
    let total: f64 = removed.iter().sum();
    if total <= 0.0 || removed.len() < 12 {
        return None;
    }
    let mean = before.iter().map(|left| left.q).sum::<f64>() / before.len() as f64;
    let speeds: Vec<f64> = before.iter().map(|left| left.qd.abs()).collect();
    let excursions: Vec<f64> = before.iter().map(|left| (left.q - mean).abs()).collect();
    let thirds = [(&speeds, "|q̇|"), (&excursions, "|q − mean|")].into_iter().flat_map(|(values, symbol)| {
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        let (low, high) = (sorted[sorted.len() / 3], sorted[2 * sorted.len() / 3]);
        let share = |inside: &dyn Fn(f64) -> bool| {
            let held = values.iter().zip(&removed).filter(|(value, _)| inside(**value));
            held.map(|(_, removed)| removed).sum::<f64>() / total
        };
        [
            (share(&|value| value < low), format!("where {symbol} < {low:.3}")),
            (share(&|value| value > high), format!("where {symbol} > {high:.3}")),
        ]
    });
    let best = thirds.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 > 0.45).then(|| format!("{:.0} % of what it removes lies {}", 100.0 * best.0.min(1.0), best.1))
}
