//! What may have happened, and what is unknown under it.

use super::expected::Expected;
use crate::estimation::Channel;
use serde::{Deserialize, Serialize};

/// What may have happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// Nothing but readings that are wide draws, if any.
    Readings,
    /// Nothing but those, and they lie to one side.
    OneSided,
    /// Nothing but wide draws, and the law in use is as wrong as a valid one may be.
    Misfit,
    /// The law changed, and q̈ by so many times what a switch usually adds: with the first reading that is held, or
    /// unnoticed before it.
    Law { times: u8, unnoticed: bool },
    /// Something moved q̇, and q follows.
    Kick,
    /// What was read of F is not what acted: that was any force of its usual size.
    Glitch,
    /// F, which stands still, is not what acts: that goes on as F did before.
    ForceStuck,
    /// F acts so many samples later than it did.
    Late(i8),
    /// A channel has an offset.
    Offset(Channel),
    /// A channel repeats its value.
    Stuck(Channel),
    /// Both channels do.
    BothStuck,
    /// A channel scatters more than it did, and goes on to.
    Louder(Channel),
    /// Both channels do.
    BothLouder,
}

impl Kind {
    /// Every one of them by which readings are held, the least first: what lies to one side is an offset there.
    pub const ALL: [Kind; 18] = [
        Kind::Readings,
        Kind::Misfit,
        Kind::Law { times: 1, unnoticed: false },
        Kind::Law { times: 10, unnoticed: false },
        Kind::Law { times: 1, unnoticed: true },
        Kind::Kick,
        Kind::Glitch,
        Kind::ForceStuck,
        Kind::Late(-1),
        Kind::Late(1),
        Kind::Offset(Channel::Q),
        Kind::Offset(Channel::Qd),
        Kind::Stuck(Channel::Q),
        Kind::Stuck(Channel::Qd),
        Kind::BothStuck,
        Kind::Louder(Channel::Q),
        Kind::Louder(Channel::Qd),
        Kind::BothLouder,
    ];

    /// Whether nothing has happened but readings that are wide draws.
    pub fn is_no_event(self) -> bool {
        matches!(self, Kind::Readings | Kind::Misfit)
    }

    /// Whether it can be told where no law is known: a change of law is one of q̈ there. An offset moves slowly in one
    /// channel, as its own course may, and a rest repeats both.
    pub fn can_be_told_by_motion(self) -> bool {
        !matches!(self, Kind::Misfit | Kind::ForceStuck | Kind::Late(_) | Kind::Offset(_) | Kind::BothStuck)
    }

    /// Whether it can be told apart where these channels are measured: a sensor that is not there does not fail.
    pub fn can_be_told(self, measured: [bool; 2]) -> bool {
        match self {
            Kind::Offset(channel) | Kind::Stuck(channel) | Kind::Louder(channel) => measured[channel as usize],
            Kind::BothStuck | Kind::BothLouder => measured == [true; 2],
            _ => true,
        }
    }

    /// Whether the channel repeats its value.
    pub fn sticks(self, channel: Channel) -> bool {
        self == Kind::BothStuck || self == Kind::Stuck(channel)
    }

    /// Whether the channel scatters more than it did.
    pub fn is_louder(self, channel: Channel) -> bool {
        self == Kind::BothLouder || self == Kind::Louder(channel)
    }

    /// Whether it says why the channel reads what is not expected.
    pub fn explains(self, channel: Channel) -> bool {
        self.sticks(channel) || self.is_louder(channel) || self == Kind::Offset(channel)
    }

    /// Whether a channel does.
    pub fn is_loud(self) -> bool {
        matches!(self, Kind::Louder(_) | Kind::BothLouder)
    }

    /// Whether q̇ moved once by what no reading tells, and q follows.
    pub fn is_kick(self) -> bool {
        matches!(self, Kind::Kick | Kind::Glitch)
    }

    /// Whether F acts at another time.
    pub fn is_late(self) -> bool {
        matches!(self, Kind::Late(_))
    }

    /// Whether what acts in its own interval is not what was read of F: of the one in which a channel begins to come
    /// late nobody knows that either.
    pub fn is_unread(self) -> bool {
        self == Kind::Glitch || self.is_late()
    }

    /// Intensity of the white acceleration that it adds in its own interval, the `first`, for when in it that was
    /// nobody knows, and what u₀ moves by in a second, as a variance. Of a law that changed by an acceleration that is
    /// known the mean square of that is `sudden`.
    pub fn unknown(self, law: &Expected, inputs: [f64; 2], dt: f64, first: bool, sudden: Option<f64>) -> [f64; 2] {
        let [acceleration, gain] = law.switch;
        match self {
            Kind::Law { times, .. } => {
                let acceleration = f64::from(times) * acceleration;
                let event = sudden.unwrap_or(acceleration * acceleration + (gain * inputs[1]).powi(2)) * dt;
                [if first { event } else { 0.0 }, acceleration * acceleration * law.rate]
            }
            Kind::Misfit => [0.0, law.misfit() * law.rate],
            Kind::Kick if first => [law.size[1] * law.size[1] / dt, 0.0],
            _ if first && self.is_unread() => [law.drive * law.drive * dt, 0.0],
            _ => [0.0; 2],
        }
    }

    /// How much rarer it is than what befalls a sensor, nats: a switch that is so many times as large is so many times
    /// as rare.
    pub fn rarity(self) -> f64 {
        if let Kind::Law { times, .. } = self { f64::from(times).ln() } else { 0.0 }
    }

    /// Whether the law is another one.
    pub fn is_law(self) -> bool {
        matches!(self, Kind::Law { .. })
    }
}
