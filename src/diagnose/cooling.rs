//! A fit that leaves error, its process noise taken down step by step while coefficients and inner parameters follow.
//!
//! Under much process noise the motion follows its record whatever the law, and the likelihood of a friction that sticks or of a delay has
//! its maximum beside the truth; under none a law that is off leaves the record at once. Between the two lies a way from the one to the other
//! (simulated annealing without chance: Kirkpatrick, Gelatt and Vecchi, Science 220 (1983), 671).

use super::descent::{Descent, total};
use super::fit::{Fit, best_of, solve};
use super::piece::Piece;
use crate::evidence::Pass;

/// Steps in which the process noise is taken down.
const STEPS: usize = 8;

/// Factor of each.
const COOLER: f64 = 0.25;

/// Log-likelihood, nats per measurement, that may be lost on the way: more is lost where the law is another one.
const LOST: f64 = 0.25;

/// The fit that a gentler way down leads to; none where it ends no better than this one.
pub fn cooled(fit: &Fit, pieces: &[Piece]) -> Option<Fit> {
    let mut descent = Descent::new(&fit.form, pieces, &fit.coefficients, fit.noise)?;
    let mut pass = descent.pass();
    descent.renew_series(&mut pass);
    let least = fit.log_likelihood - LOST * fit.measurements;
    for _ in 0..STEPS {
        descent.noise.process *= COOLER;
        descent.cool(&mut pass, least)?;
    }
    best_of(descent, pass).filter(|cold| cold.log_likelihood > fit.log_likelihood)
}

impl Descent<'_> {
    /// One step of all but the noise; none where the motion is lost, or more likelihood than to `least`.
    fn cool(&mut self, pass: &mut Pass, least: f64) -> Option<()> {
        let outcomes = self.run(pass);
        let mut sums = total(&outcomes);
        let log_likelihood = self.log_likelihood(&outcomes, &sums);
        let finite = outcomes.iter().all(|outcome| outcome.finite);
        if !finite || log_likelihood.is_nan() || log_likelihood < least {
            return None;
        }
        self.add_priors(&mut sums);
        self.take(&solve(&sums.information, &sums.score)?.step);
        self.follow(&outcomes, pass);
        Some(())
    }
}
