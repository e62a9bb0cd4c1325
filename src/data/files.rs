//! Model, scenario and law files.

use super::error::DataError;
use crate::identify::SavedLaws;
use crate::law::Model;
use crate::simulate::Scenario;
use std::path::Path;

fn read(path: &Path) -> Result<String, DataError> {
    let file = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|source| DataError::Read { file, source })?;
    Ok(text.strip_prefix('\u{feff}').map(String::from).unwrap_or(text))
}

/// Opens a model file.
///
/// # Errors
/// [`DataError`] names the file and the key at fault.
pub fn open_model(path: &Path) -> Result<Model, DataError> {
    let file = path.display().to_string();
    Model::from_toml(&read(path)?).map_err(|source| DataError::Model { file, source })
}

/// Opens a scenario file.
///
/// # Errors
/// [`DataError`] names the file and the key or stage at fault.
pub fn open_scenario(path: &Path) -> Result<Scenario, DataError> {
    let file = path.display().to_string();
    Scenario::from_toml(&read(path)?).map_err(|source| DataError::Scenario { file, source })
}

/// Opens a file of known laws.
///
/// # Errors
/// [`DataError`] names the file.
pub fn open_laws(path: &Path) -> Result<SavedLaws, DataError> {
    let file = path.display().to_string();
    SavedLaws::from_toml(&read(path)?).map_err(|source| DataError::Laws { file, source })
}
