//! What a diagnosis found.

use crate::diagnose::{Clock, Diagnosis, Finding, StageDiagnosis};

/// What the command found.
pub(in crate::cli) struct Found {
    /// The diagnosis that says most: of all recordings together, or of one stage.
    pub(in crate::cli) principal: Diagnosis,
    pub(super) finding: Finding,
    pub(super) stages: Vec<StageDiagnosis>,
    pub(super) clock: Option<Clock>,
}
