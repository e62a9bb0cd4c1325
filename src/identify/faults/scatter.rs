//! A burst whose readings are each near enough to count: together they scatter as no working sensor does.
//!
//! Page's cumulative sum (*Biometrika* 41 (1954), 100) of ln(faulty ÷ working) over the innovations of the law in use.

use super::price::{Burst, faulty, working};
use crate::estimation::{Innovation, TWENTY_TO_ONE};
use serde::{Deserialize, Serialize};

/// A reading counts for no more than this, nats: two readings are needed for what has odds of 10⁶ against it.
const MOST: f64 = 8.0;

/// How much the innovations speak for a burst, by channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scatter {
    gain: [f64; 2],
}

impl Scatter {
    /// Takes the innovations of a sample.
    pub fn take(&mut self, innovations: &[Option<Innovation>; 2]) {
        for (gain, innovation) in self.gain.iter_mut().zip(innovations) {
            if let Some(Innovation { residual, variance, .. }) = innovation {
                let more = faulty(*residual, variance.sqrt()) - working(*residual, *variance);
                *gain = (*gain + more.min(MOST)).max(0.0);
            }
        }
    }

    /// Log-likelihood ratio of a burst to none, nats.
    pub fn evidence(&self) -> f64 {
        self.gain[0] + self.gain[1]
    }

    /// The bursts that it speaks for.
    pub fn bursts(&self) -> [Burst; 2] {
        self.gain.map(|gain| if gain > TWENTY_TO_ONE { Burst::going_on() } else { Burst::default() })
    }

    /// Forgets what was.
    pub fn clear(&mut self) {
        self.gain = [0.0; 2];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(residuals: impl Iterator<Item = f64>) -> f64 {
        let mut scatter = Scatter::default();
        for residual in residuals {
            let said = Innovation { residual, variance: 1.0, precision: 1.0, gain: [0.0; 2] };
            scatter.take(&[None, Some(said)]);
        }
        scatter.evidence()
    }

    #[test]
    fn twenty_readings_of_three_stds_are_a_burst_and_none_of_one_are() {
        let sign = |index: u32| if (index * 7).is_multiple_of(3) { 1.0 } else { -1.0 };
        assert!(after((0..20).map(|index| 3.0 * sign(index))) > 20.0);
        assert!(after((0..2000).map(sign)) < 1.0);
    }
}
