//! A whole recording through the streaming identifier: its stages, one after the other.

use super::check::BuildError;
use super::identifier::Identifier;
use super::library::SavedLaws;
use super::recording::Recording;
use super::report::{ByQuantity, CHANNELS, Coefficient, SensorState, Status};
use super::sample::{Sample, Skipped};
use super::settings::{Method, Settings};
use crate::estimation::Missing;
use crate::law::{Hold, Model, Term, equation};
use std::ops::Range;

/// A time over which one law held.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stage {
    /// Estimated instant at which it began, s; the first sample's time where no switch begins it.
    pub start: f64,
    /// Std of that instant, s; `None` where no switch began the stage.
    pub start_std: Option<f64>,
    /// Its end, s: the next stage's start, or the last sample.
    pub end: f64,
    /// Time of the alarm that opened it, s; `None` where no switch began it.
    pub detected: Option<f64>,
    /// Time at which that alarm had its name, no sensor's fault, s.
    pub named: Option<f64>,
    /// First time at which its law was validated, s.
    pub identified: Option<f64>,
    /// Number of its law among those validated, the same whenever a law returns; `None` where none was validated.
    pub law_number: Option<u32>,
    /// Whether the law was recognised as one seen before, not identified anew.
    pub recognised: bool,
    /// The last published coefficients, in the order of the model's terms.
    pub coefficients: Vec<Coefficient>,
    /// Whether its coefficients were moving at its end: those published are the last ones.
    pub drifting: bool,
    /// Whether its law was validated at its end.
    pub valid: bool,
    /// Share of the force's variance that the coefficients explain: of a law without inertia, and of one of motion
    /// where they are those of the weak form, which are not validated.
    pub explained: Option<f64>,
    /// What its data could not determine.
    pub unidentifiable: Vec<String>,
    /// The effect that its law lacked at its end; `None` where no evidence stood out.
    pub missing: Option<Missing>,
}

impl Stage {
    /// The coefficients that are known, with their std: of a law that is not validated those that are known better than
    /// their own size, and the 0 of a term that it has dropped.
    pub fn known(&self) -> impl Iterator<Item = (&Coefficient, f64)> {
        let told = |value: f64, std: f64| self.valid || value == 0.0 || std < value.abs();
        let known = self.coefficients.iter().filter_map(|coefficient| Some((coefficient, coefficient.std?)));
        known.filter(move |(coefficient, std)| told(coefficient.value, *std))
    }

    /// The terms whose coefficients are not known as well as a validated law has to be, and for how many more
    /// seconds such motion would have to go on; those left out of which nothing can be said.
    pub fn lacking(&self) -> impl Iterator<Item = (Term, f64)> {
        let needed = self.coefficients.iter().filter_map(|coefficient| Some((coefficient.term, coefficient.needed?)));
        needed.filter(|(_, seconds)| *seconds > 0.0)
    }

    /// The law on one line; `None` where nothing is known but held numbers. `forced` puts F on its right-hand side.
    pub fn law(&self, forced: bool) -> Option<String> {
        let terms: Vec<_> = self.known().map(|(known, std)| (known.term, known.value, Some(std))).collect();
        let is_whole = terms.len() == self.coefficients.len();
        let is_estimated = self.known().any(|(_, std)| std > 0.0);
        (is_whole || is_estimated).then(|| equation(&terms, forced))
    }
}

/// A time over which a sensor failed.
#[derive(Clone, Debug, PartialEq)]
pub struct SensorFault {
    /// The channel: `q`, `qd` or `F`.
    pub channel: &'static str,
    /// What it did.
    pub kind: SensorState,
    /// When that was first said, s.
    pub start: f64,
    /// When it was over, s; `None` where the record ends before.
    pub end: Option<f64>,
}

/// What was found in a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Identification {
    /// The stages, in the order of time; at least one.
    pub stages: Vec<Stage>,
    /// Estimated std of the noise of the sensors of q and q̇, and of what the force has besides a law that gives it;
    /// `None` where not known, of the force for a law of motion.
    pub noise: ByQuantity<Option<f64>>,
    /// The laws that were validated, to be recognised in other recordings.
    pub known_laws: SavedLaws,
    /// What the excitation did between samples: as set, or as the motion tells.
    pub hold: Hold,
    /// The sensors' faults, in the order of their start.
    pub sensors: Vec<SensorFault>,
    /// The samples that were not used, and why.
    pub skipped: Vec<Skipped>,
}

impl Identification {
    /// Whether a sensor was at fault in the stage: what its readings leave then is not the law's.
    pub fn has_fault_in(&self, stage: &Stage) -> bool {
        let overlaps = |start: f64, end: Option<f64>| start < stage.end && end.is_none_or(|end| end > stage.start);
        self.sensors.iter().any(|fault| overlaps(fault.start, fault.end))
    }
}

/// How often the list of what cannot be determined is renewed, samples: it costs a decomposition, and changes slowly.
const RENEW_UNIDENTIFIABLE: usize = 64;

/// Samples after which holds are compared; the last time for good.
const HOLD_TRIALS: [usize; 3] = [1500, 3000, 6000];

/// Log-likelihood, nats, by which a hold falls out before that.
const BEATEN: f64 = 500.0;

/// The hold under which the first long stretch of the recording has the largest likelihood; a straight line where none
/// gives a law, which errs least where nothing is known, and of a free motion, where nothing is held. Always by our
/// method: the publication's states no likelihood. Of a model with numbers only, all are estimated.
pub fn choose_hold(model: &Model, recording: &Recording, settings: &Settings) -> Hold {
    if !recording.channels().excitation {
        return Hold::Linear;
    }
    let numbers_only = model.check_free(true).is_err();
    let freed = numbers_only.then(|| model.freed());
    let model = freed.as_ref().unwrap_or(model);
    let begin = |hold: Hold| {
        let settings = Settings { hold, method: Method::Default, ..*settings };
        Some((hold, Identifier::new(model, settings).ok()?))
    };
    let mut rivals: Vec<(Hold, Identifier)> = Hold::ALL.into_iter().filter_map(begin).collect();
    let piece = told_by(recording);
    let mut next = piece.start;
    for trial in HOLD_TRIALS {
        let end = piece.end.min(piece.start + trial);
        for (_, identifier) in &mut rivals {
            for index in next..end {
                // a skipped sample is skipped under every hold
                identifier.step(recording.sample(index)).ok();
            }
        }
        next = end;
        drop_beaten(&mut rivals, trial as f64);
        if rivals.len() < 2 {
            break;
        }
    }
    // a rival whose hold the motion has told to be wrong goes on under the other
    let tried = rivals.iter().filter_map(|(_, identifier)| Some((identifier.output().hold, identifier.likelihood()?)));
    tried.max_by(|a, b| a.1.total_cmp(&b.1)).map_or(Hold::Linear, |(hold, _)| hold)
}

/// The first stretch without gaps that is long enough to compare holds on, or the longest.
fn told_by(recording: &Recording) -> Range<usize> {
    let pieces = recording.pieces();
    let enough = |piece: &&Range<usize>| piece.len() >= HOLD_TRIALS[0];
    let piece = pieces.iter().find(enough).or_else(|| pieces.iter().max_by_key(|piece| piece.len()));
    piece.cloned().unwrap_or(0..0)
}

/// Drops the holds whose law is far less likely after so many samples than the best one's.
fn drop_beaten(rivals: &mut Vec<(Hold, Identifier)>, samples: f64) {
    let known = rivals.iter().filter_map(|(_, identifier)| identifier.likelihood());
    let best = known.fold(f64::NEG_INFINITY, f64::max);
    rivals.retain(|(_, identifier)| identifier.likelihood().is_none_or(|own| samples * (best - own) < BEATEN));
}

/// Steps an identifier over every sample and collects the stages. What a gap may hide, a switch or an offset, is told
/// as in any stream; where none is [carried over](carries_over_gaps), each gap starts a new identifier that knows the
/// laws before it. `watch` is called after every sample with it, also after one that lacks a reading.
///
/// # Errors
/// [`BuildError`] when settings or model are refused.
pub fn identify_recording(
    model: &Model,
    settings: Settings,
    recording: &Recording,
    watch: impl FnMut(&Identifier, Sample),
) -> Result<Identification, BuildError> {
    identify_knowing(model, settings, &SavedLaws::default(), recording, watch)
}

/// The same with laws to recognise from the first sample on.
///
/// # Errors
/// [`BuildError`] when settings, model or laws are refused.
pub fn identify_knowing(
    model: &Model,
    settings: Settings,
    known: &SavedLaws,
    recording: &Recording,
    mut watch: impl FnMut(&Identifier, Sample),
) -> Result<Identification, BuildError> {
    let fresh = Identifier::new(model, settings)?;
    let mut found = Identification { known_laws: known.clone(), hold: settings.hold, ..Identification::default() };
    let pieces = match carries_over_gaps(model, &settings) {
        true => std::iter::once(0..recording.count()).collect(),
        false => recording.pieces(),
    };
    for piece in pieces {
        let identifier = fresh.clone().with_known_laws(&found.known_laws)?;
        follow(identifier, recording, piece, &mut found, &mut watch);
    }
    Ok(found)
}

/// Whether a law goes on over a gap of the recording. The published procedure integrates over all that its window
/// holds, and a law that gives the force tells q̇ and q̈ from successive samples: neither may go over a gap.
pub fn carries_over_gaps(model: &Model, settings: &Settings) -> bool {
    settings.method == Method::Default && !model.is_force_law()
}

/// One stretch of the record: adds its stages to `found`.
fn follow(
    mut identifier: Identifier,
    recording: &Recording,
    piece: Range<usize>,
    found: &mut Identification,
    watch: &mut impl FnMut(&Identifier, Sample),
) {
    let mut samples = (piece.start..).zip(recording.stream(piece)).peekable();
    let start = samples.peek().map_or(0.0, |(_, sample)| sample.t);
    let mut present = begin(&identifier, start);
    end_faults(&mut found.sensors, start);
    for (index, sample) in samples {
        let switches = identifier.output().switch_count;
        let sensors = identifier.output().sensors;
        found.skipped.extend(identifier.step(sample).err());
        note_faults(&mut found.sensors, sensors, identifier.output().sensors, sample.t);
        found.hold = identifier.output().hold;
        if identifier.output().switch_count != switches {
            let next = begin(&identifier, identifier.output().switch_time);
            present.end = next.start;
            found.stages.push(std::mem::replace(&mut present, next));
        }
        renew(&mut present, &identifier, sample.t);
        if index % RENEW_UNIDENTIFIABLE == 0 {
            present.unidentifiable = identifier.unidentifiable();
        }
        watch(&identifier, sample);
    }
    present.unidentifiable = identifier.unidentifiable();
    present.valid = identifier.output().valid;
    found.stages.push(present);
    found.known_laws = identifier.known_laws();
    let (now, before) = (identifier.output().noise, found.noise);
    found.noise = ByQuantity { q: now.q.or(before.q), qd: now.qd.or(before.qd), force: now.force.or(before.force) };
}

/// An identifier that begins anew knows of no fault.
fn end_faults(faults: &mut [SensorFault], t: f64) {
    faults.iter_mut().filter(|fault| fault.end.is_none()).for_each(|fault| fault.end = Some(t));
}

/// Faults that have ended at a sample, and those that have begun.
fn note_faults(faults: &mut Vec<SensorFault>, before: [SensorState; 3], now: [SensorState; 3], t: f64) {
    for (channel, (before, now)) in CHANNELS.into_iter().zip(before.into_iter().zip(now)) {
        if before == now {
            continue;
        }
        let open = faults.iter_mut().rev().find(|fault| fault.channel == channel && fault.end.is_none());
        open.into_iter().for_each(|fault| fault.end = Some(t));
        if now != SensorState::Ok {
            faults.push(SensorFault { channel, kind: now, start: t, end: None });
        }
    }
}

/// A stage that begins; what else its samples tell, [`renew`] takes over.
fn begin(identifier: &Identifier, start: f64) -> Stage {
    let output = identifier.output();
    Stage {
        start,
        start_std: output.switch_time_std,
        detected: output.detection_time,
        named: output.named_time,
        coefficients: identifier.coefficients().to_vec(),
        unidentifiable: identifier.unidentifiable(),
        ..Stage::default()
    }
}

fn renew(stage: &mut Stage, identifier: &Identifier, t: f64) {
    stage.end = t;
    let output = identifier.output();
    stage.identified = output.identified_time;
    (stage.law_number, stage.recognised) = (output.law_number, output.recognised);
    (stage.drifting, stage.explained) = (output.drifting, output.explained);
    // what is held while a switch is suspected may be of the next stage
    if output.status != Status::SwitchSuspected {
        stage.valid = output.valid;
    }
    stage.missing = output.missing;
    stage.coefficients.copy_from_slice(identifier.coefficients());
}
