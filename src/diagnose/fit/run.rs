//! One run of the filter over a piece, with forces given as series beside the law's own terms.
//!
//! A term whose force cannot be computed from the state alone (it remembers, it looks back) enters as a series: the
//! line that stands for it over every interval between samples, along the smoothed motion. Its sensitivity is carried
//! through the filter like that of any term, so that its coefficient and its information are those of the likelihood,
//! with the noise of all samples accounted for.

use super::loop_run;
use super::outcome::{Law, Outcome, first_state, relieved};
use crate::diagnose::piece::Piece;
use crate::estimation::{Channel, Pass, Smoothable, gains};
use crate::law::{Line, Motion, Term};

/// Sensitivities of the state to a set of forces that are given as series.
struct Carried {
    state: Vec<[f64; 2]>,
    rows: [Vec<f64>; 2],
}

impl Carried {
    fn new(count: usize) -> Carried {
        Carried { state: vec![[0.0; 2]; count], rows: [vec![0.0; count], vec![0.0; count]] }
    }

    /// Over an interval in which the forces have these means, and through its measurements.
    fn step(&mut self, forces: impl Iterator<Item = f64>, pass: &Pass, inverse_mass: f64, gains: [[f64; 2]; 2]) {
        let [q_rows, qd_rows] = &mut self.rows;
        for (((state, force), q_row), qd_row) in self.state.iter_mut().zip(forces).zip(q_rows).zip(qd_rows) {
            ([*q_row, *qd_row], *state) = pass.carry(*state, -force * inverse_mass, &gains);
        }
    }
}

/// Runs the filter over a piece. `series` holds the lines of every interval, one row per interval.
pub fn run(law: &Law, piece: &Piece, pass: &mut Pass, series: &[Vec<Line>]) -> Outcome {
    if !law.tangents.is_empty() {
        return loop_run::run(law, piece, pass, series);
    }
    let free: Vec<Term> = law.free.iter().map(|index| law.terms[*index]).collect();
    let (n, extra) = (free.len(), law.series.len());
    let first = first_state(piece, &law.noise);
    let mut outcome = Outcome::none(first, n + extra, piece.len());
    let motion = Motion::new(law.terms, law.coefficients);
    let mut carried = Carried::new(extra);
    let mut unknowns = vec![0.0; n + extra];
    pass.begin(first);
    for (k, observation) in piece.observations.iter().enumerate() {
        let without = series.get(k).map(|forces| relieved(observation, law.series, forces, [0.0; 2]));
        let observation = without.as_ref().unwrap_or(observation);
        let innovations = pass.step(&motion, &free, &law.noise, observation);
        let inverse_mass = motion.mass(pass.filter.mean[0]).recip();
        let gains = gains(&innovations);
        if let Some(forces) = series.get(k) {
            carried.step(forces.iter().map(|[from, to]| 0.5 * (from + to)), pass, inverse_mass, gains);
        }
        for channel in Channel::ALL {
            if let Some(innovation) = &innovations[channel as usize] {
                unknowns[..n].copy_from_slice(pass.expected(channel));
                unknowns[n..].copy_from_slice(&carried.rows[channel as usize]);
                outcome.information.add(&unknowns, innovation.residual, innovation.variance);
            }
        }
        outcome.steps.push(Smoothable { innovations, filtered: pass.filter, transition: pass.map.transition });
        outcome.finite &= pass.filter.state().is_finite();
    }
    outcome.log_likelihood = pass.track.log_likelihood();
    outcome.rivals = pass.rivals.log_likelihoods();
    (outcome.squares, outcome.count) = (pass.track.squares, pass.track.count);
    outcome
}
