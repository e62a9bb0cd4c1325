//! One measurement, and why it may not be used.

use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Samples further apart than so many usual distances have a gap between them: four lost ones in a row are still
/// bridged.
pub const GAP: f64 = 4.5;

/// Readings that do not come, or do not count, for so many usual distances are an outage: the law may have switched
/// within, and nothing says when.
pub const OUTAGE: f64 = 50.0;

/// Share of an interval in the usual one: that follows another rate of sampling within 20 samples.
pub const PACE_SHARE: f64 = 0.05;

/// Whether nothing that counts has come for so long, s, where one usually comes every `pace` s, that it is an outage.
pub fn is_outage(silence: f64, pace: f64) -> bool {
    pace > 0.0 && silence > OUTAGE * pace
}

/// One measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Time, s.
    pub t: f64,
    /// Displacement; ignored where [`super::Channels`] says it is not measured.
    pub q: f64,
    /// Velocity; ignored where it is not measured.
    pub qd: f64,
    /// Excitation; ignored where it is not measured.
    pub excitation: f64,
}

/// Why a sample was not used. Nothing else changes.
#[derive(Clone, Copy, Debug, PartialEq, Error, Serialize, Deserialize)]
pub enum Skipped {
    /// A measured channel is NaN or infinite.
    #[error("the sample at t = {t} s has a {channel} that is no finite number: skipped")]
    NotFinite {
        /// Time of the sample, s.
        t: f64,
        /// The channel at fault: `t`, `q`, `qd` or `F`.
        channel: &'static str,
    },
    /// Time did not advance.
    #[error("the sample at t = {t} s does not come after the one at {previous} s: skipped")]
    NotLater {
        /// Time of the sample, s.
        t: f64,
        /// Time of the last accepted one, s.
        previous: f64,
    },
    /// The sample before came after a gap, and this one comes before it: its stamp was wrong.
    #[error(
        "the sample at t = {t} s came long after the one at {previous} s, and the next one before it: its time is wrong, skipped"
    )]
    Ahead {
        /// Time of the sample that is skipped, s.
        t: f64,
        /// Time of the last accepted one, s.
        previous: f64,
    },
    /// Every channel repeats the last sample, which is no chance: that was sent again.
    #[error("the sample at t = {t} s repeats the last one in every channel: it was sent again, and is skipped")]
    Repeated {
        /// Time of the sample, s.
        t: f64,
    },
    /// Every channel of the sample before lay on the line to this one, which is no chance: nobody has read it.
    #[error("the sample at t = {t} s lies on the line between its neighbours in every channel: interpolated, skipped")]
    Interpolated {
        /// Time of the sample, s.
        t: f64,
    },
    /// The stream is faster than `sample_time`; thinned.
    #[error("the sample at t = {t} s comes sooner than sample_time after the last one: thinned")]
    TooSoon {
        /// Time of the sample, s.
        t: f64,
    },
}
