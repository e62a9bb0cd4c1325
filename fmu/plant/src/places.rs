//! Where a plant's variables stand, and the scenario that its parameters describe.

use serde::{Deserialize, Serialize};
use switchid::law::{Catalogue, Entry, Expression, InnerError, InnerParameter, State, Term};
use switchid::simulate::{
    Excitation, ExcitationKind, Hidden, ParametricLaw, Reading, Scenario, SensorNoise, Stage, Truth,
};
use switchid_fmu_slave::{Description, Value, ValueError, Values};
use thiserror::Error;

/// A start from which on a stage does not occur, s.
const NEVER: f64 = 1e29;

/// Why parameters describe no plant.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlaceError {
    /// A stage is left out before one that occurs.
    #[error("stage[{set}].time is set but stage[{missing}].time is not: number the stages without a gap")]
    Gap {
        /// Number of the stage that is left out.
        missing: usize,
        /// Number of one that occurs after it.
        set: usize,
    },
    /// An inner parameter of a hidden effect is refused.
    #[error("hidden.{0}")]
    Inner(#[from] InnerError),
}

/// The number of the excitation that comes from outside.
const INPUT: i32 = 6;

/// Value references of all variables.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Places {
    kind: usize,
    input: usize,
    intensity: usize,
    sample_time: usize,
    drive: DrivePlaces,
    noise: [usize; 2],
    seed: usize,
    initial: [usize; 2],
    stages: Vec<StagePlaces>,
    /// Coefficient and inner parameters of each effect of the catalogue.
    hidden: Vec<(usize, Vec<usize>)>,
    /// The same of each of the user's own.
    own: Vec<(usize, Vec<usize>)>,
    /// `q`, `qd`, `F`, `true.q`, `true.qd`.
    motion: [usize; 5],
    /// `true.stage`.
    stage: usize,
    /// `true.coef.*`, in the order of the law's terms.
    coefficients: Vec<usize>,
    /// `der(true.q)`, `der(true.qd)`, where a host can integrate it.
    derivatives: Option<[usize; 2]>,
}

/// What multisine and sweep are made of.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct DrivePlaces {
    from: usize,
    to: usize,
    count: usize,
    rms: usize,
    period: usize,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StagePlaces {
    time: usize,
    parameters: Vec<usize>,
    /// Amplitude and angular frequency of the sine, where there is an excitation.
    sine: Option<[usize; 2]>,
}

impl Places {
    /// Finds every variable of a plant with that law.
    ///
    /// # Errors
    /// [`ValueError::NoSuchName`] when one is missing.
    pub fn find(description: &Description, law: &ParametricLaw) -> Result<Places, ValueError> {
        let find = |name: &str| position(description, name);
        let coefficients = law.terms().into_iter().map(|term| find(&format!("true.coef.{}", term.fmu_name())));
        let count = (1..).take_while(|number| description.position(&format!("stage[{number}].time")).is_some()).count();
        Ok(Places {
            kind: find("excitation.kind")?,
            input: find("excitation.F")?,
            intensity: find("excitation.intensity")?,
            sample_time: find("excitation.sample_time")?,
            drive: find_drive(description)?,
            noise: [find("noise.q")?, find("noise.qd")?],
            seed: find("seed")?,
            initial: [find("q0")?, find("qd0")?],
            stages: (1..=count).map(|number| find_stage(description, law, number)).collect::<Result<_, _>>()?,
            hidden: find_hidden_of(description, Catalogue::ENTRIES.iter())?,
            own: find_own_of(description, law)?,
            motion: [find("q")?, find("qd")?, find("F")?, find("true.q")?, find("true.qd")?],
            stage: find("true.stage")?,
            coefficients: coefficients.collect::<Result<_, _>>()?,
            derivatives: description.position("der(true.q)").zip(description.position("der(true.qd)")).map(Into::into),
        })
    }

    /// The scenario that the parameters describe; not checked yet.
    ///
    /// # Errors
    /// [`PlaceError`] for a gap in the schedule or an impossible inner parameter of a hidden effect.
    pub fn scenario(&self, law: &ParametricLaw, values: &Values) -> Result<Scenario, PlaceError> {
        let [q, qd] = self.initial.map(|reference| values.real(reference));
        let [noise_q, noise_qd] = self.noise.map(|reference| values.real(reference));
        // A plant has no end: the duration is only there to be positive.
        let mut scenario = Scenario::new(&law.name, law.terms(), schedule(&self.stages, law, values)?, NEVER);
        scenario.seed = values.integer(self.seed).max(0) as u64;
        scenario.initial = State { q, qd };
        scenario.noise = SensorNoise { q: noise_q, qd: noise_qd, ..SensorNoise::default() };
        scenario.excitation = self.excitation(values);
        scenario.hidden = hidden_effects(Catalogue::ENTRIES.iter(), &self.hidden, values)?;
        push_own(&mut scenario.hidden, law, &self.own, values);
        Ok(scenario)
    }

    /// What drives the plant from outside; `None` where it has an excitation of its own.
    pub fn input(&self, values: &Values) -> Option<f64> {
        (values.integer(self.kind) == INPUT).then(|| self.outside(values))
    }

    /// Whether variables show the derivatives of the state.
    pub fn shows_derivatives(&self) -> bool {
        self.derivatives.is_some()
    }

    /// What the input brings, whether it acts or not.
    pub fn outside(&self, values: &Values) -> f64 {
        values.real(self.input)
    }

    /// Writes what is measured and what is the case.
    pub fn show(&self, reading: &Reading, truth: &Truth, acceleration: f64, values: &mut Values) {
        let motion = [reading.q, reading.qd, reading.excitation, truth.state.q, truth.state.qd];
        let derivatives = self.derivatives.into_iter().flatten().zip([truth.state.qd, acceleration]);
        for (reference, value) in self.motion.into_iter().zip(motion).chain(derivatives) {
            values.put(reference, Value::Real(value));
        }
        for (reference, value) in self.coefficients.iter().zip(truth.coefficients) {
            values.put(*reference, Value::Real(*value));
        }
        values.put(self.stage, Value::Integer(truth.stage as i32 + 1));
    }

    fn excitation(&self, values: &Values) -> Excitation {
        let drive = &self.drive;
        Excitation {
            kind: match values.integer(self.kind) {
                1 | INPUT => ExcitationKind::None,
                2 => ExcitationKind::Sine,
                3 => ExcitationKind::WhiteNoise,
                4 => ExcitationKind::Multisine,
                _ => ExcitationKind::Sweep,
            },
            intensity: values.real(self.intensity),
            sample_time: values.real(self.sample_time),
            from: values.real(drive.from),
            to: values.real(drive.to),
            count: values.integer(drive.count).max(0) as u32,
            rms: values.real(drive.rms),
            period: values.real(drive.period),
        }
    }
}

/// The effects whose coefficient is not 0, of those at these places.
///
/// # Errors
/// [`InnerError`] for an impossible inner parameter.
pub fn hidden_effects(
    entries: impl Iterator<Item = &'static Entry>,
    places: &[(usize, Vec<usize>)],
    values: &Values,
) -> Result<Hidden, InnerError> {
    let mut hidden = Hidden::default();
    for (entry, (coefficient, inner)) in entries.zip(places) {
        let coefficient = values.real(*coefficient);
        if coefficient == 0.0 {
            continue;
        }
        let inner: Vec<f64> = inner.iter().map(|reference| values.real(*reference)).collect();
        let term = match entry.term {
            Term::Effect(effect) => Term::Effect(effect.with_inner(&inner)?),
            term => term,
        };
        hidden.push(term, coefficient);
    }
    Ok(hidden)
}

/// Adds the user's own effects whose coefficient is not 0, of those at these places.
pub fn push_own(hidden: &mut Hidden, law: &ParametricLaw, places: &[(usize, Vec<usize>)], values: &Values) {
    for (effect, (coefficient, inner)) in law.effects.iter().zip(places) {
        let coefficient = values.real(*coefficient);
        if coefficient != 0.0 {
            let mut effect = effect.clone();
            effect.set(&inner.iter().map(|reference| values.real(*reference)).collect::<Vec<f64>>());
            hidden.push_expression(effect, coefficient);
        }
    }
}

/// All stages that occur.
///
/// # Errors
/// [`PlaceError::Gap`].
pub fn schedule(stages: &[StagePlaces], law: &ParametricLaw, values: &Values) -> Result<Vec<Stage>, PlaceError> {
    let occurs = |places: &StagePlaces| values.real(places.time) < NEVER;
    let count = stages.iter().take_while(|places| occurs(places)).count();
    if let Some(next) = stages[count..].iter().position(occurs) {
        return Err(PlaceError::Gap { missing: count + 1, set: count + 1 + next });
    }
    Ok(stages[..count].iter().map(|places| places.stage(law, values)).collect())
}

impl StagePlaces {
    fn stage(&self, law: &ParametricLaw, values: &Values) -> Stage {
        let [amplitude, omega] = self.sine.map_or([0.0; 2], |sine| sine.map(|reference| values.real(reference)));
        let parameters: Vec<f64> = self.parameters.iter().map(|reference| values.real(*reference)).collect();
        Stage { start: values.real(self.time), coefficients: law.coefficients(&parameters), amplitude, omega }
    }
}

fn find_drive(description: &Description) -> Result<DrivePlaces, ValueError> {
    let find = |field: &str| position(description, &format!("excitation.{field}"));
    let (from, to, count) = (find("from")?, find("to")?, find("count")?);
    Ok(DrivePlaces { from, to, count, rms: find("rms")?, period: find("period")? })
}

/// Coefficient and inner parameters of each of these effects.
///
/// # Errors
/// [`ValueError::NoSuchName`].
pub fn find_hidden_of(
    description: &Description,
    entries: impl Iterator<Item = &'static Entry>,
) -> Result<Vec<(usize, Vec<usize>)>, ValueError> {
    let places = |id: &str, inner: &[InnerParameter]| {
        let name = format!("hidden.{id}");
        let inner = inner.iter().map(|inner| position(description, &format!("{name}.{}", inner.name)));
        Ok((position(description, &name)?, inner.collect::<Result<_, _>>()?))
    };
    entries.map(|entry| places(entry.id, entry.inner())).collect()
}

/// Coefficient and inner parameters of each of the user's own effects.
///
/// # Errors
/// [`ValueError::NoSuchName`].
pub fn find_own_of(description: &Description, law: &ParametricLaw) -> Result<Vec<(usize, Vec<usize>)>, ValueError> {
    let places = |own: &Expression| {
        let name = format!("hidden.{}", own.name());
        let inner = own.parameters().iter().map(|inner| position(description, &format!("{name}.{inner}")));
        Ok((position(description, &name)?, inner.collect::<Result<_, _>>()?))
    };
    law.effects.iter().map(places).collect()
}

fn find_stage(description: &Description, law: &ParametricLaw, number: usize) -> Result<StagePlaces, ValueError> {
    let find = |field: &str| position(description, &format!("stage[{number}].{field}"));
    let sine = Some([find("P")?, find("omega")?]);
    Ok(StagePlaces { sine, ..find_time_and_parameters(description, law, number)? })
}

/// A stage without excitation.
///
/// # Errors
/// [`ValueError::NoSuchName`].
pub fn find_time_and_parameters(
    description: &Description,
    law: &ParametricLaw,
    number: usize,
) -> Result<StagePlaces, ValueError> {
    let find = |field: &str| position(description, &format!("stage[{number}].{field}"));
    let parameters = law.parameters.iter().map(|parameter| find(&parameter.name));
    Ok(StagePlaces { time: find("time")?, parameters: parameters.collect::<Result<_, _>>()?, sine: None })
}

/// Where the variable of that name stands.
///
/// # Errors
/// [`ValueError::NoSuchName`].
pub fn position(description: &Description, name: &str) -> Result<usize, ValueError> {
    description.position(name).ok_or_else(|| ValueError::NoSuchName { name: name.into() })
}
