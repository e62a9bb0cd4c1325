//! The scenarios that come with switchid.
//!
//! The publication shows its stages in figures that are not at hand; the values here are plausible ones, chosen around
//! its Duffing plant (m = 1, c = 0.3, k₁ = 4, k₃ = 2, P = 2, ω = 1.5) and around a van der Pol circuit with L = C = 1,
//! α between 0.3 and 1.2, a = 1 (limit cycle) or −0.5 (focus), V = 1.2 sin 1.1t. Every coefficient changes by at least
//! a tenth at every switch, the sine's amplitude and frequency too.

use super::excitation::ExcitationKind;
use super::plants::{duffing, van_der_pol};
use super::random;
use super::scenario::{Scenario, Stage};
use crate::law::{State, Term};
use thiserror::Error;

/// A scenario by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Builtin {
    /// m q̈ + c q̇ + k₁ q + k₃ q³ = P sin ωt, five stages.
    DuffingSine,
    /// The same plant under white noise of intensity 2D = 3.
    DuffingWhite,
    /// L q̈ + α(q² − a)q̇ + q/C = P sin ωt, five stages: limit cycle and focus by turns.
    VanDerPolSine,
    /// The same plant under white noise of intensity 2D = 3.
    VanDerPolWhite,
    /// The publication's noise case: one Duffing stage of 12 s, sensor noise 0.1.
    DuffingNoise,
    /// The publication's noise case: one van der Pol stage of 24 s, sensor noise 0.05.
    VanDerPolNoise,
}

/// No scenario of that name.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("there is no built-in scenario \"{name}\": the names are {}", Builtin::ALL.map(Builtin::id).join(", "))]
pub struct UnknownBuiltin {
    /// The name asked for.
    pub name: String,
}

impl Builtin {
    /// Every built-in scenario.
    pub const ALL: [Builtin; 6] = [
        Builtin::DuffingSine,
        Builtin::DuffingWhite,
        Builtin::VanDerPolSine,
        Builtin::VanDerPolWhite,
        Builtin::DuffingNoise,
        Builtin::VanDerPolNoise,
    ];

    /// The name on the command line.
    pub fn id(self) -> &'static str {
        match self {
            Builtin::DuffingSine => "duffing-sine",
            Builtin::DuffingWhite => "duffing-white",
            Builtin::VanDerPolSine => "van-der-pol-sine",
            Builtin::VanDerPolWhite => "van-der-pol-white",
            Builtin::DuffingNoise => "duffing-noise",
            Builtin::VanDerPolNoise => "van-der-pol-noise",
        }
    }

    /// The scenario of that name.
    ///
    /// # Errors
    /// [`UnknownBuiltin`] lists the names there are.
    pub fn from_id(name: &str) -> Result<Builtin, UnknownBuiltin> {
        Builtin::ALL
            .into_iter()
            .find(|builtin| builtin.id() == name)
            .ok_or_else(|| UnknownBuiltin { name: name.into() })
    }

    /// Whether the plant is the van der Pol circuit.
    pub fn is_van_der_pol(self) -> bool {
        matches!(self, Builtin::VanDerPolSine | Builtin::VanDerPolWhite | Builtin::VanDerPolNoise)
    }

    /// The terms of the plant's law.
    pub fn terms(self) -> Vec<Term> {
        let stiffness = Term::power(1, 0);
        match self.is_van_der_pol() {
            true => vec![Term::Inertia, Term::power(0, 1), Term::power(2, 1), stiffness],
            false => vec![Term::Inertia, Term::power(0, 1), stiffness, Term::power(3, 0)],
        }
    }

    /// The documented scenario: the same numbers always.
    pub fn scenario(self) -> Scenario {
        let (stages, duration) = match self {
            Builtin::DuffingSine | Builtin::DuffingWhite => (duffing_stages(), 90.0),
            Builtin::VanDerPolSine | Builtin::VanDerPolWhite => (van_der_pol_stages(), 120.0),
            Builtin::DuffingNoise => (vec![duffing(0.0, [1.0, 0.3, 4.0, 2.0], 2.0, 1.5)], 12.0),
            Builtin::VanDerPolNoise => (vec![van_der_pol(0.0, [1.0, 0.6, 1.0, 1.0], 1.2, 1.1)], 24.0),
        };
        self.assemble(stages, duration)
    }

    /// A scenario with stages drawn from the seed, which also seeds excitation and sensor noise. The two noise cases
    /// keep their law; only their noise is drawn anew.
    pub fn random(self, seed: u64) -> Scenario {
        match self {
            Builtin::DuffingNoise | Builtin::VanDerPolNoise => self.scenario().with_seed(seed),
            _ => {
                let (stages, duration) = random::stages(self.is_van_der_pol(), seed);
                self.assemble(stages, duration).with_seed(seed)
            }
        }
    }

    fn assemble(self, stages: Vec<Stage>, duration: f64) -> Scenario {
        let mut scenario = Scenario::new(self.id(), self.terms(), stages, duration);
        scenario.initial = State { q: 0.5, qd: 0.0 };
        match self {
            Builtin::DuffingWhite | Builtin::VanDerPolWhite => scenario.excitation.kind = ExcitationKind::WhiteNoise,
            Builtin::DuffingNoise => return scenario.with_noise(0.1),
            Builtin::VanDerPolNoise => return scenario.with_noise(0.05),
            _ => {}
        }
        scenario
    }
}

fn duffing_stages() -> Vec<Stage> {
    vec![
        duffing(0.0, [1.0, 0.3, 4.0, 2.0], 2.0, 1.5),
        duffing(18.0, [1.2, 0.5, 5.0, 1.2], 2.6, 1.2),
        duffing(36.0, [0.9, 0.2, 3.5, 3.0], 1.6, 1.8),
        duffing(54.0, [1.1, 0.4, 4.5, 1.5], 2.4, 1.4),
        duffing(72.0, [0.8, 0.25, 3.0, 2.5], 1.8, 1.7),
    ]
}

fn van_der_pol_stages() -> Vec<Stage> {
    vec![
        van_der_pol(0.0, [1.0, 0.6, 1.0, 1.0], 1.2, 1.1),
        van_der_pol(24.0, [1.2, 0.8, -0.5, 0.8], 1.6, 0.9),
        van_der_pol(48.0, [0.9, 1.2, 0.8, 1.1], 1.0, 1.3),
        van_der_pol(72.0, [1.1, 0.4, -0.8, 0.9], 1.4, 1.0),
        van_der_pol(96.0, [0.8, 0.9, 1.2, 1.2], 1.1, 1.2),
    ]
}
