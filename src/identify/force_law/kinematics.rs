//! A motion that nothing is known of but its smoothness: (q, q̇, q̈) driven by a white jerk.
//!
//! q̈ is a Wiener process of intensity Q, (m/s³)² s (Bar-Shalom, Li and Kirubarajan, *Estimation with Applications to
//! Tracking and
//! Navigation*, 2001, 6.2.3); readings of q and q̇ have white noise of variance R. The filter's innovations e with
//! variance s give the
//! likelihood of Q and R.

use serde::{Deserialize, Serialize};

/// q, q̇, q̈.
pub type Vector = [f64; 3];

/// How far, in intervals of readings, the first velocity and acceleration may differ from the first difference.
const FAR: f64 = 100.0;

/// State and covariance of the filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Kinematics {
    /// Expected q, q̇, q̈.
    pub state: Vector,
    /// Their covariance.
    pub covariance: [Vector; 3],
}

/// What a reading told.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Reading − expectation.
    pub innovation: f64,
    /// Its variance.
    pub variance: f64,
    /// Cov(q, q̇, q̈; the channel) before the reading.
    pub across: Vector,
}

impl Kinematics {
    /// Begins at two successive values of a channel (0: q, 1: q̇), `dt` s apart, with noise of that variance, at the
    /// second one's time. What is
    /// not measured is 0, and exact where nothing will tell it.
    pub fn begin(channel: usize, [before, now]: [f64; 2], dt: f64, variance: f64) -> Kinematics {
        let slope = (now - before) / dt;
        let spread = |order: i32| FAR * (variance + (now - before).powi(2)) / dt.powi(2 * order);
        let (mut state, mut covariance) = ([0.0; 3], [[0.0; 3]; 3]);
        (state[channel], covariance[channel][channel]) = (now, variance);
        (state[channel + 1], covariance[channel + 1][channel + 1]) = (slope, spread(1));
        if channel == 0 {
            covariance[2][2] = spread(2);
        }
        Kinematics { state, covariance }
    }

    /// Goes on by `dt` s under a white jerk of that intensity.
    pub fn advance(&mut self, dt: f64, intensity: f64) {
        self.state = carried(self.state, dt);
        // A P Aᵀ: first the rows, then the columns
        for column in 0..3 {
            let carried = carried([0, 1, 2].map(|row| self.covariance[row][column]), dt);
            (0..3).for_each(|row| self.covariance[row][column] = carried[row]);
        }
        self.covariance.iter_mut().for_each(|row| *row = carried(*row, dt));
        let noise = [
            [dt.powi(5) / 20.0, dt.powi(4) / 8.0, dt.powi(3) / 6.0],
            [dt.powi(4) / 8.0, dt.powi(3) / 3.0, dt * dt / 2.0],
            [dt.powi(3) / 6.0, dt * dt / 2.0, dt],
        ];
        for (row, noise) in self.covariance.iter_mut().zip(noise) {
            row.iter_mut().zip(noise).for_each(|(entry, noise)| *entry += intensity * noise);
        }
    }

    /// Takes a reading of a channel (0: q, 1: q̇) with noise of that variance.
    pub fn measure(&mut self, channel: usize, value: f64, noise: f64) -> Reading {
        let across = self.covariance[channel];
        let variance = across[channel] + noise;
        let innovation = value - self.state[channel];
        for row in 0..3 {
            self.state[row] += across[row] * innovation / variance;
            (0..3).for_each(|column| self.covariance[row][column] -= across[row] * across[column] / variance);
        }
        // the same with less rounding where the state was hardly known
        for (row, across) in across.iter().enumerate() {
            self.covariance[channel][row] = across * noise / variance;
            self.covariance[row][channel] = self.covariance[channel][row];
        }
        Reading { innovation, variance, across }
    }
}

/// A v: where (q, q̇, q̈) is after `dt` s without jerk.
pub fn carried([q, qd, qdd]: Vector, dt: f64) -> Vector {
    [q + dt * (qd + 0.5 * dt * qdd), qd + dt * qdd, qdd]
}
