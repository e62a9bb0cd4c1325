//! The identifier's FMU over simulated hours: `cargo xtask endurance [HOURS]`.
//!
//! A Duffing plant at 1 kHz whose law switches every ten minutes among five; what a step costs, how much memory the
//! process has, and how well each stage is known, two hours by two hours. Nothing may grow.

use rustix::time::{ClockId, clock_gettime};
use switchid::fmu::identifier;
use switchid::law::Model;
use switchid::simulate::{Builtin, Plant, Reading, Scenario, Stage};
use switchid_fmu_slave::Interface;
use switchid_fmu_slave::host::{Functions, Instance, Request};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Distance of two samples, of two switches, and of two rows of the table, s.
const SAMPLE_TIME: f64 = 1e-3;
const STAGE: f64 = 600.0;
const ROW: f64 = 7200.0;

/// Std of the sensors' noise on q and q̇.
const NOISE: f64 = 0.01;

/// Samples that are made before the identifier takes them, so that its own time is measured.
const BLOCK: usize = 10_000;

const TERMS: &str = "qdd qd q q^3";

fn main() -> Result<(), Failure> {
    let hours: f64 = std::env::args().nth(1).map_or(Ok(24.0), |text| text.parse())?;
    let mut plant = Plant::new(scenario(3600.0 * hours))?;
    let fmu = Fmu::new()?;
    println!("| hour | doStep, µs | memory, MB | switches | e of eq. (8), median |\n|---|---|---|---|---|");
    let mut row = Row::default();
    let (mut block, mut switches) = (Vec::with_capacity(BLOCK), 0);
    for number in 0..(3600.0 * hours / SAMPLE_TIME) as u64 {
        plant.advance_to(number as f64 * SAMPLE_TIME)?;
        block.push(plant.reading());
        if block.len() < BLOCK {
            continue;
        }
        let begun = cpu();
        fmu.take(&block)?;
        row.seconds += cpu() - begun;
        row.samples += block.len();
        let t = block[BLOCK - 1].t;
        block.clear();
        if (t + SAMPLE_TIME) % STAGE < 0.5 * SAMPLE_TIME || (t + SAMPLE_TIME) % STAGE > STAGE - 0.5 * SAMPLE_TIME {
            row.errors.push(error(&fmu.coefficients()?, plant.truth().coefficients));
        }
        if row.samples as f64 * SAMPLE_TIME >= ROW - 0.5 {
            let count = fmu.count()?;
            println!("{}", row.text((t / 3600.0).round(), count - switches)?);
            (row, switches) = (Row::default(), count);
        }
    }
    Ok(())
}

/// Laws of the built-in scenario, one after the other and from the beginning again.
fn scenario(duration: f64) -> Scenario {
    let mut scenario = Builtin::DuffingWhite.scenario().with_noise(NOISE);
    let laws = scenario.stages.clone();
    let count = (duration / STAGE).ceil() as usize;
    let stage = |index: usize| Stage { start: STAGE * index as f64, ..laws[index % laws.len()].clone() };
    scenario.stages = (0..count.max(1)).map(stage).collect();
    scenario.duration = duration;
    scenario
}

#[derive(Default)]
struct Row {
    samples: usize,
    seconds: f64,
    errors: Vec<f64>,
}

impl Row {
    fn text(&mut self, hour: f64, switches: i32) -> Result<String, Failure> {
        self.errors.sort_by(f64::total_cmp);
        let median = self.errors.get(self.errors.len() / 2).copied().unwrap_or(f64::NAN);
        let cost = 1e6 * self.seconds / self.samples as f64;
        Ok(format!("| {hour} | {cost:.2} | {:.1} | {switches} | {median:.1e} |", memory()?))
    }
}

/// CPU time of this thread, s.
fn cpu() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + 1e-9 * now.tv_nsec as f64
}

/// Resident memory of the process, MB.
fn memory() -> Result<f64, Failure> {
    let pages = std::fs::read_to_string("/proc/self/statm")?;
    let pages: f64 = pages.split(' ').nth(1).ok_or("no resident set")?.parse()?;
    Ok(1e-6 * pages * rustix::param::page_size() as f64)
}

/// Σ(θ − θ*)² ÷ Σθ*².
fn error(found: &[f64], truth: &[f64]) -> f64 {
    let sum: f64 = found.iter().zip(truth).map(|(found, truth)| (found - truth).powi(2)).sum();
    sum / truth.iter().map(|truth| truth * truth).sum::<f64>()
}

/// The identifier's FMU with the plant's terms.
struct Fmu {
    instance: Instance,
    interface: Interface,
    inputs: [u32; 3],
    _resources: tempfile::TempDir,
}

impl Fmu {
    fn new() -> Result<Fmu, Failure> {
        let resources = tempfile::tempdir()?;
        for (path, content) in identifier("SwitchedIdentifier", &Model::cubic_library())?.files() {
            if let Some(name) = path.strip_prefix("resources/") {
                std::fs::write(resources.path().join(name), content)?;
            }
        }
        let interface: Interface = serde_json::from_slice(&std::fs::read(resources.path().join("interface.json"))?)?;
        let library =
            format!("{}switchid_fmu_identifier{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
        let functions = Functions::load(&std::path::Path::new("target/release").join(library))?;
        let location = resources.path().display().to_string();
        let request = Request { co_simulation: true, guid: &interface.guid, location: Some(&location), logging: false };
        let instance = Instance::new(functions, &request).map_err(|said| format!("{said:?}"))?;
        let place = |name: &str| interface.description.position(name).map(|place| place as u32);
        let places = |names: [&str; 3]| names.map(|name| place(name).unwrap_or(u32::MAX));
        instance.set_text(place("terms").ok_or("no terms")?, TERMS);
        let inputs = places(["q", "qd", "F"]);
        let fmu = Fmu { instance, interface, inputs, _resources: resources };
        fmu.done(fmu.instance.initialize(0.0))?;
        Ok(fmu)
    }

    fn done(&self, status: u32) -> Result<(), Failure> {
        if status == 0 { Ok(()) } else { Err(format!("{:?}", self.instance.messages().last()).into()) }
    }

    fn take(&self, readings: &[Reading]) -> Result<(), Failure> {
        for reading in readings {
            self.instance.set_reals(&self.inputs, &[reading.q, reading.qd, reading.excitation]);
            self.done(self.instance.step(reading.t, SAMPLE_TIME))?;
        }
        Ok(())
    }

    fn place(&self, name: &str) -> Result<u32, Failure> {
        Ok(self.interface.description.position(name).ok_or_else(|| format!("no variable {name}"))? as u32)
    }

    /// In the order of the terms.
    fn coefficients(&self) -> Result<Vec<f64>, Failure> {
        let places: Vec<u32> = ["coef.qdd", "coef.qd", "coef.q", "coef.q_3"]
            .into_iter()
            .map(|name| self.place(name))
            .collect::<Result<_, _>>()?;
        self.instance.reals(&places).map_err(|status| format!("status {status}").into())
    }

    fn count(&self) -> Result<i32, Failure> {
        self.instance.integer(self.place("switch.count")?).map_err(|status| format!("status {status}").into())
    }
}
