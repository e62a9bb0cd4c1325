//! The law in weak form beside the filter: what a record tells where its errors are not those of white sensors.
//!
//! A likelihood with white noise puts lag, quantisation and unmodelled forces into sensors or process noise, and ends
//! in absurd maxima. Weak rows take them for what they are, errors of the equation. The rows here are Poisson moment
//! functionals ([`crate::weak::Functional`]) of ten lengths, an octave apart, over samples that are averaged pair by
//! pair: a sample costs as much as two octaves, whatever the longest is, and the whole segment counts though no sample
//! is kept.
//!
//! The octave in use has its rate a near ten times rms q̈ ÷ rms q̇ of the motion, so that φ passes some four times the
//! motion's frequency, as windows of 0.3 T₀ do. The std is that of the scatter between blocks of time ([`regression`]),
//! and of how far the estimate moves when the variation is half or twice as long: what a coefficient owes to the scale
//! is not known of it.

mod octave;
mod regression;

use super::problem::Problem;
use super::report::Coefficient;
use super::sample::Sample;
use crate::law::Hold;
use crate::weak::Functional;
use octave::{ADVANCE, Octave, Sensors};
use regression::{Estimate, Regression};
use serde::{Deserialize, Serialize};

/// Octaves: of the longest variation two rows are 512 samples apart.
const OCTAVES: usize = 10;

/// Rate of the variation over the motion's frequency: five stages pass 0.39 a, four times the motion's frequency …
const RATIO: f64 = 10.0;

/// … which must at least be passed itself; twice the ratio is the octave beside the right one.
const PASSED: std::ops::RangeInclusive<f64> = 2.6..=2.0 * RATIO;

/// Octaves below the fitting one that go on: one to compare with, and one more where the motion quickens.
const SPARE: usize = 2;

/// No sensor resolves a smaller part of its range: 20 bits.
const RESOLUTION: f64 = 1e-6;

/// A coefficient is told to lack so many records like the one there is, at most: scatter falls with the length as long
/// as the motion stays.
const FORESEEN: f64 = 10.0;

/// The running estimate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WeakForm {
    octaves: Vec<Octave>,
    regression: Regression,
    gains: [f64; 3],
    /// The first octave that forms rows.
    finest: usize,
    begun: Option<f64>,
    last: Option<Sample>,
    /// ∫ q̇ dt, where the displacement is not measured.
    travelled: f64,
}

impl WeakForm {
    /// Room for the problem's unknowns.
    pub fn new(problem: &Problem) -> WeakForm {
        let n = problem.n();
        WeakForm {
            octaves: vec![Octave::new(n); OCTAVES],
            regression: Regression::new(n),
            gains: [0, 1, 2].map(|order| Functional::noise_gain(order, ADVANCE)),
            finest: 0,
            begun: None,
            last: None,
            travelled: 0.0,
        }
    }

    /// Forgets all samples: what comes may obey another law.
    pub fn restart(&mut self) {
        (self.begun, self.last) = (None, None);
    }

    /// Takes an accepted sample; the first two tell how far apart they are.
    pub fn step(&mut self, problem: &Problem, sample: Sample) {
        let Some(last) = self.last.replace(sample) else { return };
        let dt = sample.t - last.t;
        if self.begun.is_none() {
            self.begin(last.t, dt);
        }
        self.travelled += 0.5 * dt * (last.qd + sample.qd);
        let mut next = Some(Sample {
            q: if problem.channels.q { sample.q } else { self.travelled },
            excitation: match problem.timing.hold {
                // the mean of what was held half an interval before and after
                Hold::Zero => 0.5 * (last.excitation + sample.excitation),
                _ => sample.excitation,
            },
            ..sample
        });
        for (index, octave) in self.octaves.iter_mut().enumerate() {
            let Some(averaged) = next else { return };
            next = if index < self.finest { octave.average(averaged) } else { octave.take(problem, averaged) };
        }
    }

    fn begin(&mut self, t: f64, dt: f64) {
        (self.begun, self.travelled) = (Some(t), 0.0);
        self.finest = 0;
        let mut averaged = 1.0;
        for octave in &mut self.octaves {
            octave.begin(averaged, averaged * dt);
            averaged *= 2.0;
        }
    }

    /// Ends the rows of octaves too fine for the motion, under sensor noise of these variances: they cost more than all
    /// others. Where the motion has quickened they begin anew.
    pub fn rest(&mut self, problem: &Problem, variance: [f64; 2]) {
        let sensors = Sensors { variance, gains: self.gains };
        let Some(fitting) = self.fitting(problem, &sensors) else { return };
        let finest = fitting.saturating_sub(SPARE);
        for index in finest..self.finest {
            self.octaves[index].resume();
        }
        self.finest = finest;
    }

    /// The octave that fits the motion: the nearest in rate, if it has rows enough.
    fn fitting(&self, problem: &Problem, sensors: &Sensors) -> Option<usize> {
        let ratio = |octave: &Octave| Some(octave.rate() / octave.frequency(problem, sensors)?);
        let off = |ratio: f64| (ratio / RATIO).ln().abs();
        let octaves = self.octaves.iter().enumerate().skip(self.finest);
        let ratios = octaves.filter_map(|(index, octave)| Some((index, ratio(octave)?)));
        let (index, ratio) = ratios.min_by(|a, b| off(a.1).total_cmp(&off(b.1)))?;
        (PASSED.contains(&ratio) && self.octaves[index].is_ready()).then_some(index)
    }

    /// Whether an inertia can be told from none by any sensor: it is above zero, and its force more than a millionth of
    /// the right side.
    pub fn resolves(&self, inertia: f64) -> bool {
        let [acceleration, right] = self.octaves[0].amplitudes();
        inertia > 0.0 && inertia * acceleration >= RESOLUTION * right
    }

    /// Writes the coefficients that are known to better than their own size, under sensor noise of these variances;
    /// returns the share of the force that the law explains, none where no coefficient is known or the law is none: one
    /// with an inertia below zero, or that explains nothing. Solves one octave at most.
    pub fn publish(&mut self, problem: &Problem, variance: [f64; 2], shown: &mut [Coefficient]) -> Option<f64> {
        let sensors = Sensors { variance, gains: self.gains };
        let fitting = self.fitting(problem, &sensors)?;
        let near = fitting.saturating_sub(1).max(self.finest)..(fitting + 2).min(OCTAVES);
        let WeakForm { octaves, regression, .. } = self;
        for octave in &mut octaves[near.clone()] {
            if octave.solve(problem, &sensors, regression) {
                break;
            }
        }
        let compared = Compared { own: octaves[fitting].estimate(), octaves: &octaves[near] };
        if !compared.is_law(problem) {
            return None;
        }
        compared.write(problem, self.last?.t - self.begun?, shown);
        Some(1.0 - compared.own.error * compared.own.error)
    }
}

/// An estimate beside those from variations half and twice as long, itself among them.
struct Compared<'a> {
    own: &'a Estimate,
    octaves: &'a [Octave],
}

impl Compared<'_> {
    /// Estimates of other lengths, and this one.
    fn lengths(&self) -> impl Iterator<Item = &Estimate> {
        self.octaves.iter().map(Octave::estimate).filter(|estimate| estimate.is_known())
    }

    /// Of the scatter in time, and of how far another length moves the coefficient.
    fn std(&self, free: usize) -> f64 {
        let value = self.own.coefficients[free];
        let moved = self.lengths().map(|other| (other.coefficients[free] - value).abs()).fold(0.0, f64::max);
        self.own.std[free].hypot(moved)
    }

    fn knows(&self, free: usize) -> bool {
        self.std(free) < self.own.coefficients[free].abs()
    }

    /// Whether there is anything to compare with, and what is known can be a law.
    fn is_law(&self, problem: &Problem) -> bool {
        let inverted = problem.free_inertia().is_some_and(|free| self.knows(free) && self.own.coefficients[free] < 0.0);
        let known = (0..problem.n()).any(|free| self.knows(free));
        self.own.error < 1.0 && self.lengths().count() > 1 && known && !inverted
    }

    /// Writes what is known from a record of this length, s, and how much more of it the rest needs.
    fn write(&self, problem: &Problem, length: f64, shown: &mut [Coefficient]) {
        for (index, coefficient) in shown.iter_mut().enumerate() {
            match problem.free.iter().position(|free| *free == index) {
                None => (coefficient.value, coefficient.std) = (problem.known[index], Some(0.0)),
                Some(free) => {
                    let (value, std) = (self.own.coefficients[free], self.std(free));
                    let growth = (std / value).powi(2) - 1.0;
                    coefficient.needed = (0.0..FORESEEN).contains(&growth).then_some(growth * length);
                    if std < value.abs() {
                        (coefficient.value, coefficient.std) = (value, Some(std));
                    }
                }
            }
        }
    }
}
