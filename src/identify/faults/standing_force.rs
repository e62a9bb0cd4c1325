//! Whether the motion follows an F that was lost as it is read again.
//!
//! An F that repeats itself is stuck, or its drive is off. Under the first the law in use goes on with a force of which
//! only the usual size and pace are known; under the second with the one that is read. Both are scored on the same
//! readings, from where the second began to be the likelier one (Page 1954).

use super::expected::Expected;
use crate::estimation::{Channel, Filter, Innovation, Observation, TWENTY_TO_ONE};
use serde::{Deserialize, Serialize};

/// The law in use under F as it is read, beside itself under an unknown one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StandingForce {
    filter: Filter,
    /// Log-odds of F as it is read against an unknown one, nats, and since when they have been positive, s.
    odds: f64,
    lasts: f64,
}

impl StandingForce {
    /// From this state on F may act as it is read.
    pub fn begin(filter: Filter) -> StandingForce {
        StandingForce { filter, ..StandingForce::default() }
    }

    /// Takes a sample over which an unknown F led to this filter, with these innovations.
    pub fn take(
        &mut self,
        law: &Expected,
        observation: &Observation,
        unknown: &Filter,
        innovations: &[Option<Innovation>; 2],
    ) {
        self.filter = law.carry(&self.filter, observation.dt, &observation.drive);
        for channel in Channel::ALL {
            let index = channel as usize;
            if let (Some(measured), Some(unknown)) = (observation.measured[index], innovations[index]) {
                let read = self.filter.update(channel, measured, law.noise.sensor[index]);
                self.odds += log_density(&read) - log_density(&unknown);
            }
        }
        self.lasts += observation.dt;
        if self.odds.is_nan() || self.odds <= 0.0 {
            *self = StandingForce::begin(*unknown);
        }
    }

    /// Whether the motion has followed F as it is read for so long, s, and nothing else is as likely.
    pub fn has_been_followed(&self, time: f64) -> bool {
        self.lasts > time && self.odds > TWENTY_TO_ONE
    }
}

/// But for a constant.
fn log_density(innovation: &Innovation) -> f64 {
    -0.5 * (innovation.residual * innovation.residual * innovation.precision + innovation.variance.ln())
}
