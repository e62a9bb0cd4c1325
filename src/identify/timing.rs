//! When the excitation that was read acted on the motion that was read.
//!
//! Over an interval between two samples the excitation is taken for the last reading F₀ of F, or for a straight line
//! from it to the next one F₁; and F may have come a sample earlier or later than q and q̇. Where κ₊ and κ₋ are shares
//! of F₁ and of the reading F₋₁ before F₀, the mean excitation of the interval is
//!
//! ```text
//! F₀ + κ₊ (F₁ − F₀) + κ₋ (F₋₁ − F₀)
//! ```

use crate::law::{Drive, Hold};
use serde::{Deserialize, Serialize};

/// What F does between samples, and by how many samples it comes before the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Timing {
    /// What F does between samples.
    pub hold: Hold,
    /// Samples by which q and q̇ come later than F, −1 to 1.
    pub lag: i8,
}

impl Timing {
    /// All that are told apart.
    pub const ALL: [Timing; 5] = [
        Timing { hold: Hold::Zero, lag: 0 },
        Timing { hold: Hold::Linear, lag: 0 },
        Timing { hold: Hold::Zero, lag: 1 },
        Timing { hold: Hold::Linear, lag: 1 },
        Timing { hold: Hold::Zero, lag: -1 },
    ];

    /// As the samples stand.
    pub fn of(hold: Hold) -> Timing {
        Timing { hold, lag: 0 }
    }

    /// κ₊ and κ₋; of a band-limited excitation those of one that is smooth.
    pub fn shares(self) -> [f64; 2] {
        match (self.hold, self.lag) {
            (Hold::Zero, 0) => [0.0, 0.0],
            (Hold::Zero, 1) => [0.0, 1.0],
            (Hold::Zero, _) => [1.0, 0.0],
            (_, 0) => [0.5, 0.0],
            (_, _) => [0.0, 0.5],
        }
    }

    /// The excitation of an interval between F₋₁, F₀ and F₁ as they were read; one that is band-limited as a straight
    /// line.
    pub fn drive(self, [earlier, before, after]: [f64; 3]) -> Drive {
        match (self.hold, self.lag) {
            (Hold::Zero, 0) => Drive::Held(before),
            (Hold::Zero, 1) => Drive::Held(earlier),
            (Hold::Zero, _) => Drive::Held(after),
            (_, 0) => Drive::Line(before, after),
            (_, _) => Drive::Line(earlier, before),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_a_drive_is_what_its_shares_say() {
        let read @ [earlier, before, after] = [0.7, 2.0, -1.1];
        for timing in Timing::ALL {
            let [to_after, to_earlier] = timing.shares();
            let mean = before + to_after * (after - before) + to_earlier * (earlier - before);
            assert!((timing.drive(read).at(0.5) - mean).abs() < 1e-12, "{timing:?}");
        }
    }
}
