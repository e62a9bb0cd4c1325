//! What an identifier publishes, by name: outputs of the FMU, columns of the command line's trace.

use super::identifier::Identifier;
use super::report::{Coefficient, Output, SensorState, Status};
use crate::law::Term;
use serde::{Deserialize, Serialize};

/// Stands for "not known" where a number has to stand: stds before the first law, instants that have not come.
pub const UNKNOWN: f64 = 1e30;

/// What kind of value an output has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputKind {
    /// A real number, with its unit where it has one.
    Real(Option<&'static str>),
    /// A number of events.
    Count,
    /// True or false.
    Flag,
    /// A [`Status`].
    Status,
    /// A [`SensorState`].
    Sensor,
    /// An effect of the catalogue, 2 the first; 1 for none.
    Effect,
}

/// An output's name and meaning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputDescription {
    /// Its name: `coef.q_2_qd`, `switch.time`.
    pub name: String,
    /// What kind of value it has.
    pub kind: OutputKind,
    /// What it says.
    pub description: String,
}

/// An output's value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutputValue {
    /// Of [`OutputKind::Real`].
    Real(f64),
    /// Of [`OutputKind::Count`].
    Count(u32),
    /// Of [`OutputKind::Flag`].
    Flag(bool),
    /// Of [`OutputKind::Status`].
    Status(Status),
    /// Of [`OutputKind::Sensor`].
    Sensor(SensorState),
    /// Of [`OutputKind::Effect`].
    Effect(u8),
}

impl OutputValue {
    /// As a number, for a table: flags are 0 and 1, a status its number.
    pub fn number(self) -> f64 {
        match self {
            OutputValue::Real(value) => value,
            OutputValue::Count(count) => f64::from(count),
            OutputValue::Flag(flag) => f64::from(u8::from(flag)),
            OutputValue::Status(status) => f64::from(status as u8),
            OutputValue::Sensor(sensor) => f64::from(sensor as u8),
            OutputValue::Effect(effect) => f64::from(effect),
        }
    }
}

/// The outputs of an identifier over a list of terms, which may hold terms that its model leaves out: their
/// coefficient is 0 and their std [`UNKNOWN`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outputs {
    /// For every listed term, its place among the identifier's coefficients.
    places: Vec<Option<usize>>,
    /// Whether F is what the law gives.
    of_force: bool,
}

const NUMBER: OutputKind = OutputKind::Real(None);
const SECONDS: OutputKind = OutputKind::Real(Some("s"));

fn or_unknown(value: Option<f64>) -> OutputValue {
    OutputValue::Real(value.unwrap_or(UNKNOWN))
}

/// Stands for a term that the model leaves out.
const ABSENT: Coefficient = Coefficient::unknown(Term::Inertia);

/// An output's name, kind and description, and how it is read from what an `S` says.
type Row<S> = (&'static str, OutputKind, &'static str, fn(&S) -> OutputValue);

/// What there is of every term, whose name comes after that of the output: `std.q_2`.
const OF_TERMS: &[Row<Coefficient>] = &[
    (
        "coef",
        NUMBER,
        "Coefficient of {term} on the left-hand side; keeps its last value while unknown",
        |coefficient| OutputValue::Real(coefficient.value),
    ),
    ("std", NUMBER, "Std of the coefficient of {term}; 1e30 while unknown", |coefficient| or_unknown(coefficient.std)),
    (
        "needed",
        SECONDS,
        "Further time of such motion until the coefficient of {term} is known as a law that is valid asks; 0 when it is, 1e30 while \
         nothing can be said",
        |coefficient| or_unknown(coefficient.needed),
    ),
    ("known", OutputKind::Flag, "Whether std.{name} is known; plot the two only where it is", |coefficient| {
        OutputValue::Flag(coefficient.std.is_some())
    }),
];

/// What there is once, whatever the terms are.
const SCALARS: &[Row<Output>] = &[
    ("switch.count", OutputKind::Count, "Switches detected so far", |output| OutputValue::Count(output.switch_count)),
    ("switch.time", SECONDS, "Estimated instant at which the present stage began", |output| {
        OutputValue::Real(output.switch_time)
    }),
    ("switch.time_std", SECONDS, "Std of switch.time; 1e30 in the first stage, which no switch began", |output| {
        or_unknown(output.switch_time_std)
    }),
    (
        "switch.detection_time",
        SECONDS,
        "Time of the alarm that ended the last stage; 1e30 before the first alarm",
        |output| or_unknown(output.detection_time),
    ),
    ("status", OutputKind::Status, "What the identifier is doing", |output| OutputValue::Status(output.status)),
    (
        "valid",
        OutputKind::Flag,
        "Whether the present law is validated, every std known, and the last samples were used",
        |output| OutputValue::Flag(output.valid),
    ),
    ("deviation", NUMBER, "Mean deviation of prediction from observation over deviation.interval", |output| {
        OutputValue::Real(output.deviation)
    }),
    ("threshold", NUMBER, "Deviation that is out of the ordinary", |output| OutputValue::Real(output.threshold)),
    ("prediction.q", NUMBER, "q that the present law predicts for the last sample", |output| {
        OutputValue::Real(output.prediction.q)
    }),
    ("prediction.qd", NUMBER, "qd that the present law predicts for the last sample", |output| {
        OutputValue::Real(output.prediction.qd)
    }),
    ("noise_estimate.q", NUMBER, "Estimated std of the sensor noise on q; 1e30 while not known", |output| {
        or_unknown(output.noise.q)
    }),
    ("noise_estimate.qd", NUMBER, "Estimated std of the sensor noise on qd; 1e30 while not known", |output| {
        or_unknown(output.noise.qd)
    }),
    ("identified_time", SECONDS, "First time at which the present law was validated; 1e30 before", |output| {
        or_unknown(output.identified_time)
    }),
    (
        "missing.effect",
        OutputKind::Effect,
        "The effect of the catalogue that the present law lacks most; none where no evidence stands out",
        |output| OutputValue::Effect(output.missing.map_or(1, |missing| missing.entry as u8 + 2)),
    ),
    (
        "missing.evidence",
        NUMBER,
        "Log-likelihood that missing.effect would gain, less that of chance among all candidates, nats",
        |output| OutputValue::Real(output.missing.map_or(0.0, |missing| missing.evidence)),
    ),
    (
        "law.number",
        OutputKind::Count,
        "Number of the law in use among those validated so far, the same whenever it returns; 0 while there is none",
        |output| OutputValue::Count(output.law_number.unwrap_or(0)),
    ),
    ("drifting", OutputKind::Flag, "Whether the coefficients move: they are followed as they go", |output| {
        OutputValue::Flag(output.drifting)
    }),
    (
        "switch.named_time",
        SECONDS,
        "Time at which the alarm that ended the last stage had its name, no sensor's fault; 1e30 before the first one",
        |output| or_unknown(output.named_time),
    ),
    ("sensor.q", OutputKind::Sensor, "What the sensor of q does", |output| OutputValue::Sensor(output.sensors[0])),
    ("sensor.qd", OutputKind::Sensor, "What the sensor of qd does", |output| OutputValue::Sensor(output.sensors[1])),
    ("sensor.F", OutputKind::Sensor, "What the sensor of F does", |output| OutputValue::Sensor(output.sensors[2])),
    ("prediction.F", NUMBER, "F that the present law gives for the last sample's q and qd", |output| {
        OutputValue::Real(output.prediction.force)
    }),
    ("noise_estimate.F", NUMBER, "Estimated std of what F has besides the law; 1e30 while not known", |output| {
        or_unknown(output.noise.force)
    }),
    ("explained", NUMBER, "Share of the variance of F that the present law explains; 0 while not known", |output| {
        OutputValue::Real(output.explained.unwrap_or(0.0))
    }),
];

/// What only a law of motion has.
const OF_MOTION: &[&str] = &["prediction.q", "prediction.qd"];

/// What only a law that gives F has.
const OF_FORCE: &[&str] = &["prediction.F", "noise_estimate.F", "explained"];

fn scalars(of_force: bool) -> impl Iterator<Item = &'static Row<Output>> {
    let of_others = if of_force { OF_MOTION } else { OF_FORCE };
    SCALARS.iter().filter(move |(name, ..)| !of_others.contains(name))
}

impl Outputs {
    /// The outputs for these terms, with the names that FMU and trace give them: all `coef.`, all `std.`, all
    /// `needed.`, all `known.`, the rest.
    pub fn describe(terms: &[Term]) -> Vec<OutputDescription> {
        let of_terms = OF_TERMS.iter().flat_map(|(before, kind, text, _)| {
            terms.iter().map(move |term| {
                let description = text.replace("{term}", &term.name()).replace("{name}", &term.fmu_name());
                OutputDescription { name: format!("{before}.{}", term.fmu_name()), kind: *kind, description }
            })
        });
        let scalars = scalars(is_force_law(terms)).map(|(name, kind, text, _)| OutputDescription {
            name: (*name).into(),
            kind: *kind,
            description: (*text).into(),
        });
        of_terms.chain(scalars).collect()
    }

    /// The outputs of this identifier over these terms.
    pub fn new(terms: &[Term], identifier: &Identifier) -> Outputs {
        let coefficients = identifier.coefficients();
        let place = |term: &Term| coefficients.iter().position(|coefficient| coefficient.term == *term);
        Outputs { places: terms.iter().map(place).collect(), of_force: is_force_law(terms) }
    }

    /// Every value, in the order of [`Outputs::describe`].
    pub fn values<'a>(&'a self, identifier: &'a Identifier) -> impl Iterator<Item = OutputValue> + 'a {
        let at = |place: &Option<usize>| place.and_then(|place| identifier.coefficients().get(place));
        let coefficients = self.places.iter().map(move |place| at(place).unwrap_or(&ABSENT));
        let of_terms = OF_TERMS.iter().flat_map(move |(.., value)| coefficients.clone().map(value));
        of_terms.chain(scalars(self.of_force).map(|(.., value)| value(identifier.output())))
    }
}

fn is_force_law(terms: &[Term]) -> bool {
    terms.iter().all(|term| !term.is_inertial())
}

#[cfg(test)]
mod tests {
    use super::{Outputs, UNKNOWN};
    use crate::identify::{Identifier, Settings};
    use crate::law::{Given, Model, Term};

    #[test]
    fn a_term_that_the_model_leaves_out_is_listed_as_unknown() {
        let library = Model::cubic_library();
        let terms: Vec<Term> = library.terms.iter().map(|entry| entry.term).collect();
        let duffing = library.with_terms(["qdd", "qd", "q", "q^3"]).unwrap();
        let identifier = Identifier::new(&duffing, Settings::default()).unwrap();
        let outputs = Outputs::new(&terms, &identifier);
        let names = Outputs::describe(&terms);
        let values: Vec<f64> = outputs.values(&identifier).map(|value| value.number()).collect();
        assert_eq!(values.len(), names.len());
        let at = |name: &str| values[names.iter().position(|output| output.name == name).unwrap()];
        assert_eq!((at("coef.q_2_qd"), at("std.q_2_qd")), (0.0, UNKNOWN));
        assert_eq!((at("std.qdd"), at("status")), (UNKNOWN, 1.0));
        assert_eq!((at("needed.qdd"), at("switch.time_std")), (UNKNOWN, UNKNOWN));
        assert_eq!((at("known.qdd"), at("known.q_2_qd")), (0.0, 0.0));
    }

    #[test]
    fn every_value_is_of_the_kind_that_is_said() {
        let variant = |of: &dyn std::fmt::Debug| format!("{of:?}").split('(').next().map(String::from);
        for model in [Model::cubic_library(), Model::of("force law", [(Term::power(1, 0), Given::Fit)])] {
            let terms: Vec<Term> = model.terms.iter().map(|entry| entry.term).collect();
            let identifier = Identifier::new(&model, Settings::default()).unwrap();
            let outputs = Outputs::new(&terms, &identifier);
            for (said, value) in Outputs::describe(&terms).iter().zip(outputs.values(&identifier)) {
                assert_eq!(variant(&said.kind), variant(&value), "{}", said.name);
            }
        }
    }
}
