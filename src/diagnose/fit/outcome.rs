//! What a run of the filter over a piece needs and leaves.

use crate::diagnose::piece::Piece;
use crate::estimation::{Filter, Information, Noise, Observation, Smoothable, initial_state};
use crate::law::{Drive, Line, NODES, State, Term};

/// The law that runs: terms of the state, and series beside them.
#[derive(Clone, Copy, Debug)]
pub struct Law<'a> {
    /// Terms of the state.
    pub terms: &'a [Term],
    /// Their coefficients.
    pub coefficients: &'a [f64],
    /// Positions of the terms whose coefficients are sought.
    pub free: &'a [usize],
    /// What multiplies the series.
    pub series: &'a [f64],
    /// How one of the series changes with the displacement, one for every interval; empty where none does.
    pub tangents: &'a [Tangent],
    /// Variances of the noise.
    pub noise: Noise,
}

/// How a hysteresis follows a motion beside the one along which its series was computed, in an interval.
#[derive(Clone, Copy, Debug)]
pub struct Tangent {
    /// Which of the series.
    pub series: usize,
    /// dz/dq.
    pub slope: f64,
    /// What is left at the end of a difference in z at the start.
    pub kept: f64,
    /// The displacement as a line with its mean and its first moment …
    pub displacement: Line,
    /// … and at the ends.
    pub ends: [f64; 2],
}

/// What a run leaves.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What the piece says on the unknowns: free terms, then series.
    pub information: Information,
    /// At the first sample.
    pub first: Filter,
    /// One per sample after it.
    pub steps: Vec<Smoothable>,
    /// Log-likelihood, and what the rival levels of process noise would make of it.
    pub log_likelihood: f64,
    /// Under the process noise times the pass's ratios.
    pub rivals: [f64; 2],
    /// Σ ε²/s and number of innovations by channel.
    pub squares: [f64; 2],
    /// Number of innovations by channel.
    pub count: [f64; 2],
    /// Whether the motion stayed finite.
    pub finite: bool,
    /// Smoothed states where the law's memory is part of the state, and the steps do not tell them.
    pub smoothed: Option<Vec<State>>,
}

/// Where the unknowns of a piece stand among those of all: first what all pieces share, then each piece's own.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// Unknowns that all pieces share.
    pub shared: usize,
    /// Unknowns of the pieces before, beside them.
    pub first: usize,
    /// Unknowns of all pieces, beside them.
    pub all: usize,
}

impl Span {
    /// The place among all of the piece's unknown of that number.
    pub fn place(self, unknown: usize) -> usize {
        if unknown < self.shared { unknown } else { self.first + unknown }
    }
}

impl Law<'_> {
    /// Terms and coefficients; where a series has tangents, with a linear stiffness at the end that they set.
    pub(super) fn bent(&self) -> (Vec<Term>, Vec<f64>) {
        let (mut terms, mut coefficients) = (self.terms.to_vec(), self.coefficients.to_vec());
        if !self.tangents.is_empty() {
            terms.push(Term::power(1, 0));
            coefficients.push(0.0);
        }
        (terms, coefficients)
    }
}

impl Outcome {
    /// The same with its information among that on the unknowns of all pieces.
    pub fn among(self, span: Span) -> Outcome {
        let own = self.information.n;
        if own == span.shared + span.all {
            return self;
        }
        let mut information = Information::none(span.shared + span.all);
        for row in 0..own {
            information.score[span.place(row)] = self.information.score[row];
            for column in row..own {
                *information.entry_mut(span.place(row), span.place(column)) = self.information.entry(row, column);
            }
        }
        Outcome { information, ..self }
    }

    pub(super) fn none(first: Filter, unknowns: usize, samples: usize) -> Outcome {
        Outcome {
            information: Information::none(unknowns),
            first,
            steps: Vec::with_capacity(samples),
            log_likelihood: 0.0,
            rivals: [0.0; 2],
            squares: [0.0; 2],
            count: [0.0; 2],
            finite: true,
            smoothed: None,
        }
    }
}

/// The observation with the series' forces, and a force beside them, taken off its excitation.
pub(super) fn relieved(observation: &Observation, coefficients: &[f64], forces: &[Line], besides: Line) -> Observation {
    let sum = |end: usize| {
        let forces = coefficients.iter().zip(forces).map(|(coefficient, line)| coefficient * line[end]);
        forces.sum::<f64>() + besides[end]
    };
    let [start, end]: Line = [sum(0), sum(1)];
    let drive = match observation.drive {
        Drive::Held(value) => Drive::Line(value - start, value - end),
        Drive::Line(from, to) => Drive::Line(from - start, to - end),
        Drive::Nodes(nodes) => {
            let at = |node: usize| nodes[node] - start - (end - start) * node as f64 / NODES as f64;
            Drive::Nodes(std::array::from_fn(at))
        }
    };
    Observation { drive, ..*observation }
}

/// The state at the first sample, from it and its neighbours alone.
pub(super) fn first_state(piece: &Piece, noise: &Noise) -> Filter {
    let measured = piece.measured().map(|channel| channel.map(|values| [values[0], values[1]]));
    initial_state(measured, piece.t[1] - piece.t[0], noise)
}

/// q and q̇ of smoothed means.
pub(super) fn states<const N: usize>(means: &[[f64; N]]) -> Vec<State> {
    means.iter().map(|mean| State { q: mean[0], qd: mean[1] }).collect()
}
