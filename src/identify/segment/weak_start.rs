//! First coefficients of a stage, from weak rows alone, formed from the window as its samples come.

use crate::estimation::{RowsOfLength, VARIATION};
use crate::identify::problem::Problem;
use crate::identify::section::{LONGEST_VARIATION, SectionBuffer, deserialize_room, serialize_room};
use crate::identify::window::Window;
use crate::weak::{Fit, Row};
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

/// Regressions over variations of many lengths, fed from the window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WeakStart {
    scales: Vec<Scale>,
    #[serde(serialize_with = "serialize_room", deserialize_with = "deserialize_room")]
    section: SectionBuffer,
    row: Row,
    equation: Vec<f64>,
    fit: Fit,
    std: Vec<f64>,
}

/// The rows of one length, and the sample that the next one ends at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Scale {
    rows: RowsOfLength,
    next: u64,
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
        let scale = |length| Scale { rows: RowsOfLength::new(length, n), next: 0 };
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
            scale.rows.clear();
            scale.next = start + scale.rows.length as u64;
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
        let length = scale.rows.length;
        let (first, last) = (scale.next - length as u64, scale.next);
        scale.next += scale.rows.stride() as u64;
        if first < window.oldest() {
            return;
        }
        self.section.load(problem, window, first, last);
        let section = self.section.view(problem, length + 1);
        self.row.integrate(&section, VARIATION, &problem.motion(&problem.terms, &[]));
        let right = problem.weak_equation(&self.row, &mut self.equation);
        scale.rows.add(&self.row, &problem.free, &mut self.equation, right);
    }

    /// What the rows of the longest variation with enough of them leave open, each combination by its free terms; all
    /// terms while there are no such rows.
    pub fn open_directions(&self) -> Vec<Vec<usize>> {
        let n = self.equation.len();
        let mut fit = Fit::new(n);
        match self.scales.iter().rev().find_map(|scale| scale.rows.solve(&mut fit)) {
            Some(_) => fit.open_directions(),
            None => (0..n).map(|free| vec![free]).collect(),
        }
    }

    /// The solution of the length with the smallest predicted error, for sensor noise of these variances; none while no
    /// length has twice as many rows as unknowns and signal enough.
    pub fn guess(&mut self, problem: &Problem, sensor: [f64; 2]) -> Option<Guess<'_>> {
        // the best of those with little noise, and of long ones with much
        let mut best: [Option<(usize, f64)>; 2] = [None; 2];
        for (index, scale) in self.scales.iter().enumerate() {
            let Some(error) = scale.rows.solve(&mut self.fit) else { continue };
            let share = attenuation(&scale.rows, problem, &self.fit, sensor);
            let kinds = [share <= ATTENUATION, share <= MUCH_NOISE && scale.rows.length >= LONG];
            for (best, _) in best.iter_mut().zip(kinds).filter(|(_, fits)| *fits) {
                if best.is_none_or(|(_, least)| error < least) {
                    *best = Some((index, error));
                }
            }
        }
        let (index, _) = best[0].or(best[1])?;
        let rows = &self.scales[index].rows;
        let relative_error = rows.solve(&mut self.fit)?;
        self.std.iter_mut().zip(rows.std(&self.fit)).for_each(|(slot, std)| *slot = std);
        let force_intensity = self.fit.residual.powi(2);
        Some(Guess { fit: &self.fit, std: &self.std, relative_error, force_intensity })
    }
}

/// The largest share of noise in what a "fit" term has of its own.
fn attenuation(rows: &RowsOfLength, problem: &Problem, fit: &Fit, sensor: [f64; 2]) -> f64 {
    let terms = (0..fit.spread.len()).filter(|index| !problem.maybe[*index] && fit.determined[*index]);
    terms.map(|index| rows.attenuation(fit, index, sensor)).fold(0.0, f64::max)
}
