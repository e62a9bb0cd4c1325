//! Readings that have been let through, on their way into the record: a ring.

use crate::identify::packed_readings;
use crate::identify::reading::Reading;
use serde::{Deserialize, Serialize};

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Queue {
    #[serde(with = "packed_readings")]
    ring: Vec<Reading>,
    first: usize,
    count: usize,
}

impl Queue {
    /// Room for so many.
    pub fn new(room: usize) -> Queue {
        Queue { ring: vec![Reading::default(); room], first: 0, count: 0 }
    }

    pub fn count(&self) -> usize {
        self.count
    }

    pub fn push(&mut self, reading: Reading) {
        let slot = (self.first + self.count) % self.ring.len();
        self.ring[slot] = reading;
        self.count = (self.count + 1).min(self.ring.len());
    }

    /// The oldest one, which leaves.
    pub fn pop(&mut self) -> Option<Reading> {
        let left = self.count.checked_sub(1)?;
        let reading = std::mem::take(&mut self.ring[self.first]);
        (self.first, self.count) = ((self.first + 1) % self.ring.len(), left);
        Some(reading)
    }

    /// The reading that is so many behind the oldest one.
    pub fn at(&mut self, place: usize) -> &mut Reading {
        let slot = (self.first + place) % self.ring.len();
        &mut self.ring[slot]
    }
}
