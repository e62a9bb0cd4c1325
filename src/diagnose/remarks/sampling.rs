//! The clock: even or not, samples lost, and how many of them a period has.

use super::remark::Remark;
use crate::identify::Recording;
use crate::law::numerals::{digits, seconds};

/// Share of the usual distance of two samples by which distances differ before a clock is called uneven: times that are
/// rounded to a tenth of it stay below.
const UNEVEN: f64 = 0.1;

/// Distance of two samples in usual ones from which one at least is lost: half a sample beyond the usual.
const LOST: f64 = 1.5;

/// Fewest samples of a natural period that weak windows of a tenth of it still resolve, and that show how fast the
/// motion is.
pub(super) const FEW: f64 = 10.0;

/// What a lost sample means.
const UNKNOWN: &str = "nothing is known of the motion there";

/// Remarks on the times.
pub(super) fn remarks(recording: &Recording, period: Option<f64>) -> Vec<Remark> {
    let usual = recording.sample_time();
    let t: Vec<f64> = recording.stream(0..recording.count()).map(|sample| sample.t).collect();
    let distances = || t.windows(2).map(|pair| (pair[0], pair[1] - pair[0]));
    let mut said = Vec::new();
    let lost: Vec<(f64, f64)> = distances().filter(|(_, distance)| *distance > LOST * usual).collect();
    let missing: f64 = lost.iter().map(|(_, distance)| (distance / usual).round() - 1.0).sum();
    // What is lost is missing in the count over the whole record; after a reading that only came late the next one
    // comes the sooner.
    let in_all = (t[t.len() - 1] - t[0]) / usual + 1.0 - t.len() as f64;
    if let Some((first, _)) = lost.first().filter(|_| missing >= 1.0 && in_all > 0.5 * missing) {
        let share = 100.0 * missing / (missing + t.len() as f64);
        let (samples_are, after) = (if missing > 1.0 { "samples are" } else { "sample is" }, seconds(*first));
        let sentence = match lost.len() {
            1 => format!("{missing} {samples_are} missing ({share:.2} %) after {after} s: {UNKNOWN}"),
            places => format!(
                "{missing} {samples_are} missing in {places} places ({share:.2} %), the first after {after} s: {UNKNOWN}"
            ),
        };
        said.push(Remark::new("t", "lost", sentence));
    }
    let whole = || distances().map(|(_, distance)| distance).filter(|distance| *distance <= LOST * usual);
    let count = whole().count().max(1) as f64;
    let spread = (whole().map(|distance| (distance - usual).powi(2)).sum::<f64>() / count).sqrt() / usual;
    if spread > UNEVEN {
        let sentence = format!(
            "the distance of two samples varies by {:.0} % (std) about {} s: times are used as they are; where they are those \
             of a computer and not of the sensor, a rate in their place is nearer the truth",
            100.0 * spread,
            digits(usual, 4)
        );
        said.push(Remark::new("t", "uneven", sentence));
    }
    if let Some(samples) = period.map(|period| period / usual).filter(|samples| *samples < FEW) {
        let sentence = format!(
            "a natural period has {samples:.1} samples only: what the motion does between them is a guess; sample ten times as fast as \
             the fastest motion"
        );
        said.push(Remark::new("t", "slow", sentence));
    }
    said
}
