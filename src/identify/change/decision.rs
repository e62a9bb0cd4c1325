//! The decision threshold: the log Bayes factor of a change, in nats, that an alarm asks.

use crate::estimation::TWENTY_TO_ONE;
use crate::identify::settings::Settings;

/// Under the right law the evidence rises by chance as if one sample in so many were a trial of its own: neighbouring
/// samples and starts share their noise, and the evidence is a mean over all sizes of a switch. With one in 100 an
/// interval of 60 s gives 0.62 to 1.67 times the alarms asked for, by plant and library.
const SAMPLES_PER_TRIAL: f64 = 85.0;

/// Evidence that chance brings once in some ten thousand samples, nats.
const UNUSUAL: f64 = 5.0;

/// A law that is not validated, nor stands its stability check, needs this many times the evidence: what it leaves may
/// be its own error, which the evidence takes for white.
const UNPROVEN: f64 = 10.0;

/// Samples for which unusual evidence keeps the law in use from being renewed: what comes may belong to another law.
pub const SUSPENSE: u64 = 1000;

/// What a law in use has to its credit when a switch is weighed against it.
#[derive(Clone, Copy, Debug)]
pub struct Decision {
    /// Factor by which error that lasts makes all evidence larger.
    pub overdispersion: f64,
    /// Whether it was validated, or stood its stability check and explained its record.
    pub proven: bool,
    /// Whether it explains its record down to the sensors' noise, and that is long enough to tell.
    pub explains: bool,
    /// Time in which the motion goes there and back, as a part of its record.
    pub youth: f64,
}

impl Decision {
    /// How many times the evidence is asked of it that a law known for sure would need.
    pub fn caution(&self) -> f64 {
        // before the motion has gone there and back, what speaks for a switch may be what the law lacks, or what its
        // linearisation leaves
        let caution = self.overdispersion * (1.0 + self.youth * self.youth);
        if self.proven { caution } else { UNPROVEN * caution }
    }

    /// The threshold for samples that usually come `pace` s apart.
    pub fn threshold(&self, settings: &Settings, pace: f64) -> f64 {
        // what chance brings is known of a law that explains its record; of another every sample may be a trial
        let trial = if self.explains { SAMPLES_PER_TRIAL } else { 1.0 };
        self.caution() * false_alarm_level(settings, trial * pace)
    }

    /// Evidence from which on a law is not renewed: more than chance brings now and then.
    pub fn unusual(&self, threshold: f64) -> f64 {
        (UNUSUAL * self.caution()).min(0.5 * threshold)
    }
}

/// Evidence that chance reaches once in the false-alarm interval, nats, where a trial of its own comes every `trial` s.
pub fn false_alarm_level(settings: &Settings, trial: f64) -> f64 {
    (settings.false_alarm_interval / trial).ln().max(TWENTY_TO_ONE)
}
