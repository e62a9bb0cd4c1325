//! Why a model is refused.

use super::formula::FormulaError;
use super::inner::InnerError;
use super::term::TermError;
use thiserror::Error;

/// Why a model is refused.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ModelError {
    /// The text is no TOML, or a key has the wrong type.
    #[error("{message}")]
    Syntax {
        /// What the TOML reader says, with line and column.
        message: String,
    },
    /// A key of `[terms]` is no term.
    #[error("[terms]: {source}")]
    Term {
        /// Which text, and why.
        source: TermError,
    },
    /// Two keys name the same term.
    #[error("[terms]: \"{first}\" and \"{second}\" are the same term: keep one")]
    Twice {
        /// The first key.
        first: String,
        /// The second key.
        second: String,
    },
    /// The value of a term is none of the three things it may be.
    #[error("[terms]: \"{key}\" = {value}: write \"fit\", \"maybe\" or a finite number")]
    Given {
        /// The key.
        key: String,
        /// Its value as written.
        value: String,
    },
    /// A unit that is not known, or no unit of that quantity.
    #[error("[units] {channel} = \"{unit}\" is no unit of {meaning}; known are {known}")]
    Unit {
        /// The key.
        channel: &'static str,
        /// Its value.
        unit: String,
        /// What the quantity is.
        meaning: &'static str,
        /// The units that it may have.
        known: String,
    },
    /// No terms at all.
    #[error("[terms] is empty: name at least one term, for example inertia = \"fit\"")]
    NoTerms,
    /// Without inertia there is no equation of motion to integrate.
    #[error("[terms] has no inertia: add inertia = \"fit\" (or its known value)")]
    NoInertia,
    /// F on both sides of a law that gives F.
    #[error(
        "[terms]: \"{key}\" depends on F, which a law without inertia gives: F = law(q, qd); leave it out, or add inertia = \"fit\" for a law \
         of motion"
    )]
    OutputAmongTerms {
        /// The key of the term.
        key: String,
    },
    /// An inertia that no body has.
    #[error("[terms]: \"{key}\" = {value}: the inertia must be positive: write its value, or \"fit\"")]
    Inertia {
        /// The key.
        key: String,
        /// Its value.
        value: f64,
    },
    /// More terms than the estimator is built for.
    #[error("[terms] has {count} terms; at most {max} are supported")]
    TooMany {
        /// How many there are.
        count: usize,
        /// How many there may be.
        max: usize,
    },
    /// More effects of the user's own than are supported.
    #[error("[effects] has {count} effects; at most {max} are supported")]
    TooManyEffects {
        /// How many there are.
        count: usize,
        /// How many there may be.
        max: usize,
    },
    /// More than one coordinate.
    #[error("coordinates = {names:?}: this version identifies one coordinate, named q")]
    Coordinates {
        /// The names given.
        names: Vec<String>,
    },
    /// A term of U₀ that is no total time derivative.
    #[error(
        "[potential]: \"{key}\": only total time derivatives (qd, q*qd, q^2*qd …) may stand here; write other terms in [terms]"
    )]
    Potential {
        /// The key.
        key: String,
    },
    /// An inner parameter is refused.
    #[error("[{table}] {source}")]
    Inner {
        /// The table it stands in.
        table: &'static str,
        /// Which one, and why.
        source: Box<InnerError>,
    },
    /// The value of an inner parameter is neither a number nor to be fitted.
    #[error("[terms]: \"{key}\": {inner} = {value}: write a finite number to hold it, or \"fit\"")]
    InnerValue {
        /// The key of the term.
        key: String,
        /// The inner parameter.
        inner: String,
        /// Its value as written.
        value: String,
    },
    /// A user's effect has no formula.
    #[error(
        "[effects.{name}]: write expression = \"a formula in q, qd, F, t\", and start values of its inner parameters if need be"
    )]
    NoExpression {
        /// The effect's name.
        name: String,
    },
    /// A formula is refused.
    #[error("[effects.{name}] expression = \"{text}\": {source}")]
    Expression {
        /// The effect's name.
        name: String,
        /// The formula.
        text: String,
        /// Where, and why.
        source: Box<FormulaError>,
    },
    /// A user's effect has the name of another term, or none that can be one.
    #[error(
        "[effects.{name}]: choose another name: up to 30 letters, digits and underscores, a letter first, that is no term or effect already"
    )]
    ExpressionName {
        /// The name.
        name: String,
    },
    /// An inner parameter that the streaming identifier would have to fit.
    #[error(
        "[terms]: \"{key}\": {inner} is not given: sample by sample only coefficients are estimated; write {key} = {{ coefficient = \"fit\", \
         {inner} = a number }} (diagnose, add and improve find that number)"
    )]
    Open {
        /// The key of the term.
        key: String,
        /// The inner parameter.
        inner: String,
    },
    /// The excitation among the terms of a law that nothing else gives a scale.
    #[error(
        "[terms]: \"{key}\" stands on both sides of the equation: with every coefficient 0 but this one it says F = F, which all data \
         fulfil; leave it out (a sensor's scale goes into the data), or write the inertia as a number"
    )]
    ExcitationAlone {
        /// The key of the term.
        key: String,
    },
    /// No coefficient that the streaming identifier could estimate.
    #[error(
        "[terms]: nothing to identify: every coefficient is known{}; give at least one term \"fit\" or \"maybe\"",
        if *.forced { "" } else { " (in free motion the inertia too: it only sets the scale of the others)" }
    )]
    NothingFree {
        /// Whether there is an excitation.
        forced: bool,
    },
    /// A user's own effect that depends on time.
    #[error(
        "[terms]: \"{key}\" depends on the time t, which a law that is identified sample by sample cannot: give what drives it as F, or \
         leave it out here (compare, diagnose, add, improve and simulate take it)"
    )]
    Time {
        /// The key of the term.
        key: String,
    },
    /// A term that the streaming identifier cannot have.
    #[error(
        "[terms]: \"{key}\" cannot be identified sample by sample: it needs the past, or is the fourth effect with a gap, the fourth with a \
         Stribeck speed, or none of the first five of your own; leave it out here (compare, diagnose, add, improve and simulate take it)"
    )]
    Memory {
        /// The key of the term.
        key: String,
    },
}
