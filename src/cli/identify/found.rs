//! What a run of the identifier over a recording found.

use crate::cli::stage_limit::StageLimit;
use crate::data::Opened;
use crate::identify::{Identification, Settings, Stage};

/// What the run rested on.
pub(super) struct Run {
    pub(super) opened: Opened,
    pub(super) settings: Settings,
    /// Who chose the hold.
    pub(super) hold_from: &'static str,
    /// Whether F is what the law gives.
    pub(super) gives_force: bool,
    pub(super) found: Identification,
    /// What any method could reach, stage by stage; none where a stage has no law or no limit.
    pub(super) limits: Vec<Option<StageLimit>>,
}

/// Stages with their limits.
pub(super) fn stages(run: &Run) -> impl Iterator<Item = (&Stage, Option<&StageLimit>)> {
    run.found.stages.iter().zip(run.limits.iter().map(Option::as_ref))
}

/// Estimated std of the sensors' noise by channel.
pub(super) fn noise(found: &Identification) -> Vec<(String, f64)> {
    let channels = [("q", found.noise_q), ("qd", found.noise_qd), ("F", found.noise_force)];
    channels.into_iter().filter_map(|(channel, std)| Some((channel.to_string(), std?))).collect()
}
