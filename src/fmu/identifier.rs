//! The identifier's interface for a model.

use super::description::describe;
use super::error::FmuError;
use super::ports;
use crate::identify::{
    Identifier, Method, OutputDescription, OutputKind, Outputs, Parameter, SavedLaws, SensorState, Settings, Status,
};
use crate::law::{Catalogue, Hold, Model, NamedLaw, Term};
use switchid_fmu_package::variables::{at_least, choice, input, output, real, variable};
use switchid_fmu_package::{Fmu, documentation};
use switchid_fmu_slave::{Description, Enumeration, Kind, Variable};

/// An identifier for a model, still without binaries.
///
/// # Errors
/// [`FmuError`] where the model is refused, cannot be identified sample by sample, or `name` is no identifier.
pub fn identifier(name: &str, model: &Model) -> Result<Fmu, FmuError> {
    identifier_knowing(name, model, &SavedLaws::default())
}

/// The same with laws in its resources, which it recognises from its first sample on.
///
/// # Errors
/// [`FmuError`], also where the laws are not the model's.
pub fn identifier_knowing(name: &str, model: &Model, known: &SavedLaws) -> Result<Fmu, FmuError> {
    model.check()?;
    match model.is_force_law() {
        true => model.check_force_law()?,
        false => model.check_inertia()?,
    }
    model.check_streaming()?;
    model.check_free(true)?;
    let mut resources = vec![("model.toml".into(), model.to_toml().into_bytes())];
    if !known.laws.is_empty() {
        check(model, known)?;
        resources.push(("laws.toml".into(), known.to_toml()?.into_bytes()));
    }
    let description = identifier_description(name, model);
    let page = documentation::page(&description, &text(model));
    Ok(Fmu::new(description, resources, page)?)
}

/// Laws that no identifier of the model takes are not packed.
fn check(model: &Model, known: &SavedLaws) -> Result<(), FmuError> {
    match Identifier::new(model, Settings::default()) {
        Ok(identifier) => Ok(identifier.with_known_laws(known).map(|_| ())?),
        Err(_) => Ok(()),
    }
}

/// The variables of an identifier for a model: inputs, parameters, outputs.
pub fn identifier_description(name: &str, model: &Model) -> Description {
    let terms: Vec<Term> = model.terms.iter().map(|entry| entry.term).collect();
    let variables: Vec<Variable> = inputs()
        .into_iter()
        .chain(parameters(&terms))
        .chain(Outputs::describe(&terms).iter().map(to_variable))
        .chain([stream()])
        .collect();
    let what = "Identifies the law of motion of a switched system, notices switches, re-identifies";
    let mut description = describe(name, what, enumerations(&terms), variables);
    let units = model.units.units();
    ports::declare(&mut description, &units, |name| {
        let term = name.strip_prefix("coef.").or(name.strip_prefix("std."))?;
        terms.iter().find(|known| known.fmu_name() == term).and_then(|term| units.coefficient(*term))
    });
    description
}

/// What the FMU's page says.
fn text(model: &Model) -> String {
    let terms: Vec<String> =
        model.terms.iter().map(|entry| entry.term.symbol()).filter(|term| !term.is_empty()).collect();
    let start = documentation::quick_start(&[
        "Connect <code>q</code>, <code>qd</code> and <code>F</code> to displacement, velocity and excitation, all of the same instant.",
        "Set the communication step to the sampling interval, <code>sample_time</code> too where it is not 1 ms.",
        "Narrow the law: <code>model</code> = <code>duffing</code>, or <code>terms</code> = <code>qdd, qd, q, q_3</code>.",
        "Run. Where <code>valid</code> is true, <code>coef.*</code> are the law's coefficients and <code>std.*</code> their std; \
         <code>switch.count</code> goes up when the law changes.",
        "If it never becomes valid, <code>stream</code>, <code>needed.*</code> and the log say what is lacking.",
    ]);
    let picture = documentation::PICTURE;
    let equation = match model.is_force_law() {
        true => "F = Σ θ<sub>j</sub> f<sub>j</sub>(q, q̇)",
        false => {
            "Σ θ<sub>j</sub> f<sub>j</sub>(q̈, q̇, q, F) = F, weak: ∫ Σ θ<sub>j</sub> f<sub>j</sub> δq dt = ∫ F δq dt"
        }
    };
    format!(
        "{picture}\n{start}<h2>The law</h2>\n<p>{equation}, piecewise: from a switch on with other θ. f<sub>j</sub> are products of \
         powers and named effects; θ are the outputs <code>coef.*</code>.</p>\n<h2>Samples</h2>\n<p>Connect <code>q</code>, <code>qd</code> and <code>F</code>. One <code>fmi2DoStep</code> is one sample: the \
         inputs are the sample at the step's start, the outputs hold at its end. Terms stand on the left-hand side, the \
         excitation on the right; this FMU's law may have {}.</p><p>A sample with a NaN is skipped and said in the log. \
         While a coefficient is unknown it keeps its last value and its std is 1e30. Parameters are taken at \
         <code>fmi2ExitInitializationMode</code>; 0 means automatic where the table says so.</p>",
        documentation::escape(&terms.join(", "))
    )
}

fn inputs() -> [Variable; 3] {
    [
        input(real("q", 0.0, None, "Displacement, sampled at the start of every step")),
        input(real("qd", 0.0, None, "Velocity, sampled at the start of every step")),
        input(real("F", 0.0, None, "Excitation, sampled at the start of every step")),
    ]
}

fn parameters(terms: &[Term]) -> Vec<Variable> {
    let names: Vec<String> = terms.iter().map(|term| term.name()).collect();
    let text = format!(
        "Terms of the law, separated by spaces or commas: those named are fitted, the others absent; empty = as the parameter \
         model says. To choose among: {}",
        names.join(" ")
    );
    let mut parameters = vec![
        variable("terms", Kind::String { start: String::new() }, text),
        choice("model", "Model", 1, "Which law's terms are fitted, in place of terms, where no text can be entered"),
        choice("method", "Method", 1, "Which procedure identifies; the publication's has the published settings"),
        choice("hold", "Hold", 1, "What F does between samples; in co-simulation an input is held over a step: zero"),
    ];
    parameters.extend(Parameter::ALL.iter().map(|parameter| {
        let start = parameter.default();
        at_least(real(parameter.name, start, parameter.unit, parameter.description), parameter.min)
    }));
    parameters
}

fn to_variable(of: &OutputDescription) -> Variable {
    let kind = match of.kind {
        OutputKind::Real(unit) => Kind::Real { start: 0.0, min: None, max: None, unit: unit.map(Into::into) },
        OutputKind::Count => Kind::Integer { start: 0, min: Some(0), max: None },
        OutputKind::Flag => Kind::Boolean { start: false },
        OutputKind::Status => Kind::Enumeration { of: "Status".into(), start: 1 },
        OutputKind::Sensor => Kind::Enumeration { of: "Sensor".into(), start: 1 },
        OutputKind::Effect => Kind::Enumeration { of: "Effect".into(), start: 1 },
    };
    let output = output(variable(&of.name, kind, &of.description), initial_dependencies(&of.name));
    if of.name.starts_with("std.") || of.name.starts_with("needed.") { at_least(output, 0.0) } else { output }
}

/// Which parameters an output's value before the first sample depends on.
fn initial_dependencies(name: &str) -> &'static [&'static str] {
    match name {
        "threshold" => &["deviation.threshold", "method"],
        "noise_estimate.q" => &["noise.q"],
        "noise_estimate.qd" => &["noise.qd"],
        "noise_estimate.F" => &["noise.F"],
        name if name.starts_with("coef.") || name.starts_with("std.") || name.starts_with("known.") => {
            &["terms", "model"]
        }
        _ => &[],
    }
}

/// What is to be said of the inputs.
fn stream() -> Variable {
    let kind = Kind::Enumeration { of: "Stream".into(), start: 1 };
    output(
        variable(
            "stream",
            kind,
            "What is to be said of the samples that the inputs bring; the log says it with its time",
        ),
        &[],
    )
}

/// In the order of the FMU's numbers.
const STREAM: [(&str, &str); 8] = [
    ("ok", "Nothing"),
    ("not_a_number", "A sample was NaN or infinite and is left out"),
    ("not_connected", "q, qd and F have been 0 since the start"),
    ("no_motion", "q and qd do not change"),
    (
        "not_fresh",
        "q, qd and F repeat bit by bit or lie on a line though the motion goes on: held, interpolated, or stuck",
    ),
    ("thinned", "Samples closer than half of sample_time are left out"),
    ("too_far_apart", "There was no sample for more than a sixth of a natural period"),
    ("too_coarse", "Fewer than six samples in a natural period of the motion"),
];

fn enumerations(terms: &[Term]) -> Vec<Enumeration> {
    let item = |name: &str, text: &str| (name.to_string(), text.to_string());
    let packaged = std::iter::once(item(
        "as_packaged",
        "As the packaged model says; evidence decides on terms that may be absent",
    ));
    let models = packaged.chain(NamedLaw::among(terms).into_iter().map(|law| item(law.id, law.equation)));
    let stream = STREAM.map(|(name, text)| item(name, text));
    let methods = Method::ALL.map(|method| {
        let text = match method {
            Method::Default => "Needs no setting",
            Method::Publication => "The published procedure",
        };
        item(method.id(), text)
    });
    let holds = Hold::ALL.map(|hold| {
        let text = match hold {
            Hold::Zero => "A sample's value stays until the next one",
            Hold::Linear => "A straight line from sample to sample",
            Hold::BandLimited => "Smooth up to half the sampling frequency",
        };
        item(hold.id(), text)
    });
    let statuses = Status::ALL.map(|status| {
        let text = match status {
            Status::Acquiring => "No law yet",
            Status::Tracking => "The law explains the data",
            Status::SwitchSuspected => "Evidence of a switch is growing",
            Status::ReIdentifying => "A switch was detected; the new law is being identified",
        };
        item(status.id(), text)
    });
    let sensors = SensorState::ALL.map(|state| {
        let text = match state {
            SensorState::Ok => "It works",
            SensorState::Outlier => "Its readings are far from what can have been",
            SensorState::Stuck => "It repeats its value where it varied before",
            SensorState::Offset => "It is off by a constant, which is taken off",
            SensorState::Missing => "It says nothing",
            SensorState::Late => "It comes later than the others",
        };
        item(state.id(), text)
    });
    let none = std::iter::once(item("none", "Nothing stands out"));
    let effects = none.chain(Catalogue::ENTRIES.iter().map(|entry| item(entry.id, entry.equation)));
    vec![
        Enumeration { name: "Model".into(), items: models.collect() },
        Enumeration { name: "Method".into(), items: methods.into() },
        Enumeration { name: "Hold".into(), items: holds.into() },
        Enumeration { name: "Status".into(), items: statuses.into() },
        Enumeration { name: "Sensor".into(), items: sensors.into() },
        Enumeration { name: "Effect".into(), items: effects.collect() },
        Enumeration { name: "Stream".into(), items: stream.into() },
    ]
}
