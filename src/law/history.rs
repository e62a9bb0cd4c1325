//! The excitation as a function of time, present and past.

use super::hold::Hold;

/// An excitation that can be asked for its past.
pub trait History {
    /// Values at the start, the middle and the end of `from` … `to` (s), a short piece of time within which it counts
    /// as smooth. One that jumps within the piece gives its mean over it three times.
    fn over(&self, from: f64, to: f64) -> [f64; 3];
}

impl<F: Fn(f64) -> f64> History for F {
    fn over(&self, from: f64, to: f64) -> [f64; 3] {
        [self(from), self(0.5 * (from + to)), self(to)]
    }
}

/// A recorded excitation. Before the first sample it counts as the first one, after the last as the last.
#[derive(Clone, Copy, Debug)]
pub struct Samples<'a> {
    /// Time, s, increasing.
    pub t: &'a [f64],
    /// Excitation, N.
    pub excitation: &'a [f64],
    /// What it did between samples; a band-limited one is interpolated by the cubic through four samples.
    pub hold: Hold,
}

/// Share of a sample interval by which rounding may displace a time.
const JITTER: f64 = 1e-6;

impl Samples<'_> {
    /// The value at time t, s; 0 without samples.
    pub fn at(&self, t: f64) -> f64 {
        self.after(self.index(t), t)
    }

    /// The value at time t, before which the sample of that position is the last.
    pub(super) fn after(&self, index: Option<usize>, t: f64) -> f64 {
        let Some(index) = index else { return self.excitation.first().copied().unwrap_or(0.0) };
        let last = self.excitation.len() - 1;
        if index >= last {
            return self.excitation[last];
        }
        let width = self.t[index + 1] - self.t[index];
        let position = (t - self.t[index]) / width;
        match self.hold {
            Hold::Zero if position > 1.0 - JITTER => self.excitation[index + 1],
            Hold::Zero => self.excitation[index],
            Hold::BandLimited if index > 0 && index + 2 <= last => self.cubic(index, t),
            _ => self.excitation[index] + position * (self.excitation[index + 1] - self.excitation[index]),
        }
    }

    /// The last sample not after t, none before the first.
    fn index(&self, t: f64) -> Option<usize> {
        self.t.partition_point(|time| *time <= t).checked_sub(1)
    }

    /// The cubic through the samples `index − 1` … `index + 2`.
    fn cubic(&self, index: usize, t: f64) -> f64 {
        let (times, values) = (&self.t[index - 1..index + 3], &self.excitation[index - 1..index + 3]);
        let weight = |own: usize| {
            let others = (0..4).filter(|other| *other != own);
            others.map(|other| (t - times[other]) / (times[own] - times[other])).product::<f64>()
        };
        values.iter().enumerate().map(|(own, value)| value * weight(own)).sum()
    }

    /// The mean of the held excitation over `from` … `to`.
    pub(super) fn held_mean(&self, from: f64, to: f64) -> f64 {
        let mut index = self.index(from).unwrap_or(0);
        let (mut start, mut sum) = (from, 0.0);
        while index + 1 < self.t.len() && self.t[index + 1] < to {
            let end = self.t[index + 1].max(start);
            sum += self.excitation[index] * (end - start);
            (start, index) = (end, index + 1);
        }
        sum += self.excitation.get(index).copied().unwrap_or(0.0) * (to - start);
        sum / (to - from)
    }
}

impl History for Samples<'_> {
    fn over(&self, from: f64, to: f64) -> [f64; 3] {
        match self.hold {
            Hold::Zero if to > from => [self.held_mean(from, to); 3],
            _ => [self.at(from), self.at(0.5 * (from + to)), self.at(to)],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const T: [f64; 5] = [0.0, 0.1, 0.2, 0.35, 0.4];
    const EXCITATION: [f64; 5] = [1.0, -2.0, 0.5, 4.0, 3.0];

    fn samples(hold: Hold) -> Samples<'static> {
        Samples { t: &T, excitation: &EXCITATION, hold }
    }

    #[test]
    fn a_held_excitation_has_its_mean_over_a_jump() {
        let held = samples(Hold::Zero);
        assert_eq!(held.over(0.02, 0.06), [1.0; 3]);
        let mean = held.over(0.05, 0.25)[0];
        assert!((mean - (0.05 - 0.2 + 0.025) / 0.2).abs() < 1e-12, "{mean}");
        assert_eq!((held.at(-1.0), held.at(0.0999), held.at(0.1 - 1e-12), held.at(9.0)), (1.0, 1.0, -2.0, 3.0));
        assert_eq!((held.over(-2.0, -1.0)[1], held.over(1.0, 2.0)[1]), (1.0, 3.0));
    }

    #[test]
    fn lines_and_cubics_are_reproduced() {
        assert!((samples(Hold::Linear).at(0.275) - 2.25).abs() < 1e-12);
        let cubic = |t: f64| 1.0 - 3.0 * t + 20.0 * t.powi(3);
        let values = T.map(cubic);
        let samples = Samples { t: &T, excitation: &values, hold: Hold::BandLimited };
        assert!((samples.at(0.17) - cubic(0.17)).abs() < 1e-12);
    }
}
