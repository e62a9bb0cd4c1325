//! A diagnosis and the truth side by side.

use super::problem::{Problem, Setting};
use super::secret::{Secret, id};
use super::sensors::Sensors;
use rustix::time::{ClockId, clock_gettime};
use std::ops::Range;
use switchid::diagnose::{
    Candidate, Diagnosis, Finding, Improvement, Posed, Switched, Target, WindowError, diagnose_stages, same_effect,
};
use switchid::law::{Given, Hold, Model, Term};

/// Ratio of held-out errors, with the true law and without, up to which a record shows what is hidden.
const VISIBLE: f64 = 0.9;

/// Most by which the share that an answer explains may differ from the true one.
const HONEST: f64 = 0.1;

/// Natural periods within which the instant of a switch counts as found.
const NEAR: f64 = 1.0;

/// What a diagnosis came to, against the truth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// The hidden effects by name; nothing where nothing is hidden; unexplained, or its share told, where the catalogue
    /// does not have it.
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
    /// Whether this record can show what is hidden: the true law cuts the held-out error by a tenth.
    pub visible: bool,
    /// Whether the answer was a tie with the truth in it.
    pub tie: bool,
    /// Whether the law's switch, and no other, was found; none where it has none, or where this record cannot show it:
    /// the true laws of the stages cut the held-out error of the true form by a tenth.
    pub switch: Option<bool>,
    /// Held-out error with the right effect ÷ that of the true form.
    pub ratio: Option<f64>,
    /// CPU time of the diagnosis, s.
    pub seconds: f64,
    /// The answer in words.
    pub words: String,
}

/// Diagnoses the record under the model, then looks at the truth.
///
/// Where the sensors are a usual rig's, nobody knows the hold, and a complete law leaves what they are: it is right to
/// name nothing.
pub fn judge(setting: &Setting, problem: &Problem) -> Outcome {
    let model = Model::of("draw", problem.model.iter().map(|term| (*term, Given::Fit)));
    let hold = (setting.sensors == Sensors::Ideal).then_some(problem.hold);
    let start = clock();
    if let Some(switch) = problem.switch {
        let found = diagnose_stages(&model, &[&problem.recording], hold);
        return judge_stages(&model, hold, problem, switch, &found, clock() - start);
    }
    let Some(posed) = Posed::new(&model, &[&problem.recording], hold) else {
        return Outcome::without_law(clock() - start);
    };
    match &setting.secret {
        Secret::Missing(ids) if ids.len() > 1 => judge_several(&posed, problem, start),
        secret => {
            let found = posed.diagnose();
            let seconds = clock() - start;
            match found {
                Some(found) => judge_one(setting, secret, &found, (&posed, hold), problem, seconds),
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
        Outcome { answer: Answer::NoLaw, visible: true, tie: false, ratio: None, switch: None, seconds, words }
    }
}

/// Held-out error at the principal window length; where none is told there, at the longest.
fn principal(errors: &[WindowError]) -> f64 {
    let told = |index: usize| Some(errors[index].after).filter(|error| error.is_finite());
    told(1).or(told(2)).unwrap_or(f64::INFINITY)
}

fn judge_one(
    setting: &Setting,
    secret: &Secret,
    found: &Diagnosis,
    (posed, hold): (&Posed, Option<Hold>),
    problem: &Problem,
    seconds: f64,
) -> Outcome {
    let truth = if problem.lacking.is_empty() { "" } else { id(problem.lacking[0]) };
    let named = found.finding == Finding::Missing && found.effect.as_deref() == Some(truth);
    let tie = found.indistinguishable.iter().any(|group| group.iter().any(|id| id == truth));
    let base = posed.errors(&problem.model).map_or(f64::INFINITY, |errors| principal(&errors));
    let true_error = true_error(posed, hold, problem);
    let ideal = setting.sensors == Sensors::Ideal;
    let answer = match (secret, found.finding) {
        (Secret::Missing(_), Finding::Missing) if named => Answer::Right,
        (Secret::Missing(_), Finding::Missing) if tie => Answer::Tied,
        (Secret::Complete(_), Finding::Adequate) => Answer::Right,
        (Secret::Complete(_), Finding::Unexplained) if !ideal => Answer::Right,
        (Secret::Outside(_), Finding::Unexplained) => Answer::Right,
        (Secret::Outside(_), Finding::Missing) if is_honest(found, base, true_error) => Answer::Right,
        (_, Finding::Missing) => Answer::Wrong,
        (_, Finding::Adequate) => Answer::Adequate,
        (_, Finding::Unexplained) => Answer::Unexplained,
    };
    let visible = matches!(secret, Secret::Complete(_)) || true_error <= VISIBLE * base;
    let ratio = named.then(|| principal(&found.errors) / true_error);
    let words = format!("{} | base {base:.4} true {true_error:.4}", words(found));
    Outcome { answer, visible, tie, switch: None, ratio, seconds, words }
}

/// Of a record that switches, the hidden effect is to be named in one stage at least, and none that is not there in
/// another.
fn judge_stages(
    model: &Model,
    hold: Option<Hold>,
    problem: &Problem,
    switch: f64,
    found: &Switched,
    seconds: f64,
) -> Outcome {
    let truth = problem.lacking.first().map_or("", |term| id(*term));
    let diagnoses = found.diagnoses().collect::<Vec<_>>();
    let effects: Vec<&str> = diagnoses.iter().filter_map(|found| found.effect.as_deref()).collect();
    let tied = |found: &&Diagnosis| found.indistinguishable.iter().flatten().any(|id| id == truth);
    let is_named = |found: &&Diagnosis| found.effect.as_deref() == Some(truth);
    let tie = diagnoses.iter().any(&tied);
    let honest = |found: &&Diagnosis| found.effect.is_none() || is_named(found) || tied(found);
    let answer = match found.finding() {
        None => Answer::NoLaw,
        Some(Finding::Adequate) if truth.is_empty() => Answer::Right,
        Some(Finding::Adequate) => Answer::Adequate,
        Some(Finding::Unexplained) => Answer::Unexplained,
        Some(Finding::Missing) if truth.is_empty() || !diagnoses.iter().all(honest) => Answer::Wrong,
        Some(Finding::Missing) if effects.contains(&truth) => Answer::Right,
        Some(Finding::Missing) => Answer::Tied,
    };
    let places: Vec<f64> = found.stages.iter().skip(1).map(|stage| stage.start).collect();
    let period = found.principal().map_or(0.0, |found| found.period);
    let seen = places.len() == 1 && (places[0] - switch).abs() <= NEAR * period;
    let at = index(problem, switch);
    let [whole, before, after] = [0..problem.recording.count(), 0..at, at..problem.recording.count()]
        .map(|part| Part::of(model, hold, problem, part));
    let shows = |part: &Option<Part>| part.as_ref().is_some_and(|part| part.complete <= VISIBLE * part.model);
    let visible = truth.is_empty() || (shows(&before) && shows(&after));
    let switches = whole.zip(before.zip(after)).is_none_or(|(whole, (before, after))| whole.switches(&before, &after));
    let words = diagnoses.iter().map(|found| words(found)).collect::<Vec<_>>().join("\n    ");
    let words = format!("switch {switch:.3}, found {places:.3?}, T₀ {period:.3}\n    {words}");
    Outcome { answer, visible, tie, switch: switches.then_some(seen), ratio: None, seconds, words }
}

/// What the model and the true form leave of a part of a record.
struct Part {
    model: f64,
    complete: f64,
    target: Target,
    samples: f64,
}

impl Part {
    fn of(model: &Model, hold: Option<Hold>, problem: &Problem, range: Range<usize>) -> Option<Part> {
        let samples = range.len() as f64;
        let section = problem.recording.section(range).ok()?;
        let posed = Posed::new(model, &[&section], hold)?;
        let error = |terms: &[Term]| Some(principal(&posed.errors(terms)?));
        let complete = error(&complete(problem, &|_| true))?;
        Some(Part { model: error(&problem.model)?, complete, target: posed.law()?.0.target, samples })
    }

    /// Whether two laws of the true form leave a tenth less than one of it. Errors of other targets are not compared:
    /// the switch counts as shown.
    fn switches(&self, before: &Part, after: &Part) -> bool {
        let energy = |part: &Part| part.samples * part.complete.powi(2);
        let comparable = before.target == self.target && after.target == self.target;
        !comparable || energy(before) + energy(after) <= VISIBLE * VISIBLE * energy(self)
    }
}

/// The first sample of the record from a time on.
fn index(problem: &Problem, t: f64) -> usize {
    problem.recording.t().partition_point(|own| *own < t)
}

/// Whether the share that an answer claims to explain is no more than what it would be of the whole error, within a
/// tenth.
fn is_honest(found: &Diagnosis, base: f64, true_error: f64) -> bool {
    let left = principal(&found.errors);
    let share = (base.powi(2) - left.powi(2)) / (base.powi(2) - true_error.powi(2));
    (found.explained - share).abs() <= HONEST
}

/// What the true law leaves.
fn true_error(posed: &Posed, hold: Option<Hold>, problem: &Problem) -> f64 {
    let errors = match &problem.relieved {
        Some(relieved) => {
            let model = Model::of("relieved", problem.model.iter().map(|term| (*term, Given::Fit)));
            Posed::new(&model, &[relieved], hold).and_then(|posed| posed.errors(&problem.model))
        }
        None => posed.errors(&complete(problem, &|_| true)),
    };
    errors.map_or(f64::INFINITY, |errors| principal(&errors))
}

/// The model's terms with those of the lacking ones, by position.
fn complete(problem: &Problem, wanted: &dyn Fn(usize) -> bool) -> Vec<Term> {
    let lacking = problem.lacking.iter().enumerate().filter(|(index, _)| wanted(*index));
    problem.model.iter().copied().chain(lacking.map(|(_, term)| *term)).collect()
}

/// Several hidden effects are found when the staircase ends with just these.
fn judge_several(posed: &Posed, problem: &Problem, start: f64) -> Outcome {
    let found = posed.improve();
    let seconds = clock() - start;
    let Some(found) = found else { return Outcome::without_law(seconds) };
    let Some(last) = found.steps.last() else { return Outcome::without_law(seconds) };
    let own = |term: &Term| problem.model.iter().any(|other| same_effect(*term, *other));
    let mut added: Vec<&str> = last.law.terms.iter().filter(|term| !own(term)).map(|term| id(*term)).collect();
    let mut truth: Vec<&str> = problem.lacking.iter().map(|term| id(*term)).collect();
    added.sort_unstable();
    truth.sort_unstable();
    let tie = added != truth && is_tied(&added, &truth, &found);
    let answer = match found.last.finding {
        _ if added == truth => Answer::Right,
        _ if tie => Answer::Tied,
        Finding::Unexplained if added.iter().all(|id| truth.contains(id)) => Answer::Unexplained,
        Finding::Adequate if added.iter().all(|id| truth.contains(id)) => Answer::Adequate,
        _ => Answer::Wrong,
    };
    let error = |terms: &[Term]| posed.errors(terms).map_or(f64::INFINITY, |errors| principal(&errors));
    let whole = error(&complete(problem, &|_| true));
    let shows = |index: usize| whole <= VISIBLE * error(&complete(problem, &|other| other != index));
    let visible = (0..problem.lacking.len()).all(shows);
    let ratio = (answer == Answer::Right).then(|| principal(&last.errors) / whole);
    let steps: Vec<String> =
        found.steps.iter().map(|step| format!("{:?} {:?} {:.4}", step.effect, step.ties, step.error())).collect();
    let words = format!("steps {}, then {} | true {whole:.4}", steps.join(", "), words(&found.last));
    Outcome { answer, visible, tie, switch: None, ratio, seconds, words }
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

fn words(found: &Diagnosis) -> String {
    let candidate = |candidate: &Candidate| {
        let inner: Vec<f64> = candidate.inner.iter().map(|(_, value)| *value).collect();
        let after = candidate.errors.map(|error| error.after);
        format!(
            "{} {inner:.3?} S {:.3} {after:.4?} p {:?} R² {:.3} c {:.2e}±{:.0e} {:?}",
            candidate.effect,
            candidate.score,
            candidate.p_value,
            candidate.resemblance,
            candidate.coefficient,
            candidate.std,
            candidate.doubt,
        )
    };
    let candidates: Vec<String> = found.candidates.iter().take(3).map(candidate).collect();
    let errors = found.errors.map(|error| [error.before, error.floor]);
    format!(
        "{:?} {} ties {:?} explained {:.3} before, floor {errors:.4?} {:?} {:?} | {}",
        found.finding,
        found.effect.as_deref().unwrap_or("-"),
        found.indistinguishable,
        found.explained,
        found.base.target,
        found.base.timing,
        candidates.join("; "),
    )
}
