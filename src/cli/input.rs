//! What commands on recordings and a model have in common: opening them, and what the excitation did between samples.

use super::columns::ColumnArguments;
use super::error::CommandError;
use super::looked;
use super::output;
use super::words::{quoted, seconds};
use crate::data::{self, Opened};
use crate::diagnose::{Comparison, Options, Posed, compare_posed};
use crate::identify::{self, Gap, Recording, Settings};
use crate::law::{Given, Hold, Model, ModelTerm, Term, Units};
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;

/// Noise std ÷ largest value below which a record counts as free of noise: six digits in a file leave 3e-7.
const NOISELESS: f64 = 1e-6;

/// Samples of a recording that are judged, from twice as many on: its windows are then thousands, and what a law lacks
/// by less than they see is below any sensor's calibration.
pub(super) const ENOUGH: usize = 200_000;

/// Parts that are taken of a longer recording.
pub(super) const PARTS: usize = 8;

/// The model, and the hold if the user names one.
#[derive(Args)]
pub(super) struct ModelArguments {
    /// The model file (TOML)
    #[arg(long, short)]
    pub(super) model: PathBuf,
    /// What the excitation did between samples; else the model says, or the best one is kept
    #[arg(long, value_parser = PossibleValuesParser::new(Hold::ALL.map(Hold::id)))]
    pub(super) hold: Option<String>,
    #[command(flatten)]
    pub(super) columns: ColumnArguments,
}

/// The recordings, and the model that is held against them.
#[derive(Args)]
pub(super) struct InputArguments {
    /// The recordings (text, spreadsheet, MAT, MDF 4 or Parquet), or sections of them: DATA@t0:t1 in seconds
    #[arg(required = true)]
    pub(super) data: Vec<String>,
    #[command(flatten)]
    pub(super) model: ModelArguments,
}

impl InputArguments {
    /// The files that are read.
    pub(super) fn files(&self) -> Result<Vec<PathBuf>, CommandError> {
        let mut files = output::files_of(&self.data)?;
        files.push(self.model.model.clone());
        Ok(files)
    }
}

/// A model with the recordings it is held against.
pub(super) struct Input {
    /// The model.
    pub(super) model: Model,
    /// Its file.
    pub(super) file: String,
    /// What is known of the units of coefficients.
    pub(super) units: Units,
    /// What the excitation did between samples, where the user or the model says so.
    pub(super) hold: Option<Hold>,
    recordings: Vec<Recording>,
}

impl Input {
    /// Opens the model and every recording.
    ///
    /// # Errors
    /// The first file that is at fault.
    pub(super) fn open(data: &[String], arguments: &ModelArguments) -> Result<Input, CommandError> {
        let mut model = data::open_model(&arguments.model)?;
        arguments.columns.apply(&mut model)?;
        let open = |data: &String| data::open_recording(data, &model);
        let opened: Vec<Opened> = data.iter().map(open).collect::<Result<_, _>>()?;
        opened.iter().for_each(looked::say);
        let units = opened.iter().map(|opened| opened.units).reduce(Units::common).unwrap_or_default();
        let recordings: Vec<Recording> = opened.into_iter().map(|opened| opened.recording).collect();
        let file = arguments.model.display().to_string();
        let moving = moving(&model);
        if let Some(free) = recordings.iter().find(|recording| !recording.channels().excitation)
            && moving.terms.len() > model.terms.len()
        {
            return Err(CommandError::NoScale { data: free.source().into(), model: file });
        }
        let hold = arguments.hold.as_deref().and_then(Hold::from_id).or(model.hold);
        recordings.iter().flat_map(warnings).for_each(|text| output::complain("warning", &text));
        Ok(Input { file, model, units, hold, recordings })
    }

    /// The same with evenly spread parts of very long recordings, which tell what a law lacks as well; says so.
    pub(super) fn thinned(mut self) -> Input {
        for recording in &mut self.recordings {
            let Some(parts) = recording.spread(ENOUGH, PARTS) else { continue };
            let (source, all) = (recording.source(), recording.count());
            let note =
                format!("{source}: {PARTS} evenly spread parts, {} of its {all} samples, are judged", parts.count());
            output::complain("note", &note);
            *recording = parts;
        }
        self
    }

    /// The recordings.
    pub(super) fn recordings(&self) -> Vec<&Recording> {
        self.recordings.iter().collect()
    }

    /// The model held against the recordings, each with the hold that is known, or under which the best of its form
    /// leaves least.
    pub(super) fn compared(&self, options: &Options) -> Comparison {
        let posed = Posed::new(&self.model.freed(), &self.recordings(), self.hold);
        let law = posed.as_ref().and_then(Posed::law);
        let hold = self.hold.or(law.map(|(law, _)| law.timing.hold)).unwrap_or(Hold::Linear);
        let recordings: Vec<_> = self.recordings.iter().map(|recording| (recording, hold)).collect();
        compare_posed(&self.model, &recordings, posed.as_ref(), &Options { units: self.units, ..*options })
    }

    /// The recordings, each with the hold that is known, or under which it is likeliest.
    pub(super) fn held(&self) -> Vec<(&Recording, Hold)> {
        let moving = moving(&self.model);
        let hold = |recording: &Recording| {
            let settings = identify::settings_for(recording, Settings::default());
            self.hold.unwrap_or_else(|| identify::choose_hold(&moving, recording, &settings))
        };
        self.recordings.iter().map(|recording| (recording, hold(recording))).collect()
    }

    /// Whether any recording has an excitation.
    pub(super) fn forced(&self) -> bool {
        self.recordings.iter().any(|recording| recording.channels().excitation)
    }

    /// The arguments by which the recordings were named.
    pub(super) fn named(&self) -> String {
        self.recordings.iter().map(Recording::source).collect::<Vec<_>>().join(" ")
    }

    /// The recordings as a shell takes them.
    pub(super) fn arguments(&self) -> String {
        self.recordings.iter().map(|recording| quoted(recording.source())).collect::<Vec<_>>().join(" ")
    }

    /// Why there is no law.
    pub(super) fn undetermined(&self) -> CommandError {
        CommandError::Undetermined { data: self.named(), model: self.file.clone() }
    }
}

/// The model as a law of motion: with an inertia where it has none.
fn moving(model: &Model) -> Model {
    let mut moving = model.clone();
    if moving.position(Term::Inertia).is_none() {
        moving.terms.push(ModelTerm::new(Term::Inertia, Given::Fit));
    }
    moving
}

/// Whether the noise of q and q̇ of that std is hardly more than rounding.
pub(super) fn is_noiseless(std: [Option<f64>; 2], recording: &Recording) -> [bool; 2] {
    let is_small = |channel: &str, std: f64| recording.signal(channel).is_some_and(|own| std < NOISELESS * usual(own));
    let [q, qd] = std;
    [q.is_some_and(|std| is_small("q", std)), qd.is_some_and(|std| is_small("qd", std))]
}

/// The size that half of a signal's readings exceed; a wild one among them does not change it.
fn usual(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).filter(|size| *size > 0.0).collect();
    let middle = sizes.len() / 2;
    if sizes.is_empty() { 0.0 } else { *sizes.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// What was taken otherwise than the file says.
fn warnings(recording: &Recording) -> Vec<String> {
    let source = recording.source();
    let gap = |gap: Gap| {
        format!(
            "{source}: no samples from {} s to {} s: nothing is carried over it",
            seconds(gap.start),
            seconds(gap.end)
        )
    };
    let mut warnings: Vec<String> = recording.gaps().into_iter().map(gap).collect();
    if !recording.channels().excitation {
        warnings.push(format!("{source}: there is no excitation: taken as free motion"));
    }
    warnings
}
