//! Estimates of one law in a growing record: what the longer record says lies within the std of what the shorter one said.
//!
//! For an efficient estimate Cov(θ_new − θ_old) = Cov(θ_old) − Cov(θ_new) (Hausman, *Econometrica* 46 (1978), 1251). A record that comes to
//! hold another law too may still be explained whole, by a third one: that one is far off.

use serde::{Deserialize, Serialize};

/// Stds by which no coefficient of the same law moves.
const FAR: f64 = 6.0;

/// The last estimate that was worth telling, and whether one before was contradicted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Constancy {
    values: Vec<f64>,
    /// Std of each; infinite where it was not known.
    std: Vec<f64>,
    /// Whether an estimate has left the one before it.
    pub(super) broken: bool,
}

impl Constancy {
    pub(super) fn new(n: usize) -> Constancy {
        Constancy { values: vec![0.0; n], std: vec![f64::INFINITY; n], broken: false }
    }

    pub(super) fn clear(&mut self) {
        self.std.fill(f64::INFINITY);
        self.broken = false;
    }

    /// Takes the new estimate of a coefficient.
    pub(super) fn take(&mut self, free: usize, value: f64, std: f64) {
        self.broken |= (value - self.values[free]).abs() > FAR * self.std[free];
        (self.values[free], self.std[free]) = (value, std);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_leaves_its_own_std_is_contradicted() {
        let mut constancy = Constancy::new(1);
        constancy.take(0, 50.0, f64::INFINITY);
        constancy.take(0, 3.0, 0.1);
        constancy.take(0, 3.5, 0.05);
        assert!(!constancy.broken);
        constancy.take(0, 3.9, 0.01);
        constancy.take(0, 3.9, 0.01);
        assert!(constancy.broken);
        constancy.clear();
        constancy.take(0, 9.0, 0.1);
        assert!(!constancy.broken);
    }
}
