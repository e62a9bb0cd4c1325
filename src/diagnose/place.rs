//! Where along the motion a candidate removes error.

use super::errors::Left;
use super::locate::{Bounds, Over};
use crate::law::Units;

/// Share of what goes away that a third of the motion must hold to be worth saying.
const WORTH: f64 = 0.45;

/// A third of the motion, by speed or by excursion, and how much of what a candidate removes lies there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Removal {
    /// Share of the error energy that goes away.
    pub share: f64,
    /// Speed or excursion.
    pub over: Over,
    /// Bounds of it, in units of q̇ or of q.
    pub bounds: Bounds,
}

impl Removal {
    /// One plain sentence.
    pub fn sentence(&self, units: &Units) -> String {
        let share = 100.0 * self.share.min(1.0);
        format!("{share:.0} % of what it removes lies {}", self.bounds.text(self.over, units))
    }
}

/// Where a candidate removes error: the third of the motion, by speed or by displacement, that holds most of what goes away.
pub(super) fn place(before: &[Left], after: &[Left]) -> Option<Removal> {
    let removed: Vec<f64> = before.iter().zip(after).map(|(before, after)| before.squared - after.squared).collect();
    let total: f64 = removed.iter().sum();
    if total <= 0.0 || removed.len() < 12 {
        return None;
    }
    let mean = before.iter().map(|left| left.q).sum::<f64>() / before.len() as f64;
    let speeds: Vec<f64> = before.iter().map(|left| left.qd.abs()).collect();
    let excursions: Vec<f64> = before.iter().map(|left| (left.q - mean).abs()).collect();
    let thirds = [(&speeds, Over::Speed), (&excursions, Over::Excursion)].into_iter().flat_map(|(values, over)| {
        let mut sorted = values.clone();
        sorted.sort_by(f64::total_cmp);
        let (low, high) = (sorted[sorted.len() / 3], sorted[2 * sorted.len() / 3]);
        let removal = |bounds: Bounds, inside: &dyn Fn(f64) -> bool| {
            let held = values.iter().zip(&removed).filter(|(value, _)| inside(**value));
            Removal { share: held.map(|(_, removed)| removed).sum::<f64>() / total, over, bounds }
        };
        [
            removal(Bounds { lower: None, upper: Some(low) }, &|value| value < low),
            removal(Bounds { lower: Some(high), upper: None }, &|value| value > high),
        ]
    });
    thirds.max_by(|a, b| a.share.total_cmp(&b.share)).filter(|best| best.share > WORTH)
}
