//! Short ways to write down variables and their units.

use switchid_fmu_slave::{Causality, Description, Kind, Unit, Variability, Variable};

/// A real variable without a range.
pub fn real(name: impl Into<String>, start: f64, unit: Option<&str>, description: impl Into<String>) -> Variable {
    Variable {
        name: name.into(),
        description: description.into(),
        causality: Causality::Parameter,
        variability: Variability::Discrete,
        kind: Kind::Real { start, min: None, max: None, unit: unit.map(Into::into) },
        depends_on: Vec::new(),
        derivative_of: None,
        follows: Vec::new(),
    }
}

/// A variable of any kind.
pub fn variable(name: impl Into<String>, kind: Kind, description: impl Into<String>) -> Variable {
    Variable { kind, ..real(name, 0.0, None, description) }
}

/// A parameter that is an item of an enumeration.
pub fn choice(name: &str, of: &str, start: i32, description: &str) -> Variable {
    variable(name, Kind::Enumeration { of: of.into(), start }, description)
}

/// The variable with a smallest value.
pub fn at_least(mut variable: Variable, least: f64) -> Variable {
    if let Kind::Real { min, .. } = &mut variable.kind {
        *min = Some(least);
    }
    variable
}

/// The variable as an input.
pub fn input(variable: Variable) -> Variable {
    Variable { causality: Causality::Input, variability: Variability::Continuous, ..variable }
}

/// The variable as an output that changes from step to step; before the first step it depends on these parameters.
pub fn output(variable: Variable, depends_on: &[&str]) -> Variable {
    let depends_on = depends_on.iter().map(|name| (*name).into()).collect();
    Variable { causality: Causality::Output, depends_on, ..variable }
}

/// The time.
pub fn time() -> Variable {
    let (causality, variability) = (Causality::Independent, Variability::Continuous);
    Variable { causality, variability, ..real("time", 0.0, Some("s"), "Simulation time") }
}

/// The variable as the derivative in time of that state; at the same instant it depends on those.
pub fn derivative(variable: Variable, state: &str, follows: &[&str]) -> Variable {
    let follows = follows.iter().map(|name| (*name).into()).collect();
    let (causality, variability) = (Causality::Local, Variability::Continuous);
    Variable { causality, variability, derivative_of: Some(state.into()), follows, ..variable }
}

/// The units among seconds and radians per second that the variables name.
pub fn units(variables: &[Variable]) -> Vec<Unit> {
    let known = [("s", [0, 0, 1, 0, 0]), ("rad/s", [0, 0, -1, 0, 1])];
    let uses =
        |name: &str, variable: &Variable| matches!(&variable.kind, Kind::Real { unit: Some(unit), .. } if unit == name);
    let used = known.into_iter().filter(|(name, _)| variables.iter().any(|variable| uses(name, variable)));
    used.map(|(name, exponents)| Unit { name: name.into(), exponents }).collect()
}

/// Gives variables the unit that `unit_for` has for their names, where they have none yet.
pub fn declare_units(description: &mut Description, unit_for: impl Fn(&str) -> Option<Unit>) {
    for variable in &mut description.variables {
        let Kind::Real { unit: unit @ None, .. } = &mut variable.kind else { continue };
        let Some(found) = unit_for(&variable.name) else { continue };
        *unit = Some(found.name.clone());
        if description.units.iter().all(|known| known.name != found.name) {
            description.units.push(found);
        }
    }
}
