//! What a segment holds: the estimate of its law, what the last filter run said of it, and the run under way.

use super::convergence::Convergence;
use super::motion_scales::MotionScales;
use super::prior::InertiaPrior;
use crate::estimation::{
    AddedEffect, EffectPosterior, Information, KnownEffect, Lacked, LagTest, Missing, Noise, OwnTerms, Pass,
    SandwichFactor, ScoreTest, Solution, TermSelection, TermsAnew, ToldLag, WithAndWithout,
};
use crate::identify::library::Estimate;
use crate::identify::problem::Problem;
use crate::identify::validation::{Constancy, Stability};
use crate::law::Term;
use serde::{Deserialize, Serialize};

/// For how many samples the sensor noise of the last segment counts in the next one: free to follow the innovations, it
/// collapses on one channel under white excitation (docs/decisions/prediction-error-method.md).
pub const NOISE_MEMORY: f64 = 500.0;

/// An estimate of one segment's law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Segment {
    /// Number of the sample at which the segment's record begins.
    pub start: u64,
    /// Free coefficients.
    pub coefficients: Vec<f64>,
    /// Its terms: the model's and, last, an effect that the model lacks.
    pub terms: Vec<Term>,
    /// All coefficients, that of the effect which the model lacks the last.
    pub all: Vec<f64>,
    /// Which free terms the law has.
    pub active: Vec<bool>,
    /// Noise levels.
    pub noise: Noise,
    /// Covariance of the active coefficients.
    pub solution: Solution,
    /// What the closed run, the prior included, says about `coefficients`.
    pub information: Information,
    /// How large accelerations and their slopes were in the last closed run.
    pub scales: MotionScales,
    /// How well the law explains its record, as of the last closed run.
    pub fit: Fit,
    /// How many runs there were.
    pub runs: Runs,
    /// The effect that the law lacks most, as of the last run that looked for one.
    pub missing: Option<Missing>,
    /// One that a run named, and with which the law has not been tried.
    pub untried: Option<Lacked>,
    /// By how much the free coefficients are others with it.
    pub untried_step: Vec<f64>,
    /// When F acted, as that run told.
    pub timing: OpenTiming,
    /// What is known beside the record.
    pub(super) known: Known,
    /// The run under way.
    pub(super) run: Run,
    /// Effects that the law lacks, tested beside a run.
    pub(super) score_test: MissingEffects,
    pub(super) convergence: Convergence,
    pub(super) selection: TermSelection,
    pub(super) stability: Stability,
    pub(super) constancy: Constancy,
    /// The coefficients before the last step, then that step.
    pub(super) step: Vec<f64>,
}

/// What a record says of when F acted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OpenTiming {
    /// The lag beyond the one assumed.
    pub told: ToldLag,
    /// Mean square of it that this leaves open.
    pub(super) open: f64,
    /// The same lag with every term that the law may have: one that it lacks, or has wrongly, may hide it.
    pub(super) whole: ToldLag,
}

/// How well a law explains its record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Fit {
    /// The Gauss–Newton decrement of the last run ÷ number of active coefficients.
    pub decrement: f64,
    /// What another level of process noise would add to the log-likelihood of the last run.
    pub gain: f64,
    /// Log-likelihood per measurement of the last run.
    pub likelihood: f64,
    /// Whether the record speaks for process noise: the law does not explain it down to the sensors' noise.
    pub process_matters: bool,
    /// Whether the law carries the state through the whole record, with no error that lasts.
    pub explains: bool,
    /// Factor by which error that lasts makes the covariance larger than stated; 1 where the law explains its record.
    pub overdispersion: f64,
}

/// Counts of filter runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Runs {
    /// Closed in this segment.
    pub closed: u32,
    /// In a row that left what can be integrated.
    pub(super) astray: u32,
    /// In a row that changed little.
    pub(super) calm: u32,
    /// In a row after which the estimate had not settled.
    pub restless: u32,
}

/// What is known beside the record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Known {
    /// On the coefficients, about `coefficients`.
    pub(super) information: Information,
    /// On the inertia.
    pub(super) inertia: Option<InertiaPrior>,
    /// Sensor variances.
    pub(super) noise: [f64; 2],
    /// How large the motion was.
    pub(super) scales: MotionScales,
    /// Samples that these variances and scales count for.
    pub(super) weight: f64,
    /// Samples of this stage whose information is part of the one above, the record having outgrown the window.
    pub(super) folded: u64,
}

/// A filter run over the segment's record, and what is summed up beside it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Run {
    pub(super) filter_run: Pass,
    /// When F acted, by that run.
    pub(super) lag: LagTest,
    /// The effect that the model lacks, where the law has it.
    pub(super) effect: AddedEffect,
    /// Number of the sample that comes next.
    pub(super) next: u64,
    /// Number of the sample that the last run ended with.
    pub(super) closed_at: u64,
    /// Largest magnitude measured by channel.
    pub(super) largest: [f64; 2],
    pub(super) scales: MotionScales,
    pub(super) sandwich: SandwichFactor,
    pub(super) checkpoint: Checkpoint,
}

/// Information from the first half of a long record, to be folded into the prior.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Checkpoint {
    pub(super) at: Option<u64>,
    pub(super) information: Information,
    pub(super) effect: AddedEffect,
}

/// The test for effects that the law lacks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct MissingEffects {
    /// Beside every run: the law in use takes it over.
    pub(super) candidates: ScoreTest,
    /// What the run says of the law's own terms and of its effect.
    pub(super) own: OwnTerms,
    /// Variance of that effect's coefficient beside any one more term that the law may have.
    pub(super) beside_another: f64,
    /// The effect that explained most in the last run, named or not.
    pub(super) likeliest: Option<Lacked>,
    /// What the last run that had settled says of the law's effect, and where it is asked.
    pub(super) posterior: EffectPosterior,
    pub(super) laws: WithAndWithout,
    /// Room for the choice of terms with an effect.
    pub(super) anew: TermsAnew,
    /// Length of the record from which on the law is tried with an effect …
    pub(super) next_try: u64,
    /// … and, where it does not explain the record, with all error in the sensors.
    pub(super) next_look: u64,
    /// Beside a run that looks, where the law's error is taken for process noise: with all error in the sensors the
    /// record tells when F acted.
    pub(super) in_the_sensors: InTheSensors,
}

/// A run with all error in the sensors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct InTheSensors {
    pub(super) filter_run: Pass,
    pub(super) noise: Noise,
    pub(super) lag: LagTest,
    pub(super) told: ToldLag,
    /// Whether there is one.
    pub(super) running: bool,
}

impl OpenTiming {
    /// Of `n` free terms of which no record has told anything.
    pub(super) fn unknown(n: usize) -> OpenTiming {
        OpenTiming { told: ToldLag::none(n), open: 0.0, whole: ToldLag::none(n) }
    }

    /// Nothing has been told.
    pub(super) fn clear(&mut self) {
        self.open = 0.0;
        self.told.clear();
        self.whole.clear();
    }
}

impl Fit {
    /// Of a law that no run has told anything of.
    fn unknown() -> Fit {
        Fit {
            decrement: f64::INFINITY,
            gain: f64::INFINITY,
            likelihood: f64::NEG_INFINITY,
            process_matters: false,
            explains: false,
            overdispersion: 1.0,
        }
    }
}

impl Segment {
    /// Room for the problem.
    pub fn new(problem: &Problem) -> Segment {
        let n = problem.n();
        Segment {
            start: 0,
            coefficients: vec![0.0; n],
            terms: problem.terms_and_effect(),
            all: problem.known.clone(),
            active: vec![true; n],
            noise: Noise { sensor: [1.0; 2], process: 1.0 },
            solution: Solution::none(n),
            information: Information::none(n),
            scales: MotionScales::new(n),
            fit: Fit::unknown(),
            runs: Runs::default(),
            missing: None,
            untried: None,
            untried_step: vec![0.0; n],
            timing: OpenTiming::unknown(n),
            known: Known {
                information: Information::none(n),
                inertia: None,
                noise: [0.0; 2],
                scales: MotionScales::new(n),
                weight: 0.0,
                folded: 0,
            },
            run: Run {
                filter_run: Pass::new(n).gated(),
                lag: LagTest::new(n),
                effect: AddedEffect::new(n),
                next: 0,
                closed_at: 0,
                largest: [0.0; 2],
                scales: MotionScales::new(n),
                sandwich: SandwichFactor::new(n),
                checkpoint: Checkpoint { at: None, information: Information::none(n), effect: AddedEffect::new(n) },
            },
            score_test: MissingEffects {
                candidates: ScoreTest::new(&problem.terms, n),
                own: OwnTerms::none(n),
                beside_another: f64::INFINITY,
                likeliest: None,
                posterior: EffectPosterior::default(),
                laws: WithAndWithout::none(n),
                anew: TermsAnew::new(n),
                next_try: 0,
                next_look: 0,
                in_the_sensors: InTheSensors {
                    filter_run: Pass::new(n),
                    noise: Noise { sensor: [1.0; 2], process: 1.0 },
                    lag: LagTest::new(n),
                    told: ToldLag::none(n),
                    running: false,
                },
            },
            convergence: Convergence::new(n),
            selection: TermSelection::new(n),
            stability: Stability::new(problem.terms.len()),
            constancy: Constancy::new(n),
            step: vec![0.0; n],
        }
    }

    /// Its coefficients without that of the effect which the model lacks.
    pub fn own(&self) -> &[f64] {
        &self.all[..self.all.len() - 1]
    }

    /// The coefficient of the effect that the model lacks; 0 where the law does not have it.
    pub fn effect(&self) -> f64 {
        self.all[self.all.len() - 1]
    }

    /// Whether a law of those terms, whose effect has that coefficient, has the same effect as this one, or none too.
    pub fn has_terms_of(&self, terms: &[Term], effect: f64) -> bool {
        match [self.effect(), effect].map(|coefficient| coefficient != 0.0) {
            [true, true] => self.terms == terms,
            [own, other] => own == other,
        }
    }

    /// That effect as the next record takes it: known from as many samples as the sensors' noise is.
    pub fn known_effect(&self) -> Option<KnownEffect> {
        let (coefficient, term) = (self.effect(), self.terms[self.terms.len() - 1]);
        let part = (NOISE_MEMORY / self.length(self.run.closed_at).max(1) as f64).min(1.0);
        let precision = part / self.run.effect.variance(&self.solution, &self.active);
        (coefficient != 0.0).then_some(KnownEffect { term, coefficient, precision })
    }

    /// The law has the effect that the model lacks, or none.
    pub fn add_effect(&mut self, known: Option<KnownEffect>) {
        let place = self.terms.len() - 1;
        self.all[place] = known.map_or(0.0, |known| known.coefficient);
        if let Some(known) = known {
            self.terms[place] = known.term;
            self.run.effect.suppose(&known);
        }
    }

    /// Number of samples in the stage's record up to `end`.
    pub fn length(&self, end: u64) -> u64 {
        end.saturating_sub(self.start)
    }

    /// Number of samples that the estimate rests on: those of the record and those before it.
    pub fn samples(&self) -> u64 {
        self.known.folded + self.length(self.run.next)
    }

    /// Number of the sample that the last pass ended with.
    pub fn closed_at(&self) -> u64 {
        self.run.closed_at
    }

    /// Std of the free coefficient, with what its record leaves open of when F acted; infinite where the data do not
    /// determine it.
    pub fn std(&self, free: usize) -> f64 {
        self.solution.std(free, self.fit.overdispersion).hypot(self.timing.open.sqrt() * self.timing.told.slope[free])
    }

    /// The variance that the estimate states for e of eq. (8), relative: Σ std² ÷ Σθ².
    pub fn stated_error(&self) -> f64 {
        let squares: f64 = self.own().iter().map(|value| value * value).sum();
        let active = (0..self.active.len()).filter(|index| self.active[*index]);
        active.map(|index| self.std(index).powi(2)).sum::<f64>() / squares
    }

    /// Variance of the same kind that no std holds: what the record leaves open of when F acted were the law to have
    /// every term that it may have, beyond what it leaves open with the law's own.
    pub fn untold_error(&self, problem: &Problem) -> f64 {
        let OpenTiming { open, whole, .. } = &self.timing;
        self.error_of(&whole.slope, (problem.timing.left_open(&whole.lag) - open).max(0.0))
    }

    /// What a lag of that square, in squares of a sample, makes of e.
    pub fn error_of_lag(&self, square: f64) -> f64 {
        self.error_of(&self.timing.told.slope, square)
    }

    fn error_of(&self, slope: &[f64], square: f64) -> f64 {
        let squares = |values: &[f64]| values.iter().map(|value| value * value).sum::<f64>();
        square * squares(slope) / squares(self.own())
    }

    /// The law as the library keeps it.
    pub fn estimate(&self) -> Estimate<'_> {
        Estimate {
            coefficients: &self.coefficients,
            active: &self.active,
            noise: self.noise,
            information: &self.information,
            overdispersion: self.fit.overdispersion,
        }
    }
}
