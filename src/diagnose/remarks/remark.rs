//! Something to be said of a recording.

/// Something to be said of a recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Remark {
    /// Of what: `t`, `q`, `qd` or `F`.
    pub channel: &'static str,
    /// What kind of thing, one word: `wild`, `late`.
    pub kind: &'static str,
    /// What was seen, and what it does, without its channel.
    pub sentence: String,
}

impl Remark {
    /// A remark.
    pub(super) fn new(channel: &'static str, kind: &'static str, sentence: String) -> Remark {
        Remark { channel, kind, sentence }
    }
}
