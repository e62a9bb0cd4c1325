//! The figures of one run, as DESIGN §7 defines them: eq. (8), detections, tracking delays.

use switchid::identify::{Coefficient, Identifier, Sample};
use switchid::simulate::{Reading, Scenario};

/// A law is tracked once e stays below this.
const TRACKED: f64 = 0.05 * 0.05;

/// The figures of one stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// e of eq. (8) at its last sample.
    pub error: f64,
    /// From its start until e stays below 0.05², s; infinite where it never does.
    pub tracking: f64,
    /// From its start to the alarm, s; infinite where there is none. `None` in the first stage, which no switch opens.
    pub detection: Option<f64>,
}

/// The figures of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct Figures {
    /// Stage by stage.
    pub stages: Vec<Stage>,
    /// Alarms that are no detection.
    pub false_alarms: usize,
}

impl Stage {
    /// `since` is the time since the stage's start, s.
    fn take(&mut self, error: f64, since: f64) {
        self.error = error;
        match error < TRACKED {
            true => self.tracking = self.tracking.min(since),
            false => self.tracking = f64::INFINITY,
        }
    }
}

impl Figures {
    /// Switches without a detection.
    pub fn missed(&self) -> usize {
        self.stages.iter().filter(|stage| stage.detection == Some(f64::INFINITY)).count()
    }
}

/// Steps the identifier through readings of the scenario.
pub fn follow(
    identifier: &mut Identifier,
    scenario: &Scenario,
    readings: impl IntoIterator<Item = Reading>,
) -> Result<Figures, Box<dyn std::error::Error + Send + Sync>> {
    let mut figures = begin(scenario);
    let mut alarms = 0;
    for reading in readings {
        identifier.step(Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation })?;
        let stage = scenario.stage_at(reading.t);
        let since = reading.t - scenario.stages[stage].start;
        let error = coefficient_error(identifier.coefficients(), scenario, stage);
        figures.stages[stage].take(error, since);
        if identifier.output().switch_count != alarms {
            alarms = identifier.output().switch_count;
            alarm(&mut figures, stage, since);
        }
    }
    Ok(figures)
}

fn begin(scenario: &Scenario) -> Figures {
    let stage = |index: usize| Stage {
        error: f64::INFINITY,
        tracking: f64::INFINITY,
        detection: (index > 0).then_some(f64::INFINITY),
    };
    Figures { stages: (0..scenario.stages.len()).map(stage).collect(), false_alarms: 0 }
}

/// e of eq. (8): inertia and all active terms counted, absent ones with truth 0, the excitation's fixed 1 not.
fn coefficient_error(published: &[Coefficient], scenario: &Scenario, stage: usize) -> f64 {
    let truth = &scenario.stages[stage].coefficients;
    let of = |known: &Coefficient| scenario.terms.iter().position(|term| *term == known.term).map_or(0.0, |i| truth[i]);
    let difference: f64 = published.iter().map(|known| (known.value - of(known)).powi(2)).sum();
    difference / truth.iter().map(|value| value * value).sum::<f64>()
}

fn alarm(figures: &mut Figures, stage: usize, since: f64) {
    match &mut figures.stages[stage].detection {
        Some(delay) if *delay == f64::INFINITY => *delay = since,
        _ => figures.false_alarms += 1,
    }
}
