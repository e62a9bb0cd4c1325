//! What a diagnosis found.

use crate::diagnose::{Clock, Diagnosis, Finding, StageDiagnosis};

/// What the command found.
pub(super) struct Found {
    /// The diagnosis that says most: of all recordings together, or of one stage.
    pub(super) principal: Diagnosis,
    pub(super) finding: Finding,
    pub(super) stages: Vec<StageDiagnosis>,
    pub(super) clock: Option<Clock>,
}
