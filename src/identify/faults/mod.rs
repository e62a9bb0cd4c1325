//! What may have happened to the sensors instead of to the law: one posterior over both.
//!
//! A reading far from what the law in use expects, or where there is none the motion itself, is not used at once. It
//! is held, with those after it, until what happened has a name: the law changed, or a sensor failed. Every hypothesis
//! is a filter of the state from the last reading that was as expected, scored on the same readings; physics prices
//! them. A switch leaves q and q̇ continuous and changes q̈ alone; readings of a burst are independent wide draws,
//! priced one by one; an offset moves one channel; a kick (an F that was not the plant's) moves q̇, and q follows; a
//! stuck sensor repeats exactly where it varied before. What is held enters the record once the law or a fault has
//! [3 nats](crate::estimation::TWENTY_TO_ONE) on the other, without the readings that are a sensor's fault: nothing
//! that is not committed has to be taken back. What no reading shows alone is weighed at an alarm, and once more at the
//! next.
//!
//! - `price`: densities of readings, and the two states of a channel;
//! - `repetition`: whether a channel repeats a value since it was not read, or is stuck;
//! - `expected`: the law that readings are held against, or what there is without one;
//! - `kind`: what may have happened; `hypothesis`: the filter of one; `weighing`: all of them on the same readings;
//! - `motion_alone`: what is expected where no law is known;
//! - `arrival`: a reading beside the last one; `queue`: readings on their way into the record;
//! - `quarantine`: readings held, and what is let through; `states`: what is said of each sensor;
//! - `hindsight`: whether what speaks for a switch is a burst of readings that were not held;
//! - `lateness`: whether F, or q and q̇, have begun to come late, or F to be held otherwise;
//! - `excitation`: a reading of F that leaves its course and returns;
//! - `standing_force`: whether an F that was lost acts as it is read again;
//! - `after_outage`: whether a sensor came back from an outage with an offset;
//! - `clock`: time stamps that are none;
//! - `sender`: samples that nobody has read, sent again or interpolated.

mod after_outage;
mod arrival;
mod clock;
mod excitation;
mod expected;
mod hindsight;
mod hypothesis;
mod kind;
mod lateness;
mod motion_alone;
mod price;
mod quarantine;
mod queue;
mod repetition;
mod sender;
mod standing_force;
mod states;
mod weighing;

pub use after_outage::{AfterOutage, DECISIVE, Returned};
pub use clock::Clock;
pub use excitation::{ExcitationGate, Stray};
pub use expected::{Expected, Standing, delay, is_held};
pub use hindsight::{Found, Hindsight, settled};
pub use lateness::{LateChannels, Lateness};
pub use quarantine::{Against, Quarantine};
pub use repetition::{Repeat, Repetition};
pub use sender::Sender;
pub use standing_force::StandingForce;
pub use weighing::CERTAIN;
