//! A scenario as a TOML file.

use super::error::ScenarioError;
use super::scenario::Scenario;

impl Scenario {
    /// Reads a scenario file.
    ///
    /// # Errors
    /// [`ScenarioError`] names the key or stage at fault.
    pub fn from_toml(text: &str) -> Result<Scenario, ScenarioError> {
        let scenario: Scenario =
            toml::from_str(text).map_err(|error| ScenarioError::Syntax { message: error.to_string() })?;
        scenario.check()?;
        Ok(scenario)
    }

    /// Writes a file that [`Scenario::from_toml`] reads back to the same scenario.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where TOML cannot hold a number (a seed above 2⁶³).
    pub fn to_toml(&self) -> Result<String, ScenarioError> {
        toml::to_string(self).map_err(|error| ScenarioError::Syntax { message: error.to_string() })
    }
}
