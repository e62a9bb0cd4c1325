//! The library as the identifier uses it: known laws, their trials, and the one that stands out.

use super::regime::Recognition;
use crate::identify::library::{KnownLaws, Trials, Verdict};
use crate::identify::problem::Problem;
use serde::{Deserialize, Serialize};

/// Known laws, and what the record says of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Library {
    pub(super) known: KnownLaws,
    pub(super) trials: Trials,
    /// What says that a law is to be recognised in the next step.
    pub(super) in_sight: Option<Verdict>,
    /// Start of a record on which the known laws are to be tried as soon as it has begun.
    pub(super) trial_due: Option<u64>,
}

impl Library {
    /// No law is known; those that are learned before the first sample are tried at once.
    pub(super) fn new(problem: &Problem) -> Library {
        Library { known: KnownLaws::new(problem.n()), trials: Trials::new(problem), in_sight: None, trial_due: Some(0) }
    }

    /// No known law is on trial any more.
    pub(super) fn end_trials(&mut self) {
        self.trials.end();
        (self.in_sight, self.trial_due) = (None, None);
    }

    /// What a free coefficient's std owes to the doubt whether the law was recognised rightly; `spread` is how far a
    /// switch moves it.
    pub(super) fn recognition_std(
        &self,
        recognition: Option<Recognition>,
        free: usize,
        value: f64,
        spread: f64,
    ) -> f64 {
        let doubt = recognition.and_then(|recognition| recognition.doubt).filter(|_| self.trials.is_running());
        doubt.map_or(0.0, |doubt| doubt.variance(self.known.laws(), free, value, spread).sqrt())
    }
}
