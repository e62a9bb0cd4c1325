//! The Kalman filter of one coordinate's state under a law.

use crate::law::{Linearized, State};
use serde::{Deserialize, Serialize};

/// A measured channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Channel {
    /// The displacement.
    Q = 0,
    /// The velocity.
    Qd = 1,
}

impl Channel {
    /// Both channels.
    pub const ALL: [Channel; 2] = [Channel::Q, Channel::Qd];
}

/// Variances of what disturbs a record.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Noise {
    /// Variance of the sensor noise of q and of q̇.
    pub sensor: [f64; 2],
    /// Intensity of the white acceleration that the law does not explain, (m/s²)² s.
    pub process: f64,
}

impl Noise {
    /// Whether each sensor's variance is within a quarter of the other's.
    pub fn is_near(&self, other: &Noise) -> bool {
        let near = |a: f64, b: f64| (0.8..1.25).contains(&(a / b));
        self.sensor.iter().zip(other.sensor).all(|(a, b)| near(*a, b))
    }
}

/// Mean and covariance of (q, q̇).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Filter {
    /// Mean.
    pub state: State,
    /// Covariance: q with q, q with q̇, q̇ with q̇.
    pub covariance: [f64; 3],
}

/// What a measurement says that the filter did not expect.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Innovation {
    /// Measured minus expected.
    pub residual: f64,
    /// Variance of the residual.
    pub variance: f64,
    /// 1 ÷ variance.
    pub precision: f64,
    /// How much of the residual goes into (q, q̇).
    pub gain: [f64; 2],
}

impl Filter {
    /// Carries the covariance over a step; the mean is the caller's.
    #[inline]
    pub fn predict(&mut self, step: &Linearized, dt: f64, process: f64) {
        let [[a, b], [c, d]] = step.transition;
        let [qq, qv, vv] = self.covariance;
        let (first_q, first_v) = (a * qq + b * qv, a * qv + b * vv);
        let (second_q, second_v) = (c * qq + d * qv, c * qv + d * vv);
        self.covariance = [
            first_q * a + first_v * b + process * dt * dt * dt / 3.0,
            first_q * c + first_v * d + process * dt * dt / 2.0,
            second_q * c + second_v * d + process * dt,
        ];
    }

    /// What the measurement would leave, and the variance of that.
    #[inline]
    pub fn residual(&self, channel: Channel, measured: f64, variance: f64) -> (f64, f64) {
        match channel {
            Channel::Q => (measured - self.state.q, self.covariance[0] + variance),
            Channel::Qd => (measured - self.state.qd, self.covariance[2] + variance),
        }
    }

    /// Takes one measurement with this noise variance.
    #[inline]
    pub fn update(&mut self, channel: Channel, measured: f64, variance: f64) -> Innovation {
        let [qq, qv, vv] = self.covariance;
        let (expected, column) = match channel {
            Channel::Q => (self.state.q, [qq, qv]),
            Channel::Qd => (self.state.qd, [qv, vv]),
        };
        let total = column[channel as usize] + variance;
        let precision = total.recip();
        let gain = [column[0] * precision, column[1] * precision];
        let residual = measured - expected;
        self.state.q += gain[0] * residual;
        self.state.qd += gain[1] * residual;
        self.covariance = match channel {
            Channel::Q => [gain[0] * variance, gain[1] * variance, (vv - gain[1] * qv).max(0.0)],
            Channel::Qd => [(qq - gain[0] * qv).max(0.0), gain[0] * variance, gain[1] * variance],
        };
        Innovation { residual, variance: total, precision, gain }
    }
}
