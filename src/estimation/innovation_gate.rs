//! Readings that are far off under a law: a sensor's outliers, unless more of them follow.

use super::filter::Channel;
use serde::{Deserialize, Serialize};

/// A reading this many stds off is far off: by chance one in five hundred million is.
pub const OUTLYING: f64 = 6.0;

/// Readings far off that are no outliers, of a sensor that is not known for them and of one that is: false alarms among
/// 0.5 % and 2 % of outliers were counted (docs/decisions/sensor-faults.md) …
const LASTS: [u32; 2] = [3, 4];

/// … among so many: another inertia under a rough excitation leaves residuals of either sign, large and small.
const AMONG: u32 = 8;

/// Where a motion leaves the law each residual is larger than the one before, by half at least.
const GROWS: f64 = 1.5;

/// Two in a row this many stds off are beyond what a sensor scatters: five times as far as one that is far off.
const BEYOND: f64 = 30.0;

/// A reading that does not count speaks of another law as one this many stds off does, from a sensor known for
/// outliers; from another as one that is just not far off.
const DOUBTFUL: f64 = 3.0;

/// What a channel's last readings were like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InnovationGate {
    /// Which of the last readings were far off, the latest in the lowest bit.
    far: [u32; 2],
    last: [f64; 2],
    /// Whether one far off has been left alone by those after it: an outlier.
    outlier: [bool; 2],
}

impl InnovationGate {
    /// Whether a reading counts that leaves this residual, whose variance is `variance`.
    #[inline]
    pub fn admits(&mut self, channel: Channel, residual: f64, variance: f64) -> bool {
        let index = channel as usize;
        let far = residual * residual > OUTLYING * OUTLYING * variance;
        let row = self.far[index] & 1 == 1;
        self.outlier[index] |= self.far[index] == 1 << (AMONG - 1);
        self.far[index] = (self.far[index] << 1 | u32::from(far)) & ((1 << AMONG) - 1);
        if !far {
            return true;
        }
        let last = std::mem::replace(&mut self.last[index], residual);
        let beyond = |residual: f64| residual * residual > BEYOND * BEYOND * variance;
        let leaves = residual / last > GROWS || (beyond(residual) && beyond(last));
        let known = self.outlier[index];
        (row && leaves && !known) || self.far[index].count_ones() >= LASTS[usize::from(known)]
    }

    /// 1 ÷ variance with which a reading that does not count speaks of another law.
    #[inline]
    pub fn precision(&self, channel: Channel, residual: f64) -> f64 {
        let stds = if self.outlier[channel as usize] { DOUBTFUL } else { OUTLYING };
        (stds / residual).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn admitted(residuals: &[f64]) -> Vec<bool> {
        let mut gate = InnovationGate::default();
        residuals.iter().map(|residual| gate.admits(Channel::Qd, *residual, 1.0)).collect()
    }

    #[test]
    fn outliers_do_not_count_alone_or_in_pairs() {
        assert_eq!(admitted(&[1.0, 20.0, 19.0, -2.0, 0.5]), [true, false, false, true, true]);
        assert_eq!(admitted(&[20.0, 1.0, 0.5, 20.0, 1.0]), [false, true, true, false, true]);
    }

    #[test]
    fn a_motion_that_leaves_the_law_counts_from_its_second_reading_on() {
        assert_eq!(admitted(&[1.0, 20.0, 45.0, 70.0]), [true, false, true, true]);
        assert_eq!(admitted(&[1.0, 800.0, -300.0]), [true, false, true]);
    }

    #[test]
    fn the_third_of_eight_counts() {
        assert_eq!(admitted(&[-7.0, 9.0, 3.0, 2.0, 8.0, 2.0, -9.0]), [false, false, true, true, true, true, true]);
        assert_eq!(admitted(&[-7.0, 9.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0])[8..], [false]);
    }

    #[test]
    fn a_sensor_known_for_outliers_may_have_three_in_a_row() {
        let quiet = [0.0; AMONG as usize];
        let readings = [&[40.0][..], &quiet, &[35.0, 60.0, 1.0, 9.0]].concat();
        assert_eq!(admitted(&readings)[9..], [false, false, true, false]);
        assert_eq!(admitted(&[&readings[..], &[9.0]].concat())[13..], [true]);
        let mut gate = InnovationGate::default();
        assert_eq!(gate.precision(Channel::Qd, 60.0), (OUTLYING / 60.0).powi(2));
        readings
            .iter()
            .for_each(|residual| assert!(gate.admits(Channel::Qd, *residual, 1.0) == (residual.abs() < OUTLYING)));
        assert_eq!(gate.precision(Channel::Qd, 60.0), (DOUBTFUL / 60.0).powi(2));
    }

    #[test]
    fn a_lasting_change_counts_from_its_third_reading_on() {
        assert_eq!(admitted(&[20.0, 20.0, 20.0, 20.0]), [false, false, true, true]);
    }
}
