//! What a law remembers of the motion before an instant.

use super::windows::COUNT;

/// Parts of a record that are held out in turn: four fifths of it train, and a stretch of its own tests.
pub(super) const FOLDS: usize = 5;

/// What the internal states of a law's terms keep; nothing where it has none.
#[derive(Clone, Debug, Default)]
pub(in crate::diagnose) struct Memory {
    /// By window length, the equations that hold what was stored when their piece began, which nobody knows.
    pub(super) void: [Vec<usize>; COUNT],
    /// How long after the beginning of each part, and after the end of the last, something is left of what was stored
    /// until then, s.
    pub(super) aside: [f64; FOLDS + 1],
}
