//! What an identifier tells after a step.

use crate::estimation::Missing;
use crate::law::{Hold, Term};
use serde::{Deserialize, Serialize};

/// What the identifier is doing; numbered as in the FMU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Status {
    /// No law yet.
    #[default]
    Acquiring = 1,
    /// The law explains the data.
    Tracking = 2,
    /// Evidence of a switch is growing.
    SwitchSuspected = 3,
    /// A switch was detected; the new law is being identified.
    ReIdentifying = 4,
}

impl Status {
    /// Every status, in the order of the FMU's enumeration.
    pub const ALL: [Status; 4] = [Status::Acquiring, Status::Tracking, Status::SwitchSuspected, Status::ReIdentifying];

    /// The name used in reports and in the FMU.
    pub fn id(self) -> &'static str {
        match self {
            Status::Acquiring => "acquiring",
            Status::Tracking => "tracking",
            Status::SwitchSuspected => "switch suspected",
            Status::ReIdentifying => "re-identifying",
        }
    }
}

/// What a channel's sensor does; numbered as in the FMU.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum SensorState {
    /// It works.
    #[default]
    Ok = 1,
    /// Its readings are far from what can have been.
    Outlier = 2,
    /// It repeats its value where it varied before.
    Stuck = 3,
    /// It is off by a constant.
    Offset = 4,
    /// It says nothing.
    Missing = 5,
    /// It comes later than the others.
    Late = 6,
}

impl SensorState {
    /// Every state, in the order of the FMU's enumeration.
    pub const ALL: [SensorState; 6] = [
        SensorState::Ok,
        SensorState::Outlier,
        SensorState::Stuck,
        SensorState::Offset,
        SensorState::Missing,
        SensorState::Late,
    ];

    /// The name used in reports and in the FMU.
    pub fn id(self) -> &'static str {
        match self {
            SensorState::Ok => "ok",
            SensorState::Outlier => "outlier",
            SensorState::Stuck => "stuck",
            SensorState::Offset => "offset",
            SensorState::Missing => "missing",
            SensorState::Late => "late",
        }
    }
}

/// The channels in the order of [`Output::sensors`].
pub const CHANNELS: [&str; 3] = ["q", "qd", "F"];

/// A published coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coefficient {
    /// What it multiplies.
    pub term: Term,
    /// Its last known value; 0 before the first, and for a "maybe" term that the law does not have.
    pub value: f64,
    /// Its std; `None` while the coefficient is not known.
    pub std: Option<f64>,
    /// How many more seconds of such a record it needs until it is known as well as a validated law has to be; 0
    /// when it is, `None` while nothing can be said.
    pub needed: Option<f64>,
}

impl Coefficient {
    /// Of that term, before anything is known.
    pub const fn unknown(term: Term) -> Coefficient {
        Coefficient { term, value: 0.0, std: None, needed: None }
    }
}

/// One value for each quantity that is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ByQuantity<T> {
    /// Of the displacement.
    pub q: T,
    /// Of the velocity.
    pub qd: T,
    /// Of the excitation, or of the force that a law without inertia gives.
    pub force: T,
}

/// All other outputs after a step; by default those before the first one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Switches detected so far.
    pub switch_count: u32,
    /// Estimated instant at which the present stage began, s.
    pub switch_time: f64,
    /// Its std, s; `None` in the first stage, which no switch opened.
    pub switch_time_std: Option<f64>,
    /// Time of the alarm that ended the last stage, s; `None` in the first one.
    pub detection_time: Option<f64>,
    /// First time at which the present law was valid (its stated covariance puts e below 0.05², by three stds), s.
    pub identified_time: Option<f64>,
    /// Number of the law in use among those that were validated, 1 for the first of all; `None` while there is none.
    pub law_number: Option<u32>,
    /// Whether that law was recognised as one seen before, not identified anew.
    pub recognised: bool,
    /// What the identifier is doing.
    pub status: Status,
    /// What F is taken to do between samples: as set, until the motion tells otherwise.
    pub hold: Hold,
    /// Whether the present law is validated, every std known and honest, and the last samples were used.
    pub valid: bool,
    /// What the sensors of q, q̇ and F do.
    pub sensors: [SensorState; 3],
    /// Time at which the last switch was named one, s; `None` in the first stage.
    pub named_time: Option<f64>,
    /// Whether the coefficients move: they are followed as they go, and valid as long as their stated e is below
    /// 0.2².
    pub drifting: bool,
    /// Deviation of eq. (4) over T; 0 before the first law.
    pub deviation: f64,
    /// The deviation that is out of the ordinary.
    pub threshold: f64,
    /// What the law predicts for this instant, m, m/s and N: of the force 0 for a law of motion, of the motion 0 for a
    /// law that gives F.
    pub prediction: ByQuantity<f64>,
    /// The effect of the catalogue that the present law lacks most; `None` where none stands out.
    pub missing: Option<Missing>,
    /// Share of the force's variance that the published coefficients explain: of a law without inertia, and of one of
    /// motion where they are those of the weak form; `None` for a law of motion that states its own std, and while
    /// nothing is known.
    pub explained: Option<f64>,
    /// Estimated std of the noise of the sensors of q and q̇, and of what the force has besides the law; `None` while
    /// not known or not measured, of the force for a law of motion.
    pub noise: ByQuantity<Option<f64>>,
}
