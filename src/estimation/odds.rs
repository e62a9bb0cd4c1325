//! Odds at which a question counts as decided, and sizes of samples that tell a variance.

/// Log-odds, nats, at which one of two hypotheses is taken for the right one: twenty to one, the 5 % that are usual.
pub const TWENTY_TO_ONE: f64 = 3.0;

/// Samples that a mean square is taken over: its std is then √(2 ÷ 4000), 2 % of it.
pub const SAMPLES_OF_A_VARIANCE: f64 = 4000.0;
