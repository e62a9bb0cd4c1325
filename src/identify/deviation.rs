//! The deviation of eq. (4) over the last T seconds.

use serde::{Deserialize, Serialize};

/// Mean of weighted |predicted − observed| over a moving interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Deviation {
    interval: f64,
    ring: Vec<(f64, f64)>,
    first: usize,
    count: usize,
    sum: f64,
}

impl Deviation {
    /// Over `interval` s of samples at least `sample_time` s apart.
    pub fn new(interval: f64, sample_time: f64) -> Deviation {
        let capacity = (interval / sample_time).ceil() as usize + 2;
        Deviation { interval, ring: vec![(0.0, 0.0); capacity], first: 0, count: 0, sum: 0.0 }
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        (self.first, self.count, self.sum) = (0, 0, 0.0);
    }

    /// Takes the weighted absolute differences of one sample at time t.
    pub fn add(&mut self, t: f64, difference: f64) {
        let capacity = self.ring.len();
        while self.count > 0 && (self.count == capacity || self.ring[self.first].0 <= t - self.interval) {
            self.sum -= self.ring[self.first].1;
            self.first = (self.first + 1) % capacity;
            self.count -= 1;
        }
        if self.count == 0 {
            self.sum = 0.0;
        }
        self.ring[(self.first + self.count) % capacity] = (t, difference);
        self.count += 1;
        self.sum += difference;
    }

    /// The mean over the interval; 0 while empty.
    pub fn mean(&self) -> f64 {
        if self.count == 0 { 0.0 } else { (self.sum / self.count as f64).max(0.0) }
    }

    /// Whether the interval is full: its oldest sample is almost T old at time t.
    pub fn is_full(&self, t: f64) -> bool {
        self.count > 1 && t - self.ring[self.first].0 >= 0.98 * self.interval
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_last_interval_counts() {
        let mut deviation = Deviation::new(0.5, 0.1);
        for k in 0..20 {
            deviation.add(0.1 * f64::from(k), f64::from(k));
        }
        assert!((deviation.mean() - 17.0).abs() < 1e-12, "{}", deviation.mean());
        assert!(!deviation.is_full(1.9) && deviation.is_full(2.0));
    }
}
