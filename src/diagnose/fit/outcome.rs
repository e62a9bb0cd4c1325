//! What a run of the filter over a piece needs and leaves.

use crate::diagnose::piece::Piece;
use crate::estimation::{Channel, Filter, Innovation, LogSum, Noise, Observation, initial_state};
use crate::law::{Drive, Line, NODES, State, Term};
use nalgebra::{DMatrix, DVector};

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

/// Sums over a stretch of samples: what it says on the unknowns (free terms, then series).
#[derive(Clone, Debug)]
pub struct Sums {
    /// Σ ψψᵀ/s of the unknowns, P × P.
    pub information: DMatrix<f64>,
    /// Σ ψε/s, P.
    pub score: DVector<f64>,
    /// Σ ε²/s by channel.
    pub energy: [f64; 2],
    /// Σ ln s.
    pub log_variance: LogSum,
    /// Number of innovations by channel.
    pub count: [f64; 2],
}

/// A sample as the filter saw it, for the smoother.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// What the measurements said that the filter did not expect, by channel.
    pub innovations: [Option<Innovation>; 2],
    /// After them.
    pub filtered: Filter,
    /// ∂x⁺/∂x of the interval before.
    pub transition: [[f64; 2]; 2],
}

/// Stretches into which a record is cut.
pub const STRETCHES: usize = 24;

/// Where a piece lies in its record.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Intervals of the pieces before it.
    before: usize,
    /// Intervals of all pieces.
    all: usize,
}

impl Place {
    /// Of every piece.
    pub fn of(pieces: &[Piece]) -> Vec<Place> {
        let all = pieces.iter().map(|piece| piece.len() - 1).sum::<usize>().max(1);
        let mut before = 0;
        let place = |piece: &Piece| {
            let place = Place { before, all };
            before += piece.len() - 1;
            place
        };
        pieces.iter().map(place).collect()
    }

    /// The stretch that the piece's interval of that number belongs to.
    pub fn stretch(self, interval: usize) -> usize {
        ((self.before + interval) * STRETCHES / self.all).min(STRETCHES - 1)
    }
}

/// What a run leaves beside its sums.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// One per stretch of the record.
    pub sums: Vec<Sums>,
    /// At the first sample.
    pub first: Filter,
    /// One per sample after it.
    pub steps: Vec<Step>,
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

impl Sums {
    /// Nothing seen of `unknowns`.
    pub fn none(unknowns: usize) -> Sums {
        Sums {
            information: DMatrix::zeros(unknowns, unknowns),
            score: DVector::zeros(unknowns),
            energy: [0.0; 2],
            log_variance: LogSum::default(),
            count: [0.0; 2],
        }
    }

    /// The same sums among the unknowns of all pieces.
    fn among(self, span: Span) -> Sums {
        let own = self.score.len();
        if own == span.shared + span.all {
            return self;
        }
        let mut all = Sums::none(span.shared + span.all);
        for row in 0..own {
            all.score[span.place(row)] = self.score[row];
            for column in 0..own {
                all.information[(span.place(row), span.place(column))] = self.information[(row, column)];
            }
        }
        Sums { information: all.information, score: all.score, ..self }
    }

    /// Adds another stretch's.
    pub fn merge(&mut self, other: &Sums) {
        self.information += &other.information;
        self.score += &other.score;
        self.log_variance.add_logarithm(other.log_variance.total());
        for channel in 0..2 {
            self.energy[channel] += other.energy[channel];
            self.count[channel] += other.count[channel];
        }
    }

    /// Number of innovations.
    pub fn measurements(&self) -> f64 {
        self.count[0] + self.count[1]
    }

    /// Log-likelihood, up to a constant.
    pub fn log_likelihood(&self) -> f64 {
        -0.5 * (self.log_variance.total() + self.energy[0] + self.energy[1])
    }

    /// Says energies and log-likelihood under variances that are these times as large, by channel.
    pub fn rescale(&mut self, scale: [f64; 2]) {
        for ((energy, count), scale) in self.energy.iter_mut().zip(self.count).zip(scale) {
            *energy /= scale;
            self.log_variance.add_logarithm(count * scale.ln());
        }
    }

    pub(super) fn add(&mut self, unknowns: &[f64], channel: Channel, innovation: &Innovation) {
        let (weight, residual) = (innovation.precision, innovation.residual);
        self.energy[channel as usize] += residual * residual * weight;
        self.log_variance.add(innovation.variance);
        self.count[channel as usize] += 1.0;
        for (column, psi) in unknowns.iter().enumerate() {
            let scaled = psi * weight;
            self.score[column] += scaled * residual;
            for (entry, other) in self.information.column_mut(column).iter_mut().zip(unknowns) {
                *entry += scaled * other;
            }
        }
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
    /// The same with its sums among the unknowns of all pieces.
    pub fn among(mut self, span: Span) -> Outcome {
        self.sums = self.sums.into_iter().map(|sums| sums.among(span)).collect();
        self
    }

    pub(super) fn none(first: Filter, unknowns: usize, samples: usize) -> Outcome {
        Outcome {
            sums: vec![Sums::none(unknowns); STRETCHES],
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
pub(super) fn beside(observation: &Observation, coefficients: &[f64], forces: &[Line], besides: Line) -> Observation {
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
