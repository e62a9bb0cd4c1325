//! Median and worst of many numbers.

/// Sorted numbers.
pub struct Spread(Vec<f64>);

impl Spread {
    /// Of numbers that may be infinite.
    pub fn of(numbers: impl IntoIterator<Item = f64>) -> Spread {
        let mut sorted: Vec<f64> = numbers.into_iter().collect();
        sorted.sort_by(f64::total_cmp);
        Spread(sorted)
    }

    /// How many.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// NaN where there is none.
    pub fn median(&self) -> f64 {
        self.0.get(self.0.len() / 2).copied().unwrap_or(f64::NAN)
    }

    /// NaN where there is none.
    pub fn worst(&self) -> f64 {
        self.0.last().copied().unwrap_or(f64::NAN)
    }

    /// Median and worst as two cells.
    pub fn cells(&self) -> String {
        format!("{:.2} | {:.2}", self.median(), self.worst())
    }
}
