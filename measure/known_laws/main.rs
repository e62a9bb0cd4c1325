//! The table of known laws: `cargo xtask known-laws [SEEDS]`.
//!
//! Three laws take turns, A B A C B A C, drawn with their excitation as in the random built-in scenarios, and recorded
//! with sensor noise. A law that returns is *known* from when its number stands with `valid` to the stage's end. Seeds
//! begin at 1000: none of them served to choose a constant.

use switchid::identify::{Identifier, Output, Sample, Settings};
use switchid::law::{Given, Model};
use switchid::simulate::{Builtin, Scenario, record};

type Failure = Box<dyn std::error::Error>;

const SEEDS: u64 = 20;
const FIRST_SEED: u64 = 1000;
const TURNS: [usize; 7] = [0, 1, 0, 2, 1, 0, 2];
const NOISES: [f64; 3] = [0.001, 0.01, 0.1];
const SAMPLE_TIME: f64 = 1e-3;
const HEAD: &str =
    "| plant | noise | returns | detected, s | known, s | known ÷ detected, median | 90 % | known at the alarm \
                    | taken for another | longest, s | at the end | missed | false |
|---|---|---|---|---|---|---|---|---|---|---|---|---|";

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let seeds: u64 = arguments.next().map_or(Ok(SEEDS), |text| text.parse())?;
    let first: u64 = arguments.next().map_or(Ok(FIRST_SEED), |text| text.parse())?;
    println!("{HEAD}");
    for builtin in [Builtin::DuffingSine, Builtin::VanDerPolSine] {
        for noise in NOISES {
            let mut tally = Tally::default();
            for seed in first..first + seeds {
                watch(&model(builtin), &turns(builtin, seed).with_noise(noise), &mut tally)?;
            }
            println!("| {} | {noise} | {} |", builtin.id(), tally.row());
        }
    }
    Ok(())
}

fn model(builtin: Builtin) -> Model {
    match builtin.is_van_der_pol() {
        true => Model::cubic_library(),
        false => Model::of("Duffing", builtin.terms().into_iter().map(|term| (term, Given::Fit))),
    }
}

/// The first three laws of a random scenario by turns, the excitation changing from stage to stage as drawn.
fn turns(builtin: Builtin, seed: u64) -> Scenario {
    let drawn = builtin.random(seed);
    let mut scenario = drawn.clone();
    let stage = |(index, law): (usize, &usize)| {
        let mut stage = drawn.stages[index % drawn.stages.len()].clone();
        stage.coefficients.clone_from(&drawn.stages[*law].coefficients);
        stage.start = 15.0 * index as f64 + 0.1 * stage.omega;
        stage
    };
    scenario.stages = TURNS.iter().enumerate().map(stage).collect();
    scenario.stages[0].start = 0.0;
    scenario.duration = 15.0 * TURNS.len() as f64;
    scenario
}

/// What happened to the laws that returned.
#[derive(Default)]
struct Tally {
    returns: usize,
    detected: Vec<f64>,
    known: Vec<f64>,
    ratios: Vec<f64>,
    at_alarm: usize,
    taken_for_another: usize,
    longest_wrong: f64,
    wrong_at_end: usize,
    missed: usize,
    false_alarms: usize,
}

/// The stage at hand.
struct Present {
    stage: usize,
    detected: Option<f64>,
    known: Option<f64>,
    /// For how long another known law stood in use, s.
    wrong: f64,
    last: Option<u32>,
}

impl Present {
    fn of(stage: usize) -> Present {
        Present { stage, detected: None, known: None, wrong: 0.0, last: None }
    }
}

fn watch(model: &Model, scenario: &Scenario, tally: &mut Tally) -> Result<(), Failure> {
    let mut identifier = Identifier::new(model, Settings::default())?;
    let mut numbers: [Option<u32>; 3] = [None; 3];
    let mut present = Present::of(0);
    let mut alarms = 0;
    for reading in record(scenario)? {
        let stage = scenario.stage_at(reading.t);
        if stage != present.stage {
            tally.close(&present, &mut numbers);
            present = Present::of(stage);
        }
        identifier.step(Sample { t: reading.t, q: reading.q, qd: reading.qd, excitation: reading.excitation })?;
        let since = reading.t - scenario.stages[stage].start;
        let output = identifier.output();
        if output.switch_count != alarms {
            alarms = output.switch_count;
            match present.detected.is_none() && stage > 0 {
                true => present.detected = Some(since),
                false => tally.false_alarms += 1,
            }
        }
        present.see(output, since, &numbers);
    }
    tally.close(&present, &mut numbers);
    Ok(())
}

impl Present {
    fn see(&mut self, output: &Output, since: f64, numbers: &[Option<u32>; 3]) {
        if self.stage > 0 && self.detected.is_none() {
            return;
        }
        self.last = output.law_number;
        let own = numbers[TURNS[self.stage]];
        match output.valid && own.is_some() && output.law_number == own {
            true => _ = self.known.get_or_insert(since),
            false => self.known = None,
        }
        let other = output.law_number.is_some_and(|number| own != Some(number) && numbers.contains(&Some(number)));
        if other {
            self.wrong += SAMPLE_TIME;
        }
    }
}

impl Tally {
    fn close(&mut self, present: &Present, numbers: &mut [Option<u32>; 3]) {
        let law = TURNS[present.stage];
        self.taken_for_another += usize::from(present.wrong > 0.0);
        self.longest_wrong = self.longest_wrong.max(present.wrong);
        let others =
            (0..3).filter(|other| *other != law).any(|other| numbers[other] == present.last && present.last.is_some());
        self.wrong_at_end += usize::from(others);
        self.missed += usize::from(present.stage > 0 && present.detected.is_none());
        if numbers[law].is_some() {
            self.returns += 1;
            let (detected, known) = (present.detected.unwrap_or(f64::INFINITY), present.known.unwrap_or(f64::INFINITY));
            self.at_alarm += usize::from(known <= detected);
            self.detected.push(detected);
            self.known.push(known);
            self.ratios.push(known / detected);
        } else if !others {
            numbers[law] = present.last;
        }
    }

    fn row(&mut self) -> String {
        let at = |values: &mut Vec<f64>, part: f64| {
            values.sort_by(f64::total_cmp);
            let place = (part * values.len() as f64) as usize;
            values.get(place.min(values.len().saturating_sub(1))).copied().unwrap_or(f64::NAN)
        };
        format!(
            "{} | {:.3} | {:.3} | {:.2} | {:.2} | {} | {} | {:.3} | {} | {} | {}",
            self.returns,
            at(&mut self.detected, 0.5),
            at(&mut self.known, 0.5),
            at(&mut self.ratios, 0.5),
            at(&mut self.ratios, 0.9),
            self.at_alarm,
            self.taken_for_another,
            self.longest_wrong,
            self.wrong_at_end,
            self.missed,
            self.false_alarms,
        )
    }
}
