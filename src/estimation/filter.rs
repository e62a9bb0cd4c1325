//! The Kalman filter of N states, of which the first two, q and q̇, are measured.

use super::covariance::{Matrix, carry, correct};
use crate::law::State;
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

/// Smallest std of a sensor's noise ÷ the largest value that it measured: what rounding and the integration's own error
/// leave.
const NOISE_FLOOR: f64 = 3e-7;

impl Noise {
    /// Least variance of a sensor that measured values up to `largest`.
    pub fn floor(largest: f64) -> f64 {
        (NOISE_FLOOR * largest).powi(2).max(f64::MIN_POSITIVE)
    }

    /// Whether each sensor's variance is within a quarter of the other's.
    pub fn is_near(&self, other: &Noise) -> bool {
        let near = |a: f64, b: f64| (0.8..1.25).contains(&(a / b));
        self.sensor.iter().zip(other.sensor).all(|(a, b)| near(*a, b))
    }
}

/// Mean and covariance of N states: (q, q̇), and what else moves with them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound(
    serialize = "[f64; N]: Serialize, Matrix<N>: Serialize",
    deserialize = "[f64; N]: Deserialize<'de>, Matrix<N>: Deserialize<'de>"
))]
pub struct Filter<const N: usize = 2> {
    /// Mean.
    pub mean: [f64; N],
    /// Covariance, both triangles.
    pub covariance: Matrix<N>,
}

/// What a measurement says that the filter did not expect.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "[f64; N]: Serialize", deserialize = "[f64; N]: Deserialize<'de>"))]
pub struct Innovation<const N: usize = 2> {
    /// Measured minus expected.
    pub residual: f64,
    /// Variance of the residual.
    pub variance: f64,
    /// 1 ÷ variance.
    pub precision: f64,
    /// How much of the residual goes into each state.
    pub gain: [f64; N],
}

/// Covariance of (q, q̇) after `dt` s of a white acceleration of this intensity, (m/s²)² s, from rest.
#[inline]
pub fn white_acceleration(intensity: f64, dt: f64) -> Matrix<2> {
    let (variance, cross) = (intensity * dt * dt * dt / 3.0, intensity * dt * dt / 2.0);
    [[variance, cross], [cross, intensity * dt]]
}

/// A x.
#[inline]
pub fn times<const N: usize>(matrix: &Matrix<N>, vector: [f64; N]) -> [f64; N] {
    matrix.map(|row| row.iter().zip(vector).map(|(entry, other)| entry * other).sum())
}

impl<const N: usize> Default for Filter<N> {
    fn default() -> Filter<N> {
        Filter { mean: [0.0; N], covariance: [[0.0; N]; N] }
    }
}

impl<const N: usize> Filter<N> {
    /// Knows of each state its mean and variance.
    pub fn begin(mean: [f64; N], variances: [f64; N]) -> Filter<N> {
        let mut filter = Filter { mean, ..Filter::default() };
        variances.iter().enumerate().for_each(|(index, variance)| filter.covariance[index][index] = *variance);
        filter
    }

    /// The mean of q and q̇.
    #[inline]
    pub fn state(&self) -> State {
        State { q: self.mean[0], qd: self.mean[1] }
    }

    /// Puts the mean of q and q̇ elsewhere.
    #[inline]
    pub fn set_state(&mut self, state: State) {
        (self.mean[0], self.mean[1]) = (state.q, state.qd);
    }

    /// Carries the covariance over an interval: `map` is what the interval makes of a small change of the states, and
    /// `noise` what it adds. The mean is the caller's.
    #[inline]
    pub fn predict(&mut self, map: impl Fn([f64; N]) -> [f64; N], noise: &Matrix<N>) {
        carry(self.covariance.as_flattened_mut(), &mut [[0.0; N]; N], map, &[], noise);
    }

    /// What the measurement would leave, and the variance of that.
    #[inline]
    pub fn residual(&self, channel: Channel, measured: f64, variance: f64) -> (f64, f64) {
        let place = channel as usize;
        (measured - self.mean[place], self.covariance[place][place] + variance)
    }

    /// Takes one measurement with this noise variance.
    #[inline]
    pub fn update(&mut self, channel: Channel, measured: f64, variance: f64) -> Innovation<N> {
        let (residual, total) = self.residual(channel, measured, variance);
        let (column, precision) = (self.covariance[channel as usize], total.recip());
        let gain = column.map(|entry| entry * precision);
        self.mean.iter_mut().zip(gain).for_each(|(mean, gain)| *mean += gain * residual);
        correct(self.covariance.as_flattened_mut(), &column, &gain, channel as usize, variance);
        Innovation { residual, variance: total, precision, gain }
    }
}
