//! The table of sensor faults: `cargo xtask faults [--seeds N] [--first SEED] [--only TEXT] [--at S]
//! [--threads N] [--cells]`.
//!
//! Every fault is put into a record of four plants, terms given and full library, at 1 kHz with noise σ = 0.01: the law
//! holds for 20 s, the fault begins at 10 s or where `--at` says, and at 20 s the law switches. What is wrong is
//! judged by the truth, and the switch counts from the first sample after it:
//!
//! | column | meaning |
//! |---|---|
//! | valid and wrong | time with `valid` while e is above 0.05², the second after the switch left out, s a record |
//! | dishonest | time with `valid` while a coefficient is beyond 6 of its std, s a record |
//! | false | switches counted from the fault on that are none; of a law that lacks an effect, from the beginning on; \
//!        of one that moves, those that are told where it does |
//! | valid again | from the last faulty sample until the law is valid for good, s; of records valid before the fault |
//! | missed | next switches not counted in 10 s |
//! | unknown | samples with `valid` and a coefficient without std |
//! | named | delay of the switch's name ÷ limit of detection |
//! | z² | of all coefficients over the time with `valid`, the second after the switch left out: mean by record of \
//!        ((θ − θ*) ÷ std)², then its median and mean over the records |
//! | missing | records in which an effect is said to be missing |

mod fault;
mod tally;
mod watch;

use fault::Fault;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use switchid::law::{Given, Model, Term};
use switchid::simulate::{Builtin, Scenario};
use tally::{HEAD, Tally};
use watch::{Seen, watch};

/// Why a figure could not be measured.
type Failure = Box<dyn std::error::Error + Send + Sync>;

const PLANTS: [Builtin; 4] =
    [Builtin::DuffingSine, Builtin::DuffingWhite, Builtin::VanDerPolSine, Builtin::VanDerPolWhite];

/// Std of the sensors' noise on q and q̇.
const NOISE: f64 = 0.01;

/// RMS of the force of an effect that a law lacks ÷ RMS of the inertia's.
const LACKED: f64 = 0.1;

/// Time at which the fault begins unless another is asked for, the law switches, and the record ends, s.
const FAULT: f64 = 10.0;
const SWITCH: f64 = 20.0;
const END: f64 = 30.0;

/// What is asked for.
struct Asked {
    seeds: Range<u64>,
    only: String,
    at: f64,
    threads: usize,
    cells: bool,
}

/// One record.
#[derive(Clone, Copy)]
struct Cell {
    fault: Fault,
    plant: Builtin,
    library: bool,
    seed: u64,
    at: f64,
}

fn main() -> Result<(), Failure> {
    let asked = asked(std::env::args().skip(1))?;
    println!("{HEAD}");
    for fault in Fault::ALL.into_iter().filter(|fault| fault.id().contains(&asked.only)) {
        let cells = cells(&asked, fault);
        let seen = measure(&cells, asked.threads)?;
        if asked.cells {
            cells.iter().zip(&seen).for_each(|(cell, seen)| println!("{} {seen:?}", cell.label()));
        }
        println!("| {} | {} |", fault.id(), Tally::of(&seen).row());
    }
    Ok(())
}

fn asked(mut arguments: impl Iterator<Item = String>) -> Result<Asked, Failure> {
    let (mut seeds, mut first) = (20, 3000);
    let mut asked = Asked { seeds: 0..0, only: String::new(), at: FAULT, threads: 2, cells: false };
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} needs a value"));
        match argument.as_str() {
            "--seeds" => seeds = value()?.parse()?,
            "--first" => first = value()?.parse()?,
            "--only" => asked.only = value()?,
            "--at" => asked.at = value()?.parse()?,
            "--threads" => asked.threads = value()?.parse()?,
            "--cells" => asked.cells = true,
            _ => return Err(format!("no such option: {argument}").into()),
        }
    }
    asked.seeds = first..first + seeds;
    Ok(asked)
}

fn cells(asked: &Asked, fault: Fault) -> Vec<Cell> {
    let plants = PLANTS.into_iter().filter(|plant| fault.suits(*plant));
    let at = asked.at;
    let of =
        |plant: Builtin, library: bool| asked.seeds.clone().map(move |seed| Cell { fault, plant, library, seed, at });
    plants.flat_map(|plant| [false, true].into_iter().flat_map(move |library| of(plant, library))).collect()
}

/// Watches every cell, on several threads; in the order of the cells.
fn measure(cells: &[Cell], threads: usize) -> Result<Vec<Seen>, Failure> {
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || -> Result<(), Failure> {
        while let Some((number, cell)) = cells.iter().enumerate().nth(next.fetch_add(1, Ordering::Relaxed)) {
            let seen = cell.watch()?;
            done.lock().map_err(|_| "a thread ended early")?.push((number, seen));
        }
        Ok(())
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        threads.into_iter().try_for_each(|thread| thread.join().map_err(|_| "a thread ended early")?)
    })?;
    let mut done = done.into_inner().map_err(|_| "a thread ended early")?;
    done.sort_by_key(|(number, _)| *number);
    Ok(done.into_iter().map(|(_, seen)| seen).collect())
}

impl Cell {
    fn label(&self) -> String {
        let terms = if self.library { "library" } else { "given" };
        format!("{} {} {terms} seed {}", self.fault.id(), self.plant.id(), self.seed)
    }

    fn model(&self) -> Model {
        match self.library {
            true => Model::cubic_library(),
            false => Model::of(self.plant.id(), self.plant.terms().into_iter().map(|term| (term, Given::Fit))),
        }
    }

    /// Two stages of the plant as it is drawn for the seed.
    fn scenario(&self) -> Scenario {
        let mut scenario = self.plant.random(self.seed).with_noise(NOISE);
        scenario.stages.truncate(2);
        scenario.stages[1].start = SWITCH;
        scenario.duration = END;
        scenario
    }

    /// The same with the effect that the fault is, at a tenth of the inertia's force.
    fn scenario_of_fault(&self) -> Result<Scenario, Failure> {
        let mut scenario = self.scenario();
        if let Fault::Lacks(effect) = self.fault {
            let term = Term::parse(effect)?;
            let scale = watch::ratio_of_forces(&scenario, term)?;
            scenario.hidden.push(term, LACKED * scale);
        }
        self.fault.change(&mut scenario, self.at, self.seed);
        Ok(scenario)
    }

    fn watch(&self) -> Result<Seen, Failure> {
        watch(&self.model(), &self.scenario_of_fault()?, self.fault, self.at, self.seed)
    }
}
