//! A recording: what was measured, sample by sample.

use super::sample::{GAP, Sample};
use super::settings::{Channels, Settings};
use std::ops::Range;
use thiserror::Error;

/// Times the shortest distance of two samples, a `sample_time` under which none comes too soon.
const NEVER_TOO_SOON: f64 = 1.9;

/// Measured signals over increasing time, SI units; each signal has as many values as there are times.
///
/// Where a sensor gave no reading at a sample, that one is no sample of the signals but [incomplete]: they leave it out
/// as a gap does, and only the stream sees it.
///
/// [incomplete]: Recording::incomplete
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    t: Vec<f64>,
    q: Option<Vec<f64>>,
    qd: Option<Vec<f64>>,
    excitation: Option<Vec<f64>>,
    source: String,
    incomplete: Vec<Sample>,
}

/// A time without samples, far longer than the usual distance of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Time of the last sample before it, s.
    pub start: f64,
    /// Time of the first sample after it, s.
    pub end: f64,
}

/// Why signals are no recording.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RecordingError {
    /// Too short to hold any motion.
    #[error("{source_name}: {count} samples are too few: at least {} are needed", Recording::MINIMUM)]
    TooFew {
        /// Where it came from.
        source_name: String,
        /// How many samples there are.
        count: usize,
    },
    /// Too few samples of which no reading is missing.
    #[error(
        "{source_name}: of {of} samples {count} have a reading of every channel, but at least {} are needed: \
         where sensors are read at different times, resample them, or leave a channel out",
        Recording::MINIMUM
    )]
    TooFewWhole {
        /// Where it came from.
        source_name: String,
        /// How many samples are whole.
        count: usize,
        /// How many there are.
        of: usize,
    },
    /// A signal without any reading.
    #[error("{source_name}: {channel} has no reading at all: leave it out, or name another signal")]
    NoReading {
        /// Where it came from.
        source_name: String,
        /// Which signal.
        channel: &'static str,
    },
    /// Signals of different length.
    #[error("{source_name}: {channel} has {found} values for {expected} times")]
    Length {
        /// Where it came from.
        source_name: String,
        /// Which signal.
        channel: &'static str,
        /// How many values it has.
        found: usize,
        /// How many it must have.
        expected: usize,
    },
    /// A value that is infinite, none, or so large that its square is.
    #[error(
        "{source_name}: {channel} of sample {index} is not a finite number, or one that no sensor reads: correct it or leave the sample out"
    )]
    NotFinite {
        /// Where it came from.
        source_name: String,
        /// Which signal.
        channel: &'static str,
        /// Which sample, from 0.
        index: usize,
    },
    /// Time that does not increase.
    #[error("{source_name}: time does not increase at sample {index}: {previous} s, then {t} s")]
    NotIncreasing {
        /// Where it came from.
        source_name: String,
        /// Which sample, from 0.
        index: usize,
        /// The time before, s.
        previous: f64,
        /// Its time, s.
        t: f64,
    },
    /// Neither displacement nor velocity.
    #[error("{source_name}: neither q nor qd is measured: one of them is needed")]
    NothingMeasured {
        /// Where it came from.
        source_name: String,
    },
    /// A motion that never moves.
    #[error(
        "{source_name}: {channel} is {value} in every sample: a motion that stands still determines no law; check the sensor, \
         or leave the column out if another one measures the motion"
    )]
    Constant {
        /// Where it came from.
        source_name: String,
        /// Which signal.
        channel: &'static str,
        /// Its only value.
        value: f64,
    },
}

impl Recording {
    /// Fewest samples of a recording.
    pub const MINIMUM: usize = 10;

    /// Largest reading of one: the square of a larger one is no number, and no sensor reads it.
    pub const LARGEST: f64 = 1e150;

    /// Whether a value is a reading that can be computed with.
    pub fn is_reading(value: f64) -> bool {
        value.abs() <= Recording::LARGEST
    }

    /// A recording from signals in SI units; `source` names it in messages.
    ///
    /// # Errors
    /// [`RecordingError`] names the signal and the sample at fault.
    pub fn new(
        source: &str,
        t: Vec<f64>,
        q: Option<Vec<f64>>,
        qd: Option<Vec<f64>>,
        excitation: Option<Vec<f64>>,
    ) -> Result<Recording, RecordingError> {
        let recording = Recording { t, q, qd, excitation, source: source.into(), incomplete: Vec::new() };
        recording.check_signals(Recording::is_reading)?;
        recording.check_motion()?;
        Ok(recording)
    }

    /// The same where NaN in q, q̇ or F is a reading that the sensor did not give.
    ///
    /// # Errors
    /// [`RecordingError`] names the signal and the sample at fault.
    pub fn with_missing(
        source: &str,
        t: Vec<f64>,
        q: Option<Vec<f64>>,
        qd: Option<Vec<f64>>,
        excitation: Option<Vec<f64>>,
    ) -> Result<Recording, RecordingError> {
        let all = Recording { t, q, qd, excitation, source: source.into(), incomplete: Vec::new() };
        all.check_signals(|value| value.is_nan() || Recording::is_reading(value))?;
        let source_name = all.source.clone();
        if let Some((channel, _)) = all.signals().find(|(_, values)| values.iter().all(|value| value.is_nan())) {
            return Err(RecordingError::NoReading { source_name, channel });
        }
        let is_whole = |index: &usize| all.signals().all(|(_, values)| !values[*index].is_nan());
        let (whole, lacking): (Vec<usize>, Vec<usize>) = (0..all.count()).partition(is_whole);
        if lacking.is_empty() {
            return all.check_motion().map(|()| all);
        }
        if whole.len() < Recording::MINIMUM {
            return Err(RecordingError::TooFewWhole { source_name, count: whole.len(), of: all.count() });
        }
        let incomplete = lacking.into_iter().map(|index| all.sample(index)).collect();
        let kept = all.cut(|values| whole.iter().map(|index| values[*index]).collect())?;
        Ok(Recording { incomplete, ..kept })
    }

    /// Checks lengths, times and that every value `fits`.
    fn check_signals(&self, fits: impl Fn(f64) -> bool) -> Result<(), RecordingError> {
        let source_name = self.source.clone();
        if self.q.is_none() && self.qd.is_none() {
            return Err(RecordingError::NothingMeasured { source_name });
        }
        if self.t.len() < Recording::MINIMUM {
            return Err(RecordingError::TooFew { source_name, count: self.t.len() });
        }
        self.check_signal("t", &self.t, Recording::is_reading)?;
        for (channel, values) in self.signals() {
            self.check_signal(channel, values, &fits)?;
        }
        match self.t.windows(2).position(|pair| pair[1] <= pair[0]) {
            Some(index) => {
                let (previous, t) = (self.t[index], self.t[index + 1]);
                Err(RecordingError::NotIncreasing { source_name, index: index + 1, previous, t })
            }
            None => Ok(()),
        }
    }

    fn check_signal(
        &self,
        channel: &'static str,
        values: &[f64],
        fits: impl Fn(f64) -> bool,
    ) -> Result<(), RecordingError> {
        let source_name = self.source.clone();
        let (found, expected) = (values.len(), self.t.len());
        if found != expected {
            return Err(RecordingError::Length { source_name, channel, found, expected });
        }
        match values.iter().position(|value| !fits(*value)) {
            Some(index) => Err(RecordingError::NotFinite { source_name, channel, index }),
            None => Ok(()),
        }
    }

    fn check_motion(&self) -> Result<(), RecordingError> {
        let source_name = self.source.clone();
        match self.signals().find(|(channel, values)| *channel != "F" && is_constant(values)) {
            Some((channel, values)) => Err(RecordingError::Constant { source_name, channel, value: values[0] }),
            None => Ok(()),
        }
    }

    fn signals(&self) -> impl Iterator<Item = (&'static str, &[f64])> {
        let all = [("q", &self.q), ("qd", &self.qd), ("F", &self.excitation)];
        all.into_iter().filter_map(|(channel, values)| Some((channel, values.as_deref()?)))
    }

    /// Where it came from.
    pub fn source(&self) -> &str {
        &self.source
    }

    /// The times, s.
    pub fn t(&self) -> &[f64] {
        &self.t
    }

    /// The readings of `q`, `qd` or `F`, where they are measured.
    pub fn signal(&self, channel: &str) -> Option<&[f64]> {
        self.signals().find(|(name, _)| *name == channel).map(|(_, values)| values)
    }

    /// The samples of which a reading is missing, NaN in its place, in the order of time.
    pub fn incomplete(&self) -> &[Sample] {
        &self.incomplete
    }

    /// How many samples came, with the incomplete ones.
    pub fn came(&self) -> usize {
        self.count() + self.incomplete.len()
    }

    /// How many samples it has; at least [`Recording::MINIMUM`].
    pub fn count(&self) -> usize {
        self.t.len()
    }

    /// Which quantities are measured. An excitation that is 0 throughout is none: the motion is free.
    pub fn channels(&self) -> Channels {
        let forced = self.excitation.as_deref().is_some_and(|values| values.iter().any(|value| *value != 0.0));
        Channels { q: self.q.is_some(), qd: self.qd.is_some(), excitation: forced }
    }

    /// Sample `index`; 0 stands for a quantity that is not measured.
    pub fn sample(&self, index: usize) -> Sample {
        let value = |values: &Option<Vec<f64>>| values.as_deref().map_or(0.0, |values| values[index]);
        Sample { t: self.t[index], q: value(&self.q), qd: value(&self.qd), excitation: value(&self.excitation) }
    }

    /// The samples of a piece as they came, with the incomplete ones up to the next piece; the first piece's with those
    /// before it.
    pub fn stream(&self, piece: Range<usize>) -> impl Iterator<Item = Sample> {
        let before = |index: usize| match self.t.get(index) {
            Some(t) => self.incomplete.partition_point(|sample| sample.t < *t),
            None => self.incomplete.len(),
        };
        let first = if piece.start == 0 { before(0) } else { 0 };
        let with_next = move |index: usize| {
            let incomplete = &self.incomplete[before(index)..before(index + 1)];
            std::iter::once(self.sample(index)).chain(incomplete.iter().copied())
        };
        self.incomplete[..first].iter().copied().chain(piece.flat_map(with_next))
    }

    /// The usual distance of two samples, s: the median.
    pub fn sample_time(&self) -> f64 {
        let mut distances: Vec<f64> = self.t.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let middle = distances.len() / 2;
        *distances.select_nth_unstable_by(middle, f64::total_cmp).1
    }

    /// The shortest distance of two samples, s.
    pub fn shortest_interval(&self) -> f64 {
        self.t.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min)
    }

    /// The gaps, in the order of time: distances of more than a few usual ones. Nothing may be integrated over them.
    pub fn gaps(&self) -> Vec<Gap> {
        let longest = GAP * self.sample_time();
        let pairs = self.t.windows(2).filter(|pair| pair[1] - pair[0] > longest);
        pairs.map(|pair| Gap { start: pair[0], end: pair[1] }).collect()
    }

    /// The gaps in which no sample at all came, not even an incomplete one.
    pub fn silences(&self) -> Vec<Gap> {
        let came = |gap: &Gap| {
            let next = self.incomplete.partition_point(|sample| sample.t < gap.start);
            self.incomplete.get(next).is_some_and(|sample| sample.t < gap.end)
        };
        self.gaps().into_iter().filter(|gap| !came(gap)).collect()
    }

    /// A part of it, by the positions of its samples; without those that are incomplete.
    ///
    /// # Errors
    /// [`RecordingError`] where the part has too few samples, or does not move.
    pub fn section(&self, range: Range<usize>) -> Result<Recording, RecordingError> {
        self.cut(|values| values[range.clone()].to_vec())
    }

    /// The recording of what is cut from every signal.
    fn cut(&self, cut: impl Fn(&[f64]) -> Vec<f64>) -> Result<Recording, RecordingError> {
        let of = |values: &Option<Vec<f64>>| values.as_deref().map(&cut);
        Recording::new(&self.source, cut(&self.t), of(&self.q), of(&self.qd), of(&self.excitation))
    }

    /// Evenly spread parts of it, `most` samples together, with gaps between them; none where it is not at least twice
    /// as long.
    pub fn spread(&self, most: usize, parts: usize) -> Option<Recording> {
        let length = most / parts;
        if self.count() < 2 * most || parts < 2 || length < Recording::MINIMUM {
            return None;
        }
        let start = |part: usize| (self.count() - length) * part / (parts - 1);
        self.cut(|values| (0..parts).flat_map(|part| values[start(part)..][..length].to_vec()).collect()).ok()
    }

    /// The runs of samples between gaps.
    pub fn pieces(&self) -> Vec<Range<usize>> {
        let cuts = self.gaps().into_iter().map(|gap| self.t.partition_point(|t| *t < gap.end));
        let cuts: Vec<usize> = std::iter::once(0).chain(cuts).chain([self.t.len()]).collect();
        cuts.windows(2).map(|pair| pair[0]..pair[1]).collect()
    }
}

fn is_constant(values: &[f64]) -> bool {
    values.iter().all(|value| *value == values[0])
}

/// Settings that fit a recording: its channels, a `sample_time` that is its own and thins nothing, a window that holds
/// enough samples.
pub fn settings_for(recording: &Recording, base: Settings) -> Settings {
    let sample_time = recording.sample_time().min(NEVER_TOO_SOON * recording.shortest_interval());
    let max_window = base.max_window.clamp(2e3 * sample_time, 1e6 * sample_time);
    Settings { channels: recording.channels(), sample_time, max_window, ..base }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(t: Vec<f64>) -> Recording {
        let q = t.iter().map(|t| 2.0 * t).collect();
        Recording::new("ramp", t, Some(q), None, None).unwrap()
    }

    #[test]
    fn gaps_cut_a_recording_into_pieces() {
        let t: Vec<f64> = (0..40).map(|n| f64::from(n) * 0.1 + if n >= 15 { 2.0 } else { 0.0 }).collect();
        let recording = ramp(t.clone());
        assert!((recording.sample_time() - 0.1).abs() < 1e-12);
        assert_eq!(recording.gaps(), [Gap { start: t[14], end: t[15] }]);
        assert_eq!(recording.pieces(), [0..15, 15..40]);
    }

    #[test]
    fn the_stream_has_the_samples_that_lack_a_reading() {
        let t: Vec<f64> = (0..30).map(f64::from).collect();
        let missing = [0, 1, 7, 12, 13, 14, 15, 16, 29];
        let q = (0..30).map(|n| if missing.contains(&n) { f64::NAN } else { f64::from(n) }).collect();
        let recording = Recording::with_missing("x", t.clone(), Some(q), Some(t.clone()), None).unwrap();
        assert_eq!((recording.count(), recording.incomplete().len(), recording.sample(0).q), (21, 9, 2.0));
        let times = |piece| recording.stream(piece).map(|sample| sample.t).collect::<Vec<f64>>();
        assert_eq!(times(0..21), t);
        let pieces: Vec<Vec<f64>> = recording.pieces().into_iter().map(times).collect();
        assert_eq!((pieces.len(), pieces.concat()), (2, t.clone()));
        let lacking: Vec<f64> = recording.stream(0..21).filter(|s| s.q.is_nan()).map(|s| s.t).collect();
        assert_eq!(lacking, missing.map(f64::from));
        assert_eq!((recording.gaps().len(), recording.silences().len()), (1, 0));
        assert_eq!(recording.section(3..20).unwrap().incomplete().len(), 0);
    }

    #[test]
    fn what_is_missing_must_not_be_everything() {
        let t: Vec<f64> = (0..30).map(f64::from).collect();
        let new = |q: Vec<f64>| Recording::with_missing("x", t.clone(), Some(t.clone()), Some(q), None);
        assert!(matches!(new(vec![f64::NAN; 30]), Err(RecordingError::NoReading { channel: "qd", .. })));
        let few = (0..30).map(|n| if n % 4 == 0 { f64::from(n) } else { f64::NAN }).collect();
        assert!(matches!(new(few), Err(RecordingError::TooFewWhole { count: 8, of: 30, .. })));
        let mut wrong = t.clone();
        wrong[4] = f64::INFINITY;
        assert!(matches!(new(wrong), Err(RecordingError::NotFinite { channel: "qd", index: 4, .. })));
        assert!(Recording::new("x", t.clone(), Some(vec![f64::NAN; 30]), None, None).is_err());
    }

    #[test]
    fn parts_of_a_long_recording_are_spread_over_all_of_it() {
        let recording = ramp((0..1000).map(f64::from).collect());
        let parts = recording.spread(200, 4).unwrap();
        assert_eq!((parts.count(), parts.t()[0], parts.t()[199]), (200, 0.0, 999.0));
        assert_eq!(parts.pieces(), [0..50, 50..100, 100..150, 150..200]);
        assert_eq!(parts.sample(70).q, 2.0 * parts.t()[70]);
        assert_eq!(recording.spread(600, 4), None);
    }

    #[test]
    fn jitter_and_a_lost_sample_are_no_gap() {
        let t = (0..40).filter(|n| *n != 17).map(|n| f64::from(n) * 0.1 + 0.03 * f64::from(n % 3)).collect();
        let recording = ramp(t);
        assert!(recording.gaps().is_empty());
        assert_eq!(recording.pieces(), std::iter::once(0..39).collect::<Vec<_>>());
    }

    #[test]
    fn an_excitation_of_zeros_is_free_motion() {
        let t: Vec<f64> = (0..20).map(f64::from).collect();
        let forced = |force: f64| {
            Recording::new("x", t.clone(), Some(t.clone()), None, Some(vec![force; 20])).unwrap().channels().excitation
        };
        assert!(!forced(0.0));
        assert!(forced(1.0));
    }
}
