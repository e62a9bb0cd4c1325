//! What a run of the identifier over a recording found.

use crate::cli::stage_limit::StageLimit;
use crate::data::Opened;
use crate::identify::{Identification, Missing, Settings, Stage};

/// What the run rested on.
pub(super) struct Run {
    pub(super) opened: Opened,
    /// The model's file.
    pub(super) file: String,
    pub(super) settings: Settings,
    /// Who chose the hold.
    pub(super) hold_from: &'static str,
    /// Whether F is what the law gives.
    pub(super) gives_force: bool,
    /// Whether laws go on over gaps.
    pub(super) carries_over_gaps: bool,
    /// Inner parameters that the model left open, as they suit the whole recording: `gap of dead_zone_stiffness`.
    pub(super) inner: Vec<(String, f64)>,
    pub(super) found: Identification,
    /// What any method could reach, stage by stage; none where a stage has no law or no limit.
    pub(super) limits: Vec<Option<StageLimit>>,
}

/// Stages with their limits.
pub(super) fn stages(run: &Run) -> impl Iterator<Item = (&Stage, Option<&StageLimit>)> {
    run.found.stages.iter().zip(run.limits.iter().map(Option::as_ref))
}

/// The stage whose law lacks an effect most evidently, from 0, with what it lacks.
pub(super) fn missing(found: &Identification) -> Option<(usize, Missing)> {
    let lacking = found.stages.iter().enumerate().filter_map(|(index, stage)| Some((index, stage.missing?)));
    lacking.max_by(|a, b| a.1.evidence.total_cmp(&b.1.evidence))
}

/// Estimated std of the sensors' noise by channel.
pub(super) fn noise(found: &Identification) -> Vec<(String, f64)> {
    let channels = [("q", found.noise.q), ("qd", found.noise.qd), ("F", found.noise.force)];
    channels.into_iter().filter_map(|(channel, std)| Some((channel.to_string(), std?))).collect()
}
