//! Why there is no such plant.

use crate::law::{DynamicsError, ModelError, Term};
use thiserror::Error;

/// Why a scenario is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ScenarioError {
    /// The text is no TOML, or a key is missing, unknown or of the wrong type.
    #[error("{message}")]
    Syntax {
        /// What the TOML reader says, with line and column.
        message: String,
    },
    /// The same term twice.
    #[error("terms: \"{term}\" stands there twice: keep one")]
    Twice {
        /// The term.
        term: Term,
    },
    /// Nothing to integrate.
    #[error("terms: there is no inertia: add \"qdd\"")]
    NoInertia,
    /// A law that moves of itself where one is asked for that a machine moves.
    #[error("terms: there is an inertia: nobody can impose the motion of this plant, leave \"qdd\" out")]
    Inertia,
    /// A term whose force one instant does not give.
    #[error("terms: the force of \"{term}\" needs the past: simulate the scenario as a record, or leave the term out")]
    Memory {
        /// The term.
        term: Term,
    },
    /// A term whose law has events that no host is told of.
    #[error(
        "\"{term}\" has memory, a delay or dry friction: only the FMU's own integration meets its kinks, so use it for co-simulation, \
         or leave the term out"
    )]
    NotSmooth {
        /// The term.
        term: Term,
    },
    /// F on both sides of a law that gives F.
    #[error("terms: \"{term}\" depends on F, which a law without inertia gives: leave it out, or add \"qdd\"")]
    OutputAmongTerms {
        /// The term.
        term: Term,
    },
    /// An excitation that no machine imposes as a motion.
    #[error(
        "excitation.kind = \"{kind}\" {why}: a law without inertia gives F for the q that the excitation imposes; choose \"sine\", \"multisine\" \
         or \"sweep\", or add \"qdd\" to the terms"
    )]
    NothingMoves {
        /// The kind.
        kind: &'static str,
        /// What is wrong with it.
        why: &'static str,
    },
    /// No stage at all.
    #[error("there is no stage: write at least one [[stage]] with start = 0")]
    NoStages,
    /// The first stage does not begin at 0.
    #[error("stage 1 starts at {start} s: the first stage starts at 0")]
    FirstStart {
        /// Its start, s.
        start: f64,
    },
    /// Stages out of order.
    #[error("stage {stage} starts at {start} s, which is not after stage {} at {previous} s: order the stages by time", stage - 1)]
    Order {
        /// The stage, counted from 1.
        stage: usize,
        /// Its start, s.
        start: f64,
        /// The start of the stage before, s.
        previous: f64,
    },
    /// Not one coefficient per term.
    #[error("stage {stage} has {found} coefficients for {expected} terms: write one for each, in their order")]
    Count {
        /// The stage, counted from 1.
        stage: usize,
        /// How many terms there are.
        expected: usize,
        /// How many coefficients there are.
        found: usize,
    },
    /// A mass of 0 has no acceleration.
    #[error("stage {stage}: the coefficient of qdd is 0: give it a mass")]
    ZeroInertia {
        /// The stage, counted from 1.
        stage: usize,
    },
    /// A stage holds an infinite number or none.
    #[error("stage {stage}: {name} = {value} is no finite number")]
    StageNumber {
        /// The stage, counted from 1.
        stage: usize,
        /// What is at fault.
        name: String,
        /// Its value.
        value: f64,
    },
    /// A hidden effect is refused.
    #[error("hidden: {source}")]
    Hidden {
        /// Which, and why; it is written as in a model's `[terms]`.
        source: Box<ModelError>,
    },
    /// A hidden effect lacks a number.
    #[error("hidden: \"{key}\": {name} is not given: a plant needs a number for it")]
    HiddenNumber {
        /// The key.
        key: String,
        /// What has no number.
        name: String,
    },
    /// The law with its hidden effects cannot be integrated.
    #[error(transparent)]
    Dynamics(#[from] DynamicsError),
    /// A number outside its range.
    #[error("{name} = {value} is out of range: it must be {range}")]
    OutOfRange {
        /// The key.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed, in words.
        range: &'static str,
    },
}
