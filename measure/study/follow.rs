//! An identifier stepped through a record, beside the truth that it does not see.

use super::Failure;
use serde::{Deserialize, Serialize};
use switchid::identify::{Coefficient, Identifier, Sample};
use switchid::law::Term;
use switchid::simulate::{Reading, Scenario};

/// A law is right once e stays below this.
pub const RIGHT: f64 = 0.05 * 0.05;

/// What an error beyond all numbers counts as.
const BEYOND: f64 = 1e12;

/// One stage, as an identifier saw it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stage {
    /// From the switch to the first alarm of the stage, s; the first stage has none.
    pub detection: Option<f64>,
    /// From the switch until e stays below 0.05² to the stage's end, s.
    pub tracking: Option<f64>,
    /// From the switch until its law is validated, s.
    pub validated: Option<f64>,
    /// e of eq. (8) at its last sample.
    pub error: f64,
    /// Largest e while its law is validated.
    pub worst: f64,
    /// Share of its samples at which its law is validated and e is above 0.05².
    pub wrong: f64,
    /// Share of its samples at which a law is validated without an alarm since the switch, and e is above 0.05².
    pub stale: f64,
    /// (θ − θ*) ÷ std of the coefficients last validated; none where the law never was.
    pub normalised: Vec<f64>,
    /// The same of whatever has a std at the stage's end, validated or not, its switch detected or not.
    pub stated: Vec<f64>,
    /// Share of the coefficients that have a std then.
    pub told: f64,
}

/// A whole record, as an identifier saw it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Stage by stage.
    pub stages: Vec<Stage>,
    /// Alarms that are no detection.
    pub false_alarms: usize,
}

/// What is measured at an instant.
pub fn sample(reading: &Reading) -> Sample {
    Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation }
}

/// e of eq. (8): inertia and all active terms counted, absent ones with truth 0, the excitation's fixed 1 not.
pub fn error(published: &[Coefficient], terms: &[Term], truth: &[f64]) -> f64 {
    let difference: f64 = published.iter().map(|known| (known.value - of(known.term, terms, truth)).powi(2)).sum();
    (difference / truth.iter().map(|value| value * value).sum::<f64>()).min(BEYOND)
}

fn of(term: Term, terms: &[Term], truth: &[f64]) -> f64 {
    terms.iter().position(|other| *other == term).map_or(0.0, |index| truth[index])
}

fn normalised(published: &[Coefficient], terms: &[Term], truth: &[f64]) -> Vec<f64> {
    let known = published.iter().filter_map(|known| Some((known, known.std.filter(|std| *std > 0.0)?)));
    known.map(|(known, std)| ((known.value - of(known.term, terms, truth)) / std).clamp(-BEYOND, BEYOND)).collect()
}

/// Steps through all readings of a scenario.
///
/// # Errors
/// A sample that was not accepted.
pub fn follow(identifier: &mut Identifier, scenario: &Scenario, readings: &[Reading]) -> Result<Run, Failure> {
    let mut run = Run { stages: Vec::new(), false_alarms: 0 };
    let ends = scenario.switch_times().into_iter().chain([f64::INFINITY]);
    let mut rest = readings;
    for (index, end) in ends.enumerate() {
        let (own, later) = rest.split_at(rest.partition_point(|reading| reading.t < end));
        let mut watch = Watch::new(identifier, scenario, index);
        own.iter().try_for_each(|reading| watch.step(identifier, reading))?;
        run.false_alarms += watch.false_alarms();
        run.stages.push(watch.finish(identifier, own.len()));
        rest = later;
    }
    Ok(run)
}

/// One stage under way.
struct Watch<'a> {
    terms: &'a [Term],
    truth: &'a [f64],
    start: f64,
    first: bool,
    alarms_before: u32,
    alarms: u32,
    stage: Stage,
}

impl<'a> Watch<'a> {
    fn new(identifier: &Identifier, scenario: &'a Scenario, index: usize) -> Watch<'a> {
        let alarms = identifier.output().switch_count;
        let nothing = Stage {
            detection: None,
            tracking: None,
            validated: None,
            error: BEYOND,
            worst: 0.0,
            wrong: 0.0,
            stale: 0.0,
            normalised: Vec::new(),
            stated: Vec::new(),
            told: 0.0,
        };
        Watch {
            terms: &scenario.terms,
            truth: &scenario.stages[index].coefficients,
            start: scenario.stages[index].start,
            first: index == 0,
            alarms_before: alarms,
            alarms,
            stage: nothing,
        }
    }

    fn step(&mut self, identifier: &mut Identifier, reading: &Reading) -> Result<(), Failure> {
        identifier.step(sample(reading))?;
        let since = reading.t - self.start;
        if identifier.output().switch_count != self.alarms && self.alarms == self.alarms_before && !self.first {
            self.stage.detection = Some(since);
        }
        self.alarms = identifier.output().switch_count;
        self.stage.error = error(identifier.coefficients(), self.terms, self.truth);
        self.stage.tracking = (self.stage.error < RIGHT).then(|| self.stage.tracking.unwrap_or(since));
        match (identifier.output().valid, self.is_known()) {
            (true, true) => self.validated(identifier, since),
            (true, false) => self.stage.stale += f64::from(u8::from(self.stage.error >= RIGHT)),
            (false, _) => {}
        }
        Ok(())
    }

    /// Whether the identifier has taken notice of the stage: what it said before is of another law.
    fn is_known(&self) -> bool {
        self.first || self.stage.detection.is_some()
    }

    fn validated(&mut self, identifier: &Identifier, since: f64) {
        self.stage.validated = self.stage.validated.or(Some(since));
        self.stage.worst = self.stage.worst.max(self.stage.error);
        self.stage.wrong += f64::from(u8::from(self.stage.error >= RIGHT));
        self.stage.normalised = normalised(identifier.coefficients(), self.terms, self.truth);
    }

    fn false_alarms(&self) -> usize {
        let detections = u32::from(self.stage.detection.is_some());
        (self.alarms - self.alarms_before - detections) as usize
    }

    fn finish(self, identifier: &Identifier, samples: usize) -> Stage {
        let part = |count: f64| count / samples.max(1) as f64;
        let published = identifier.coefficients();
        let told = published.iter().filter(|known| known.std.is_some()).count();
        Stage {
            wrong: part(self.stage.wrong),
            stale: part(self.stage.stale),
            stated: normalised(published, self.terms, self.truth),
            told: told as f64 / published.len() as f64,
            ..self.stage
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::plant::Plant;
    use super::{BEYOND, Identifier, RIGHT, Scenario, Term, error, follow, normalised};
    use switchid::identify::{Coefficient, Settings};
    use switchid::simulate::{Stage, record};

    fn known(value: f64, std: Option<f64>) -> [Coefficient; 2] {
        let absent = Coefficient { term: Term::power(2, 0), value: 1.0, std: Some(0.0), needed: None };
        [Coefficient { term: Term::Inertia, value, std, needed: None }, absent]
    }

    #[test]
    fn an_absent_term_counts_as_zero_and_a_std_of_zero_is_none() {
        let (terms, truth) = ([Term::Inertia], [2.0]);
        assert_eq!(error(&known(3.0, None), &terms, &truth), (1.0 + 1.0) / 4.0);
        assert_eq!(normalised(&known(3.0, Some(0.5)), &terms, &truth), [2.0]);
        assert_eq!(normalised(&known(3.0, None), &terms, &truth), Vec::<f64>::new());
        assert_eq!(error(&known(f64::MAX, None), &terms, &truth), BEYOND);
    }

    #[test]
    fn a_switch_is_followed_through_its_stages() {
        let mut scenario = Plant::Duffing.rapid(8.0, 1, 0.01, 0);
        scenario.stages[1].start = 10.0;
        scenario.duration = 18.0;
        let readings = record(&scenario).unwrap();
        let mut identifier = Identifier::new(&Plant::Duffing.model(), Settings::default()).unwrap();
        let run = follow(&mut identifier, &scenario, &readings).unwrap();
        let [first, second] = &run.stages[..] else { panic!("{run:?}") };
        assert_eq!((first.detection, run.false_alarms), (None, 0));
        assert!(second.detection.is_some_and(|delay| delay > 0.0 && delay < 1.0), "{second:?}");
        assert!(second.tracking >= second.detection && second.error < RIGHT, "{second:?}");
        assert_eq!((second.stated.len(), second.told), (4, 1.0));
        assert!((8.0 * second.stale - second.detection.unwrap()).abs() < 0.002, "{second:?}");
        assert_eq!(second.wrong, 0.0, "{second:?}");
        let mut blind = Identifier::new(&Plant::Duffing.model(), Settings::default()).unwrap();
        let other = scenario.stages[1].clone();
        let wrong = Scenario { stages: vec![Stage { start: 0.0, ..other.clone() }, other], ..scenario };
        let run = follow(&mut blind, &wrong, &readings[..9000]).unwrap();
        let validated = (9000.0 - 1000.0 * run.stages[0].validated.unwrap()) / 9000.0;
        assert!((run.stages[0].wrong - validated).abs() < 1e-3 && run.stages[0].worst >= RIGHT, "{run:?}");
        assert!(run.stages[0].normalised.iter().any(|z| z.abs() > 10.0));
    }

    /// Its second switch is taken for a return of the first law, for nine samples in which the excitation all but
    /// vanishes: a prior from the forces of those alone held the new law to the old one for six seconds.
    #[test]
    fn a_law_that_was_taken_for_another_leaves_no_trace() {
        let plant = Plant::VanDerPol;
        let scenario = plant.rapid(plant.period(), 3, 0.01, 510);
        let mut identifier = Identifier::new(&plant.model(), Settings::default()).unwrap();
        let run = follow(&mut identifier, &scenario, &record(&scenario).unwrap()).unwrap();
        for stage in &run.stages {
            assert!(stage.error < RIGHT && stage.told == 1.0, "{stage:?}");
            assert!(stage.stated.iter().all(|z| z.abs() < 6.0), "{stage:?}");
            assert!(stage.normalised.iter().all(|z| z.abs() < 6.0), "{stage:?}");
        }
    }
}
