//! Coefficients that move while the record runs: slow drift, and moves that are no jumps.
//!
//! A segment has one law. Where none explains its record because the coefficients move, they are tracked here: weak
//! rows against variations φ with ∫ φ dt = 0, which leave an offset of the sensor out, are the measurements of a random
//! walk ([`super::random_walk`]). How far the coefficients wander and how far the law errs is a bank of rivals
//! ([`super::variation_length`]), weighed by their predictions. Long variations keep more noise and faster modes out,
//! short ones follow sooner: the length whose next row is predicted best, relative to its size, is taken.
//!
//! Coefficients that drift are told from constant ones by the likelihood of the rivals that wander to that of those
//! that do not.

use super::oscillation::Oscillation;
use super::variation_length::VariationLength;
use crate::estimation::OVERLAP;
use crate::identify::problem::Problem;
use crate::identify::section::{LONGEST_VARIATION, SectionBuffer, deserialize_room, serialize_room};
use crate::identify::window::Window;
use crate::weak::{Row, Variation};
use serde::{Deserialize, Serialize};

/// Samples in the shortest variation: its second sine still has 32 a period.
const SHORTEST: usize = 64;

/// Odd about its middle, so that its integral is zero; smooth enough to keep faster modes out.
const VARIATION: Variation = Variation::SmoothSine { mode: 2 };

/// For how many of the longest variations a row counts in the choice of the length.
const MEMORY: f64 = 16.0;

/// Evidence for any law at all from which on one is shown, nats: e²⁰ to one against a row that nothing predicts.
const SEEN: f64 = 20.0;

/// Evidence of wandering, nats (odds of 400 to one), that must have lasted …
const MOVING: f64 = 6.0;

/// … for this many rows: a jump is far from every constant law for the length of a variation.
const LASTING: u32 = 2 * OVERLAP as u32;

/// For how many variations a constant law is waited for.
const PATIENCE: u64 = 8;

/// Coefficients as they move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WeakRowDrift {
    lengths: Vec<VariationLength>,
    oscillation: Oscillation,
    #[serde(serialize_with = "serialize_room", deserialize_with = "deserialize_room")]
    section: SectionBuffer,
    row: Row,
    chosen: usize,
    moving: u32,
}

impl WeakRowDrift {
    /// Room for the problem's unknowns and for variations up to a quarter of the window.
    pub fn new(problem: &Problem, capacity: usize) -> WeakRowDrift {
        let longest = LONGEST_VARIATION.min(capacity / 4).max(SHORTEST);
        let lengths = (0..).map(|octave| SHORTEST << octave).take_while(|samples| *samples <= longest);
        WeakRowDrift {
            lengths: lengths.map(|samples| VariationLength::new(problem, samples)).collect(),
            oscillation: Oscillation::default(),
            section: SectionBuffer::new(longest + 1),
            row: Row::new(problem.terms.len()),
            chosen: 0,
            moving: 0,
        }
    }

    /// Forgets the coefficients, but not which length tells most; rows begin at sample `start`.
    pub fn restart(&mut self, start: u64) {
        self.lengths.iter_mut().for_each(|length| length.restart(start));
        self.moving = 0;
    }

    /// Takes the newest sample of the window and forms at most one row, under sensor noise of these variances; returns
    /// whether the law was renewed. Unless it is to be `thorough`, the rows of the lengths that are not in use do not
    /// overlap.
    pub fn step(&mut self, problem: &Problem, window: &Window, sensor: [f64; 2], thorough: bool) -> bool {
        self.oscillation.step(window.sample(window.end() - 1).q);
        let due = |length: &VariationLength| length.next < window.end();
        let Some(index) = self.lengths.iter().position(due) else { return false };
        let overlap = if thorough || index == self.chosen { OVERLAP } else { 1 };
        self.form_row(problem, window, sensor, index, overlap) && self.choose(index)
    }

    fn form_row(&mut self, problem: &Problem, window: &Window, sensor: [f64; 2], index: usize, overlap: usize) -> bool {
        let longest = self.lengths.last().map_or(0, |length| length.samples);
        let length = &mut self.lengths[index];
        let (first, last) = (length.next - length.samples as u64, length.next);
        length.next += (length.samples / overlap) as u64;
        if first < window.oldest() {
            return false;
        }
        self.section.load(problem, window, first, last);
        let section = self.section.view(problem, length.samples + 1);
        self.row.integrate(&section, VARIATION, &problem.motion(&problem.terms, &length.all));
        let memory = MEMORY * longest as f64 / length.samples as f64;
        if length.evidence == 0.0 {
            length.predicts_from = first;
        }
        length.take(problem, &self.row, sensor, (overlap as f64).recip(), memory);
        true
    }

    /// Takes the length with the best score; returns whether its law is new.
    fn choose(&mut self, renewed: usize) -> bool {
        let before = self.chosen;
        for (index, length) in self.lengths.iter().enumerate() {
            if length.score() > self.lengths[self.chosen].score() {
                self.chosen = index;
            }
        }
        if self.chosen != before {
            self.moving = 0;
        } else if self.chosen == renewed {
            let wandering = self.law().wandering();
            self.moving = if wandering > MOVING { self.moving + 1 } else { 0 };
        }
        self.chosen == renewed
    }

    fn law(&self) -> &VariationLength {
        &self.lengths[self.chosen]
    }

    /// Whether the coefficients move: constant ones have been improbable for some time.
    pub fn is_moving(&self) -> bool {
        self.moving >= LASTING
    }

    /// Whether that has been so for long enough for a constant law to be found, had there been one.
    pub fn has_no_rest(&self, window: &Window) -> bool {
        let patience = PATIENCE * self.law().samples as u64;
        self.is_moving() && window.end() > self.law().predicts_from + patience
    }

    /// Whether the law predicts anything.
    pub fn predicts(&self) -> bool {
        self.law().evidence > SEEN
    }

    /// Whether the variations are longer than half an oscillation: below that no record of its own gives an acceptable
    /// law.
    pub fn spans_half(&self) -> bool {
        self.law().samples as f64 > self.oscillation.half_period()
    }

    /// Free coefficients.
    pub fn coefficients(&self) -> &[f64] {
        &self.law().coefficients
    }

    /// Std of the free coefficient; infinite where the rows do not determine it.
    pub fn std(&self, free: usize) -> f64 {
        self.law().variances[free].sqrt()
    }

    /// Variance that is stated for e of eq. (8), of the coefficients that the rows determine.
    pub fn stated_error(&self) -> f64 {
        let law = self.law();
        let known = law.variances.iter().filter(|variance| variance.is_finite());
        known.sum::<f64>() / law.all.iter().map(|value| value * value).sum::<f64>()
    }

    /// The same of all coefficients: one that the rows do not determine is as uncertain as its term may be large.
    pub fn whole_error(&self) -> f64 {
        let law = self.law();
        let variance = |free: usize| law.variances[free].min(law.reach(free).powi(2));
        let sum: f64 = (0..law.variances.len()).map(variance).sum();
        sum / law.all.iter().map(|value| value * value).sum::<f64>()
    }

    /// Whether the rows say anything of the free coefficient: it is known better than that its term may be as large as
    /// the right side.
    pub fn determines(&self, free: usize) -> bool {
        self.std(free) < self.reach(free)
    }

    /// The value of the free coefficient at which its term alone would be as large as the right side.
    pub fn reach(&self, free: usize) -> f64 {
        self.law().reach(free)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::sample::Sample;
    use crate::identify::settings::Settings;
    use crate::law::{Given, Hold, Model};
    use crate::simulate::{Builtin, record};
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    /// What waits for a constant law waits from when the motion begins.
    #[test]
    fn the_rows_predict_from_where_the_motion_begins() {
        const REST: u64 = 6000;
        let builtin = Builtin::DuffingSine;
        let model = Model::of("Duffing", builtin.terms().into_iter().map(|term| (term, Given::Fit)));
        let problem = Problem::new(&model, &Settings::default());
        let mut scenario = builtin.random(1).with_noise(0.01);
        scenario.duration = 14.0;
        let mut window = Window::new(20_000, problem.channels, Hold::Zero);
        let mut drift = WeakRowDrift::new(&problem, 20_000);
        let mut generator = ChaCha8Rng::seed_from_u64(1);
        let mut noise = || 0.01 * generator.sample::<f64, _>(StandardNormal);
        for (index, reading) in record(&scenario).unwrap().iter().enumerate() {
            let (q, qd, excitation) = match (index as u64) < REST {
                true => (noise(), noise(), 0.0),
                false => (reading.q, reading.qd, reading.excitation),
            };
            window.push(Sample { t: reading.t, q, qd, excitation });
            drift.step(&problem, &window, [1e-4; 2], true);
        }
        let (from, length) = (drift.law().predicts_from, drift.law().samples as u64);
        assert!(drift.predicts() && (REST - length..=REST + length).contains(&from), "{from}, {length}");
    }
}
