//! When the excitation acted is no part of the law, and the law depends on it: a nuisance hypothesis with a posterior.
//!
//! Each of [`Timing::ALL`] is a point in the plane of two shares of F's readings; a run over the record says by how much
//! each changes the log-likelihood, and by how much it moves the coefficients. The law's covariance is that of the
//! mixture. As long as a hypothesis that the record does not exclude makes the law another one, no law is validated.

use crate::estimation::{Information, Innovation, Pass, Solution, TimingTest};
use crate::identify::timing::Timing;
use crate::identify::window::Window;
use serde::{Deserialize, Serialize};

/// Probability that the excitation acted otherwise than is said: one setting in ten.
const OTHERWISE: f64 = 0.1;

/// Log-likelihood below which a hypothesis is excluded, nats: odds of twenty to one.
const EXCLUDED: f64 = -3.0;

/// Posterior log-odds at which another hypothesis comes into use: 400 to one, after its improbability.
const DECISIVE: f64 = 6.0;

/// What a hypothesis must explain of what any shares would: nearer to the best ones than to the next hypothesis.
const EXPLAINED: f64 = 0.75;

/// A record of fewer samples than this is refined at the faster pace, and tested run by run: its law is not yet linear
/// within its std.
pub const YOUNG: u64 = 5000;

/// What is tested beside a run is tested again when the record has grown by this factor, twice in every doubling: most
/// runs are spared the work.
pub(super) const LOOK_AGAIN: f64 = 1.4;

/// The posterior of the timings, and what it stands on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct NuisanceTiming {
    test: TimingTest,
    /// Whether the run under way tests them.
    looking: bool,
    /// Length of the record from which the next run does: a young one is tested run by run.
    next_look: u64,
    /// Posterior probabilities, and by how much the shares of each differ from those in use.
    weights: [f64; Timing::ALL.len()],
    steps: [[f64; 2]; Timing::ALL.len()],
    /// Largest sum of squares by which a hypothesis that is not excluded moves the coefficients.
    doubt: f64,
    /// The hypothesis to come into use.
    likelier: Option<Timing>,
}

impl NuisanceTiming {
    /// Beside `n` free terms.
    pub(super) fn new(n: usize) -> NuisanceTiming {
        NuisanceTiming {
            test: TimingTest::new(n),
            looking: false,
            next_look: 0,
            weights: [0.0; Timing::ALL.len()],
            steps: [[0.0; 2]; Timing::ALL.len()],
            doubt: 0.0,
            likelier: None,
        }
    }

    /// Forgets what the record said.
    pub(super) fn forget(&mut self) {
        self.test.forget();
        (self.next_look, self.doubt, self.likelier) = (0, 0.0, None);
        self.weights = [0.0; Timing::ALL.len()];
    }

    /// A run over a record of `length` samples begins.
    pub(super) fn begin(&mut self, window: &Window, length: u64) {
        self.looking = window.tells_timing() && length >= self.next_look;
        if self.looking {
            self.test.begin();
        }
    }

    /// Takes the sample of that number, which the run has just taken under an inertia `mass`.
    #[inline]
    pub(super) fn step(
        &mut self,
        window: &Window,
        number: u64,
        mass: f64,
        pass: &Pass,
        innovations: &[Option<Innovation>; 2],
    ) {
        if self.looking {
            let [earlier, before, after] = window.excitation_around(number);
            self.test.step(pass, [(after - before) / mass, (earlier - before) / mass], innovations);
        }
    }

    /// The run over `length` samples ends: `own` is what the record says of the law's terms.
    pub(super) fn end(&mut self, own: &Information, active: &[bool], overdispersion: f64, used: Timing, length: u64) {
        if !self.looking {
            return;
        }
        self.next_look = if length < YOUNG { 0 } else { (LOOK_AGAIN * length as f64) as u64 };
        self.test.end(own, active);
        let [from_after, from_earlier] = used.shares();
        self.steps = Timing::ALL.map(|timing| {
            let [after, earlier] = timing.shares();
            [after - from_after, earlier - from_earlier]
        });
        self.weigh(used, overdispersion.max(1.0), active);
    }

    fn weigh(&mut self, used: Timing, overdispersion: f64, active: &[bool]) {
        let evidence = self.test.evidence();
        let gains = self.steps.map(|step| evidence.gain(step) / overdispersion);
        let prior = |timing: Timing| {
            let others = (Timing::ALL.len() - 1) as f64;
            if timing == used { (1.0 - OTHERWISE).ln() } else { (OTHERWISE / others).ln() }
        };
        let logs: [f64; Timing::ALL.len()] = std::array::from_fn(|place| gains[place] + prior(Timing::ALL[place]));
        let best = (0..logs.len()).max_by(|a, b| logs[*a].total_cmp(&logs[*b])).unwrap_or(0);
        let sum: f64 = logs.iter().map(|log| (log - logs[best]).exp()).sum();
        self.weights = logs.map(|log| (log - logs[best]).exp() / sum);
        let free = evidence.best();
        let most = evidence.gain(free) / overdispersion;
        let explained = gains[best] >= EXPLAINED * most + EXCLUDED;
        let decided = logs[best] > prior(used) + DECISIVE;
        self.likelier = (decided && explained).then_some(Timing::ALL[best]);
        let moved = |step: [f64; 2]| {
            (0..active.len()).filter(|free| active[*free]).map(|free| evidence.shift(step, free).powi(2)).sum::<f64>()
        };
        let open = (0..gains.len()).filter(|place| gains[*place] > gains[best] + EXCLUDED);
        let doubt = open.map(|place| moved(self.steps[place])).fold(0.0, f64::max);
        self.doubt = if explained { doubt } else { doubt.max(moved(free)) };
    }

    /// What the timing leaves open of the coefficients comes on top of their covariance.
    pub(super) fn widen(&self, solution: &mut Solution) {
        let (evidence, n) = (self.test.evidence(), solution.step.len());
        for (weight, step) in self.weights.iter().zip(self.steps).filter(|(weight, _)| **weight > 0.0) {
            for row in 0..n {
                let moved = weight * evidence.shift(step, row);
                let entries = &mut solution.covariance[row * n..(row + 1) * n];
                entries.iter_mut().enumerate().for_each(|(free, entry)| *entry += moved * evidence.shift(step, free));
            }
        }
    }

    /// Sum of squares by which the coefficients may be others.
    pub(super) fn doubt(&self) -> f64 {
        self.doubt
    }

    /// The hypothesis to come into use.
    pub(super) fn likelier(&self) -> Option<Timing> {
        self.likelier
    }
}
