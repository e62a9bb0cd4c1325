//! Stages of the two plants of the publication from the numbers that it gives.

use super::scenario::Stage;

/// A stage of m q̈ + c q̇ + k₁ q + k₃ q³ = P sin ωt from \[m, c, k₁, k₃\].
pub(super) fn duffing(start: f64, coefficients: [f64; 4], amplitude: f64, omega: f64) -> Stage {
    Stage { start, coefficients: coefficients.to_vec(), amplitude, omega }
}

/// A stage of L q̈ + α(q² − a)q̇ + q/C = P sin ωt from \[L, α, a, C\]; coefficients are those of q̈, q̇, q²q̇, q.
pub(super) fn van_der_pol(start: f64, circuit: [f64; 4], amplitude: f64, omega: f64) -> Stage {
    let [inductance, alpha, a, capacitance] = circuit;
    Stage { start, coefficients: vec![inductance, -alpha * a, alpha, 1.0 / capacitance], amplitude, omega }
}
