//! Readings of F that leave its course and return may be a burst of its sensor's or have acted; one that nothing can
//! have exerted is replaced.

use crate::estimation::{BEYOND_CHANCE, SAMPLES_OF_A_VARIANCE};
use crate::identify::reading::Reading;
use crate::identify::sample::Sample;
use serde::{Deserialize, Serialize};

/// Readings of a burst at most: an F that has been elsewhere for longer is there.
const LONGEST: u32 = 20;

/// Readings that moved after which it is known what F usually is …
const KNOWN: f64 = 100.0;

/// No actuator exerts this many times the RMS of what it has exerted, but one that has rested until now.
const ABSURD: f64 = 1e6;

/// What is usual for F, and whether it has just left that.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ExcitationGate {
    /// The last sample; none before the first.
    last: Option<Sample>,
    /// Readings in a row that nothing can have exerted, and the last of them.
    absurd: u32,
    beyond: f64,
    /// Where F was before it left its course, while it is away, for how many readings that has been, and the sum of
    /// the squares that they are off by.
    course: Option<f64>,
    away: u32,
    off: f64,
    /// Readings since it left, while that is not long ago, and how often it has jumped since; 0 else.
    since: u32,
    jumps: u32,
    /// Whether the last reading was replaced, or ends a burst that is a fault.
    faulty: bool,
    /// The burst that has just ended.
    ended: Option<Stray>,
    /// Mean squares of F, and of what it moves by.
    squares: [f64; 2],
    count: f64,
    /// Samples in which F goes as far as it usually is from 0.
    pace: f64,
}

/// Readings of F off its course, which it has returned to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stray {
    /// How many there were.
    pub readings: u32,
    /// Mean square of what they were off by, N².
    pub square: f64,
}

impl ExcitationGate {
    /// Takes a sample. The reading holds the white force that is left open for the interval: where the last F was
    /// replaced, or had repeated itself exactly `repeated` times where it varied before (a sender that has none to send
    /// sends the last again), and what was `missed` of one that moved by so much over so long.
    pub fn take(&mut self, sample: Sample, repeated: u64, missed: impl Fn(f64, f64) -> f64) -> Reading {
        let replaced = self.faulty && self.course.is_none() || (1..=u64::from(LONGEST)).contains(&repeated);
        let before = self.last.unwrap_or(Sample { excitation: 0.0, ..sample });
        let force = sample.excitation;
        let absurd = self.is_absurd(force);
        let force = if absurd { before.excitation } else { force };
        let moved = force - before.excitation;
        let scatter = if replaced { self.squares[1] } else { 0.0 };
        self.follow_course(before.excitation, force);
        self.faulty = absurd;
        let sample = Sample { excitation: force, ..sample };
        self.learn(force, moved);
        self.last = Some(sample);
        let dt = sample.t - before.t;
        Reading { unseen: scatter * dt + missed(dt, moved), ..Reading::from(sample) }
    }

    /// Whether nothing can have exerted F. A sensor's burst ends, and a sensor that is stuck repeats itself: readings
    /// that go on and vary are of an actuator that has begun to act.
    fn is_absurd(&mut self, force: f64) -> bool {
        let beyond = self.count > KNOWN && (force.is_nan() || force.abs() > ABSURD * self.size());
        let varies = force != self.beyond && !force.is_nan();
        self.absurd = if beyond { self.absurd + u32::from(varies) } else { 0 };
        self.beyond = force;
        beyond && self.absurd <= LONGEST
    }

    /// Whether F leaves its course, is away from it, or returns to it.
    fn follow_course(&mut self, before: f64, force: f64) {
        let (leaves, course) = (self.leaves(before, force, 1), self.course);
        // where its course has led meanwhile nobody has seen
        let returned = course.filter(|course| leaves && !self.leaves(*course, force, self.away + 1));
        self.ended = returned.map(|_| Stray { readings: self.away, square: self.off / f64::from(self.away) });
        (self.away, self.off) = if course.is_some() { (self.away, self.off) } else { (0, 0.0) };
        self.course = match returned {
            Some(_) => None,
            None => course.or(leaves.then_some(before)).filter(|_| self.away < LONGEST),
        };
        self.since = if self.since > 0 || self.course.is_some() { (self.since + 1) % (2 * LONGEST) } else { 0 };
        self.jumps = if self.since > 0 { self.jumps + u32::from(leaves) } else { 0 };
        if let Some(course) = self.course {
            (self.away, self.off) = (self.away + 1, self.off + (force - course).powi(2));
        }
    }

    /// Whether it is off its course.
    pub fn is_away(&self) -> bool {
        self.course.is_some()
    }

    /// Readings since F left its course, where that is so short ago that what the motion does may tell of it; none
    /// where it only went to another one.
    pub fn left(&self) -> Option<u32> {
        (self.jumps > 1).then_some(self.since)
    }

    /// The burst that has ended with the last reading.
    pub fn ended(&self) -> Option<Stray> {
        self.ended
    }

    /// RMS of F.
    pub fn size(&self) -> f64 {
        self.squares[0].sqrt()
    }

    /// What is expected to act of a force that is lost: none that F never is.
    pub fn expected(&self, force: f64) -> f64 {
        if force.abs() > BEYOND_CHANCE * self.size() { 0.0 } else { force }
    }

    /// Samples in which F goes as far as it usually is from 0, by what it did before it stood still.
    pub fn pace(&self) -> f64 {
        self.pace
    }

    /// The burst that has ended with the last reading is a fault.
    pub fn blame(&mut self) {
        self.faulty = true;
    }

    /// Whether the last reading of F was replaced, or ends a burst that is a fault.
    pub fn is_faulty(&self) -> bool {
        self.faulty
    }

    /// Whether one of two values of F is further from the other, that many samples apart, than F's size and pace let
    /// expect: what it keeps of where it was is its correlation, as if all its moves meanwhile went one way.
    fn leaves(&self, from: f64, to: f64, samples: u32) -> bool {
        let [square, moved] = self.squares;
        let kept = (1.0 - 0.5 * f64::from(samples).powi(2) * moved / square).max(0.0);
        let off = (to - kept * from).abs().max((from - kept * to).abs());
        self.count > KNOWN && off * off > BEYOND_CHANCE * BEYOND_CHANCE * (1.0 - kept * kept) * square
    }

    /// A reading that leaves its course tells little of what is usual, one of an F that stands still nothing: neither
    /// how large F is when it acts nor how fast it goes elsewhere.
    fn learn(&mut self, force: f64, moved: f64) {
        if moved == 0.0 {
            return;
        }
        self.count = (self.count + 1.0).min(SAMPLES_OF_A_VARIANCE);
        let moved = if self.count > 1.0 { moved * moved } else { 0.0 };
        let most = if self.count > KNOWN { BEYOND_CHANCE * BEYOND_CHANCE * self.squares[1] } else { f64::INFINITY };
        for (square, value) in self.squares.iter_mut().zip([force * force, moved.min(most)]) {
            *square += (value - *square) / self.count;
        }
        self.pace = if moved > 0.0 { (self.squares[0] / self.squares[1]).sqrt() } else { self.pace };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    fn sample(index: usize, excitation: f64) -> Sample {
        Sample { t: 1e-3 * index as f64, excitation, ..Sample::default() }
    }

    fn through(forces: &[f64]) -> Vec<Reading> {
        let mut gate = ExcitationGate::default();
        forces.iter().enumerate().map(|(index, force)| gate.take(sample(index, *force), 0, |_, _| 0.0)).collect()
    }

    fn sine() -> Vec<f64> {
        (0..500).map(|index| (0.0015 * f64::from(index)).sin()).collect()
    }

    /// The bursts that were told with each of the forces.
    fn ended(forces: &[f64]) -> Vec<(usize, Stray)> {
        let mut gate = ExcitationGate::default();
        let told = forces.iter().enumerate().filter_map(|(index, force)| {
            assert_eq!(gate.take(sample(index, *force), 0, |_, _| 0.0).sample.excitation, *force);
            gate.ended().map(|stray| (index, stray))
        });
        told.collect()
    }

    #[test]
    fn a_burst_is_told_when_it_has_ended() {
        for readings in [1, 7, 20] {
            let mut forces = sine();
            forces[300..300 + readings].iter_mut().zip(0..).for_each(|(force, k)| *force += [5.0, -4.0][k % 2]);
            let told = ended(&forces);
            let [(at, stray)] = told[..] else { panic!("{told:?}") };
            assert_eq!((at, stray.readings as usize), (300 + readings, readings));
            assert!((15.0..26.0).contains(&stray.square), "{stray:?}");
        }
    }

    /// White noise moves by more than it is: what it never is tells, not what it never moves by.
    #[test]
    fn a_burst_is_told_where_the_excitation_is_white() {
        let mut generator = ChaCha8Rng::seed_from_u64(18);
        let mut forces: Vec<f64> = (0..2000).map(|_| generator.sample(StandardNormal)).collect();
        let mut gate = ExcitationGate::default();
        forces[1990..].copy_from_slice(&[0.3, 6.5, 7.1, 6.8, 0.9, -0.4, 0.1, 0.8, -1.2, 0.2]);
        let jumps: Vec<Option<u32>> = forces
            .iter()
            .enumerate()
            .map(|(index, force)| {
                gate.take(sample(index, *force), 0, |_, _| 0.0);
                gate.left()
            })
            .collect();
        assert!(jumps[..1992].iter().all(Option::is_none));
        assert_eq!(jumps[1992..1995], [Some(2), Some(3), Some(4)]);
        assert!(!gate.is_away());
    }

    #[test]
    fn what_nothing_can_exert_is_replaced_by_the_force_before_it() {
        for size in [1e100, -f64::MAX] {
            let mut forces = sine();
            forces[300] = size;
            let seen: Vec<f64> = through(&forces).iter().map(|reading| reading.sample.excitation).collect();
            forces[300] = forces[299];
            assert_eq!(seen, forces);
        }
    }

    #[test]
    fn an_actuator_that_has_rested_acts_when_it_begins() {
        for rest in [0.0, 0.01] {
            let rest = || std::iter::repeat_n(rest, 50_000);
            let forces: Vec<f64> = rest().chain(sine()).chain(rest()).chain(sine()).collect();
            assert!(ended(&forces).is_empty());
        }
        // the noise of a force sensor, seven decades below what it then measures
        let mut forces: Vec<f64> = sine().iter().map(|force| 1e-7 * force).chain(sine()).collect();
        let seen: Vec<f64> = through(&forces).iter().map(|reading| reading.sample.excitation).collect();
        assert_eq!(seen[600..], forces[600..]);
        forces[500..].fill(1e100);
        let seen: Vec<f64> = through(&forces).iter().map(|reading| reading.sample.excitation).collect();
        assert!(seen[500..].iter().all(|force| *force == forces[499]));
    }

    #[test]
    fn an_excitation_that_is_held_for_long_keeps_its_pace() {
        let mut gate = ExcitationGate::default();
        let forces = sine().into_iter().chain(std::iter::repeat_n(0.5, 50_000));
        let paces: Vec<f64> = forces
            .enumerate()
            .map(|(index, force)| {
                gate.take(sample(index, force), 0, |_, _| 0.0);
                gate.pace()
            })
            .collect();
        assert!((200.0..1000.0).contains(&paces[499]), "{}", paces[499]);
        // the last move is the one to where it is held
        assert_eq!(paces[50_499], paces[500]);
    }

    #[test]
    fn a_step_is_no_burst() {
        let mut forces = sine();
        forces[300..].iter_mut().for_each(|force| *force += 0.5);
        assert!(ended(&forces).is_empty());
    }
}
