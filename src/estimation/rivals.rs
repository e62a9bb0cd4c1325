//! What the likelihood of a run would be under less and under more process noise.

use super::covariance::Matrix;
use super::filter::{Channel, Filter, times};
use super::track::Track;
use serde::{Deserialize, Serialize};

/// Ratios by which the process noise of the two rival filters differs from the one in use, unless told otherwise: down
/// through nearly nine decades in six runs, up more carefully (docs/decisions/prediction-error-method.md).
pub const RIVALS: [f64; 2] = [1.0 / 30.0, 6.0];

/// Two filters beside the one in use, linear about its motion.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(bound(serialize = "Filter<N>: Serialize", deserialize = "Filter<N>: Deserialize<'de>"))]
pub struct Rivals<const N: usize = 2> {
    /// Their process noise ÷ the one in use.
    pub ratios: [f64; 2],
    filters: [Filter<N>; 2],
    tracks: [Track; 2],
}

impl<const N: usize> Rivals<N> {
    /// Of process noise at these ratios to the one in use; they have not begun.
    pub fn new(ratios: [f64; 2]) -> Rivals<N> {
        Rivals { ratios, filters: [Filter::default(); 2], tracks: [Track::default(); 2] }
    }

    /// Both begin where the filter in use does.
    pub fn begin(&mut self, filter: Filter<N>) {
        (self.filters, self.tracks) = ([filter; 2], [Track::default(); 2]);
    }

    /// Both go on from where the filter in use does; what they said so far stands.
    pub fn resume(&mut self, filter: Filter<N>) {
        self.filters = [filter; 2];
    }

    /// Both go over an interval that takes the filter in use from mean `from` to mean `to`; `noise` is what it adds
    /// under a ratio.
    #[inline]
    pub fn predict(&mut self, from: [f64; N], to: [f64; N], transition: &Matrix<N>, noise: impl Fn(f64) -> Matrix<N>) {
        for (rival, ratio) in self.filters.iter_mut().zip(self.ratios) {
            let apart: [f64; N] = std::array::from_fn(|index| rival.mean[index] - from[index]);
            let add = |sum: f64, (entry, apart): (&f64, &f64)| sum + entry * apart;
            rival.mean = std::array::from_fn(|row| transition[row].iter().zip(&apart).fold(to[row], add));
            rival.predict(|change| times(transition, change), &noise(ratio));
        }
    }

    /// Both take one measurement with this noise variance, which `counts` in their likelihood or does not.
    #[inline]
    pub fn update(&mut self, channel: Channel, measured: f64, variance: f64, counts: bool) {
        for (rival, track) in self.filters.iter_mut().zip(&mut self.tracks) {
            let innovation = rival.update(channel, measured, variance);
            if counts {
                track.add(channel, &innovation);
            }
        }
    }

    /// Their log-likelihoods, as [`Track::log_likelihood`].
    pub fn log_likelihoods(&self) -> [f64; 2] {
        self.tracks.each_ref().map(Track::log_likelihood)
    }
}
