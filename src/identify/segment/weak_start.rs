//! First coefficients of a stage, from weak rows alone.
//!
//! Nothing is known of the system's time scale, so that rows are formed with variations of many lengths, each length a
//! regression of its own. The length whose predicted error is smallest wins: short ones average too little noise, long
//! ones have too few rows.

use crate::identify::problem::Problem;
use crate::identify::section::{LONGEST_VARIATION, OVERLAP, SectionBuffer};
use crate::identify::window::Window;
use crate::weak::{Fit, Regression, Row, Variation};
use serde::{Deserialize, Serialize};

/// Samples in the shortest variation: a quarter of a period of a motion of 128 samples a period.
const SHORTEST: usize = 32;

/// Largest share of noise in a term that the start may rest on: its coefficient is a fifth too small then …
const ATTENUATION: f64 = 0.2;

/// … and, where no length has so little, half, of variations that average many samples: without, 11 of 62 switches of
/// van der Pol records were missed (docs/decisions/first-law.md) …
const MUCH_NOISE: f64 = 0.5;
/// … 16 times as many as the shortest.
const LONG: usize = 512;

/// Smooth enough that the trapezoidal rule is exact to far below the noise, wide enough to average.
const VARIATION: Variation = Variation::Polynomial { power: 6 };

/// Regressions over variations of many lengths, fed from the window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WeakStart {
    scales: Vec<Scale>,
    section: SectionBuffer,
    row: Row,
    equation: Vec<f64>,
    fit: Fit,
    std: Vec<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Scale {
    length: usize,
    next: u64,
    regression: Regression,
    /// Σ (right side)² over the rows.
    norm: f64,
    /// Σ over the rows of what noise of std 1 in (q, q̇) adds to the square of each entry.
    noise: Vec<[f64; 2]>,
}

/// What the best length says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guess<'a> {
    /// The regression's solution in the free coefficients.
    pub fit: &'a Fit,
    /// Std of its coefficients, n.
    pub std: &'a [f64],
    /// RMS of the predicted error of the law's force ÷ RMS of the excitation's weak integrals.
    pub relative_error: f64,
    /// Intensity of a white force that would leave the residual seen, N² s.
    pub force_intensity: f64,
}

impl WeakStart {
    /// Room for the problem's unknowns and for variations up to a quarter of the window.
    pub fn new(problem: &Problem, capacity: usize) -> WeakStart {
        let n = problem.free.len();
        let longest = LONGEST_VARIATION.min(capacity / 4).max(SHORTEST);
        let lengths = (0..).map(|octave| SHORTEST << octave).take_while(|length| *length <= longest);
        let scale =
            |length| Scale { length, next: 0, regression: Regression::new(n), norm: 0.0, noise: vec![[0.0; 2]; n] };
        WeakStart {
            scales: lengths.map(scale).collect(),
            section: SectionBuffer::new(longest + 1),
            row: Row::new(problem.terms.len()),
            equation: vec![0.0; n],
            fit: Fit::new(n),
            std: vec![0.0; n],
        }
    }

    /// Begins at sample `start`.
    pub fn begin(&mut self, start: u64) {
        for scale in &mut self.scales {
            scale.regression.clear();
            scale.norm = 0.0;
            scale.noise.fill([0.0; 2]);
            scale.next = start + scale.length as u64;
        }
    }

    /// Forms at most `rows` of the rows that have come due, the shortest first; returns whether any was formed.
    pub fn feed(&mut self, problem: &Problem, window: &Window, rows: usize) -> bool {
        let mut left = rows;
        for index in 0..self.scales.len() {
            while left > 0 && self.scales[index].next < window.end() {
                self.form_row(problem, window, index);
                left -= 1;
            }
        }
        left < rows
    }

    fn form_row(&mut self, problem: &Problem, window: &Window, index: usize) {
        let scale = &mut self.scales[index];
        let (first, last) = (scale.next - scale.length as u64, scale.next);
        scale.next += (scale.length / OVERLAP) as u64;
        if first < window.oldest() {
            return;
        }
        self.section.load(problem, window, first, last);
        let section = self.section.view(problem, scale.length + 1);
        self.row.integrate(&section, VARIATION, &problem.motion(&[]));
        let right = problem.weak_equation(&self.row, &mut self.equation);
        let weight = self.row.norm.sqrt().recip();
        self.equation.iter_mut().for_each(|entry| *entry *= weight);
        scale.regression.add(&self.equation, right * weight);
        scale.norm += (right * weight).powi(2);
        for (sum, index) in scale.noise.iter_mut().zip(&problem.free) {
            let [by_q, by_qd] = self.row.noise[*index];
            sum[0] += by_q * weight * weight;
            sum[1] += by_qd * weight * weight;
        }
    }

    /// What the rows of the longest variation with enough of them leave open, each combination by its free terms; all
    /// terms while there are no such rows.
    pub fn open_directions(&self) -> Vec<Vec<usize>> {
        let n = self.equation.len();
        let enough = |scale: &&Scale| scale.regression.rows() as usize >= 2 * n + 2;
        let Some(scale) = self.scales.iter().rfind(enough) else {
            return (0..n).map(|free| vec![free]).collect();
        };
        let mut fit = Fit::new(n);
        scale.regression.solve(&mut fit);
        fit.open_directions()
    }

    /// The solution of the length with the smallest predicted error, for sensor noise of these variances; none while no
    /// length has twice as many rows as unknowns and signal enough.
    pub fn guess(&mut self, problem: &Problem, sensor: [f64; 2]) -> Option<Guess<'_>> {
        let n = self.equation.len();
        // the best of those with little noise, and of long ones with much
        let mut best: [Option<(usize, f64)>; 2] = [None; 2];
        for (index, scale) in self.scales.iter().enumerate() {
            let rows = scale.regression.rows() as usize;
            if rows < 2 * n + 2 {
                continue;
            }
            scale.regression.solve(&mut self.fit);
            let error = scale.relative_error(&self.fit);
            let share = scale.attenuation(problem, &self.fit, sensor);
            let kinds = [share <= ATTENUATION, share <= MUCH_NOISE && scale.length >= LONG];
            for (best, _) in best.iter_mut().zip(kinds).filter(|(_, fits)| *fits) {
                if best.is_none_or(|(_, least)| error < least) {
                    *best = Some((index, error));
                }
            }
        }
        let (index, relative_error) = best[0].or(best[1])?;
        let scale = &self.scales[index];
        scale.regression.solve(&mut self.fit);
        for (std, spread) in self.std.iter_mut().zip(&self.fit.spread) {
            *std = (spread * OVERLAP as f64 / 2.0).sqrt() * self.fit.residual;
        }
        let force_intensity = self.fit.residual.powi(2);
        Some(Guess { fit: &self.fit, std: &self.std, relative_error, force_intensity })
    }
}

impl Scale {
    /// Overlapping rows share their noise: only one in [`OVERLAP`] ÷ 2 counts as independent.
    fn relative_error(&self, fit: &Fit) -> f64 {
        let rows = f64::from(self.regression.rows());
        let independent = (rows / (OVERLAP as f64 / 2.0) - fit.rank as f64).max(0.5);
        let excitation = (self.norm / rows).sqrt();
        if fit.rank == 0 || excitation == 0.0 {
            return f64::INFINITY;
        }
        let unknowns = fit.rank as f64;
        fit.residual / excitation * (unknowns / independent).sqrt()
    }

    /// The largest share of noise in what a "fit" term has of its own: least squares takes the coefficient for that
    /// much too small (errors in variables).
    fn attenuation(&self, problem: &Problem, fit: &Fit, sensor: [f64; 2]) -> f64 {
        let terms = (0..fit.spread.len()).filter(|index| !problem.maybe[*index] && fit.determined[*index]);
        terms
            .map(|index| fit.spread[index] * (self.noise[index][0] * sensor[0] + self.noise[index][1] * sensor[1]))
            .fold(0.0, f64::max)
    }
}
