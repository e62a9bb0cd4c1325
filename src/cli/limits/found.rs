//! Limits, and what they are of.

use super::asked::Asked;
use crate::cli::input::Input;
use crate::identify::Recording;
use crate::law::{Hold, Term};
use crate::limits::{Bound, Detection, Law, LimitsError};

/// What the limits are of, and the limits.
pub(super) struct Limits<'a> {
    pub(super) input: &'a Input,
    pub(super) asked: &'a Asked,
    pub(super) recording: &'a Recording,
    /// What the excitation did between samples; none where F is what the law gives.
    pub(super) hold: Option<Hold>,
    pub(super) law: Law,
    /// Std of the sensors' noise by channel.
    pub(super) noise: Vec<(&'static str, f64)>,
    /// What the user should know of these limits.
    pub(super) warnings: Vec<String>,
    /// Whether all coefficients are the model's numbers.
    pub(super) numbers_only: bool,
    pub(super) bound: Bound,
    /// Shortest record where the state at its start is known, s; none where F is what the law gives.
    pub(super) after_switch: Option<f64>,
    /// Log-likelihood ratio at which a change is seen, nats.
    pub(super) level: f64,
    pub(super) detection: Option<Detection>,
}

impl Limits<'_> {
    /// "maybe" terms that the fit dropped.
    pub(super) fn dropped(&self) -> Vec<Term> {
        let terms = self.input.model.terms.iter().map(|entry| entry.term);
        terms.filter(|term| !self.law.terms().contains(term)).collect()
    }
}

/// Refuses a model with a term that one instant does not give, before anything is fitted.
pub(super) fn pointwise(input: &Input) -> Result<(), LimitsError> {
    match input.model.terms.iter().find(|entry| !entry.term.is_pointwise()) {
        Some(entry) => Err(LimitsError::NotPointwise { term: entry.key.clone() }),
        None => Ok(()),
    }
}

/// What is to be said of limits of a law that leaves more than noise, or of sensors without any.
pub(super) fn warnings(recording: &Recording, leaves_more: bool, is_noiseless: bool) -> Vec<String> {
    let source = recording.source();
    let mut warnings = Vec::new();
    if leaves_more {
        warnings.push(format!(
            "{source}: the law leaves more than sensor noise: it lacks something, or switches within the record \
             (`switchid diagnose` tells); the limits are those of a record that it explained"
        ));
    }
    if is_noiseless {
        warnings.push(format!(
            "{source}: hardly any sensor noise is to be seen, and the limits are small accordingly: \
             name it by --noise q=STD,qd=STD where you know it"
        ));
    }
    warnings
}
