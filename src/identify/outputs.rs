//! What an identifier publishes, by name: outputs of the FMU, columns of the command line's trace.

use super::identifier::Identifier;
use super::report::{SensorState, Status};
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

/// Name, kind and description.
type Scalar = (&'static str, OutputKind, &'static str);

/// What a law that gives F has in place of the predictions of a motion, and besides.
const OF_FORCE: [Scalar; 3] = [
    ("prediction.F", OutputKind::Real(None), "F that the present law gives for the last sample's q and qd"),
    ("noise_estimate.F", OutputKind::Real(None), "Estimated std of what F has besides the law; 1e30 while not known"),
    (
        "explained",
        OutputKind::Real(None),
        "Share of the variance of F that the present law explains; 0 while not known",
    ),
];

const SCALARS: [Scalar; 21] = [
    ("switch.count", OutputKind::Count, "Switches detected so far"),
    ("switch.time", OutputKind::Real(Some("s")), "Estimated instant at which the present stage began"),
    (
        "switch.time_std",
        OutputKind::Real(Some("s")),
        "Std of switch.time; 1e30 in the first stage, which no switch began",
    ),
    (
        "switch.detection_time",
        OutputKind::Real(Some("s")),
        "Time of the alarm that ended the last stage; 1e30 before the first alarm",
    ),
    ("status", OutputKind::Status, "What the identifier is doing"),
    (
        "valid",
        OutputKind::Flag,
        "Whether the present law is validated, every std known, and the last samples were used",
    ),
    ("deviation", OutputKind::Real(None), "Mean deviation of prediction from observation over deviation.interval"),
    ("threshold", OutputKind::Real(None), "Deviation that is out of the ordinary"),
    ("prediction.q", OutputKind::Real(None), "q that the present law predicts for the last sample"),
    ("prediction.qd", OutputKind::Real(None), "qd that the present law predicts for the last sample"),
    ("noise_estimate.q", OutputKind::Real(None), "Estimated std of the sensor noise on q; 1e30 while not known"),
    ("noise_estimate.qd", OutputKind::Real(None), "Estimated std of the sensor noise on qd; 1e30 while not known"),
    ("identified_time", OutputKind::Real(Some("s")), "First time at which the present law was validated; 1e30 before"),
    (
        "missing.effect",
        OutputKind::Effect,
        "The effect of the catalogue that the present law lacks most; none where no evidence stands out",
    ),
    (
        "missing.evidence",
        OutputKind::Real(None),
        "Log-likelihood that missing.effect would gain, less that of chance among all candidates, nats",
    ),
    (
        "law.number",
        OutputKind::Count,
        "Number of the law in use among those validated so far, the same whenever it returns; 0 while there is none",
    ),
    ("drifting", OutputKind::Flag, "Whether the coefficients move: they are followed as they go"),
    (
        "switch.named_time",
        OutputKind::Real(Some("s")),
        "Time at which the alarm that ended the last stage had its name, no sensor's fault; 1e30 before the first one",
    ),
    ("sensor.q", OutputKind::Sensor, "What the sensor of q does"),
    ("sensor.qd", OutputKind::Sensor, "What the sensor of qd does"),
    ("sensor.F", OutputKind::Sensor, "What the sensor of F does"),
];

impl Outputs {
    /// The outputs for these terms, with the names that FMU and trace give them: all `coef.`, all `std.`, all
    /// `needed.`, all `known.`, the rest.
    pub fn describe(terms: &[Term]) -> Vec<OutputDescription> {
        let real =
            |name: String, description: String| OutputDescription { name, kind: OutputKind::Real(None), description };
        let coefficients = terms.iter().map(|term| {
            let description =
                format!("Coefficient of {term} on the left-hand side; keeps its last value while unknown");
            real(format!("coef.{}", term.fmu_name()), description)
        });
        let stds = terms.iter().map(|term| {
            real(format!("std.{}", term.fmu_name()), format!("Std of the coefficient of {term}; 1e30 while unknown"))
        });
        let needed = terms.iter().map(|term| OutputDescription {
            name: format!("needed.{}", term.fmu_name()),
            kind: OutputKind::Real(Some("s")),
            description: format!(
                "Further time of such motion until the coefficient of {term} is known as a law that is valid asks; 0 when it is, 1e30 while \
                 nothing can be said"
            ),
        });
        let known = terms.iter().map(|term| OutputDescription {
            name: format!("known.{}", term.fmu_name()),
            kind: OutputKind::Flag,
            description: format!("Whether std.{} is known; plot the two only where it is", term.fmu_name()),
        });
        let scalars = scalars_of(is_force_law(terms));
        let scalars =
            scalars.map(|(name, kind, text)| OutputDescription { name: name.into(), kind, description: text.into() });
        coefficients.chain(stds).chain(needed).chain(known).chain(scalars).collect()
    }

    /// The outputs of this identifier over these terms.
    pub fn new(terms: &[Term], identifier: &Identifier) -> Outputs {
        let coefficients = identifier.coefficients();
        let place = |term: &Term| coefficients.iter().position(|coefficient| coefficient.term == *term);
        Outputs { places: terms.iter().map(place).collect(), of_force: is_force_law(terms) }
    }

    /// Every value, in the order of [`Outputs::describe`].
    pub fn values<'a>(&'a self, identifier: &'a Identifier) -> impl Iterator<Item = OutputValue> + 'a {
        let coefficients = identifier.coefficients();
        let at = |place: &Option<usize>| place.and_then(|place| coefficients.get(place));
        let values = self.places.iter().map(move |place| at(place).map_or(0.0, |found| found.value));
        let stds = self.places.iter().map(move |place| at(place).and_then(|found| found.std).unwrap_or(UNKNOWN));
        let needed = self.places.iter().map(move |place| at(place).and_then(|found| found.needed).unwrap_or(UNKNOWN));
        let known = self.places.iter().map(move |place| at(place).is_some_and(|found| found.std.is_some()));
        let scalars = SCALARS.iter().zip(scalars(identifier)).map(|((name, ..), value)| (*name, value));
        let kept = scalars.filter(|(name, _)| !self.of_force || !PREDICTIONS.contains(name)).map(|(_, value)| value);
        let of_force = of_force(identifier).into_iter().filter(|_| self.of_force);
        let reals = values.chain(stds).chain(needed).map(OutputValue::Real);
        reals.chain(known.map(OutputValue::Flag)).chain(kept).chain(of_force)
    }
}

/// Predictions that a law which gives F does not make.
const PREDICTIONS: [&str; 2] = ["prediction.q", "prediction.qd"];

fn is_force_law(terms: &[Term]) -> bool {
    terms.iter().all(|term| !term.is_inertial())
}

fn scalars_of(force_law: bool) -> impl Iterator<Item = Scalar> {
    let kept = SCALARS.into_iter().filter(move |(name, ..)| !force_law || !PREDICTIONS.contains(name));
    kept.chain(OF_FORCE.into_iter().filter(move |_| force_law))
}

/// In the order of [`OF_FORCE`].
fn of_force(identifier: &Identifier) -> [OutputValue; OF_FORCE.len()] {
    let output = identifier.output();
    let (noise, explained) = (output.noise.force.unwrap_or(UNKNOWN), output.explained.unwrap_or(0.0));
    [output.prediction.force, noise, explained].map(OutputValue::Real)
}

fn scalars(identifier: &Identifier) -> [OutputValue; SCALARS.len()] {
    let output = identifier.output();
    let or_unknown = |value: Option<f64>| OutputValue::Real(value.unwrap_or(UNKNOWN));
    [
        OutputValue::Count(output.switch_count),
        OutputValue::Real(output.switch_time),
        or_unknown(output.switch_time_std),
        or_unknown(output.detection_time),
        OutputValue::Status(output.status),
        OutputValue::Flag(output.valid),
        OutputValue::Real(output.deviation),
        OutputValue::Real(output.threshold),
        OutputValue::Real(output.prediction.q),
        OutputValue::Real(output.prediction.qd),
        or_unknown(output.noise.q),
        or_unknown(output.noise.qd),
        or_unknown(output.identified_time),
        OutputValue::Effect(output.missing.map_or(1, |missing| missing.entry as u8 + 2)),
        OutputValue::Real(output.missing.map_or(0.0, |missing| missing.evidence)),
        OutputValue::Count(output.law_number.unwrap_or(0)),
        OutputValue::Flag(output.drifting),
        or_unknown(output.named_time),
        OutputValue::Sensor(output.sensors[0]),
        OutputValue::Sensor(output.sensors[1]),
        OutputValue::Sensor(output.sensors[2]),
    ]
}

#[cfg(test)]
mod tests {
    use super::{Outputs, UNKNOWN};
    use crate::identify::{Identifier, Settings};
    use crate::law::{Model, Term};

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
}
