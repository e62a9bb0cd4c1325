//! A plant's interface for a law with parameters.

use super::description::describe;
use super::error::FmuError;
use crate::law::{Catalogue, Entry, Expression, InnerParameter, InnerRange, InnerUnit};
use crate::simulate::{Excitation, ParametricLaw, is_smooth};
use switchid_fmu_package::variables::{at_least, choice, derivative, input, output, real, variable};
use switchid_fmu_package::{Fmu, documentation};
use switchid_fmu_slave::{Causality, Description, Enumeration, Kind, Variability, Variable};

/// The law file of the Duffing oscillator, eq. (5).
pub const DUFFING: &str = include_str!("laws/duffing.toml");

/// The law file of the van der Pol circuit, eq. (9).
pub const VAN_DER_POL: &str = include_str!("laws/van_der_pol.toml");

/// How many stages a plant can have.
pub const STAGES: usize = 16;

/// Start of a stage that does not occur, s.
pub(super) const NEVER: f64 = 1e30;

/// A plant whose law is that file's, still without binaries.
///
/// # Errors
/// [`FmuError`] where the law is refused or its name is no identifier.
pub fn plant(law_file: &str) -> Result<Fmu, FmuError> {
    let law = ParametricLaw::from_toml(law_file)?;
    let description = plant_description(&law);
    let smooth = law.terms().into_iter().all(is_smooth);
    pack(if smooth { with_equations(description) } else { description }, law_file)
}

/// The description of a plant that a host can integrate too: q and q̇ are its continuous states.
pub(super) fn with_equations(mut description: Description) -> Description {
    let known = |variable: &&Variable| matches!(variable.causality, Causality::Parameter | Causality::Input);
    let names = description.variables.iter().filter(known).map(|variable| variable.name.clone());
    let acceleration = real("der(true.qd)", 0.0, None, "Derivative of true.qd in time: the acceleration without noise");
    let velocity = real("der(true.q)", 0.0, None, "Derivative of true.q in time");
    let derivatives = [
        Variable { depends_on: vec!["qd0".into()], ..derivative(velocity, "true.q", &["true.qd"]) },
        Variable {
            depends_on: names.collect(),
            ..derivative(acceleration, "true.qd", &["true.q", "true.qd", "excitation.F"])
        },
    ];
    for (name, state) in [("q", "true.q"), ("qd", "true.qd"), ("true.q", "true.q"), ("true.qd", "true.qd")] {
        let outputs = description.variables.iter_mut().filter(|variable| variable.name == name);
        outputs.for_each(|variable| variable.follows = vec![state.into()]);
    }
    description.variables.extend(derivatives);
    description.model_exchange = true;
    description
}

const INTEGRATED: &str = "<p>In model exchange your solver integrates <code>true.q</code> and <code>true.qd</code>. Stages begin, and an \
     excitation of the plant's own and the sensors' noise change, in time events; with <code>excitation.kind</code> = input or none \
     and without noise there are no others, and <code>excitation.F</code> acts at any time. <code>F</code> shows it as it was at the last \
     event. Hidden effects with memory, delay or dry friction are for co-simulation only.</p>";

const NOT_INTEGRATED: &str = "<p>This plant is for co-simulation only: its law has memory, a delay or dry friction, whose kinks only its own \
     integration meets.</p>";

/// A plant of that interface.
pub(super) fn pack(description: Description, law_file: &str) -> Result<Fmu, FmuError> {
    let start = documentation::quick_start(&[
        "Connect <code>q</code>, <code>qd</code> and <code>F</code> to an identifier's inputs.",
        "Set a switch: <code>stage[2].time</code> = 15, and in <code>stage[2].*</code> the coefficients from then on.",
        "Add sensor noise, <code>noise.q</code>, and run with steps of <code>excitation.sample_time</code>.",
        "Compare what was identified with <code>true.coef.*</code>.",
    ]);
    let law = documentation::escape(&description.description);
    let text = "<p>With <code>excitation.kind</code> = input the input <code>excitation.F</code> drives the plant, held over each \
                step: so it stands behind a controller or in place of a plant of yours. Connect an identifier's <code>F</code> to \
                what drives <code>excitation.F</code>: the plant's own <code>F</code> shows it one step later.</p>\
                <p>Outputs <code>q</code>, <code>qd</code> carry sensor noise, <code>F</code> is the excitation that is \
                held from this instant on; <code>true.*</code> is what no estimator may see. A stage begins at \
                <code>stage[i].time</code>, counted from the start of the simulation; 1e30 = it does not occur. The inner \
                integration does not depend on the communication step. <code>hidden.*</code> are effects \
                besides the law's terms, for a model to lack.</p>";
    let exchange = if description.model_exchange { INTEGRATED } else { NOT_INTEGRATED };
    let picture = documentation::PICTURE;
    let text = format!(
        "{picture}\n{start}<h2>The law</h2>\n<p>{law}; the coefficients are those of the present stage.</p>\n{text}\n{exchange}"
    );
    let page = documentation::page(&description, &text);
    Ok(Fmu::new(description, vec![("plant.toml".into(), law_file.as_bytes().to_vec())], page)?)
}

/// The variables of a plant: parameters, outputs, truth.
pub fn plant_description(law: &ParametricLaw) -> Description {
    let stages = (1..=STAGES).flat_map(|number| stage(law, number));
    let hidden = Catalogue::ENTRIES.iter().flat_map(hidden);
    let own = law.effects.iter().flat_map(own_effect);
    let variables = general().into_iter().chain([driver()]).chain(drive()).chain(stages).chain(hidden).chain(own);
    let variables: Vec<Variable> = variables.chain(measured()).chain(truth(law)).collect();
    describe(&law.name, &law.description, vec![excitations()], variables)
}

fn excitations() -> Enumeration {
    let items = [
        ("none", "Free motion"),
        ("sine", "P sin(omega t) with the numbers of the stage"),
        ("white", "Gaussian white noise of intensity excitation.intensity"),
        ("multisine", "excitation.count sines with phases drawn from the seed"),
        ("sweep", "A sine whose frequency runs from excitation.from to excitation.to and back"),
        ("input", "What the input excitation.F brings, held over each step"),
    ];
    let items = items.map(|(name, text)| (name.to_string(), text.to_string()));
    Enumeration { name: "Excitation".into(), items: items.into() }
}

fn general() -> Vec<Variable> {
    let grid = "Time between two points of the grid on which the excitation is evaluated and then held";
    vec![
        choice("excitation.kind", "Excitation", 2, "Which excitation acts"),
        at_least(real("excitation.intensity", 3.0, None, "Intensity 2D of the white noise"), 0.0),
        at_least(real("excitation.sample_time", 1e-3, Some("s"), grid), 1e-9),
        at_least(real("noise.q", 0.0, None, "Std of the Gaussian sensor noise on q"), 0.0),
        at_least(real("noise.qd", 0.0, None, "Std of the Gaussian sensor noise on qd"), 0.0),
        variable(
            "seed",
            Kind::Integer { start: 1, min: Some(0), max: None },
            "Seed of the white excitation, of the multisine's phases and of the sensor noise",
        ),
        real("q0", 0.5, None, "Displacement at the start"),
        real("qd0", 0.0, None, "Velocity at the start"),
    ]
}

fn driver() -> Variable {
    let text = "Excitation from outside, sampled at the start of every step and held over it; used where excitation.kind = input";
    input(real("excitation.F", 0.0, None, text))
}

/// What multisine and sweep are made of.
fn drive() -> [Variable; 5] {
    let Excitation { from, to, count, rms, period, .. } = Excitation::default();
    let range = |name, start, text| at_least(real(name, start, Some("rad/s"), text), 0.0);
    let count = Kind::Integer { start: count as i32, min: Some(1), max: Some(Excitation::MAX_COUNT as i32) };
    [
        range("excitation.from", from, "Lowest angular frequency of multisine and sweep"),
        range("excitation.to", to, "Highest angular frequency of multisine and sweep"),
        variable("excitation.count", count, "How many sines the multisine has"),
        at_least(real("excitation.rms", rms, None, "RMS of multisine and sweep"), 0.0),
        at_least(
            real("excitation.period", period, Some("s"), "How long the sweep takes from one end to the other"),
            1e-6,
        ),
    ]
}

/// An effect besides the law's terms: its coefficient, 0 where the plant does not have it, and its inner parameters.
pub(super) fn hidden(entry: &'static Entry) -> impl Iterator<Item = Variable> {
    let name = format!("hidden.{}", entry.id);
    let text =
        format!("Hidden effect in every stage: coefficient of {} on the left-hand side; 0 = absent", entry.equation);
    let inner = entry.inner().iter().map({
        let name = name.clone();
        move |parameter| inner(&name, parameter)
    });
    std::iter::once(real(name, 0.0, None, text)).chain(inner)
}

/// The same of an effect of the user's own.
pub(super) fn own_effect(own: &Expression) -> impl Iterator<Item = Variable> {
    let name = format!("hidden.{}", own.name());
    let text = format!("Effect in every stage: coefficient of {} on the left-hand side; 0 = absent", own.text());
    let coefficient = real(name.clone(), 0.0, None, text);
    let inner = own.parameters().iter().zip(own.values()).map(move |(inner, value)| {
        real(format!("{name}.{inner}"), *value, None, format!("Inner parameter {inner} of the effect"))
    });
    std::iter::once(coefficient).chain(inner)
}

fn inner(effect: &str, parameter: &InnerParameter) -> Variable {
    let unit = match parameter.unit {
        InnerUnit::Time => Some("s"),
        InnerUnit::AngularFrequency => Some("rad/s"),
        _ => None,
    };
    let variable = real(format!("{effect}.{}", parameter.name), parameter.default, unit, parameter.description);
    match parameter.range {
        InnerRange::Positive | InnerRange::NotNegative => at_least(variable, 0.0),
        InnerRange::AtLeast(least) => at_least(variable, least),
        InnerRange::Either(one, other) => at_least(variable, one.min(other)),
        InnerRange::Any => variable,
    }
}

fn stage(law: &ParametricLaw, number: usize) -> Vec<Variable> {
    let name = |field: &str| format!("stage[{number}].{field}");
    let (start, text) = match number {
        1 => (0.0, "Start of the first stage: 0".to_string()),
        _ => (NEVER, format!("Start of stage {number}, after that of the stage before; 1e30 = it does not occur")),
    };
    let mut variables = vec![at_least(real(name("time"), start, Some("s"), text), 0.0)];
    variables.extend(law.parameters.iter().map(|parameter| {
        real(name(&parameter.name), parameter.start, None, format!("{} in stage {number}", parameter.description))
    }));
    variables.push(real(name("P"), law.amplitude, None, format!("Amplitude of the sine excitation in stage {number}")));
    let omega = format!("Angular frequency of the sine excitation in stage {number}");
    variables.push(real(name("omega"), law.omega, Some("rad/s"), omega));
    variables
}

fn measured() -> [Variable; 3] {
    let drive = [
        "excitation.kind",
        "excitation.intensity",
        "excitation.sample_time",
        "excitation.from",
        "excitation.to",
        "excitation.count",
        "excitation.rms",
        "excitation.period",
        "seed",
        "stage[1].P",
        "stage[1].omega",
    ];
    [
        continuous(output(real("q", 0.0, None, "Displacement with its sensor noise"), &["noise.q", "seed", "q0"])),
        continuous(output(real("qd", 0.0, None, "Velocity with its sensor noise"), &["noise.qd", "seed", "qd0"])),
        output(
            real("F", 0.0, None, "Excitation held from this instant on; of an input the one that was held last"),
            &drive,
        ),
    ]
}

fn truth(law: &ParametricLaw) -> Vec<Variable> {
    let stage = variable("true.stage", Kind::Integer { start: 1, min: None, max: None }, "Number of the present stage");
    let mut variables = vec![
        continuous(output(real("true.q", 0.0, None, "Displacement without noise"), &["q0"])),
        continuous(output(real("true.qd", 0.0, None, "Velocity without noise"), &["qd0"])),
        output(stage, &[]),
    ];
    variables.extend(true_coefficients(law));
    variables
}

/// The coefficients of the present stage.
pub(super) fn true_coefficients(law: &ParametricLaw) -> impl Iterator<Item = Variable> {
    law.terms().into_iter().map(|term| {
        let depends: Vec<String> = law.depends_on(term).map(|name| format!("stage[1].{name}")).collect();
        let text = format!("Coefficient of {term} on the left-hand side in the present stage");
        Variable { depends_on: depends, ..output(real(format!("true.coef.{}", term.fmu_name()), 0.0, None, text), &[]) }
    })
}

fn continuous(variable: Variable) -> Variable {
    Variable { variability: Variability::Continuous, ..variable }
}
