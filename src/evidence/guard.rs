//! Readings that are far off under a law: a sensor's outliers, unless more of them follow.

use super::filter::Channel;
use serde::{Deserialize, Serialize};

/// A reading this many stds off is far off: by chance one in five hundred million is.
const FAR: f64 = 6.0;

/// Readings far off in a row that are no outliers.
const LASTS: u32 = 3;

/// Where a motion leaves the law each residual is larger than the one before, by half at least.
const GROWS: f64 = 1.5;

/// Two in a row this many stds off are beyond what a sensor scatters.
const BEYOND: f64 = 30.0;

/// What a channel's last readings were like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Guard {
    far: [u32; 2],
    last: [f64; 2],
}

impl Guard {
    /// Whether a reading counts that leaves this residual, whose variance is `variance`.
    #[inline]
    pub fn admits(&mut self, channel: Channel, residual: f64, variance: f64) -> bool {
        let index = channel as usize;
        if residual * residual <= FAR * FAR * variance {
            self.far[index] = 0;
            return true;
        }
        self.far[index] += 1;
        let last = std::mem::replace(&mut self.last[index], residual);
        let beyond = |residual: f64| residual * residual > BEYOND * BEYOND * variance;
        let leaves = residual / last > GROWS || (beyond(residual) && beyond(last));
        (self.far[index] > 1 && leaves) || self.far[index] >= LASTS
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn admitted(residuals: &[f64]) -> Vec<bool> {
        let mut guard = Guard::default();
        residuals.iter().map(|residual| guard.admits(Channel::Qd, *residual, 1.0)).collect()
    }

    #[test]
    fn outliers_do_not_count_alone_or_in_pairs() {
        assert_eq!(admitted(&[1.0, 20.0, -2.0, 20.0, 19.0, 0.5]), [true, false, true, false, false, true]);
    }

    #[test]
    fn a_motion_that_leaves_the_law_counts_from_its_second_reading_on() {
        assert_eq!(admitted(&[1.0, 20.0, 45.0, 70.0]), [true, false, true, true]);
        assert_eq!(admitted(&[1.0, 800.0, -300.0]), [true, false, true]);
    }

    #[test]
    fn a_lasting_change_counts_from_its_third_reading_on() {
        assert_eq!(admitted(&[20.0, 20.0, 20.0, 20.0]), [false, false, true, true]);
    }
}
