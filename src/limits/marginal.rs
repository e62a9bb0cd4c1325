//! The information of coefficients along a motion, its initial state unknown and marginalised.
//!
//! A Kalman filter of the state without process noise: its innovations are independent, so their information adds up.
//! Its covariance is kept as a square root P = L Lᵀ and updated by Potter's formula (Bierman, *Factorization Methods
//! for Discrete Sequential Estimation*, 1977, II.3). The filter's gain keeps L and the sensitivities Ψ of the filtered
//! state bounded where the motion is unstable or chaotic, and L may shrink to nothing where it is damped: neither
//! overflows on long records, as the sensitivities to the initial state would.

use super::course::{Course, Sensors};
use super::law::Law;
use super::sensitivity::{Column, Variation};
use nalgebra::DMatrix;

/// A quantity that is not measured may at first lie this many times its largest value away: its std is then
/// 10⁴ in variance beyond what it ever is, and the bound feels it by 10⁻⁴.
const UNKNOWN: f64 = 100.0;

/// What is known of the state at the start of a course.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Nothing but the first reading.
    Unknown,
    /// All: the record begins at a switch, and the law before it is known.
    Known,
}

/// Where the filter stands: L, then Ψ, as columns that the motion carries.
pub struct Marginal<'a> {
    variation: Variation<'a>,
    columns: Vec<Column>,
    sensors: Sensors,
    /// J, one row per sought coefficient.
    pub information: DMatrix<f64>,
}

impl<'a> Marginal<'a> {
    /// No information yet.
    pub fn new(law: &'a Law, sensors: Sensors) -> Marginal<'a> {
        let n = law.sought().len();
        Marginal {
            variation: Variation::new(law.motion(), law.sought()),
            columns: vec![[0.0; 2]; 2 + n],
            sensors,
            information: DMatrix::zeros(n, n),
        }
    }

    /// Takes the first sample of a course: all it tells is where the state is.
    pub fn begin(&mut self, course: &Course, start: Start) {
        self.columns.fill([0.0; 2]);
        if start == Start::Known {
            return;
        }
        let far = course.largest().map(|largest| UNKNOWN * if largest > 0.0 { largest } else { 1.0 });
        let [q, qd] = [0, 1].map(|channel| self.sensors.0[channel].unwrap_or(far[channel]));
        self.columns[0] = [q, 0.0];
        self.columns[1] = [0.0, qd];
    }

    /// Goes on from sample k of the course to k + 1 and takes its readings.
    pub fn step(&mut self, course: &Course, k: usize) {
        self.variation.carry(course, k, &mut self.columns);
        for channel in 0..2 {
            if let Some(std) = self.sensors.0[channel] {
                self.measure(channel, std * std);
            }
        }
    }

    fn measure(&mut self, channel: usize, variance: f64) {
        let (root, slopes) = self.columns.split_at_mut(2);
        let seen = [root[0][channel], root[1][channel]];
        let across = [0, 1].map(|row| root[0][row] * seen[0] + root[1][row] * seen[1]);
        let total = seen[0] * seen[0] + seen[1] * seen[1] + variance;
        for (row, slope) in slopes.iter().enumerate() {
            let weighted = slope[channel] / total;
            (0..slopes.len()).for_each(|other| self.information[(row, other)] += weighted * slopes[other][channel]);
        }
        for slope in slopes {
            let share = slope[channel] / total;
            (0..2).for_each(|row| slope[row] -= across[row] * share);
        }
        let scale = 1.0 / (total + (total * variance).sqrt());
        for (column, seen) in root.iter_mut().zip(seen) {
            (0..2).for_each(|row| column[row] -= across[row] * seen * scale);
        }
    }
}
