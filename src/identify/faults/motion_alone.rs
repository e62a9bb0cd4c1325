//! What readings are held against where no law is known: the motion itself.
//!
//! q̇ is what q moves by, and q̈ is u₀ + u₁ F, of which u₀ wanders and u₁ is constant. How fast q̈ wanders, and by how
//! much q is off the integral of q̇ (a channel that is late, filtered, or scaled otherwise), is the motion's own;
//! filters of several such roughnesses run beside each other, and the likeliest one is believed. A motion that leaves
//! all of them for longer than a fault would has refuted them: they begin anew, and what they then say is heard after
//! twice as long.

use super::expected::{Expected, Roughness};
use super::price::working;
use crate::estimation::{Channel, Filter, Noise, SAMPLES_OF_A_VARIANCE};
use crate::evidence::INERTIA_SPREAD;
use crate::law::{Drive, Motion, Term};
use serde::{Deserialize, Serialize};

/// Intervals over which a wandering q̈ takes q̇ as far as its sensor scatters: from a motion that is hardly sampled to
/// one of thousands of samples a period.
const SMOOTH: [f64; 5] = [3.0, 10.0, 30.0, 100.0, 300.0];

/// Part of its sensor's variance by which q is off the integral of q̇ after an interval: none, one that is seen after
/// thirty, and all of it.
const SLIP: [f64; 3] = [0.0, 1.0 / 30.0, 1.0];

/// Samples that the likelihood of a roughness is remembered for: longer than a fault of a second at 1 kHz.
const MEMORY: f64 = 2000.0;

/// Samples after which what is expected is known, first.
const NEEDED: u64 = 60;

/// Samples in which the unknowns are found: what is left over before says nothing of the sensors.
const SETTLED: u64 = 20;

/// A quarter of normal residuals has a square beyond this many variances.
const UPPER_QUARTER: f64 = 1.3233;

/// Samples that tell how far residuals usually are: the part beyond the upper quarter is known to a tenth of itself.
const USUAL: f64 = 400.0;

/// Factor by which the variance of a sensor follows residuals that are all beyond the upper quarter, once in so many.
const FOLLOWS: f64 = 4.0;

/// An acceleration, and what F adds to one, is this many times as large at first as takes q̇ as far as its sensor
/// scatters within an interval: anything.
const ANY: f64 = 100.0;

/// Std within which what F adds is told to be any.
const TOLD: f64 = 3.0;

const FREE_MASS: Motion<'static> = Motion::new(&[Term::Inertia], &[1.0]);

/// What the sensors and F are like where no law says so.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings {
    /// Variances of the sensors' noise, (m)² and (m/s)².
    pub noise: [f64; 2],
    /// Which of q and q̇ are measured.
    pub measured: [bool; 2],
    /// RMS of q and q̇.
    pub size: [f64; 2],
    /// RMS of F, N; 0 without one.
    pub force: f64,
}

/// Filters of the motion by its roughness.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionAlone {
    /// Of (q, q̇, u₀, u₁), u₁ counted from 1 kg⁻¹, and their log-likelihoods.
    filters: Vec<(Filter<4>, f64)>,
    /// Samples taken since they began, and after how many they are heard.
    taken: u64,
    needed: u64,
    /// Mean square of q̈.
    square: f64,
    /// Variances of the sensors, relative to those that were said.
    louder: [f64; 2],
}

impl MotionAlone {
    /// Nothing known.
    pub fn new() -> MotionAlone {
        let filters = vec![(Filter::default(), 0.0); SMOOTH.len() * SLIP.len()];
        MotionAlone { filters, taken: 0, needed: NEEDED, square: 0.0, louder: [1.0; 2] }
    }

    /// Begins with the next sample.
    pub fn restart(&mut self) {
        self.taken = 0;
    }

    /// What was expected was wrong for longer than a fault lasts.
    pub fn refute(&mut self) {
        self.restart();
        self.needed *= 2;
    }

    /// Whether what is expected is known.
    pub fn is_known(&self) -> bool {
        self.taken > self.needed
    }

    fn likeliest(&self) -> usize {
        let of = self.filters.iter().enumerate();
        of.max_by(|a, b| a.1.1.total_cmp(&b.1.1)).map_or(0, |(place, _)| place)
    }

    /// The likeliest filter.
    pub fn filter(&self) -> Filter<4> {
        self.filters[self.likeliest()].0
    }

    /// What was held has told where the motion is.
    pub fn put(&mut self, filter: &Filter<4>) {
        self.filters.iter_mut().for_each(|(own, _)| *own = *filter);
    }

    /// What the likeliest filter is carried by over an interval of `dt` s, over which a white force of that intensity,
    /// N² s, is open.
    pub fn expected(&self, around: &Surroundings, dt: f64, unseen: f64) -> Expected<'static> {
        self.expected_of(self.likeliest(), around, dt, unseen)
    }

    fn expected_of(&self, place: usize, around: &Surroundings, dt: f64, unseen: f64) -> Expected<'static> {
        let (filter, _) = &self.filters[place];
        let gain = (1.0 + filter.mean[3]).abs();
        let is_told = gain * gain > TOLD * TOLD * filter.covariance[3][3];
        let Surroundings { noise: [q, qd], measured, size, .. } = *around;
        let time = SMOOTH[place % SMOOTH.len()] * dt;
        // what q̈ does to q̇ grows with the cube of time, to q with the fifth power, a twentieth of it
        let acceleration = if measured[1] { qd / time.powi(3) } else { 20.0 * q / time.powi(5) };
        let inertia = is_told.then(|| gain.recip());
        let roughness = Roughness { acceleration, slip: q * SLIP[place / SMOOTH.len()] / dt, inertia };
        let expected = Expected {
            motion: FREE_MASS,
            noise: Noise { sensor: [q * self.louder[0], qd * self.louder[1]], process: 0.0 },
            caution: 1.0,
            switch: [self.square.sqrt(), INERTIA_SPREAD * gain],
            rate: 0.0,
            size,
            drive: self.square.sqrt(),
            unnoticed: 0.0,
            stuck: None,
            parts: 1,
            lag: 0.0,
            alone: Some(roughness),
        };
        Expected { noise: expected.noise_with(unseen, 0.0), ..expected }
    }

    /// Takes readings that are as expected, or of which nothing is known yet.
    pub fn take(&mut self, around: &Surroundings, dt: f64, drive: &Drive, unseen: f64, values: [Option<f64>; 2]) {
        if self.taken == 0 {
            return self.begin(around, dt, values);
        }
        for place in 0..self.filters.len() {
            let expected = self.expected_of(place, around, dt, unseen);
            let (filter, log) = &mut self.filters[place];
            expected.advance(filter, dt, drive, [true; 2], |_| [0.0; 2]);
            *log *= 1.0 - MEMORY.recip();
            for channel in Channel::ALL {
                if let Some(value) = values[channel as usize] {
                    let innovation = filter.update(channel, value, expected.noise.sensor[channel as usize]);
                    *log += working(innovation.residual, innovation.variance);
                }
            }
        }
        self.taken += 1;
        if self.taken > SETTLED {
            let Filter { mean: [_, _, own, gain], .. } = self.filter();
            let acceleration = own + (1.0 + gain) * drive.part(0, 1)[1];
            let share = ((self.taken - SETTLED) as f64).min(SAMPLES_OF_A_VARIANCE).recip();
            self.square += share * (acceleration * acceleration - self.square);
        }
    }

    fn begin(&mut self, around: &Surroundings, dt: f64, values: [Option<f64>; 2]) {
        let Surroundings { noise, measured, force, .. } = *around;
        let [moves, accelerates] = noise.map(|variance| ANY * variance.sqrt() / dt);
        let (velocity, acceleration) = match measured[1] {
            true => (noise[1].sqrt(), accelerates),
            false => (moves, moves / dt),
        };
        let gain = if force > 0.0 { acceleration / force } else { 0.0 };
        let mean = values.map(|value| value.unwrap_or(0.0));
        let std = [noise[0].sqrt(), velocity, acceleration, gain];
        let filter = Filter::begin([mean[0], mean[1], 0.0, -1.0], std.map(|std| std * std));
        self.filters.fill((filter, 0.0));
        (self.square, self.taken) = (acceleration * acceleration, 1);
    }

    /// Follows how far readings usually are from what is expected: by the upper quarter, of which few faults are part.
    pub fn learn(&mut self, expected: &Expected, foreseen: &Filter<4>, values: [Option<f64>; 2]) {
        if self.taken <= SETTLED {
            return;
        }
        for channel in Channel::ALL {
            let index = channel as usize;
            if let Some(value) = values[index] {
                let (residual, variance) = foreseen.residual(channel, value, expected.noise.sensor[index]);
                let beyond = if residual * residual > UPPER_QUARTER * variance { 0.75 } else { -0.25 };
                let rate = FOLLOWS / (self.taken as f64).min(USUAL);
                self.louder[index] = (self.louder[index] * (rate * beyond).exp()).max(1.0);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;

    const DT: f64 = 1e-3;
    const NOISE: f64 = 0.01;
    const SAMPLES: u32 = 3000;

    /// Mean squares of what the later half of readings of q and q̇ leaves, in the variances expected of it.
    fn left_over(motion: &mut MotionAlone, q: impl Fn(f64) -> f64, qd: impl Fn(f64) -> f64) -> [f64; 2] {
        let size = [1.0, 1.0];
        let around = Surroundings { noise: [NOISE * NOISE; 2], measured: [true; 2], size, force: 0.0 };
        let mut generator = ChaCha8Rng::seed_from_u64(18);
        let mut sums = [0.0; 2];
        for number in 1..=SAMPLES {
            let t = DT * f64::from(number);
            let mut noise = || NOISE * generator.sample::<f64, _>(StandardNormal);
            let values = [Some(q(t) + noise()), Some(qd(t) + noise())];
            let expected = motion.expected(&around, DT, 0.0);
            let foreseen = expected.foresee(&motion.filter(), DT, &Drive::Held(0.0));
            motion.learn(&expected, &foreseen, values);
            if number > SAMPLES / 2 {
                for channel in Channel::ALL {
                    let (index, value) = (channel as usize, values[channel as usize].unwrap());
                    let (residual, variance) = foreseen.residual(channel, value, expected.noise.sensor[index]);
                    sums[index] += residual * residual / variance / f64::from(SAMPLES / 2);
                }
            }
            motion.take(&around, DT, &Drive::Held(0.0), 0.0, values);
        }
        sums
    }

    #[test]
    fn slow_and_fast_motions_are_foreseen_as_well_as_the_sensors_scatter() {
        for rate in [0.5, 5.0, 50.0] {
            let mut motion = MotionAlone::new();
            let left = left_over(&mut motion, |t| (rate * t).sin(), |t| rate * (rate * t).cos());
            assert!(motion.is_known() && left.iter().all(|left| (0.8..1.2).contains(left)), "{rate}: {left:?}");
        }
    }

    /// By what q̇ is off, 0.3 m/s, an exact integral would be 30 stds off within a second.
    #[test]
    fn a_velocity_that_is_late_is_the_motions_own() {
        let mut motion = MotionAlone::new();
        let left = left_over(&mut motion, |t| (3.0 * t).sin(), |t| 3.0 * (3.0 * (t - 0.03)).cos());
        assert!(left.iter().all(|left| (0.7..1.3).contains(left)), "{left:?}");
    }

    #[test]
    fn what_was_refuted_is_heard_after_twice_as_long() {
        let mut motion = MotionAlone::new();
        left_over(&mut motion, f64::sin, f64::cos);
        motion.refute();
        assert!(!motion.is_known() && motion.needed == 2 * NEEDED);
    }
}
