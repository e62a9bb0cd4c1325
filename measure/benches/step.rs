//! What a sample costs: `cargo xtask bench`.
//!
//! divan measures blocks of steps and the throughput of a recording: small, with counters per item, and it leaves
//! `main` to us. What no benchmark harness measures is the worst single step: the table below runs the same record
//! several times and takes, for every sample, the fastest of its runs. The identifier is deterministic, so that what is
//! left is its work, not what else the machine did. Times are the machine's; the ratios within a table are what to
//! compare.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use std::time::{Duration, Instant};
use switchid::identify::{Identifier, Sample, Settings, Status};
use switchid::law::{Given, Model, Term};
use switchid::simulate::{Builtin, record};

/// Runs of one record, of which the fastest counts.
const RUNS: usize = 3;

/// A law this many samples old is refined at the slow pace.
const SETTLED: usize = 6000;

/// Samples in a block that divan measures.
const BLOCK: usize = 1000;

/// Unknowns of a model, from the true law to the full cubic library and the quintic stiffness.
const TERMS: [usize; 3] = [4, 8, 12];

/// Seconds of record that are kept.
const WINDOWS: [usize; 3] = [10, 30, 100];

fn main() {
    if !std::env::args().any(|argument| ["--list", "--help", "-h"].contains(&argument.as_str())) {
        by_terms();
        by_window();
    }
    divan::main();
}

/// The true terms of the van der Pol circuit and as many others, which evidence may drop.
fn model(count: usize) -> Model {
    let names = ["qdd", "qd", "q", "q^2*qd", "1", "q^2", "q*qd", "q^3", "qd^2", "qd^3", "q*qd^2", "q^5"];
    let given = |name: &&str| if *name == "qdd" { Given::Fit } else { Given::Maybe };
    Model::of("bench", names[..count].iter().map(|name| (Term::parse(name).unwrap(), given(name))))
}

fn settings(window: usize) -> Settings {
    Settings { max_window: window as f64, ..Settings::default() }
}

/// The van der Pol circuit under a sine with sensor noise 0.01; a switch at 24 s, or none.
fn samples(duration: f64, switches: bool) -> Vec<Sample> {
    let mut scenario = Builtin::VanDerPolSine.scenario().with_noise(0.01);
    scenario.duration = duration;
    scenario.stages.truncate(if switches { 2 } else { 1 });
    let rows = record(&scenario).unwrap();
    rows.iter().map(|row| Sample { t: row.t, q: row.q, qd: row.qd, excitation: row.excitation }).collect()
}

/// Status after each step, and its fastest time.
fn fastest(model: &Model, settings: Settings, samples: &[Sample]) -> Vec<(Status, Duration)> {
    let mut steps = vec![(Status::Acquiring, Duration::MAX); samples.len()];
    for _ in 0..RUNS {
        let mut identifier = Identifier::new(model, settings).unwrap();
        for (sample, (status, least)) in samples.iter().zip(&mut steps) {
            let begin = Instant::now();
            let taken = identifier.step(*sample);
            *least = begin.elapsed().min(*least);
            taken.unwrap();
            *status = identifier.output().status;
        }
    }
    steps
}

/// Median and worst, µs; none of nothing.
fn summary(times: impl Iterator<Item = Duration>) -> Option<[f64; 2]> {
    let mut times: Vec<f64> = times.map(|time| time.as_secs_f64() * 1e6).collect();
    times.sort_by(f64::total_cmp);
    Some([*times.get(times.len() / 2)?, *times.last()?])
}

fn row(name: &str, found: Option<[f64; 2]>, reference: &mut Option<[f64; 2]>) {
    let Some([median, worst]) = found else { return println!("  {name:<42} never seen") };
    let [first, first_worst] = *reference.get_or_insert([median, worst]);
    println!("  {name:<42}{median:>9.2}{worst:>9.1}{:>9.2}{:>9.2}", median / first, worst / first_worst);
}

fn heading(text: &str) {
    println!("\n{text}\n  {:<42}{:>9}{:>9}{:>9}{:>9}", "", "median", "worst", "÷ first", "÷ first");
}

fn by_terms() {
    let samples = samples(48.0, true);
    let runs = TERMS.map(|terms| fastest(&model(terms), settings(30), &samples));
    for (name, wanted) in [
        ("acquiring", Status::Acquiring),
        ("tracking, law older than 6 s", Status::Tracking),
        ("re-identifying", Status::ReIdentifying),
    ] {
        heading(&format!("µs per sample, {name}, window 30 s"));
        let mut reference = None;
        for (terms, steps) in TERMS.iter().zip(&runs) {
            let times = steps.iter().enumerate().filter(|(index, step)| step.0 == wanted && is_old(steps, *index));
            row(&format!("{terms} terms"), summary(times.map(|(_, step)| step.1)), &mut reference);
        }
    }
}

/// Whether a tracking step's status has been the same for [`SETTLED`] samples; any other step counts as it is.
fn is_old(steps: &[(Status, Duration)], index: usize) -> bool {
    let tracks = |status: Status| matches!(status, Status::Tracking | Status::SwitchSuspected);
    let from = index.saturating_sub(SETTLED);
    !tracks(steps[index].0) || (index >= SETTLED && tracks(steps[from].0) && tracks(steps[(from + index) / 2].0))
}

fn by_window() {
    let samples = samples(120.0, false);
    heading("µs per sample, tracking, 12 terms, last 10 s of 120 s");
    let mut reference = None;
    for window in WINDOWS {
        let steps = fastest(&model(12), settings(window), &samples);
        let last = steps[steps.len() - 10_000..].iter().filter(|step| step.0 == Status::Tracking);
        row(&format!("window {window} s"), summary(last.map(|step| step.1)), &mut reference);
    }
    println!();
}

fn step_through(mut identifier: Identifier, samples: &[Sample]) -> Identifier {
    for sample in samples {
        black_box(identifier.step(*sample)).unwrap();
    }
    identifier
}

fn block(bencher: Bencher, model: &Model, window: usize) {
    let samples = samples(22.0, false);
    let (before, after) = samples.split_at(samples.len() - BLOCK);
    let prepared = step_through(Identifier::new(model, settings(window)).unwrap(), before);
    bencher
        .counter(ItemsCount::new(BLOCK))
        .with_inputs(|| prepared.clone())
        .bench_values(|identifier| step_through(identifier, after));
}

#[divan::bench(args = TERMS, sample_count = 20)]
fn tracking_a_second_by_terms(bencher: Bencher, terms: usize) {
    block(bencher, &model(terms), 30);
}

#[divan::bench(args = WINDOWS, sample_count = 20)]
fn tracking_a_second_by_window(bencher: Bencher, window: usize) {
    block(bencher, &model(12), window);
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn a_recording_of_48_s_with_a_switch(bencher: Bencher) {
    let (model, samples) = (Model::cubic_library(), samples(48.0, true));
    bencher.counter(ItemsCount::new(samples.len())).bench_local(|| {
        let identifier = Identifier::new(&model, settings(30)).unwrap();
        black_box(step_through(identifier, &samples).output().switch_count)
    });
}
