//! The built-in scenarios through the default identifier.

use super::follow::{Figures, follow};
use switchid::identify::{Identifier, Settings};
use switchid::law::{Given, Model};
use switchid::simulate::{Builtin, Scenario, record};

/// What the default identifier is told of the plant: the Duffing terms, or the full cubic library for van der Pol.
pub fn model(builtin: Builtin) -> Model {
    match builtin.is_van_der_pol() {
        true => Model::cubic_library(),
        false => Model::of("Duffing", builtin.terms().into_iter().map(|term| (term, Given::Fit))),
    }
}

/// Runs the default identifier over a record of the scenario.
pub fn measure(builtin: Builtin, scenario: &Scenario) -> Result<Figures, Box<dyn std::error::Error + Send + Sync>> {
    let mut identifier = Identifier::new(&model(builtin), Settings::default())?;
    follow(&mut identifier, scenario, record(scenario)?)
}
