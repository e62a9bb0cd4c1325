//! A model against measurements: how wrong it is, and how wrong it could at best be.
//!
//! Two laws stand side by side: the model *as given*, its numbers held, and the *best of this form*, every coefficient
//! sought. Where the first errs much more than the second, the form is right and the numbers are off. Beside both
//! stands the noise floor, what the residual would be were the law right.

use super::coefficients::{Estimate, Held, best_coefficients};
use super::force::{Left, left_over};
use super::free_run::{Distance, FreeRun, variance};
use super::locate::{Fail, locate};
use super::record::{Balance, Record};
use super::spectrum::spectrum;
use super::window::{choose_window, periods};
use crate::diagnose::judge::Target;
use crate::diagnose::verdict::{Law, Posed, WindowError, are_adequate};
use crate::identify::Recording;
use crate::law::{Expression, Hold, Model, Motion, Term, Units};

/// What a user may set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Length of the windows of the weak residual, s; `None` = automatic.
    pub window: Option<f64>,
    /// Length of the windows of open-loop prediction, s.
    pub horizon: f64,
    /// What is known of units, for sentences.
    pub units: Units,
}

impl Default for Options {
    fn default() -> Options {
        Options { window: None, horizon: 1.0, units: Units::default() }
    }
}

/// What the judge says of a law: errors by window length, and whether they are what the sensors alone would leave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judged {
    /// Of a law as given over all windows, of the best of a form held out.
    pub errors: [WindowError; 3],
    /// Whether the law explains its record.
    pub adequate: bool,
    /// Which column its equations were solved for.
    pub target: Target,
}

/// How wrong a law is on a set of recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    /// RMS weak residual ÷ RMS weak excitation, of free motion ÷ RMS weak inertia.
    pub force_residual: f64,
    /// What `force_residual` would be were the law right.
    pub noise_floor: f64,
    /// RMSE of the free run of q (of q̇ where q is not measured) ÷ std of the measurement; none where it diverges, or
    /// where the law has memory, a delay or an expression, whose state at the start no reading gives.
    pub free_run_nrmse: Option<f64>,
    /// The same of q̇ where both are measured.
    pub free_run_nrmse_velocity: Option<f64>,
    /// Time at which the free run left all bounds, s.
    pub diverged: Option<f64>,
    /// RMSE of open-loop prediction over windows of `horizon`, in units of q (of q̇ where q is not measured).
    pub window_rmse: Option<f64>,
}

/// A law, and how wrong it is: on all recordings together, and on each.
#[derive(Clone, Debug, PartialEq)]
pub struct Side {
    /// Its coefficients.
    pub law: Estimate,
    /// Its error on all recordings together.
    pub error: Error,
    /// Its error on each recording.
    pub each: Vec<Error>,
    /// What the judge says of it; none where the record is too short for that.
    pub judged: Option<Judged>,
    /// Where it fails, the most evident place first; none where the error is spread evenly or is noise.
    pub fails: Vec<Fail>,
    /// What it leaves over of the force, along the motion.
    pub left: Vec<Left>,
}

/// What comparing a model with recordings tells.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Where each recording came from.
    pub sources: Vec<String>,
    /// What the excitation of each did between samples.
    pub holds: Vec<Hold>,
    /// Estimated std of the sensors of q and q̇ in each recording; 0 where not measured.
    pub noise: Vec<[f64; 2]>,
    /// Length of the windows of the weak residual, s.
    pub window: f64,
    /// Length of the windows of open-loop prediction, s.
    pub horizon: f64,
    /// Period of the displacement, 2π rms(q) ÷ rms(q̇), s.
    pub period: f64,
    /// Whether there is an excitation in any recording.
    pub forced: bool,
    /// Units of q and q̇, where known.
    pub units: Units,
    /// The model with its numbers held.
    pub given: Side,
    /// The best of its form.
    pub best: Side,
}

/// What a comparison comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The residual of the model as given is its noise: nothing to gain.
    AtNoise,
    /// The numbers are off; the best ones bring this form down to the noise.
    NumbersOff,
    /// The numbers are off, and even the best ones leave more than noise.
    NumbersOffAndMore,
    /// The best numbers gain little, and more than noise is left: the form is wrong.
    FormWrong,
}

/// Residual ÷ noise floor up to which the residual counts as noise: the floor is an estimate, and 15 % more is a
/// third more of its energy.
pub const NOISE_RATIO: f64 = 1.15;

/// Residual as given ÷ best from which the numbers are off: a sixth of the energy is theirs.
const NUMBERS_RATIO: f64 = 1.1;

/// Std by which at least one coefficient must then be off: of a dozen right ones one is by chance in 30 records.
const NUMBERS_SIGMA: f64 = 3.0;

impl Error {
    /// Residual ÷ noise floor.
    pub fn ratio(&self) -> f64 {
        if self.noise_floor > 0.0 { self.force_residual / self.noise_floor } else { f64::INFINITY }
    }
}

impl Side {
    /// Energy over frequency (Hz) of what is left over and of the force; empty where the record is too short.
    pub fn spectrum(&self, period: f64) -> Vec<[f64; 3]> {
        let Some(found) = spectrum(&self.left, period) else { return Vec::new() };
        let energies = found.bins.energy.iter().zip(&found.bins.baseline).enumerate();
        energies.map(|(bin, (energy, force))| [(bin + 1) as f64 * found.width, *energy, *force - found.even]).collect()
    }
}

impl Comparison {
    /// What it comes to.
    pub fn verdict(&self) -> Verdict {
        let [given, best] = [&self.given, &self.best].map(|side| &side.error);
        let adequate = |side: &Side| side.judged.map_or(side.error.ratio() <= NOISE_RATIO, |judged| judged.adequate);
        if adequate(&self.given) {
            return Verdict::AtNoise;
        }
        let off = given.force_residual > NUMBERS_RATIO * best.force_residual && self.numbers_differ();
        match (off, adequate(&self.best)) {
            (true, true) => Verdict::NumbersOff,
            (true, false) => Verdict::NumbersOffAndMore,
            (false, true) => Verdict::AtNoise,
            (false, false) => Verdict::FormWrong,
        }
    }

    /// The sentence of a place of failure.
    pub fn sentence(&self, fail: &Fail) -> String {
        let several = self.sources.len() > 1;
        let source = fail.recording.filter(|_| several).and_then(|index| self.sources.get(index));
        fail.sentence(source.map(String::as_str), self.period, &self.units)
    }

    fn numbers_differ(&self) -> bool {
        let pairs = self.given.law.coefficients.iter().zip(&self.best.law.coefficients).zip(&self.best.law.std);
        pairs.into_iter().any(|((given, best), std)| std.is_some_and(|std| (given - best).abs() > NUMBERS_SIGMA * std))
    }
}

/// Compares a model with recordings, each with what its excitation did between samples. `recordings` holds at least
/// one.
pub fn compare(model: &Model, recordings: &[(&Recording, Hold)], options: &Options) -> Comparison {
    let all: Vec<&Recording> = recordings.iter().map(|(recording, _)| *recording).collect();
    let posed = Posed::new(&model.freed(), &all, recordings.first().map(|(_, hold)| *hold));
    compare_posed(model, recordings, posed.as_ref(), options)
}

/// The same where the best of the model's form, [`Model::freed`], has been put to the recordings already; without it
/// the judge says nothing.
pub fn compare_posed(
    model: &Model,
    recordings: &[(&Recording, Hold)],
    posed: Option<&Posed>,
    options: &Options,
) -> Comparison {
    let model = &posed.map_or_else(|| model.clone(), |posed| posed.with_inner(model));
    let terms: Vec<_> = model.terms.iter().map(|entry| entry.term).collect();
    let records: Vec<Record> =
        recordings.iter().map(|(recording, hold)| Record::new(recording, *hold, &terms, &model.expressions)).collect();
    let forced = records.iter().any(|record| record.forced);
    let (as_given, free) = (Held::as_given(model, forced), Held::none(model, forced));
    let window = options.window.unwrap_or_else(|| choose_window(&records, &free));
    let rows: Vec<_> = records.iter().flat_map(|record| record.rows(record.windows(window))).collect();
    let side =
        |held: &Held| side(best_coefficients(held, &rows), &records, &model.expressions, [window, options.horizon]);
    let mut best = side(&free);
    let mut given = if as_given == free { best.clone() } else { side(&as_given) };
    best.judged = posed.and_then(judged);
    // a model without numbers is the best of its form
    given.judged =
        if as_given == free { best.judged } else { posed.and_then(|posed| judged_as_given(posed, &given.law)) };
    for side in [&mut given, &mut best] {
        if side.judged.is_some_and(|judged| judged.adequate) {
            side.fails.clear();
        }
    }
    Comparison {
        sources: records.iter().map(|record| record.source.clone()).collect(),
        holds: recordings.iter().map(|(_, hold)| *hold).collect(),
        noise: records.iter().map(|record| record.noise).collect(),
        window,
        horizon: options.horizon,
        period: periods(&records).displacement,
        forced,
        units: options.units,
        given,
        best,
    }
}

/// What the judge says of the best of a form.
fn judged(posed: &Posed) -> Option<Judged> {
    let (law, errors) = posed.law()?;
    Some(Judged { errors, adequate: are_adequate(&errors), target: law.target })
}

/// What it says of a law whose numbers are held.
fn judged_as_given(posed: &Posed, given: &Estimate) -> Option<Judged> {
    let (best, _) = posed.law()?;
    let target = best.target;
    let law = Law { terms: given.terms.clone(), coefficients: given.coefficients.clone(), ..best };
    let (errors, adequate) = posed.errors_of(&law)?;
    Some(Judged { errors, adequate, target })
}

/// What is summed over recordings before errors are formed.
#[derive(Clone, Copy, Default)]
struct Totals {
    balance: Balance,
    free: Distance,
    diverged: Option<f64>,
    windowed: Distance,
    windows_diverged: bool,
    /// Σ (reading − mean)² by channel.
    spread: [f64; 2],
}

fn side(law: Estimate, records: &[Record], expressions: &[Expression], [window, horizon]: [f64; 2]) -> Side {
    let period = periods(records).displacement;
    let stretch = 2.0 * period;
    let totals: Vec<Totals> =
        records.iter().map(|record| Totals::of(record, &law, expressions, [window, stretch, horizon])).collect();
    let error = totals.iter().fold(Totals::default(), |sum, totals| sum.and(totals)).error();
    let inertia = law.terms.iter().position(|term| *term == Term::Inertia);
    let noisy = error.ratio() <= NOISE_RATIO;
    let left = left_over(records, &law.coefficients, inertia, window);
    let fails = if noisy { Vec::new() } else { locate(&left, period) };
    Side { error, judged: None, fails, left, each: totals.iter().map(Totals::error).collect(), law }
}

impl Totals {
    /// Of one recording; `lengths` are those of the weak windows, of the stretch that gives the initial state, of the
    /// horizon, s.
    fn of(record: &Record, law: &Estimate, expressions: &[Expression], [window, stretch, horizon]: [f64; 3]) -> Totals {
        let mut totals = Totals {
            balance: record.balance(record.windows(window), &law.terms, &law.coefficients),
            ..Totals::default()
        };
        let samples = |length: f64| (length / record.sample_time).round().max(2.0) as usize;
        let motion = Motion::new(&law.terms, &law.coefficients);
        let moves = law.terms.contains(&Term::Inertia);
        for prepared in &record.pieces {
            if let Some(run) = moves.then(|| FreeRun::new(prepared, motion, expressions)).flatten() {
                totals.predict(&run, samples(stretch), samples(horizon));
            }
            for (spread, signal) in totals.spread.iter_mut().zip(prepared.piece.measured()) {
                *spread += signal.map_or(0.0, |values| variance(values) * values.len() as f64);
            }
        }
        totals
    }

    /// Adds a free run and open-loop windows of this many samples.
    fn predict(&mut self, run: &FreeRun, stretch: usize, horizon: usize) {
        match run.whole(stretch) {
            Ok(distance) => self.free = self.free.and(distance),
            Err(t) => self.diverged = self.diverged.or(Some(t)),
        }
        match run.windows(horizon) {
            Ok(distance) => self.windowed = self.windowed.and(distance),
            Err(_) => self.windows_diverged = true,
        }
    }

    fn and(self, other: &Totals) -> Totals {
        Totals {
            balance: self.balance.and(other.balance),
            free: self.free.and(other.free),
            diverged: self.diverged.or(other.diverged),
            windowed: self.windowed.and(other.windowed),
            windows_diverged: self.windows_diverged || other.windows_diverged,
            spread: [self.spread[0] + other.spread[0], self.spread[1] + other.spread[1]],
        }
    }

    fn error(&self) -> Error {
        let measured = |channel: usize| self.spread[channel] > 0.0;
        let first = if measured(0) { 0 } else { 1 };
        let nrmse = |channel: usize| {
            let share = (self.free.squares[channel] / self.spread[channel]).sqrt();
            (self.diverged.is_none() && self.free.count[channel] > 0.0 && measured(channel)).then_some(share)
        };
        Error {
            force_residual: self.balance.force_residual(),
            noise_floor: self.balance.noise_floor(),
            free_run_nrmse: nrmse(first),
            free_run_nrmse_velocity: if first == 0 { nrmse(1) } else { None },
            diverged: self.diverged,
            window_rmse: self.windowed.rms(first).filter(|_| !self.windows_diverged),
        }
    }
}
