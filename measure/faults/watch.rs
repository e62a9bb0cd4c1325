//! One record through the identifier, judged by its truth.

use crate::fault::Fault;
use crate::{END, Failure, SWITCH};
use switchid::identify::{Coefficient, Identifier, Sample, Settings};
use switchid::law::{Drive, Model, State, Term};
use switchid::limits::{Course, Law, Sensors, detection, level};
use switchid::simulate::{Plant, Reading, Scenario};

/// A law is wrong from this e on.
const WRONG: f64 = 0.05 * 0.05;

/// Std that no honest error is beyond.
const BEYOND: f64 = 6.0;

/// Time after a true switch in which a wrong law counts for nothing, s.
const ALLOWED: f64 = 1.0;

/// How long before the fault a law has to be valid, s.
const BEFORE: f64 = 0.01;

/// What was seen of one record.
#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// Time of the first sample that shows the switch, s.
    pub switch: f64,
    /// Time valid and wrong, s.
    pub wrong: f64,
    /// Time valid with a coefficient beyond 6 of its std, s.
    pub dishonest: f64,
    /// False switches from the fault on.
    pub false_switches: u32,
    /// Whether a law was valid just before the fault.
    pub valid_before: bool,
    /// From the last faulty sample until a law is valid and stays so up to the switch, s; infinite where none does.
    pub valid_again: f64,
    /// Delay of the switch's name, s; infinite where it is missed.
    pub named: f64,
    /// Limit of that delay, s.
    pub limit: f64,
    /// Samples with `valid`, and of those with a coefficient of unknown std.
    pub valid: [u64; 2],
    /// Sum of the coefficients' mean ((θ − θ*) ÷ std)² over samples with `valid`, and number of those samples.
    pub squares: [f64; 2],
    /// Whether an effect was said to be missing.
    pub missing: bool,
}

/// The motion without noise beside what sensors say of it.
struct Recorded {
    readings: Vec<Reading>,
    states: Vec<State>,
}

fn record(scenario: &Scenario) -> Result<Recorded, Failure> {
    let mut plant = Plant::new(scenario.clone())?;
    let sample_time = scenario.excitation.sample_time;
    let mut recorded = Recorded { readings: Vec::new(), states: Vec::new() };
    for index in 0..(scenario.duration / sample_time) as u64 {
        plant.advance_to(index as f64 * sample_time)?;
        recorded.readings.push(plant.reading());
        recorded.states.push(plant.truth().state);
    }
    Ok(recorded)
}

/// RMS of the inertia's force ÷ RMS of what the term multiplies, before the law switches.
pub fn ratio_of_forces(scenario: &Scenario, term: Term) -> Result<f64, Failure> {
    let recorded = record(scenario)?;
    let times: Vec<f64> = recorded.readings.iter().map(|reading| reading.t).take_while(|t| *t < SWITCH).collect();
    let inertia = scenario.terms.iter().position(|term| *term == Term::Inertia).ok_or("no inertia")?;
    let mut squares = [0.0; 2];
    for (state, next) in recorded.states.iter().zip(&recorded.states[1..]).take(times.len()) {
        let acceleration = (next.qd - state.qd) / scenario.excitation.sample_time;
        squares[0] += (scenario.stages[0].coefficients[inertia] * acceleration).powi(2);
        squares[1] += term.force(state.q, state.qd, 0.0).powi(2);
    }
    Ok((squares[0] / squares[1]).sqrt())
}

/// Steps a new identifier over the scenario's record with the fault in it from time `at` on.
pub fn watch(model: &Model, scenario: &Scenario, fault: Fault, at: f64, seed: u64) -> Result<Seen, Failure> {
    let recorded = record(scenario)?;
    let mut readings = recorded.readings.clone();
    let last = fault.apply(&mut readings, at, seed);
    // a switch that no sample shows yet is none
    let shows = |t: &f64| (SWITCH - 1e-9..END).contains(t);
    let switch = readings.iter().map(|reading| reading.t).find(shows).ok_or("no sample shows the switch")?;
    let mut identifier = Identifier::new(model, Settings::default())?;
    let none = f64::INFINITY;
    let limit = limit(scenario, &recorded, switch)?;
    let mut seen = Seen { switch, valid_again: none, named: none, limit, ..Seen::default() };
    let (mut before, mut count) = (0.0, 0);
    for reading in readings {
        let sample =
            Sample { t: fault.stamp(reading.t, at), q: reading.q, qd: reading.qd, excitation: reading.excitation };
        // what is skipped leaves the outputs as the identifier has them
        identifier.step(sample).ok();
        let t = if reading.t < END { reading.t } else { before };
        seen.take(&identifier, scenario, t, t - before, [at, last]);
        let switches = identifier.output().switch_count;
        if switches != count {
            let begins = if matches!(fault, Fault::Lacks(_)) { 0.0 } else { at };
            seen.alarm(t, switches.saturating_sub(count), begins);
        }
        (before, count) = (t, switches);
    }
    Ok(seen)
}

impl Seen {
    fn take(&mut self, identifier: &Identifier, scenario: &Scenario, t: f64, dt: f64, [at, last]: [f64; 2]) {
        let valid = identifier.output().valid;
        self.missing |= identifier.output().missing.is_some();
        if t < at - BEFORE {
            self.valid_before = valid;
        } else if t > last && t < SWITCH {
            self.valid_again = if valid { self.valid_again.min(t - last) } else { f64::INFINITY };
        }
        if !valid {
            return;
        }
        let coefficients = identifier.coefficients();
        self.valid[0] += 1;
        self.valid[1] += u64::from(coefficients.iter().any(|known| known.std.is_none()));
        let stage = scenario.stage_at(t);
        if (0.0..ALLOWED).contains(&(t - self.switch)) {
            return;
        }
        let [error, z, square] = errors(coefficients, scenario, stage);
        self.squares[0] += square;
        self.squares[1] += 1.0;
        self.wrong += if error > WRONG { dt } else { 0.0 };
        self.dishonest += if z > BEYOND { dt } else { 0.0 };
    }

    fn alarm(&mut self, t: f64, count: u32, begins: f64) {
        match t < SWITCH {
            true if t >= begins => self.false_switches += count,
            true => {}
            false if self.named.is_infinite() => {
                (self.named, self.false_switches) = (t - self.switch, self.false_switches + count - 1)
            }
            false => self.false_switches += count,
        }
    }
}

/// e of eq. (8), the largest error ÷ stated std, and the mean square of these.
fn errors(published: &[Coefficient], scenario: &Scenario, stage: usize) -> [f64; 3] {
    let truth = &scenario.stages[stage].coefficients;
    let of = |known: &Coefficient| scenario.terms.iter().position(|term| *term == known.term).map_or(0.0, |i| truth[i]);
    let square: f64 = published.iter().map(|known| (known.value - of(known)).powi(2)).sum();
    let z = |known: &Coefficient| known.std.filter(|std| *std > 0.0).map(|std| (known.value - of(known)).abs() / std);
    let worst = published.iter().filter_map(z).fold(0.0, f64::max);
    let squares: Vec<f64> = published.iter().filter_map(z).map(|z| z * z).collect();
    let mean = squares.iter().sum::<f64>() / squares.len().max(1) as f64;
    [square / truth.iter().map(|value| value * value).sum::<f64>(), worst, mean]
}

/// The limit of the delay, s, from a sample at time `switch` on; infinite where it cannot be seen.
fn limit(scenario: &Scenario, recorded: &Recorded, switch: f64) -> Result<f64, Failure> {
    let law = |stage: usize| {
        let pairs: Vec<_> = scenario.terms.iter().copied().zip(scenario.stages[stage].coefficients.clone()).collect();
        Law::new(&pairs, &(0..pairs.len()).collect::<Vec<_>>())
    };
    let from = recorded.readings.partition_point(|reading| reading.t < switch - 1e-9);
    let readings = &recorded.readings[from..];
    let course = Course {
        t: readings.iter().map(|reading| reading.t).collect(),
        drives: readings[..readings.len() - 1].iter().map(|reading| Drive::Held(reading.excitation)).collect(),
        states: recorded.states[from..].to_vec(),
    };
    let settings = Settings::default();
    let level = level(settings.false_alarm_interval, settings.sample_time);
    let sensors = Sensors([Some(scenario.noise.q), Some(scenario.noise.qd)]);
    let last = scenario.stages.len() - 1;
    Ok(detection(&law(last - 1)?, &law(last)?, &[course], sensors, level)?.at_start.unwrap_or(f64::INFINITY))
}
