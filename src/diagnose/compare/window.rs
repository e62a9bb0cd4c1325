//! How long a window of the weak residual is.
//!
//! Two periods measure a motion: that of its displacement, T_q = 2π rms(q) ÷ rms(q̇), and that of its velocity, T_q̇ =
//! 2π rms(q̇) ÷ rms(q̈), which is the shorter one where forces act in bursts. A window is a quarter of the shorter one,
//! so that it averages over none of what the law must explain, at least 40 samples, and longer, up to four tenths of
//! T_q, where the sensors' noise would fill it.

use super::coefficients::{Held, best_coefficients};
use super::record::{Balance, Record};
use std::f64::consts::TAU;

/// Share of the velocity's period that a window spans, and of the displacement's that it may.
const SHARE: f64 = 0.25;
/// … at most: two windows and a half are a period.
const LARGEST_SHARE: f64 = 0.4;

/// Fewest intervals between samples in a window.
const INTERVALS: f64 = 40.0;

/// Noise floor above which a longer window is tried.
const LOUD: f64 = 0.05;

/// How much longer.
const GROWTH: f64 = 1.25;

/// The two periods of a motion, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periods {
    /// 2π rms(q) ÷ rms(q̇).
    pub displacement: f64,
    /// 2π rms(q̇) ÷ rms(q̈).
    pub velocity: f64,
}

/// The periods of all records together.
pub fn periods(records: &[Record]) -> Periods {
    let mut powers = [0.0; 3];
    for prepared in records.iter().flat_map(|record| &record.pieces) {
        let motion = &prepared.motion;
        let count = motion.q.len() as f64;
        let mean = motion.q.iter().sum::<f64>() / count;
        powers[0] += motion.q.iter().map(|q| (q - mean).powi(2)).sum::<f64>();
        powers[1] += beyond(&motion.qd, motion.velocity_variance);
        powers[2] += beyond(&motion.qdd, motion.acceleration_variance);
    }
    let period = |over: f64, under: f64| if under > 0.0 { TAU * (over / under).sqrt() } else { 0.0 };
    Periods { displacement: period(powers[0], powers[1]), velocity: period(powers[1], powers[2]) }
}

/// Sum of squares beyond noise of this variance, a tenth at least.
fn beyond(values: &[f64], variance: f64) -> f64 {
    let squares: f64 = values.iter().map(|value| value * value).sum();
    (squares - values.len() as f64 * variance).max(0.1 * squares)
}

/// The length of window that suits the records, s.
pub fn choose_window(records: &[Record], held: &Held) -> f64 {
    let periods = periods(records);
    let sample_time = records.iter().map(|record| record.sample_time).fold(0.0, f64::max);
    let longest = LARGEST_SHARE * periods.displacement;
    let mut length = (SHARE * periods.velocity).max(INTERVALS * sample_time);
    while GROWTH * length <= longest && floor(records, held, length) > LOUD {
        length *= GROWTH;
    }
    length
}

/// The noise floor of the best law of this form.
fn floor(records: &[Record], held: &Held, length: f64) -> f64 {
    let rows: Vec<_> = records.iter().flat_map(|record| record.rows(record.windows(length))).collect();
    let best = best_coefficients(held, &rows);
    let balances = records.iter().map(|record| record.balance(record.windows(length), &best.terms, &best.coefficients));
    balances.fold(Balance::default(), Balance::and).noise_floor()
}
