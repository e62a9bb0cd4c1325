//! Where the identification stands: every regime, every transition between them, and the event that guards it.
//!
//! A regime holds what only it has. [`Regime::after`] is the only place where one follows another; what the caller sees
//! (`status`, `drifting`, and beside what is published `valid`) is derived from the regime by the methods below and
//! is read by nothing that estimates.

use crate::identify::library::Mixture;
use crate::identify::report::Status;
use serde::{Deserialize, Serialize};

/// The regime of the identification.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Regime {
    /// No law of this record is validated, and none has been before.
    Acquiring,
    /// A law is validated.
    Tracking {
        /// Its number among all that were validated.
        law: u32,
        /// Which known law it is, where it was recognised as one and not identified from the record.
        recognition: Option<Recognition>,
        /// Whether evidence of a switch is growing.
        suspected: bool,
    },
    /// The law before does not hold any more; that of the record is not validated yet.
    ReIdentifying {
        /// The time after an alarm in which the hypotheses of the switch speak for known laws.
        post_alarm: Option<PostAlarm>,
    },
    /// The coefficients move and are followed.
    Drifting {
        /// How, and how well.
        drift: Followed,
    },
}

/// A known law in use.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Recognition {
    /// Its place in the library.
    pub(super) place: usize,
    /// The laws that it may be instead; none once its trial over the new record has confirmed it.
    pub(super) doubt: Option<Mixture>,
}

/// The time after an alarm in which the bank of hypotheses goes on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct PostAlarm {
    /// Number of the sample at which it ends.
    pub(super) until: u64,
    /// Number of the law that was left.
    pub(super) left: Option<u32>,
}

/// Coefficients that are followed as they move.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Followed {
    /// What follows them.
    pub(super) by: Follower,
    /// Whether they have come to rest and a constant law is sought.
    pub(super) resting: bool,
    /// Whether they are known well enough to be validated.
    pub(super) known: bool,
}

/// What follows coefficients that move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Follower {
    /// Random walks measured by weak rows.
    WeakRows,
    /// Filters of the state together with the coefficients.
    AugmentedFilters,
}

/// What ends a regime, or changes its data: each is the guard of the transitions that it causes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Event {
    /// The segment's law states e below the bound, stands its stability check, and has an inertia that a motion can
    /// have.
    LawValidated(u32),
    /// A known law stands out from every other one, on trial or by the hypotheses of a switch.
    LawRecognised(u32, Recognition),
    /// The trial of the recognised law says how likely others are; with none it singles that law out.
    RecognitionWeighed(Option<Mixture>),
    /// The record speaks against the recognised law; whether a law was in use before it.
    RecognitionRefuted {
        /// Whether any law had been in use before it.
        after_another: bool,
    },
    /// The log Bayes factor of a change passes half the decision threshold.
    SuspicionRaised,
    /// It is below half the decision threshold again.
    SuspicionCleared,
    /// It passes the decision threshold.
    SwitchFound(Option<PostAlarm>),
    /// The hypotheses of the last switch have no more to say on known laws.
    PostAlarmEnded,
    /// The law in use does not explain its record any more, and no switch does: several laws share it.
    LawRefuted,
    /// The state under the law in use has left the finite numbers.
    StateLost,
    /// Coefficients that wander explain the record better than constant ones or one switch.
    DriftFound(Follower),
    /// The coefficients that are followed are known well enough (true), or not any more (false).
    DriftValidated(bool),
    /// The coefficients that are followed have come to rest (true), or move again (false).
    DriftRests(bool),
    /// The filters that followed the drift have lost it.
    DriftLost,
}

impl Event {
    /// Whether what was valid has been left.
    pub(super) fn ends_law(&self) -> bool {
        use Event::*;
        matches!(self, RecognitionRefuted { .. } | SwitchFound(_) | LawRefuted | StateLost | DriftLost)
    }
}

impl Regime {
    /// The regime after an event. An event that a regime is not listed with leaves it as it is.
    #[must_use]
    pub(super) fn after(self, event: Event) -> Regime {
        use Event::*;
        use Regime::*;
        match (self, event) {
            (Acquiring | ReIdentifying { .. } | Drifting { .. }, LawValidated(law)) => Regime::in_use(law, None),
            (Acquiring | ReIdentifying { .. } | Drifting { .. }, LawRecognised(law, recognition)) => {
                Regime::in_use(law, Some(recognition))
            }
            (Tracking { law, recognition: Some(known), suspected }, RecognitionWeighed(mixture)) => {
                // what has been confirmed stays so
                let recognition = Recognition { doubt: known.doubt.and(mixture), ..known };
                Tracking { law, recognition: Some(recognition), suspected }
            }
            (Tracking { recognition: Some(_), .. }, RecognitionRefuted { after_another }) => match after_another {
                true => ReIdentifying { post_alarm: None },
                false => Acquiring,
            },

            (Tracking { law, recognition, .. }, SuspicionRaised) => Tracking { law, recognition, suspected: true },
            (Tracking { law, recognition, .. }, SuspicionCleared) => Tracking { law, recognition, suspected: false },

            (Drifting { drift }, LawRefuted | StateLost) => Drifting { drift: Followed { known: false, ..drift } },
            (_, SwitchFound(post_alarm)) => ReIdentifying { post_alarm },
            (ReIdentifying { .. }, PostAlarmEnded) => ReIdentifying { post_alarm: None },
            (_, LawRefuted) => ReIdentifying { post_alarm: None },
            (_, StateLost) => Acquiring,

            (_, DriftFound(by)) => Drifting { drift: Followed { by, resting: false, known: self.is_valid() } },
            (Drifting { drift }, DriftValidated(known)) => Drifting { drift: Followed { known, ..drift } },
            (Drifting { drift }, DriftRests(resting)) => Drifting { drift: Followed { resting, ..drift } },
            (Drifting { .. }, DriftLost) => Acquiring,
            (regime, _) => regime,
        }
    }

    /// A law that has just been validated or recognised.
    fn in_use(law: u32, recognition: Option<Recognition>) -> Regime {
        Regime::Tracking { law, recognition, suspected: false }
    }

    /// The published status: a law that drifts is tracked while it is known.
    pub(super) fn status(&self) -> Status {
        match self {
            Regime::Acquiring => Status::Acquiring,
            Regime::Drifting { drift } if !drift.known => Status::Acquiring,
            Regime::Tracking { suspected: true, .. } => Status::SwitchSuspected,
            Regime::Tracking { .. } | Regime::Drifting { .. } => Status::Tracking,
            Regime::ReIdentifying { .. } => Status::ReIdentifying,
        }
    }

    /// Whether the present law is validated.
    pub(super) fn is_valid(&self) -> bool {
        matches!(self.status(), Status::Tracking | Status::SwitchSuspected)
    }

    /// Whether the coefficients move and are followed.
    pub(super) fn is_drifting(&self) -> bool {
        self.followed().is_some()
    }

    /// How the coefficients are followed, where they move.
    pub(super) fn followed(&self) -> Option<Followed> {
        match self {
            Regime::Drifting { drift } => Some(*drift),
            _ => None,
        }
    }

    /// Whether a constant law is sought: always but while filters that weigh one themselves follow coefficients that
    /// have not come to rest.
    pub(super) fn seeks_constant_law(&self) -> bool {
        !self.is_moving() || self.followed().is_some_and(|drift| drift.by == Follower::WeakRows)
    }

    /// Whether coefficients move that have not come to rest.
    pub(super) fn is_moving(&self) -> bool {
        self.followed().is_some_and(|drift| !drift.resting)
    }

    /// The number of the constant law that is validated.
    pub(super) fn law(&self) -> Option<u32> {
        match self {
            Regime::Tracking { law, .. } => Some(*law),
            Regime::Acquiring | Regime::ReIdentifying { .. } | Regime::Drifting { .. } => None,
        }
    }

    /// The known law in use, where one was recognised.
    pub(super) fn recognition(&self) -> Option<Recognition> {
        match self {
            Regime::Tracking { recognition, .. } => *recognition,
            _ => None,
        }
    }

    /// Whether the law in use was recognised and its trial has not confirmed it yet.
    pub(super) fn is_unconfirmed(&self) -> bool {
        self.recognition().is_some_and(|recognition| recognition.doubt.is_some())
    }

    /// The time after an alarm in which the bank of hypotheses goes on.
    pub(super) fn post_alarm(&self) -> Option<PostAlarm> {
        match self {
            Regime::ReIdentifying { post_alarm } => *post_alarm,
            _ => None,
        }
    }
}

/// One letter a regime: acquiring, tracking, recognised, suspected, re-identifying, drifting.
#[cfg(test)]
pub(super) fn letter(regime: Regime) -> char {
    match regime {
        Regime::Acquiring => 'a',
        Regime::Tracking { suspected: true, .. } => 's',
        Regime::Tracking { recognition: Some(_), .. } => 'r',
        Regime::Tracking { .. } => 't',
        Regime::ReIdentifying { .. } => 'i',
        Regime::Drifting { .. } => 'd',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: u32 = 3;
    const SWITCH: Event = Event::SwitchFound(Some(PostAlarm { until: 50, left: Some(3) }));

    fn recognition() -> Recognition {
        Recognition { place: 1, doubt: Some(Mixture::default()) }
    }

    fn drifting(known: bool) -> Regime {
        Regime::Drifting { drift: Followed { by: Follower::WeakRows, resting: false, known } }
    }

    fn regimes() -> [Regime; 7] {
        [
            Regime::Acquiring,
            Regime::in_use(LAW, None),
            Regime::in_use(LAW, Some(recognition())),
            Regime::in_use(LAW, None).after(Event::SuspicionRaised),
            Regime::in_use(LAW, Some(recognition())).after(Event::SuspicionRaised),
            Regime::ReIdentifying { post_alarm: Some(PostAlarm { until: 50, left: Some(3) }) },
            drifting(true),
        ]
    }

    fn events() -> [Event; 17] {
        [
            Event::LawValidated(LAW),
            Event::LawRecognised(LAW, recognition()),
            Event::RecognitionWeighed(None),
            Event::RecognitionWeighed(Some(Mixture::of(1.0, None))),
            Event::RecognitionRefuted { after_another: true },
            Event::RecognitionRefuted { after_another: false },
            Event::SuspicionRaised,
            Event::SuspicionCleared,
            SWITCH,
            Event::PostAlarmEnded,
            Event::LawRefuted,
            Event::StateLost,
            Event::DriftFound(Follower::AugmentedFilters),
            Event::DriftValidated(true),
            Event::DriftValidated(false),
            Event::DriftRests(true),
            Event::DriftLost,
        ]
    }

    #[test]
    fn these_transitions_exist_and_no_others() {
        let table = [
            ("law validated", "ttrsstt"),
            ("law recognised", "rtrssrr"),
            ("recognition confirmed", "atrssid"),
            ("recognition weighed", "atrssid"),
            ("recognition refuted, a law before", "atisiid"),
            ("recognition refuted, none before", "atasaid"),
            ("suspicion raised", "assssid"),
            ("suspicion cleared", "atrtrid"),
            ("switch found", "iiiiiii"),
            ("post-alarm window ended", "atrssid"),
            ("law refuted", "iiiiiid"),
            ("state lost", "aaaaaad"),
            ("drift found", "ddddddd"),
            ("drift known", "atrssid"),
            ("drift unknown", "atrssid"),
            ("drift rests", "atrssid"),
            ("drift lost", "atrssia"),
        ];
        for ((name, expected), event) in table.into_iter().zip(events()) {
            let found: String = regimes().into_iter().map(|regime| letter(regime.after(event))).collect();
            assert_eq!(found, expected, "{name}");
        }
    }

    #[test]
    fn a_law_keeps_its_number_until_it_is_left() {
        let later = 9;
        let tracking = Regime::Acquiring.after(Event::LawValidated(LAW));
        let again = tracking
            .after(Event::SuspicionRaised)
            .after(Event::LawValidated(later))
            .after(Event::SuspicionCleared)
            .after(Event::LawValidated(later));
        assert_eq!(again, tracking);
        assert_eq!(again.after(SWITCH).after(Event::LawValidated(later)).law(), Some(later));
    }

    #[test]
    fn a_recognised_law_stays_recognised_under_suspicion() {
        let suspected = Regime::in_use(LAW, Some(recognition())).after(Event::SuspicionRaised);
        assert!(suspected.is_unconfirmed() && suspected.status() == Status::SwitchSuspected);
        let confirmed = suspected.after(Event::RecognitionWeighed(None)).after(Event::SuspicionCleared);
        let weighed = confirmed.after(Event::RecognitionWeighed(Some(Mixture::default())));
        let recognition = Recognition { doubt: None, ..recognition() };
        assert_eq!((confirmed, weighed), (Regime::in_use(LAW, Some(recognition)), confirmed));
    }

    #[test]
    fn a_drift_is_tracked_as_long_as_it_is_known() {
        let drift = Regime::in_use(LAW, None).after(Event::DriftFound(Follower::WeakRows));
        assert_eq!(drift, drifting(true));
        let unknown = drift.after(Event::DriftValidated(false));
        assert_eq!((unknown.status(), unknown.is_valid()), (Status::Acquiring, false));
        assert!(unknown.after(Event::DriftValidated(true)).is_valid());
        let rests = unknown.after(Event::DriftRests(true));
        let weighed = Regime::in_use(LAW, None).after(Event::DriftFound(Follower::AugmentedFilters));
        assert!(rests.seeks_constant_law() && unknown.seeks_constant_law() && !weighed.seeks_constant_law());
        assert!(unknown.is_moving() && !rests.is_moving());
        assert_eq!(rests.after(Event::LawValidated(4)).law(), Some(4));
    }

    #[test]
    fn only_a_validated_law_is_valid_and_only_it_has_a_number() {
        let valid: String = regimes().into_iter().filter(Regime::is_valid).map(letter).collect();
        assert_eq!(valid, "trssd");
        let numbered: String = regimes().into_iter().filter(|regime| regime.law().is_some()).map(letter).collect();
        assert_eq!(numbered, "trss");
        let recognised: String =
            regimes().into_iter().filter(|regime| regime.recognition().is_some()).map(letter).collect();
        assert_eq!(recognised, "rs");
    }
}
