//! Recordings under judgement, and a law's standing on them.

use super::errors::{TIE, WindowError, are_adequate, errors};
use super::law::Law;
use crate::diagnose::judge::{
    Blocks, Bootstrap, COUNT, Equation, Estimate, Folds, HeldOut, Record, Target, Timing, Trial, estimate, floor,
    floor_of_law, instrumented, noise_share,
};
use crate::identify::Recording;
use crate::law::{Effect, Expression, Hold, Inner, Term};
use std::cell::OnceCell;

/// Std by which the instruments' value must differ for least squares to be biased.
const BIASED: f64 = 2.0;

/// Ratio between the delays that are tried, and steps in which the best is refined.
const GROWTH: f64 = 1.6;
/// … by halves of what is between them.
const STEPS: usize = 2;

/// Delay, in T₀, up to which its column alone takes it: the next term of the series is then 5 % of it.
const SERIES: f64 = 0.05;

/// Delay, in sample times, that is not worth another look.
const SMALL: f64 = 0.02;

/// Noise ÷ signal of the inertia term up to which it may be a regressor: the bias of 1e-4 that it brings is below any
/// other.
const NEGLIGIBLE: f64 = 0.01;

/// Largest delay of the excitation that is sought, in T₀: beyond it a periodic motion repeats itself.
const LONGEST: f64 = 0.3;

/// Recordings of one system, ready for any law.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Case {
    pub(in crate::diagnose) record: Record,
    pub(in crate::diagnose) folds: Folds,
    /// Its motion as the sensors would read it again.
    bootstrap: Bootstrap<Record>,
    /// Which column stands alone, whatever the candidates.
    pub(in crate::diagnose) target: Target,
    /// What the excitation did between samples, where the user says so.
    hold: Option<Hold>,
    /// The inertia of a free motion.
    pub(in crate::diagnose) inertia: f64,
    /// The record as its even and as its odd readings show it, once it was asked for.
    halves: OnceCell<Option<[Record; 2]>>,
}

/// A law on a record.
#[derive(Clone, Debug)]
pub(in crate::diagnose) struct Standing {
    pub(in crate::diagnose) equation: Equation,
    pub(in crate::diagnose) held: HeldOut,
    pub(in crate::diagnose) estimate: Estimate,
    /// What the sensors alone would leave of the error, by window length.
    pub(in crate::diagnose) floor: [f64; COUNT],
    pub(in crate::diagnose) blocks: Blocks,
}

impl Case {
    /// Of recordings, for laws of about these terms; `inertia` is that of a free motion. None where nothing moves or
    /// all is too short.
    pub(in crate::diagnose) fn new(
        recordings: &[&Recording],
        terms: &[Term],
        expressions: &[Expression],
        hold: Option<Hold>,
        inertia: f64,
    ) -> Option<Case> {
        let is_output = !terms.contains(&Term::Inertia);
        let mut record = Record::new(recordings, expressions)?;
        record.is_output = is_output;
        let bootstrap = Bootstrap::of(&record, record.force_noise(is_output))?;
        let folds = Folds::new(&record);
        let mut case =
            Case { record, folds, bootstrap, target: Target::Inertia, hold, inertia, halves: OnceCell::new() };
        if is_output {
            case.target = Target::Force;
        } else if case.record.forced {
            case.target = case.noisier();
        }
        Some(case)
    }

    /// The inertia term where its propagated noise is worth the word: as a regressor it would bias its own coefficient
    /// by the square of its noise ÷ signal. Else the force, for there are forces that no term has.
    fn noisier(&self) -> Target {
        let noise = noise_share(&self.bootstrap);
        if noise > NEGLIGIBLE { Target::Inertia } else { Target::Force }
    }

    /// A law of these terms with the hold that suits it, a little delay of the excitation refitted beside it; what is
    /// held out is predicted under the hold that suits the rest of the record. None where the record is too short for
    /// it.
    pub(in crate::diagnose) fn stand(&self, terms: &[Term]) -> Option<Standing> {
        let (all, usual) = self.tried(terms);
        let held: Vec<&HeldOut> = all.iter().map(|own| &own.judged).collect();
        let held = HeldOut::by_part(&self.folds, &held, usual, TIE);
        self.standing(all.into_iter().nth(usual)?.equation, held)
    }

    /// When the excitation acts by the hold that suits a law.
    fn timed(&self, terms: &[Term]) -> Timing {
        let (all, usual) = self.tried(terms);
        all.get(usual).map_or_else(|| own_timing(terms, Hold::Linear), |own| own.equation.timing)
    }

    /// A law under every hold, each with the little delay that suits it, and which suits it best: a wrong hold and half
    /// a sample's delay look alike, so that of equally good ones that with the least delay is taken.
    fn tried(&self, terms: &[Term]) -> (Vec<Held>, usize) {
        let all: Vec<Held> = self.holds().into_iter().map(|hold| self.held(terms, hold)).collect();
        let errors: Vec<f64> = all.iter().map(|own| error(&own.judged)).collect();
        let least = errors.iter().copied().fold(f64::INFINITY, f64::min);
        let ties = (0..all.len()).filter(|index| errors[*index] <= least + TIE);
        let usual = ties.min_by(|a, b| all[*a].late.total_cmp(&all[*b].late)).unwrap_or(0);
        (all, usual)
    }

    fn held(&self, terms: &[Term], hold: Hold) -> Held {
        let own = own_timing(terms, hold);
        let timing = self.centred(terms, own);
        let equation = Equation::new(&self.record, terms, self.target, timing, true);
        let judged = self.folds.judge(&equation);
        let more = self.estimate(&equation, &judged).and_then(|found| found.delay).map_or(0.0, |[step, _]| step);
        Held { equation, judged, late: (timing.delay + more - own.delay).abs() }
    }

    /// The law with the hold that suits it best, and no more delay than it has itself.
    pub(in crate::diagnose) fn punctual(&self, terms: &[Term]) -> Equation {
        let at = |hold: Hold| Equation::new(&self.record, terms, self.target, own_timing(terms, hold), false);
        let all = self.holds().into_iter().map(at).map(|equation| (error(&self.folds.judge(&equation)), equation));
        let best = all.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or_else(|| at(Hold::Linear), |(_, equation)| equation)
    }

    /// What the excitation may have done between samples.
    fn holds(&self) -> Vec<Hold> {
        match self.hold {
            Some(hold) => vec![hold],
            None if self.record.forced => vec![Hold::Linear, Hold::Zero, Hold::BandLimited],
            None => vec![Hold::Linear],
        }
    }

    /// The timing about which what is left of a delay is small: its column is only the first term of a series.
    fn centred(&self, terms: &[Term], timing: Timing) -> Timing {
        if !self.record.forced {
            return timing;
        }
        let at = |delay: f64| Equation::new(&self.record, terms, self.target, Timing { delay, ..timing }, true);
        let reach = SERIES * self.record.period;
        let first = at(timing.delay);
        let step = self.estimated(first.clone()).and_then(|found| found.delay).map_or(0.0, |[step, _]| step);
        if step.abs() < SMALL * self.record.sample_time {
            return timing;
        }
        let delay = timing.delay + step.clamp(-reach, reach);
        let better = self.folds.judge(&at(delay)).score(&self.folds.judge(&first)) < 0.0;
        if better { Timing { delay, ..timing } } else { timing }
    }

    /// The law with the delay of the excitation, up to three tenths of T₀, under which it explains most; none where its
    /// inertia would be negative: half a period of delay turns a law round.
    pub(in crate::diagnose) fn delayed(&self, terms: &[Term]) -> Option<f64> {
        let hold = self.timed(terms).hold;
        let at = |delay: f64| Equation::new(&self.record, terms, self.target, Timing { hold, delay, lag: 0.0 }, true);
        let longest = LONGEST * self.record.period;
        let sizes = std::iter::successors(Some(self.record.sample_time), |size| Some(GROWTH * size));
        let judged = |delay: f64| self.folds.judge(&at(delay));
        let first = judged(0.0);
        let tried = sizes.take_while(|size| *size < longest).map(|delay| (judged(delay).score(&first), delay));
        let (score, delay) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let refined = (0..STEPS).fold(delay, |delay, _| {
            let step = self.estimated(at(delay)).and_then(|found| found.delay).map_or(0.0, |[step, _]| step);
            (delay + step.clamp(-0.5 * delay, 0.5 * delay)).min(longest)
        });
        let refined = if judged(refined).score(&first) < score { refined } else { delay };
        self.is_forward(at(refined)).then_some(refined)
    }

    /// The time constant of an actuator's lag, about as late as a delay of that many s, under which the law explains
    /// most.
    pub(in crate::diagnose) fn lagged(&self, terms: &[Term], late: f64) -> f64 {
        let hold = self.timed(terms).hold;
        let at = |lag: f64| Equation::new(&self.record, terms, self.target, Timing { hold, delay: 0.0, lag }, true);
        let judged = |lag: f64| self.folds.judge(&at(lag));
        let first = judged(late);
        let best = |middle: f64, ratio: f64| {
            let tried = (-2..=2).map(|power| middle * f64::powi(ratio, power));
            let scored = tried.map(|lag| (judged(lag).score(&first), lag));
            scored.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(middle, |(_, lag)| lag)
        };
        best(best(late, GROWTH), GROWTH.cbrt())
    }

    /// Whether the inertia is positive.
    fn is_forward(&self, equation: Equation) -> bool {
        let place = equation.terms.iter().position(|term| *term == Term::Inertia);
        let found = self.estimated(equation);
        place.is_none_or(|index| found.is_some_and(|found| found.coefficients[index] > 0.0))
    }

    pub(in crate::diagnose) fn estimated(&self, equation: Equation) -> Option<Estimate> {
        self.estimate(&equation, &self.folds.judge(&equation))
    }

    fn estimate(&self, equation: &Equation, judged: &HeldOut) -> Option<Estimate> {
        estimate(&self.record, equation, &Blocks::new(&self.record, judged), self.inertia)
    }

    /// A law of these terms at that timing.
    pub(in crate::diagnose) fn at(&self, terms: &[Term], timing: Timing) -> Option<Standing> {
        self.of(Equation::new(&self.record, terms, self.target, timing, true))
    }

    /// The law of an equation.
    pub(in crate::diagnose) fn of(&self, equation: Equation) -> Option<Standing> {
        let held = self.folds.judge(&equation);
        self.standing(equation, held)
    }

    fn standing(&self, equation: Equation, held: HeldOut) -> Option<Standing> {
        let blocks = Blocks::new(&self.record, &held);
        let estimate = estimate(&self.record, &equation, &blocks, self.inertia)?;
        let (coefficients, solutions) = (&estimate.coefficients, &estimate.solutions);
        let (errors, folds) = (&held.errors, Some(&self.folds));
        let floor = floor(&Trial { equation: &equation, coefficients, solutions, errors, folds }, &self.bootstrap);
        Some(Standing { equation, held, estimate, floor, blocks })
    }

    /// The same standing beside what the sensors leave of the motion that the law itself makes, where more is left than
    /// of a smooth one.
    pub(in crate::diagnose) fn settled(&self, standing: Standing) -> Standing {
        if are_adequate(&self.errors_of(&standing)) {
            return standing;
        }
        let Standing { equation, held: HeldOut { errors, .. }, estimate, .. } = &standing;
        let (coefficients, solutions) = (&estimate.coefficients, &estimate.solutions);
        let trial = Trial { equation, coefficients, solutions, errors, folds: Some(&self.folds) };
        let floor = self.raised(&trial, standing.floor);
        Standing { floor, ..standing }
    }

    /// The floor, or that of a law that makes the motion itself, where it is higher.
    fn raised(&self, trial: &Trial, floor: [f64; COUNT]) -> [f64; COUNT] {
        let force = self.record.force_noise(self.record.is_output);
        let own = floor_of_law(trial, &self.record, force).unwrap_or(floor);
        std::array::from_fn(|which| floor[which].max(own[which]))
    }

    /// Errors of a law whose numbers are held, over all windows, and whether they are what the sensors alone would
    /// leave.
    pub(in crate::diagnose) fn errors_as_given(&self, law: &Law) -> Option<([WindowError; COUNT], bool)> {
        let equation = &Equation::new(&self.record, &law.terms, self.target, law.timing, false);
        let solution = equation.solution(&law.coefficients, self.record.forced)?;
        let solutions = &[solution.clone(), solution.clone(), solution];
        let held = HeldOut::as_given(equation, solutions);
        let trial = Trial { equation, coefficients: &law.coefficients, solutions, errors: &held.errors, folds: None };
        let first = floor(&trial, &self.bootstrap);
        let mut errors = errors(&self.record, &held, &held, &first);
        if !are_adequate(&errors) {
            errors = super::errors::errors(&self.record, &held, &held, &self.raised(&trial, first));
        }
        Some((errors, are_adequate(&errors)))
    }

    /// Held-out errors of a law, by window length.
    pub(in crate::diagnose) fn errors_of(&self, standing: &Standing) -> [WindowError; COUNT] {
        errors(&self.record, &standing.held, &standing.held, &standing.floor)
    }

    /// A law with its numbers: those of the robust regression, or where even and odd readings as instruments differ
    /// from them by more than two std, the instruments'.
    pub(in crate::diagnose) fn law(&self, standing: &Standing) -> Law {
        let law = Law::of(&self.record, &standing.equation, &standing.estimate);
        self.unbiased(standing, &law).unwrap_or(law)
    }

    /// The law with the coefficients that its instruments give, where least squares is biased.
    fn unbiased(&self, standing: &Standing, law: &Law) -> Option<Law> {
        let equation = &standing.equation;
        let halves = self.halves.get_or_init(|| self.record.halves()).as_ref()?;
        let same = |other: &Record| Equation::new(other, &equation.terms, self.target, equation.timing, true);
        let found = instrumented(&self.record, &[same(&halves[0]), same(&halves[1])], &standing.blocks)?;
        let (coefficients, slopes) = equation.coefficients(&found.solution, self.record.forced, self.inertia);
        let spread = |slope: &Vec<f64>| {
            slope.iter().zip(&found.std).map(|(slope, std)| (slope * std).powi(2)).sum::<f64>().sqrt()
        };
        let std: Vec<f64> = slopes.iter().map(spread).collect();
        let differs = |index: &usize| (coefficients[*index] - law.coefficients[*index]).abs() > BIASED * std[*index];
        let biased: Vec<Term> =
            (0..std.len()).filter(|index| std[*index] > 0.0).filter(differs).map(|i| law.terms[i]).collect();
        if biased.is_empty() {
            return None;
        }
        // halves of a coarsely sampled motion no longer show it: the judge must see no difference
        let unbiased = Law { coefficients, std, biased, ..law.clone() };
        let [own, other] = [self.errors_as_given(&unbiased)?.0, self.errors_as_given(law)?.0];
        let worse = own.iter().zip(&other).map(|(own, other)| (own.after / other.after).ln());
        (worse.filter(|worse| !worse.is_nan()).sum::<f64>() <= TIE * COUNT as f64).then_some(unbiased)
    }
}

/// A law under one hold of the excitation.
struct Held {
    equation: Equation,
    judged: HeldOut,
    /// How far the delay that suits it is from the law's own, s.
    late: f64,
}

/// Σ ln held-out error over the window lengths.
fn error(judged: &HeldOut) -> f64 {
    judged.errors.iter().filter(|error| error.is_finite()).map(|error| error.ln()).sum()
}

/// When the excitation acts by a law's own terms.
fn own_timing(terms: &[Term], hold: Hold) -> Timing {
    let effects = || terms.iter().filter_map(|term| term.effect());
    let delay =
        effects().find_map(|effect| if let Effect::ExcitationDelay { delay } = effect { Some(delay) } else { None });
    let lag = effects().find_map(|effect| if let Effect::ActuatorLag { time } = effect { Some(time) } else { None });
    let [delay, lag] = [delay, lag].map(|inner| inner.map_or(0.0, Inner::value));
    Timing { hold, delay, lag }
}
