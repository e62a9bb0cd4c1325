//! The published identification: one weak equation per interval and variation, all solved together by pseudo-inverse.
//!
//! The intervals are the whole record, its halves and its quarters, each half over its neighbour. Every equation is
//! divided by ‖δq‖, so that white sensor noise weighs alike in all of them; apart from that it is ordinary least
//! squares, and as such takes the residuals for independent, which those of overlapping intervals are not.

use super::capture::Capture;
use crate::identify::problem::Problem;
use crate::weak::{Fit, Regression, Row, Variation};
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

/// Each interval is half as long as one of the level above.
const LEVELS: usize = 3;

/// The variations over every interval: smooth enough at its ends that quadrature does not hide what the data leave
/// open.
const VARIATIONS: [Variation; 4] = [
    Variation::Polynomial { power: 6 },
    Variation::SmoothSine { mode: 2 },
    Variation::SmoothSine { mode: 3 },
    Variation::SmoothSine { mode: 4 },
];

/// Samples integrated over in one step, ended by the row that passes it: a step's work is bounded.
const BUDGET: usize = 1000;

/// The overdetermined system of a captured record, formed over several steps.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Equations {
    regression: Regression,
    row: Row,
    left: Vec<f64>,
    fit: Fit,
    next: usize,
}

impl Equations {
    /// Room for the problem's unknowns.
    pub fn new(problem: &Problem) -> Equations {
        let n = problem.n();
        Equations {
            regression: Regression::new(n),
            row: Row::new(problem.terms.len()),
            left: vec![0.0; n],
            fit: Fit::new(n),
            next: 0,
        }
    }

    /// Begins a new system without equations.
    pub fn begin(&mut self) {
        self.regression.clear();
        self.next = 0;
    }

    /// Forms some more of the equations; whether all of them are there and solved.
    pub fn advance(&mut self, problem: &Problem, capture: &Capture) -> bool {
        let mut used = 0;
        while used < BUDGET {
            let Some(interval) = interval(self.next / VARIATIONS.len(), capture.count()) else {
                self.regression.solve(&mut self.fit);
                return true;
            };
            used += interval.end() - interval.start();
            self.form(problem, capture, interval, VARIATIONS[self.next % VARIATIONS.len()]);
            self.next += 1;
        }
        false
    }

    fn form(&mut self, problem: &Problem, capture: &Capture, interval: RangeInclusive<usize>, variation: Variation) {
        self.row.integrate(&capture.section(problem, interval), variation, &problem.motion(&problem.terms, &[]));
        let weight = self.row.norm.sqrt().recip();
        let right = problem.weak_equation(&self.row, &mut self.left) * weight;
        self.left.iter_mut().for_each(|entry| *entry *= weight);
        if right.is_finite() && self.left.iter().all(|entry| entry.is_finite()) {
            self.regression.add(&self.left, right);
        }
    }

    /// The last solution.
    pub fn fit(&self) -> &Fit {
        &self.fit
    }

    /// Std of a free coefficient by ordinary least squares: from the residual, its equations taken for independent.
    /// `None` where the equations leave the coefficient open.
    pub fn std(&self, free: usize) -> Option<f64> {
        let rows = f64::from(self.regression.rows());
        let excess = rows - self.fit.rank as f64;
        let std = self.fit.residual * (self.fit.spread[free] * rows / excess).sqrt();
        (self.fit.determined[free] && excess > 0.0 && std.is_finite()).then_some(std)
    }

    /// Whether the solution is an equation of motion: finite, and solvable for the acceleration.
    pub fn gives_a_law(&self, problem: &Problem) -> bool {
        let inertia = |free: usize| self.std(free).is_some() && self.fit.coefficients[free] != 0.0;
        let finite = self.fit.coefficients.iter().all(|coefficient| coefficient.is_finite());
        finite && problem.free_inertia().is_none_or(inertia)
    }
}

/// The interval of that number in a record of `count` samples; none past the last.
fn interval(number: usize, count: usize) -> Option<RangeInclusive<usize>> {
    let mut position = number;
    for level in 0..LEVELS {
        let (length, intervals) = ((count - 1) >> level, (2 << level) - 1);
        if position < intervals {
            let start = position * length / 2;
            return Some(start..=start + length);
        }
        position -= intervals;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_cover_the_record_and_stay_inside() {
        for count in [64, 1001, 1002, 1003, 1004] {
            let all: Vec<_> = (0..).map_while(|number| interval(number, count)).collect();
            assert_eq!(all.len(), 1 + 3 + 7);
            assert_eq!(all[0], 0..=count - 1);
            assert!(all.iter().all(|interval| *interval.end() < count), "{all:?}");
            assert!(count - all[10].end() <= LEVELS + 1, "{all:?}");
        }
    }
}
