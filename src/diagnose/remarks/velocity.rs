//! Whether q̇ is the derivative of q: sign, scale, lag, and whether it is a measurement of its own.

use super::remark::Remark;
use crate::diagnose::motion::{Kinematics, Motion};

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

/// Remarks on q̇ beside q, and on the noise of both.
pub(super) fn remarks(motion: &Motion, sample_time: f64) -> Vec<Remark> {
    let mut said = motion.kinematics.map_or_else(Vec::new, |found| of(&found, sample_time));
    for (place, channel) in ["q", "qd"].into_iter().enumerate() {
        let values: Vec<f64> =
            motion.pieces.iter().filter_map(|piece| piece.measured()[place]).flatten().copied().collect();
        let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
        let std = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len().max(1) as f64).sqrt();
        let noise = motion.sensors.noise[place];
        if std > 0.0 && noise > NOISY * std {
            let sentence = format!("is noise to {:.0} % (std {noise:.3e} of {std:.3e})", 100.0 * noise / std);
            said.push(Remark::new(channel, "noisy", sentence));
        }
    }
    said
}

fn of(found: &Kinematics, sample_time: f64) -> Vec<Remark> {
    let say = |kind: &'static str, sentence: String| Remark::new("qd", kind, sentence);
    if !found.is_velocity() {
        let sentence = "is not the derivative of q: check its column (an acceleration, another sensor?)";
        return vec![say("foreign", sentence.into())];
    }
    let mut said = Vec::new();
    if found.scale < 0.0 {
        said.push(say("sign", "has the sign of −q̇: turn it round".into()));
    }
    let scale = found.scale.abs();
    if (scale - 1.0).abs() > SCALE.max(SURE * found.scale_std) {
        let near =
            |(factor, _): &&(f64, &str)| (scale / factor - 1.0).abs() < SCALE.max(SURE * found.scale_std / scale);
        let hint = FACTORS.iter().find(near).map_or("check its unit", |(_, hint)| hint);
        said.push(say("scale", format!("is {scale:.4} times the derivative of q: {hint}")));
    }
    if found.lag.abs() > SURE * found.lag_std && found.lag.abs() > 0.5 * sample_time {
        let (late, std) = (1e3 * found.lag.abs(), 1e3 * found.lag_std);
        let direction = if found.lag > 0.0 { "late (a filter, a bus)" } else { "early, or q late" };
        said.push(say("late", format!("comes {late:.3} ± {std:.3} ms {direction}")));
    }
    if found.is_derivative {
        said.push(say("derivative", "is computed from q: it is no second measurement".into()));
    }
    said
}
