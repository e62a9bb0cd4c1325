//! A plant whose law is a model's, with its numbers.
//!
//! Terms without inner parameters are parameters of every stage. Those with inner ones are the plant's `hidden.*`
//! effects, whose start values are then the model's: the law file has no place for a gap.

use super::error::FmuError;
use super::plant::{pack, plant_description, with_equations};
use super::ports;
use super::specimen::{pack_specimen, specimen_description};
use crate::law::{Expression, Given, Model, ModelTerm, SiUnit, Term, Units, equation};
use crate::simulate::{ParametricLaw, is_smooth};
use switchid_fmu_package::Fmu;
use switchid_fmu_slave::{Description, Kind};

/// A plant of the model's law, still without binaries; it starts at rest under a sine of amplitude 1. Of a model
/// without inertia it is a
/// specimen: inputs q and qd, output F.
///
/// # Errors
/// [`FmuError::NoNumbers`] where a coefficient or an inner parameter has no number, [`FmuError::Memory`] for a specimen
/// that needs the past, and what packing refuses.
pub fn plant_of_model(name: &str, model: &Model) -> Result<Fmu, FmuError> {
    model.check()?;
    let moves = !model.is_force_law();
    match moves {
        true => model.check_inertia()?,
        false => check_specimen(model)?,
    }
    let numbers = numbers(model)?;
    let law_file = law_file(name, model, &numbers);
    let law = ParametricLaw::from_toml(&law_file)?;
    let smooth = model.terms.iter().all(|entry| is_smooth(entry.term));
    let mut description = match (moves, smooth) {
        (true, true) => with_equations(plant_description(&law)),
        (true, false) => plant_description(&law),
        (false, _) => specimen_description(&law),
    };
    start(&mut description, "q0", 0.0);
    for (entry, value) in numbers.iter().filter(|(entry, _)| is_hidden(entry)) {
        let effect = format!("hidden.{}", entry.term.name());
        start(&mut description, &effect, *value);
        for (inner, value) in model.inner_names(entry.term).iter().zip(entry.term.inner_values()) {
            start(&mut description, &format!("{effect}.{inner}"), value);
        }
    }
    let units = model.units.units();
    ports::declare(&mut description, &units, |name| coefficient_unit(name, model, &units));
    if moves { pack(description, &law_file) } else { pack_specimen(description, &law_file) }
}

/// A specimen's force is a function of q and qd at one instant.
fn check_specimen(model: &Model) -> Result<(), FmuError> {
    model.check_force_law()?;
    let memory = |entry: &&ModelTerm| !entry.term.is_pointwise() && !matches!(entry.term, Term::Expression(_));
    match model.terms.iter().find(memory) {
        Some(entry) => Err(FmuError::Memory { key: entry.key.clone() }),
        None => Ok(()),
    }
}

/// Every term with its coefficient.
fn numbers(model: &Model) -> Result<Vec<(&ModelTerm, f64)>, FmuError> {
    let lacking: Vec<String> = model.terms.iter().flat_map(|entry| lacking(model, entry)).collect();
    if !lacking.is_empty() {
        return Err(FmuError::NoNumbers { terms: lacking.join(", ") });
    }
    let number = |entry: &ModelTerm| match entry.given {
        Given::Known(value) => value,
        Given::Fit | Given::Maybe => 0.0,
    };
    Ok(model.terms.iter().map(|entry| (entry, number(entry))).collect())
}

/// What of a term has no number.
fn lacking(model: &Model, entry: &ModelTerm) -> Vec<String> {
    let key = &entry.key;
    let coefficient = (!matches!(entry.given, Given::Known(_))).then(|| format!("\"{key}\""));
    let inner = model.inner_names(entry.term).into_iter().zip(&entry.open).filter(|(_, open)| **open);
    coefficient.into_iter().chain(inner.map(|(inner, _)| format!("{inner} of \"{key}\""))).collect()
}

/// Whether the law file has no place for it, so that it is one of the plant's `hidden.*`.
fn is_hidden(entry: &ModelTerm) -> bool {
    !entry.open.is_empty() || matches!(entry.term, Term::Expression(_))
}

/// The plant's law as its resources hold it.
fn law_file(name: &str, model: &Model, numbers: &[(&ModelTerm, f64)]) -> String {
    let quote = |text: &str| toml::Value::from(text).to_string();
    let shown: Vec<(Term, f64, Option<f64>)> =
        numbers.iter().map(|(entry, value)| (entry.term, *value, None)).collect();
    let description = format!("{}: {}", model.name, equation(&shown, true));
    let (mut parameters, mut terms) = (String::new(), String::new());
    for (entry, value) in numbers.iter().filter(|(entry, _)| !is_hidden(entry)) {
        let (parameter, term) = (parameter(entry), entry.term.name());
        let text = quote(&format!("Coefficient of {term} on the left-hand side"));
        parameters += &format!("{parameter} = {{ start = {value:?}, description = {text} }}\n");
        terms += &format!("{} = \"{parameter}\"\n", quote(&term));
    }
    let of_law = |own: &&Expression| numbers.iter().any(|(entry, _)| entry.term.name() == own.name());
    let effects: String = model.expressions.iter().filter(of_law).map(own_effect).collect();
    format!(
        "name = {}\ndescription = {}\namplitude = 1.0\nomega = 1.0\n\n[parameters]\n{parameters}\n[terms]\n{terms}{effects}",
        quote(name),
        quote(&description)
    )
}

/// An effect of the user's own as the law file has it.
fn own_effect(own: &Expression) -> String {
    let inner = own.parameters().iter().zip(own.values()).map(|(name, value)| format!("{name} = {value:?}\n"));
    let formula = toml::Value::from(own.text());
    format!("\n[effects.{}]\nexpression = {formula}\n{}", own.name(), inner.collect::<String>())
}

/// What the stages call the coefficient of a term: the user's name for the term where it can name a parameter.
fn parameter(entry: &ModelTerm) -> String {
    let legal = entry.key.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
    let named = legal && entry.key.starts_with(|letter: char| letter.is_ascii_alphabetic());
    if named { entry.key.clone() } else { entry.term.fmu_name() }
}

fn start(description: &mut Description, name: &str, value: f64) {
    let variable = description.variables.iter_mut().find(|variable| variable.name == name);
    if let Some(Kind::Real { start, .. }) = variable.map(|variable| &mut variable.kind) {
        *start = value;
    }
}

fn coefficient_unit(name: &str, model: &Model, units: &Units) -> Option<SiUnit> {
    let of = |fits: &dyn Fn(&ModelTerm) -> bool| model.terms.iter().find(|entry| fits(entry));
    let entry = if let Some(term) = name.strip_prefix("true.coef.") {
        of(&|entry| entry.term.fmu_name() == term)
    } else if let Some(effect) = name.strip_prefix("hidden.") {
        of(&|entry| entry.term.name() == effect)
    } else {
        let field = name.strip_prefix("stage[")?.split_once("].")?.1;
        of(&|entry| parameter(entry) == field)
    };
    units.coefficient(entry?.term)
}
