//! What can be identified sample by sample, and why a model or settings are refused.

use super::library::SavedLawsError;
use super::settings::{Channels, Method, Settings, SettingsError};
use crate::law::{Model, ModelError};
use thiserror::Error;

/// Why an identifier cannot be built.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BuildError {
    /// The settings are refused.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The model is refused.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The known laws are refused.
    #[error(transparent)]
    Laws(#[from] SavedLawsError),
    /// A law whose output nobody measured.
    #[error(
        "[terms] has no inertia, so that F is what the law gives, but F is not measured: name its column ([columns] F = \"…\"), or add \
         inertia = \"fit\" for a law of motion"
    )]
    NoForce,
    /// A term of q where q is not measured.
    #[error(
        "[terms]: \"{key}\" depends on q, which is not measured: with F as the output nothing else tells where q began; leave the term out, or \
         measure q"
    )]
    NoDisplacement {
        /// The key of the term.
        key: String,
    },
    /// The publication's method has laws of motion only.
    #[error(
        "[terms] has no inertia: the publication's method identifies laws of motion; leave --method out, or add inertia = \"fit\""
    )]
    PublishedForceLaw,
}

/// Checks that the model can be identified sample by sample from what is measured.
pub(super) fn check(model: &Model, settings: &Settings) -> Result<(), BuildError> {
    settings.check()?;
    model.check()?;
    match model.is_force_law() {
        true => check_force_law(model, settings)?,
        false => model.check_inertia()?,
    }
    model.check_streaming()?;
    Ok(model.check_free(settings.channels.excitation)?)
}

/// Checks that a law whose output is F can be identified from what is measured.
fn check_force_law(model: &Model, settings: &Settings) -> Result<(), BuildError> {
    model.check_force_law()?;
    let Channels { q, excitation, .. } = settings.channels;
    if settings.method == Method::Publication {
        return Err(BuildError::PublishedForceLaw);
    }
    if !excitation {
        return Err(BuildError::NoForce);
    }
    match model.terms.iter().find(|entry| !q && entry.term.uses_displacement()) {
        Some(entry) => Err(BuildError::NoDisplacement { key: entry.key.clone() }),
        None => Ok(()),
    }
}
