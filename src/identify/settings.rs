//! What a user may set, and what is refused.

use crate::law::Hold;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// Which procedure identifies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Ours; needs no setting.
    #[default]
    Default,
    /// The published procedure with the published settings.
    Publication,
}

impl Method {
    /// Every method, in the order of the FMU's enumeration.
    pub const ALL: [Method; 2] = [Method::Default, Method::Publication];

    /// The name used on the command line.
    pub fn id(self) -> &'static str {
        match self {
            Method::Default => "default",
            Method::Publication => "publication",
        }
    }

    /// The method of that name.
    pub fn from_id(id: &str) -> Option<Method> {
        Method::ALL.into_iter().find(|method| method.id() == id)
    }
}

/// Which quantities are measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Channels {
    /// The displacement.
    pub q: bool,
    /// The velocity.
    pub qd: bool,
    /// The excitation; where it is not, the motion is free and the inertia is fixed to 1.
    pub excitation: bool,
}

impl Channels {
    /// Displacement, velocity and excitation.
    pub const ALL: Channels = Channels { q: true, qd: true, excitation: true };

    /// Whether q and q̇ are.
    pub fn of_motion(self) -> [bool; 2] {
        [self.q, self.qd]
    }
}

/// The settings of an identifier. [`Settings::default`] serves every scenario; 0 means "automatic" where it says so.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Which procedure.
    pub method: Method,
    /// Which quantities the samples hold.
    pub channels: Channels,
    /// What the excitation does between samples.
    pub hold: Hold,
    /// Usual time between two samples, s: with `max_window` it fixes the memory; a sample sooner than half of it after
    /// the last one is left out.
    pub sample_time: f64,
    /// How much record the estimator keeps to refine on, s.
    pub max_window: f64,
    /// Std of the displacement's sensor noise; 0 = estimated.
    pub noise_q: f64,
    /// Std of the velocity's sensor noise; 0 = estimated.
    pub noise_qd: f64,
    /// Std of the excitation's sensor noise; 0 = none.
    pub noise_excitation: f64,
    /// Mean time between two false alarms, s.
    pub false_alarm_interval: f64,
    /// Record from which the first law is identified, s; 0 = as soon as the data allow.
    pub initial_window: f64,
    /// Interval T of the deviation, eq. (4), s.
    pub deviation_interval: f64,
    /// Deviation that raises an alarm; 0 = automatic.
    pub deviation_threshold: f64,
    /// Weight of the displacement in the deviation.
    pub weight_q: f64,
    /// Weight of the velocity in the deviation.
    pub weight_qd: f64,
}

impl Default for Settings {
    fn default() -> Settings {
        Settings {
            method: Method::Default,
            channels: Channels::ALL,
            hold: Hold::Zero,
            sample_time: 1e-3,
            max_window: 30.0,
            noise_q: 0.0,
            noise_qd: 0.0,
            noise_excitation: 0.0,
            false_alarm_interval: 1e6,
            initial_window: 0.0,
            deviation_interval: 0.5,
            deviation_threshold: 0.0,
            weight_q: 1.0,
            weight_qd: 1.0,
        }
    }
}

impl Settings {
    /// Variances of the sensors of q and q̇ where they are given.
    pub(super) fn given_noise(&self) -> [Option<f64>; 2] {
        [self.noise_q, self.noise_qd].map(|std| (std > 0.0).then_some(std * std))
    }
}

/// Why settings are refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SettingsError {
    /// A number outside its range.
    #[error("{name} = {value} is out of range: it must be {range}")]
    OutOfRange {
        /// The setting's name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed, in words.
        range: &'static str,
    },
    /// Neither displacement nor velocity is measured.
    #[error("neither q nor qd is measured: one of them is needed")]
    NothingMeasured,
    /// The window holds too few or too many samples.
    #[error("max_window ÷ sample_time = {samples} samples: it must lie between 100 and 10 million")]
    Window {
        /// How many samples the settings ask for.
        samples: f64,
    },
    /// The deviation's interval holds too many samples.
    #[error("deviation.interval ÷ sample_time = {samples} samples: at most 10 million are kept")]
    DeviationInterval {
        /// How many samples the settings ask for.
        samples: f64,
    },
}
