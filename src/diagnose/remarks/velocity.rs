//! Whether q̇ is the derivative of q: sign, scale, lag, and whether it is a measurement of its own.

use super::remark::Remark;
use crate::diagnose::motion::{Kinematics, Motion};
use crate::law::numerals::{digits, number};
use std::f64::consts::TAU;

/// Std that a lag or a scale must be away from what it should be to be said.
const SURE: f64 = 3.0;

/// Error of the scale from which it is said: sensors are calibrated to a few per cent.
const SCALE: f64 = 0.05;

/// Factors that units come with, and where they come from.
const FACTORS: [(f64, &str); 8] = [
    (1e3, "q in m and qd in mm/s, or times in ms taken as s"),
    (1e-3, "q in mm and qd in m/s"),
    (180.0 / std::f64::consts::PI, "q in rad and qd in °/s"),
    (std::f64::consts::PI / 180.0, "q in ° and qd in rad/s"),
    (30.0 / std::f64::consts::PI, "q in rad and qd in rpm"),
    (3.6, "q in m and qd in km/h"),
    (1e6, "q in m and qd in µm/s, or times in µs taken as s"),
    (1.0 / std::f64::consts::TAU, "qd in revolutions per second"),
];

/// Noise ÷ std of a channel from which it is said.
const NOISY: f64 = 0.3;

/// Part of q's std that q̇'s integral must run away from q over the record to be said.
const AWAY: f64 = 0.1;

/// Share by which the square of a motion's frequency, one number for all of its motion, may miss what relates q̇ to an
/// acceleration's slope.
const NEAR: f64 = 0.3;

/// A recording beside which q̇ is looked at.
#[derive(Clone, Copy)]
pub(super) struct Beside {
    /// Usual distance of two samples, s.
    pub(super) sample_time: f64,
    /// Its length, s.
    pub(super) duration: f64,
    /// The motion's natural period, s.
    pub(super) period: f64,
}

/// Remarks on q̇ beside q, where q shows a motion at all, and on the noise of both.
pub(super) fn remarks(motion: &Motion, beside: Beside) -> Vec<Remark> {
    let mut said = Vec::new();
    let mut spread = [0.0; 2];
    for (place, channel) in ["q", "qd"].into_iter().enumerate() {
        let values: Vec<f64> =
            motion.pieces.iter().filter_map(|piece| piece.measured()[place]).flatten().copied().collect();
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let std = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len().max(1) as f64).sqrt();
        let noise = motion.sensors.noise[place];
        spread[place] = std;
        if std > 0.0 && noise > NOISY * std {
            let share = (100.0 * noise / std).min(100.0);
            let sentence = format!("is noise to {share:.0} % (std {} of {})", digits(noise, 3), digits(std, 3));
            said.push(Remark::new(channel, "noisy", sentence));
        }
    }
    if motion.sensors.noise[0] < spread[0] {
        said.extend(motion.kinematics.iter().flat_map(|found| of(found, spread[0], beside)));
    }
    said
}

fn of(found: &Kinematics, spread: f64, beside: Beside) -> Vec<Remark> {
    let say = |kind: &'static str, sentence: String| Remark::new("qd", kind, sentence);
    if !found.is_velocity() {
        let sentence = "is not the derivative of q: check its column (an acceleration, another sensor?)";
        return vec![say("foreign", sentence.into())];
    }
    let mut said = Vec::new();
    let scale = found.scale.abs();
    // Where q is an acceleration its slope is −ω² q̇.
    let turned = scale * (TAU / beside.period).powi(2);
    if found.scale < 0.0 && (turned - 1.0).abs() < NEAR && (scale - 1.0).abs() > NEAR {
        let sentence = "goes against the derivative of q as the motion's frequency has it where q is an acceleration: check q's column";
        return vec![say("foreign", sentence.into())];
    }
    if found.scale < 0.0 {
        said.push(say("sign", "has the sign of −q̇: turn it round".into()));
    }
    if (scale - 1.0).abs() > SCALE.max(SURE * found.scale_std) {
        let near =
            |(factor, _): &&(f64, &str)| (scale / factor - 1.0).abs() < SCALE.max(SURE * found.scale_std / scale);
        let hint = FACTORS.iter().find(near).map_or("check its unit", |(_, hint)| hint);
        said.push(say("scale", format!("is {} times the derivative of q: {hint}", digits(scale, 4))));
    }
    if found.lag.abs() > SURE * found.lag_std && found.lag.abs() > 0.5 * beside.sample_time {
        let (late, std) = (1e3 * found.lag.abs(), 1e3 * found.lag_std);
        let direction = if found.lag > 0.0 { "late (a filter, a bus)" } else { "early, or q late" };
        said.push(say("late", format!("comes {} ms {direction}", number(late, std))));
    }
    let away = found.offset / found.scale * beside.duration;
    if found.offset.abs() > SURE * found.offset_std && away.abs() > AWAY * spread {
        let [away, rate] = [away.abs(), (found.offset / found.scale).abs()].map(|value| digits(value, 3));
        let sentence = format!(
            "and q part by {away} over the record ({rate} per second): q drifts, or qd has an offset; mend the one that has"
        );
        said.push(say("drift", sentence));
    }
    if found.is_derivative {
        said.push(say("derivative", "is computed from q: it is no second measurement".into()));
    }
    said
}
