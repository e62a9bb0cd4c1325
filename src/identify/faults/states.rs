//! What is said of each sensor.

use super::hypothesis::Hypothesis;
use super::kind::Kind;
use crate::estimation::{Channel, UNLIKELY};
use crate::identify::report::SensorState;
use serde::{Deserialize, Serialize};

/// Of q, q̇ and F.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct States([SensorState; 3]);

impl Default for States {
    fn default() -> States {
        States([SensorState::Ok; 3])
    }
}

impl States {
    /// What is said now.
    pub fn said(self) -> [SensorState; 3] {
        self.0
    }

    /// Says what lasts: the offsets that are taken off, and what goes on of the hypothesis that was named.
    pub fn last(&mut self, offset: [f64; 2], named: Option<&Hypothesis>) {
        let offset = offset.map(|offset| if offset == 0.0 { SensorState::Ok } else { SensorState::Offset });
        self.0 = [offset[0], offset[1], SensorState::Ok];
        let Some(named) = named else { return };
        for channel in Channel::ALL {
            let state = match named.kind {
                kind if kind.sticks(channel) => SensorState::Stuck,
                Kind::Offset(off) if off == channel => SensorState::Offset,
                _ if named.burst(channel) > UNLIKELY => SensorState::Outlier,
                _ => continue,
            };
            self.0[channel as usize] = state;
        }
    }

    /// Says what has just been named, and of which channels readings are `faulty` by it; `misread` where what begins
    /// may be blamed on F.
    pub fn say(&mut self, kind: Kind, faulty: [bool; 2], misread: bool) {
        if kind.is_no_event() {
            self.blame(faulty);
        }
        for channel in Channel::ALL.into_iter().filter(|channel| kind.sticks(*channel)) {
            self.0[channel as usize] = SensorState::Stuck;
        }
        match kind {
            Kind::Offset(channel) => self.0[channel as usize] = SensorState::Offset,
            kind if kind.is_kick() && misread => self.0[2] = SensorState::Outlier,
            _ => {}
        }
    }

    /// Readings of these channels have been found a burst.
    pub fn blame(&mut self, channels: [bool; 2]) {
        for (state, _) in self.0.iter_mut().zip(channels).filter(|(_, of_burst)| *of_burst) {
            *state = SensorState::Outlier;
        }
    }
}
