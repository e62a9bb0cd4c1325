//! A recording without a model: opened, looked at, its hold guessed.

use super::columns::ColumnArguments;
use super::error::CommandError;
use super::output;
use crate::data::{self, Opened};
use crate::diagnose::{Remark, remarks};
use crate::identify::{self, Recording, Settings};
use crate::law::{Given, Hold, Model, Term};
use std::path::Path;

/// What there is to say of a recording before any law.
pub(super) struct Looked {
    pub(super) opened: Opened,
    pub(super) remarks: Vec<Remark>,
    pub(super) hold: Hold,
    /// Why this hold.
    pub(super) hold_from: &'static str,
}

impl Looked {
    /// Opens a recording whose columns a model, the options or the file itself name.
    ///
    /// # Errors
    /// The file that is at fault.
    pub(super) fn open(data: &str, model: Option<&Path>, columns: &ColumnArguments) -> Result<Looked, CommandError> {
        let mut model = model.map_or_else(|| Ok(oscillator()), data::open_model)?;
        columns.apply(&mut model)?;
        let opened = data::open_recording(data, &model)?;
        let remarks = remarks(&opened.recording);
        let (hold, hold_from) = hold(&model, &opened.recording);
        Ok(Looked { opened, remarks, hold, hold_from })
    }

    /// Samples per second.
    pub(super) fn rate(&self) -> f64 {
        1.0 / self.opened.recording.sample_time()
    }
}

/// m q̈ + c q̇ + k q = F: what most recordings come near to.
fn oscillator() -> Model {
    let terms = [Term::Inertia, Term::power(0, 1), Term::power(1, 0)];
    Model::of("oscillator", terms.map(|term| (term, Given::Fit)))
}

/// What the excitation did between samples, and who says so.
fn hold(model: &Model, recording: &Recording) -> (Hold, &'static str) {
    if let Some(hold) = model.hold {
        return (hold, "the model's");
    }
    if !recording.channels().excitation {
        return (Hold::Linear, "there is no excitation");
    }
    let steps = recording.signal("F").is_some_and(is_stepped);
    if steps {
        return (Hold::Zero, "F stays for several samples and then jumps");
    }
    let settings = identify::settings_for(recording, Settings::default());
    (identify::choose_hold(model, recording, &settings), "likeliest under m q̈ + c q̇ + k q = F")
}

/// Whether a signal mostly repeats itself: it is held longer than a sample.
fn is_stepped(values: &[f64]) -> bool {
    let repeated = values.windows(2).filter(|pair| pair[0] == pair[1]).count();
    2 * repeated > values.len() && repeated + 1 < values.len()
}

/// Says in a line each what is conspicuous of a recording and what was guessed of its file.
pub(super) fn say(opened: &Opened) {
    if let Some(guessed) = &opened.guessed {
        output::complain("note", guessed);
    }
    let source = opened.recording.source();
    for remark in remarks(&opened.recording) {
        output::complain("note", &format!("{source}: {}: {}", remark.channel, remark.sentence));
    }
}
