//! A diagnosis and the truth side by side.

use super::problem::{Problem, Setting};
use super::secret::{Secret, id};
use rustix::time::{ClockId, clock_gettime};
use switchid::diagnose::{Diagnosis, Evidence, Finding, Fit, Form, Improvement, diagnose_model, error, improve, refit};
use switchid::evidence::Noise;
use switchid::law::{Given, Model, Term};

/// Log-likelihood, nats, that the hidden effect must be worth on the record for it to be seen at all.
const VISIBLE: f64 = 12.0;

/// Log-likelihood, nats, by which an effect of the catalogue must fall short of the truth for it to be another one.
const ALIKE: f64 = 6.0;

/// What a diagnosis came to, against the truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The hidden effects by name; adequate where nothing is hidden; unexplained where the catalogue does not have it.
    Right,
    /// Another effect first, the hidden one in a stated tie with it.
    Tied,
    /// An effect that is not there.
    Wrong,
    /// Adequate, though something is hidden.
    Adequate,
    /// Not in the catalogue, though it is, or though nothing is hidden.
    Unexplained,
    /// No law of the model's form.
    NoLaw,
}

/// An answer with its circumstances.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The answer.
    pub answer: Answer,
    /// Whether this record can show what is hidden: the truth is worth [`VISIBLE`] nats, and nothing in the catalogue comes as near.
    pub visible: bool,
    /// Whether the answer was a tie with the truth in it.
    pub tie: bool,
    /// Held-out error with the right effect ÷ that of the true form.
    pub ratio: Option<f64>,
    /// CPU time of the diagnosis, s.
    pub seconds: f64,
    /// The answer in words.
    pub words: String,
}

/// Diagnoses the record under the model, then looks at the truth.
pub fn judge(setting: &Setting, problem: &Problem) -> Outcome {
    let evidence = Evidence::new(&[(&problem.recording, problem.hold)]);
    let model = Model::of("draw", problem.model.iter().map(|term| (*term, Given::Fit)));
    let start = clock();
    match &setting.secret {
        Secret::Missing(ids) if ids.len() > 1 => judge_several(&model, &evidence, problem, start),
        secret => {
            let found = diagnose_model(&model, &evidence);
            let seconds = clock() - start;
            match found {
                Some(found) => judge_one(secret, &found, &evidence, problem, seconds),
                None => Outcome::without_law(seconds),
            }
        }
    }
}

/// CPU time of this thread, s.
fn clock() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

impl Outcome {
    /// Whether the answer is what it should be.
    pub fn is_right(&self) -> bool {
        self.answer == Answer::Right
    }

    fn without_law(seconds: f64) -> Outcome {
        let words = "no law of the model's form".into();
        Outcome { answer: Answer::NoLaw, visible: true, tie: false, ratio: None, seconds, words }
    }
}

fn judge_one(secret: &Secret, found: &Diagnosis, evidence: &Evidence, problem: &Problem, seconds: f64) -> Outcome {
    let truth = if problem.lacking.is_empty() { "" } else { id(problem.lacking[0]) };
    let expected = match secret {
        Secret::Missing(_) => Finding::Missing,
        Secret::Complete(_) => Finding::Adequate,
        Secret::Outside(_) => Finding::Unexplained,
    };
    let named = found.finding == Finding::Missing && found.effect.as_deref() == Some(truth);
    let tie = found.indistinguishable.iter().any(|group| group.iter().any(|id| id == truth));
    let answer = match found.finding {
        Finding::Missing if named => Answer::Right,
        finding if finding == expected && finding != Finding::Missing => Answer::Right,
        Finding::Missing if tie => Answer::Tied,
        Finding::Missing => Answer::Wrong,
        Finding::Adequate => Answer::Adequate,
        Finding::Unexplained => Answer::Unexplained,
    };
    let oracle = oracle(&found.base, evidence, problem);
    let gain = oracle.as_ref().map_or(0.0, |oracle| oracle.log_likelihood - found.base.log_likelihood);
    let ratio = found.improved.as_ref().filter(|_| named).zip(oracle.as_ref());
    let ratio = ratio.map(|(trial, oracle)| error(&trial.fit, evidence) / error(oracle, evidence));
    let visible = match secret {
        Secret::Missing(_) => gain >= VISIBLE,
        Secret::Complete(_) => true,
        Secret::Outside(_) => gain >= VISIBLE && gain - best_gain(found) >= ALIKE,
    };
    Outcome { answer, visible, tie, ratio, seconds, words: words(found, gain) }
}

fn best_gain(found: &Diagnosis) -> f64 {
    found.candidates.iter().map(|candidate| candidate.gain).fold(0.0, f64::max)
}

/// The true form, fitted from the truth.
fn oracle(base: &Fit, evidence: &Evidence, problem: &Problem) -> Option<Fit> {
    match &problem.relieved {
        Some(relieved) => {
            let relieved = Evidence::new(&[(relieved, problem.hold)]);
            refit(&base.form, &relieved.pieces, &problem.coefficients, base.noise)
        }
        None => complete(problem, &|_| true, base.noise, evidence),
    }
}

/// The model with those of the lacking terms, by position, fitted from the truth.
fn complete(problem: &Problem, wanted: &dyn Fn(usize) -> bool, noise: Noise, evidence: &Evidence) -> Option<Fit> {
    let own = problem.model.len();
    let all = problem.model.iter().chain(&problem.lacking).zip(&problem.coefficients).enumerate();
    let chosen = all.filter(|(index, _)| *index < own || wanted(index - own));
    let (terms, coefficients): (Vec<Term>, Vec<f64>) = chosen.map(|(_, (term, value))| (*term, *value)).unzip();
    let form = terms.iter().fold(Form::new(Vec::new(), Vec::new(), Vec::new()), |form, term| form.with(*term));
    refit(&form, &evidence.pieces, &coefficients, noise)
}

/// Several hidden effects are found when the staircase ends with just these.
fn judge_several(model: &Model, evidence: &Evidence, problem: &Problem, start: f64) -> Outcome {
    let found = improve(model, evidence);
    let seconds = clock() - start;
    let Some(found) = found else { return Outcome::without_law(seconds) };
    let law = &found.steps[found.steps.len() - 1].fit;
    let mut added: Vec<&str> = law.form.terms[problem.model.len()..].iter().map(|term| id(*term)).collect();
    let mut truth: Vec<&str> = problem.lacking.iter().map(|term| id(*term)).collect();
    added.sort_unstable();
    truth.sort_unstable();
    let tie = added != truth && is_tied(&added, &truth, &found);
    let answer = match found.last.finding {
        _ if added == truth => Answer::Right,
        _ if tie => Answer::Tied,
        Finding::Adequate if added.is_empty() => Answer::Adequate,
        Finding::Unexplained if added.iter().all(|id| truth.contains(id)) => Answer::Unexplained,
        Finding::Adequate if added.iter().all(|id| truth.contains(id)) => Answer::Adequate,
        _ => Answer::Wrong,
    };
    let noise = found.steps[0].fit.noise;
    let oracle = complete(problem, &|_| true, noise, evidence);
    let without = |index: usize| {
        complete(problem, &|other| other != index, noise, evidence).map_or(f64::INFINITY, |fit| fit.log_likelihood)
    };
    let gains = oracle.as_ref().map_or(Vec::new(), |oracle| {
        (0..problem.lacking.len()).map(|index| oracle.log_likelihood - without(index)).collect()
    });
    let visible = !gains.is_empty() && gains.iter().all(|gain| *gain >= VISIBLE);
    let left = oracle.as_ref().map_or(f64::INFINITY, Fit::lack);
    let ratio =
        oracle.filter(|_| answer == Answer::Right).map(|oracle| error(law, evidence) / error(&oracle, evidence));
    let steps: Vec<String> =
        found.steps.iter().skip(1).map(|step| format!("{:?} -{:?}", step.effect, step.removed)).collect();
    let last = words(&found.last, gains.iter().copied().fold(f64::INFINITY, f64::min));
    let words =
        format!("steps {}, then {last}; each worth {gains:.1?} nats, together they leave {left:.1}", steps.join(", "));
    Outcome { answer, visible, tie, ratio, seconds, words }
}

/// Whether every effect that is there was added, or stands in a stated tie with one that was.
fn is_tied(added: &[&str], truth: &[&str], found: &Improvement) -> bool {
    let mut others: Vec<&str> = added.iter().filter(|id| !truth.contains(id)).copied().collect();
    let stated = |one: &str, other: &str| {
        let mut groups = found.steps.iter().flat_map(|step| &step.ties);
        groups.any(|group| group.iter().any(|id| id == one) && group.iter().any(|id| id == other))
    };
    let absent = truth.iter().filter(|id| !added.contains(id));
    let all = absent.copied().all(|id| {
        let position = others.iter().position(|other| stated(id, other));
        position.map(|position| others.remove(position)).is_some()
    });
    all && others.is_empty()
}

fn words(found: &Diagnosis, gain: f64) -> String {
    let candidate = |candidate: &switchid::diagnose::Candidate| {
        format!(
            "{} {:.3?} gain {:.1} p {:.0e} share {:.3} c {:.2e}±{:.0e}{}{}",
            candidate.effect,
            candidate.inner.iter().map(|(_, value)| *value).collect::<Vec<_>>(),
            candidate.gain,
            candidate.p_value,
            candidate.share,
            candidate.coefficient,
            candidate.std,
            if candidate.physical { "" } else { " unphysical" },
            if candidate.plausible { "" } else { " implausible" },
        )
    };
    let coefficients: Vec<String> = found.base.coefficients.iter().map(|value| format!("{value:.3e}")).collect();
    let candidates: Vec<String> = found.candidates.iter().take(3).map(candidate).collect();
    format!(
        "{:?} {} beside {:?} ties {:?} explained {:.3} base {} lack {:.1} excess {:.4} truth worth {gain:.1} nats | {}",
        found.finding,
        found.effect.as_deref().unwrap_or("-"),
        found.beside,
        found.indistinguishable,
        found.explained,
        coefficients.join(", "),
        found.base.lack(),
        switchid::diagnose::excess(&found.base),
        candidates.join("; "),
    )
}
