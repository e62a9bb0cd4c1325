//! What a record says of when its excitation acted.
//!
//! Beside a run of the filter the sensitivity of the innovations to two shares κ of the excitation's readings around an
//! interval is carried, as that of any coefficient. With M and g the information and score of the law's own terms, C, I
//! and s those of κ beside them, other shares κ change the log-likelihood, the law's terms free, by
//!
//! ```text
//! κᵀ (s − CᵀM⁻¹g) − ½ κᵀ (I − CᵀM⁻¹C) κ
//! ```
//!
//! and move the law's coefficients by −M⁻¹Cκ. Where the shares and the terms are collinear the record cannot tell.

use super::filter::{Channel, Innovation};
use super::information::{Information, Solution};
use super::pass::{Pass, gains};
use serde::{Deserialize, Serialize};

/// 1 − r² of two shares that the record does not tell apart: of less, rounding is a part.
const COLLINEAR: f64 = 1e-6;

/// The two shares beside a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimingTest {
    columns: [Column; 2],
    /// Information that both share.
    shared: f64,
    /// What the record says, as of the last run.
    evidence: TimingEvidence,
    solution: Solution,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Column {
    /// ∂(q, q̇)/∂ the share.
    sensitivity: [f64; 2],
    information: f64,
    score: f64,
    /// With each free term of the law.
    cross: Vec<f64>,
}

/// What a record says of other shares than those of its run, to second order.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimingEvidence {
    /// Of κ, the law's terms free.
    pub information: [[f64; 2]; 2],
    /// Of κ, the law's terms free.
    pub score: [f64; 2],
    /// ∂θ/∂κ by share, of the free terms.
    pub slopes: [Vec<f64>; 2],
}

impl TimingEvidence {
    /// Nothing.
    fn none(n: usize) -> TimingEvidence {
        TimingEvidence { information: [[0.0; 2]; 2], score: [0.0; 2], slopes: [vec![0.0; n], vec![0.0; n]] }
    }

    /// What moving the shares by `step` changes the log-likelihood by, nats.
    pub fn gain(&self, step: [f64; 2]) -> f64 {
        let [[aa, ab], [_, bb]] = self.information;
        let [a, b] = step;
        a * self.score[0] + b * self.score[1] - 0.5 * (aa * a * a + 2.0 * ab * a * b + bb * b * b)
    }

    /// The step to the likeliest shares; none along what the record does not tell.
    pub fn best(&self) -> [f64; 2] {
        let ([[aa, ab], [_, bb]], [a, b]) = (self.information, self.score);
        let determinant = aa * bb - ab * ab;
        match determinant > COLLINEAR * aa * bb {
            true => [(bb * a - ab * b) / determinant, (aa * b - ab * a) / determinant],
            false if aa > 0.0 => [a / aa, 0.0],
            false => [0.0; 2],
        }
    }

    /// What moving the shares by `step` moves a free coefficient by.
    pub fn shift(&self, step: [f64; 2], free: usize) -> f64 {
        step[0] * self.slopes[0][free] + step[1] * self.slopes[1][free]
    }
}

impl TimingTest {
    /// Beside `n` free terms.
    pub fn new(n: usize) -> TimingTest {
        let column = || Column { sensitivity: [0.0; 2], information: 0.0, score: 0.0, cross: vec![0.0; n] };
        TimingTest {
            columns: [column(), column()],
            shared: 0.0,
            evidence: TimingEvidence::none(n),
            solution: Solution::none(n),
        }
    }

    /// Begins beside a run.
    pub fn begin(&mut self) {
        for column in &mut self.columns {
            (column.sensitivity, column.information, column.score) = ([0.0; 2], 0.0, 0.0);
            column.cross.fill(0.0);
        }
        self.shared = 0.0;
    }

    /// Forgets what the record said.
    pub fn forget(&mut self) {
        self.evidence.information = [[0.0; 2]; 2];
        self.evidence.score = [0.0; 2];
        self.evidence.slopes.iter_mut().for_each(|slopes| slopes.fill(0.0));
    }

    /// Takes the sample that the run has just taken; `moves` is what the excitation's readings after and before it
    /// differ from that of its interval by, over the inertia.
    #[inline]
    pub fn step(&mut self, pass: &Pass, moves: [f64; 2], innovations: &[Option<Innovation>; 2]) {
        let gains = gains(innovations);
        let mut rows = [[0.0; 2]; 2];
        for ((column, moved), rows) in self.columns.iter_mut().zip(moves).zip(&mut rows) {
            (*rows, column.sensitivity) = pass.carry(column.sensitivity, moved, &gains);
        }
        for channel in Channel::ALL {
            let Some(innovation) = &innovations[channel as usize] else { continue };
            let own = pass.expected(channel);
            for (column, rows) in self.columns.iter_mut().zip(&rows) {
                let scaled = rows[channel as usize] * innovation.precision;
                column.information += scaled * rows[channel as usize];
                column.score += scaled * innovation.residual;
                column.cross.iter_mut().zip(own).for_each(|(sum, other)| *sum += scaled * other);
            }
            self.shared += rows[0][channel as usize] * rows[1][channel as usize] * innovation.precision;
        }
    }

    /// The run, of which `own` is what the record says of the law's terms, ends.
    pub fn end(&mut self, own: &Information, active: &[bool]) {
        self.solution.solve(own, active);
        let TimingTest { columns, shared, evidence, solution } = self;
        let n = own.n;
        let terms = || (0..n).filter(|index| active[*index] && solution.determined[*index]);
        for (column, slopes) in columns.iter().zip(&mut evidence.slopes) {
            slopes.fill(0.0);
            for row in terms() {
                let covariance = &solution.covariance[row * n..(row + 1) * n];
                slopes[row] = -terms().map(|other| covariance[other] * column.cross[other]).sum::<f64>();
            }
        }
        for (index, column) in columns.iter().enumerate() {
            let along = |values: &[f64], slopes: &[f64]| terms().map(|row| values[row] * slopes[row]).sum::<f64>();
            evidence.score[index] = column.score + along(&own.score, &evidence.slopes[index]);
            for other in 0..2 {
                let whole = if other == index { column.information } else { *shared };
                evidence.information[index][other] = whole + along(&column.cross, &evidence.slopes[other]);
            }
        }
    }

    /// What the record says, as of the last run.
    pub fn evidence(&self) -> &TimingEvidence {
        &self.evidence
    }
}
