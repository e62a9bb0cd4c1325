//! The interface of a specimen: a plant whose law gives F for the q and qd that its inputs impose.

use super::description::describe;
use super::error::FmuError;
use super::plant::{NEVER, STAGES, hidden, own_effect, true_coefficients};
use crate::law::Catalogue;
use crate::simulate::ParametricLaw;
use switchid_fmu_package::variables::{at_least, input, output, real, variable};
use switchid_fmu_package::{Fmu, documentation};
use switchid_fmu_slave::{Description, Kind, Variable};

/// A specimen of that interface, still without binaries.
pub(super) fn pack_specimen(description: Description, law_file: &str) -> Result<Fmu, FmuError> {
    let text = "<p>Inputs <code>q</code>, <code>qd</code> are what a machine imposes at the start of a step, output <code>F</code> is the force that \
                answers them, with the noise of its sensor; one <code>fmi2DoStep</code> is one reading. <code>true.*</code> is what no estimator may see. \
                A stage begins at <code>stage[i].time</code>, counted from the start of the simulation; 1e30 = it does not occur. \
                <code>hidden.*</code> are effects besides the law's terms, for a model to lack.</p>";
    let page = documentation::page(&description, text);
    Ok(Fmu::new(description, vec![("plant.toml".into(), law_file.as_bytes().to_vec())], page)?)
}

/// The variables of a specimen: inputs, parameters, outputs, truth.
pub(super) fn specimen_description(law: &ParametricLaw) -> Description {
    let stages = (1..=STAGES).flat_map(|number| stage(law, number));
    let effects = Catalogue::ENTRIES
        .iter()
        .filter(|entry| entry.term.is_pointwise() && !entry.term.is_inertial() && !entry.term.uses_excitation());
    let variables = imposed()
        .into_iter()
        .chain(sensor())
        .chain(stages)
        .chain(effects.flat_map(hidden))
        .chain(law.effects.iter().flat_map(own_effect));
    let variables: Vec<Variable> = variables.chain(force()).chain(true_coefficients(law)).collect();
    describe(&law.name, &law.description, Vec::new(), variables)
}

fn imposed() -> [Variable; 2] {
    [
        input(real("q", 0.0, None, "Imposed displacement, sampled at the start of every step")),
        input(real("qd", 0.0, None, "Imposed velocity, sampled at the start of every step")),
    ]
}

fn sensor() -> [Variable; 2] {
    let seed = Kind::Integer { start: 1, min: Some(0), max: None };
    [
        at_least(real("noise.F", 0.0, None, "Std of the Gaussian sensor noise on F"), 0.0),
        variable("seed", seed, "Seed of the sensor noise"),
    ]
}

fn stage(law: &ParametricLaw, number: usize) -> Vec<Variable> {
    let name = |field: &str| format!("stage[{number}].{field}");
    let (start, text) = match number {
        1 => (0.0, "Start of the first stage: 0".to_string()),
        _ => (NEVER, format!("Start of stage {number}, after that of the stage before; 1e30 = it does not occur")),
    };
    let time = at_least(real(name("time"), start, Some("s"), text), 0.0);
    let parameters = law.parameters.iter().map(|parameter| {
        real(name(&parameter.name), parameter.start, None, format!("{} in stage {number}", parameter.description))
    });
    std::iter::once(time).chain(parameters).collect()
}

fn force() -> [Variable; 3] {
    let stage = variable("true.stage", Kind::Integer { start: 1, min: None, max: None }, "Number of the present stage");
    [
        output(real("F", 0.0, None, "Force that answers the inputs, with its sensor noise"), &[]),
        output(real("true.F", 0.0, None, "The same without noise"), &[]),
        output(stage, &[]),
    ]
}
