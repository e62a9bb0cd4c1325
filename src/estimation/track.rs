//! The likelihood of a filter run, as sums over its innovations.

use super::filter::{Channel, Innovation};
use super::symmetric::LogSum;
use serde::{Deserialize, Serialize};

/// Sums that make up a likelihood.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Track {
    /// Number of innovations by channel.
    pub count: [f64; 2],
    /// Σ ε²/s by channel.
    pub squares: [f64; 2],
    /// Σ ln s by channel.
    log_variance: [LogSum; 2],
}

impl Track {
    /// Adds an innovation of the channel.
    #[inline]
    pub fn add<const N: usize>(&mut self, channel: Channel, innovation: &Innovation<N>) {
        self.count[channel as usize] += 1.0;
        self.squares[channel as usize] += innovation.residual * innovation.residual * innovation.precision;
        self.log_variance[channel as usize].add(innovation.variance);
    }

    /// The same with no channel quieter than was stated: less than its noise's floor is rounding and integration.
    pub fn no_quieter(&self) -> Track {
        Track { squares: [0, 1].map(|channel| self.squares[channel].max(self.count[channel])), ..*self }
    }

    /// Mean of ε²/s in the channel: by how much its stated variance is too small; 1 where nothing was measured.
    pub fn scale(&self, channel: Channel) -> f64 {
        let count = self.count[channel as usize];
        if count > 0.0 { self.squares[channel as usize] / count } else { 1.0 }
    }

    /// Log-likelihood with each channel's scale at its own maximum, up to a constant.
    pub fn log_likelihood(&self) -> f64 {
        let profile = Channel::ALL.map(|channel| self.count[channel as usize] * self.scale(channel).max(1e-300).ln());
        let [q, qd] = &self.log_variance;
        -0.5 * (q.total() + qd.total() + profile[0] + profile[1])
    }

    /// Log-likelihood with the variances as they were stated, up to the same constant.
    pub fn stated_log_likelihood(&self) -> f64 {
        let [q, qd] = &self.log_variance;
        -0.5 * (q.total() + qd.total() + self.squares[0] + self.squares[1])
    }

    /// Number of scalar measurements.
    pub fn total(&self) -> f64 {
        self.count[0] + self.count[1]
    }
}
