//! Where a law fails most, as shaded stretches of a figure's panels.

use super::words::percent;
use crate::diagnose::{Bounds, Fail, Over, Place, Side};
use crate::report::Layer;

/// Places of failure that are told and shaded.
pub(super) const MARKED: usize = 3;

/// What a panel is laid out along.
pub(super) enum Along {
    Time,
    Velocity,
    Displacement,
    /// With the frequencies that it shows, Hz.
    Frequency(Vec<f64>),
}

impl Along {
    /// The bounds of a failure in this panel, and whether they hold for the distance from the middle, to both sides.
    fn bounds(&self, fail: &Fail) -> Option<(Bounds, bool)> {
        match (self, fail.over) {
            (Along::Time, Over::Time) | (Along::Frequency(_), Over::Frequency) => Some((fail.bounds, false)),
            (Along::Velocity, Over::Velocity) => Some((fail.bounds, false)),
            (Along::Displacement, Over::Displacement | Over::PhasePlane) => Some((fail.bounds, false)),
            (Along::Velocity, Over::PhasePlane) => Some((fail.velocity, false)),
            (Along::Velocity, Over::Speed) | (Along::Displacement, Over::Excursion) => Some((fail.bounds, true)),
            _ => None,
        }
    }

    /// Where the places lie along it.
    fn shown(&self, places: &[&Place]) -> Vec<f64> {
        match self {
            Along::Time => places.iter().map(|place| place.t).collect(),
            Along::Velocity => places.iter().map(|place| place.qd).collect(),
            Along::Displacement => places.iter().map(|place| place.q).collect(),
            Along::Frequency(all) => all.clone(),
        }
    }
}

/// The stretches of a panel in which the law fails most, with the share of the error that lies there.
pub(super) fn failing(side: &Side, along: &Along, places: &[&Place]) -> Vec<Layer> {
    let shown = along.shown(places);
    let low = shown.iter().copied().fold(f64::INFINITY, f64::min);
    let high = shown.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let middle = match along {
        Along::Displacement => shown.iter().sum::<f64>() / shown.len().max(1) as f64,
        _ => 0.0,
    };
    let stretches = |fail: &Fail| {
        let Some((Bounds { lower, upper }, is_distance)) = along.bounds(fail) else { return Vec::new() };
        let label = percent(fail.share) + " of the error";
        match (is_distance, lower) {
            (false, _) => vec![(lower.unwrap_or(low), upper.unwrap_or(high), label)],
            (true, None | Some(0.0)) => {
                let upper = upper.unwrap_or(high - low);
                vec![(middle - upper, middle + upper, label)]
            }
            (true, Some(lower)) => {
                let upper = upper.unwrap_or(high - low);
                vec![(middle - upper, middle - lower, String::new()), (middle + lower, middle + upper, label)]
            }
        }
    };
    let within = |(from, to, label): (f64, f64, String)| Layer::Band { from: from.max(low), to: to.min(high), label };
    let is_seen = |band: &Layer| matches!(band, Layer::Band { from, to, .. } if from < to);
    side.fails.iter().take(MARKED).flat_map(stretches).map(within).filter(is_seen).collect()
}
