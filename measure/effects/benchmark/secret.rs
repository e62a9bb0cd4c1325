//! What a plant has that its model may lack.

use super::generator::Generator;
use super::outside::Outside;
use std::f64::consts::PI;
use switchid::law::{Catalogue, Effect, Sign, State, Term};

/// What is hidden.
#[derive(Clone, Debug, PartialEq)]
pub enum Secret {
    /// Effects of the catalogue that the model lacks, by id.
    Missing(Vec<String>),
    /// Nothing: the model has all, this effect of the catalogue too.
    Complete(Option<String>),
    /// An effect that the catalogue does not have.
    Outside(Outside),
}

impl Secret {
    /// Effects of the catalogue that the plant has beside the base law.
    pub fn ids(&self) -> Vec<&str> {
        match self {
            Secret::Missing(ids) => ids.iter().map(String::as_str).collect(),
            Secret::Complete(id) => id.iter().map(String::as_str).collect(),
            Secret::Outside(_) => Vec::new(),
        }
    }

    /// Whether that effect is among them.
    pub fn has(&self, id: &str) -> bool {
        self.ids().contains(&id)
    }

    /// A name for tables.
    pub fn name(&self) -> String {
        match self {
            Secret::Missing(ids) => ids.join(" + "),
            Secret::Complete(id) => format!("nothing, {}", id.as_deref().unwrap_or("linear or cubic")),
            Secret::Outside(outside) => outside.name().into(),
        }
    }
}

/// A coefficient of that sign which physics allows.
pub fn sign(generator: &mut Generator, term: Term) -> f64 {
    let free = Catalogue::of(term).is_some_and(|entry| entry.sign == Sign::Any);
    // a spring or a mass that takes more than there is has no bounded motion, and friction does not push
    let restoring = ["linear_damping", "linear_stiffness", "position_dependent_friction"].contains(&id(term));
    if free && !restoring { generator.sign() } else { 1.0 }
}

/// The effect id of a term of the catalogue.
pub fn id(term: Term) -> &'static str {
    Catalogue::of(term).map_or("", |entry| entry.id)
}

/// The effect with inner parameters that fit a motion whose displacement and velocity have these std.
pub fn with_inner(generator: &mut Generator, term: Term, std: State, omega: f64) -> Term {
    let Term::Effect(effect) = term else { return term };
    let length = 2.0 * std.q;
    let values = match effect {
        Effect::StribeckFriction { .. } => vec![2.0 * std.qd * generator.uniform(0.05..0.35)],
        Effect::DeadZoneStiffness { .. } | Effect::OneSidedStop { .. } => vec![length * generator.uniform(0.15..0.65)],
        Effect::ExcitationGainNonlinearity { .. } => vec![generator.choose(&[2.0, 3.0])],
        Effect::ExcitationDelay { .. } => vec![0.1 / omega],
        Effect::Hysteresis { .. } => {
            let share = generator.uniform(0.5..1.0);
            vec![length * generator.uniform(0.1..0.6), share, generator.uniform(1.0..2.0)]
        }
        Effect::PreslidingFriction { .. } => vec![length * generator.uniform(0.05..0.4)],
        Effect::FrictionWithBacklash { .. } => {
            vec![length * generator.uniform(0.05..0.3), length * generator.uniform(0.1..0.4)]
        }
        // alone, the other power would push on one side
        Effect::PositionDependentFriction { .. } => vec![2.0],
        Effect::Cogging { .. } => vec![PI * generator.uniform(1.5..6.0) / length, generator.uniform(0.0..PI)],
        Effect::Relaxation { .. } => vec![generator.uniform(0.3..2.0) / omega],
        Effect::ActuatorLag { .. } => vec![0.1 / omega],
        Effect::HiddenResonator { .. } => vec![omega * generator.uniform(0.5..1.8), generator.decades(0.01..0.15)],
        _ => Vec::new(),
    };
    effect.with_inner(&values).map_or(term, Term::Effect)
}

/// The same effect, its delay or time constant times a factor.
pub fn with_delay(term: Term, factor: f64) -> Term {
    let Some(effect) = term.effect() else { return term };
    effect.with_inner(&[effect.inner_values()[0] * factor]).map_or(term, Term::Effect)
}

/// Two different effects that a seed chooses, none of the linear law.
pub fn pair(seed: u64, draw: u64, number: u64) -> Secret {
    let linear = ["inertia", "linear_damping", "linear_stiffness"];
    let ids: Vec<&str> = Catalogue::ENTRIES.iter().map(|entry| entry.id).filter(|id| !linear.contains(id)).collect();
    let mut generator = Generator::new(seed ^ (draw << 32) ^ (number << 16));
    let first = generator.choose(&ids);
    let others: Vec<&str> = ids.into_iter().filter(|id| *id != first).collect();
    Secret::Missing(vec![first.into(), generator.choose(&others).into()])
}
