//! The library as the identifier uses it: known laws and their trials.

use super::regime::Recognition;
use crate::identify::library::{KnownLaws, Trials};
use crate::identify::problem::Problem;
use serde::{Deserialize, Serialize};

/// Known laws, and what the record says of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Library {
    pub(super) known: KnownLaws,
    pub(super) trials: Trials,
    /// Start of a record on which the known laws are to be tried as soon as it has begun.
    pub(super) trial_due: Option<u64>,
}

impl Library {
    /// No law is known; those that are learned before the first sample are tried at once.
    pub(super) fn new(problem: &Problem) -> Library {
        Library { known: KnownLaws::new(problem.n()), trials: Trials::new(problem), trial_due: Some(0) }
    }

    /// No known law is on trial any more.
    pub(super) fn end_trials(&mut self) {
        self.trials.end();
        self.trial_due = None;
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
