//! How coefficients went over a run, at as many instants as a picture shows.

use crate::identify::Identifier;

/// Instants that are kept.
const KEPT: usize = 1500;

/// Coefficients with their std over time.
pub(super) struct Course {
    stride: usize,
    /// Times, s.
    pub(super) t: Vec<f64>,
    /// Value and std of every coefficient, in the order of the model's terms; NaN while it is not known.
    pub(super) coefficients: Vec<Vec<[f64; 2]>>,
}

impl Course {
    /// Over a run of so many samples.
    pub(super) fn new(samples: usize) -> Course {
        Course { stride: samples.div_ceil(KEPT).max(1), t: Vec::new(), coefficients: Vec::new() }
    }

    /// Keeps what the identifier says after the sample of that number at t.
    pub(super) fn push(&mut self, t: f64, index: usize, identifier: &Identifier) {
        if !index.is_multiple_of(self.stride) {
            return;
        }
        let known = identifier.coefficients();
        self.coefficients.resize_with(known.len(), Vec::new);
        self.t.push(t);
        for (series, coefficient) in self.coefficients.iter_mut().zip(known) {
            series.push(coefficient.std.map_or([f64::NAN; 2], |std| [coefficient.value, std]));
        }
    }
}
