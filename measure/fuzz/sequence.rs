//! One sequence of calls.

use super::subject::Subject;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use switchid_fmu_slave::ctypes::{ERROR, OK, Status, WARNING};
use switchid_fmu_slave::host::{Exchange, Instance, Mistake, Request, Saved};
use switchid_fmu_slave::{Kind, Variable};

/// Longest sequence, calls.
const LONGEST: usize = 60;

/// Values that a sensor, a master or a mistake can send.
const READINGS: [f64; 12] =
    [0.0, 1.0, -1.0, 1e-3, 1e6, 1e300, -1e300, 5e-324, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX];

/// Communication steps, s: most as a master takes them.
const STEPS: [f64; 12] = [1e-3, 1e-3, 1e-3, 1e-3, 1e-2, 0.1, 0.0, 1e-12, -1e-3, f64::NAN, f64::INFINITY, 1e9];

const TEXTS: [&str; 8] = ["", "qdd qd q q^3", "q_3", "%s %n", "Duffing", "white noise", "ü\u{1f980}", "terms = ["];

/// A call that came back with what FMI does not have.
pub type Violation = String;

/// One instance, what its master thinks the time is, and the states that it holds or has freed.
struct Master<'a> {
    instance: Instance,
    subject: &'a Subject,
    time: f64,
    saved: Vec<Saved>,
    calls: u64,
}

/// Makes an instance and calls it at random; how many calls that were.
///
/// # Errors
/// A status that is neither OK, warning nor error.
pub fn run(subject: &Subject, generator: &mut ChaCha8Rng) -> Result<u64, Violation> {
    let location = subject.location();
    let request = Request {
        co_simulation: subject.exchange.is_none() || generator.random_bool(0.7),
        guid: if generator.random_bool(0.01) { "another" } else { &subject.interface.guid },
        location: Some(location.as_str()).filter(|_| !generator.random_bool(0.01)),
        logging: generator.random_bool(0.5),
    };
    let Ok(instance) = Instance::new(subject.functions, &request) else { return Ok(1) };
    let mut master = Master { instance, subject, time: 0.0, saved: Vec::new(), calls: 1 };
    if generator.random_bool(0.8) {
        (0..generator.random_range(0..4)).try_for_each(|_| master.set(generator))?;
        master.instance.initialize(0.0);
    }
    for _ in 0..generator.random_range(1..LONGEST) {
        master.call(generator)?;
    }
    Ok(master.calls)
}

impl Master<'_> {
    fn call(&mut self, generator: &mut ChaCha8Rng) -> Result<(), Violation> {
        self.calls += 1;
        match generator.random_range(0..20) {
            0..8 => self.step(generator),
            8..11 => self.set(generator),
            11..13 => self.get(generator),
            13..16 => self.state(generator),
            16..18 => self.phase(generator),
            18 => self.nonsense(generator),
            _ => self.integrate(generator),
        }
    }

    fn step(&mut self, generator: &mut ChaCha8Rng) -> Result<(), Violation> {
        let step = one(generator, &STEPS);
        let from = if generator.random_bool(0.98) { self.time } else { one(generator, &READINGS) };
        let status = self.instance.step(from, step);
        if status == OK {
            self.time = from + step;
        }
        known("fmi2DoStep", status)
    }

    fn reference(&self, generator: &mut ChaCha8Rng) -> u32 {
        let count = self.subject.interface.description.variables.len() as u32;
        if generator.random_bool(0.97) { generator.random_range(0..count) } else { generator.random() }
    }

    /// The kind of a variable, now and then another one.
    fn kind(&self, reference: u32, generator: &mut ChaCha8Rng) -> u32 {
        let variable = self.subject.interface.description.variables.get(reference as usize);
        match variable {
            Some(variable) if generator.random_bool(0.95) => number(variable),
            _ => generator.random_range(0..4),
        }
    }

    fn set(&mut self, generator: &mut ChaCha8Rng) -> Result<(), Violation> {
        let reference = self.reference(generator);
        let status = match self.kind(reference, generator) {
            0 => self.instance.set_reals(&[reference], &[reading(generator)]),
            1 => self.instance.set_integer(reference, generator.random_range(-2..40)),
            2 => self.instance.set_boolean(reference, generator.random_range(-1..3)),
            _ => self.instance.set_text(reference, one(generator, &TEXTS)),
        };
        known("fmi2SetXXX", status)
    }

    fn get(&mut self, generator: &mut ChaCha8Rng) -> Result<(), Violation> {
        let reference = self.reference(generator);
        let status = match self.kind(reference, generator) {
            0 => self.instance.reals(&[reference, self.reference(generator)]).err(),
            1 => self.instance.integer(reference).err(),
            2 => self.instance.boolean(reference).err(),
            _ => self.instance.text(reference).err(),
        };
        known("fmi2GetXXX", status.unwrap_or(OK))
    }

    /// A state that is held, or was, or belongs to nobody.
    fn some_state(&self, generator: &mut ChaCha8Rng) -> Saved {
        match self.saved.is_empty() || generator.random_bool(0.1) {
            true => one(generator, &[Saved::NULL, Saved::at(8), Saved::at(0x7fff_0000_1000)]),
            false => one(generator, &self.saved),
        }
    }

    fn state(&mut self, generator: &mut ChaCha8Rng) -> Result<(), Violation> {
        let mut state = self.some_state(generator);
        let status = match generator.random_range(0..6) {
            0 => self.instance.save().map(|state| self.saved.push(state)).err().unwrap_or(OK),
            1 => self.instance.save_into(&mut state),
            2 => self.instance.restore(state),
            3 => self.instance.free(&mut state),
            4 => self.instance.pack_into(state, generator.random_range(0..100_000)),
            _ => return self.corrupt(state, generator),
        };
        known("a call on states", status)
    }

    /// Serialises a state, changes or cuts the bytes, and takes what comes back.
    fn corrupt(&mut self, state: Saved, generator: &mut ChaCha8Rng) -> Result<(), Violation> {
        let mut bytes = match self.instance.pack(state) {
            Ok(bytes) => bytes,
            Err(status) => return known("fmi2SerializeFMUstate", status),
        };
        let changed = generator.random_bool(0.8);
        if changed && !bytes.is_empty() {
            for _ in 0..generator.random_range(1..4) {
                let place = generator.random_range(0..bytes.len());
                bytes[place] ^= generator.random_range(1..=u8::MAX);
            }
        }
        if generator.random_bool(0.3) {
            bytes.truncate(generator.random_range(0..=bytes.len()));
        }
        match self.instance.unpack(&bytes) {
            Ok(state) => {
                self.saved.push(state);
                known("fmi2SetFMUstate", self.instance.restore(state))
            }
            Err(status) => known("fmi2DeSerializeFMUstate", status),
        }
    }

    fn phase(&mut self, generator: &mut ChaCha8Rng) -> Result<(), Violation> {
        let start = if generator.random_bool(0.7) { 0.0 } else { reading(generator) };
        let status = match generator.random_range(0..8) {
            0 => self.instance.setup(start),
            1 => self.instance.setup_until(start, reading(generator)),
            2 => self.instance.enter(),
            3 => self.instance.exit(),
            4 => self.instance.terminate(),
            5 => self.instance.reset(),
            _ => {
                let status = self.instance.reset().max(self.instance.initialize(start));
                if status == OK {
                    self.time = start;
                }
                status
            }
        };
        known("a change of phase", status)
    }

    /// What no master should do.
    fn nonsense(&mut self, generator: &mut ChaCha8Rng) -> Result<(), Violation> {
        let [one, other] = [self.reference(generator), self.reference(generator)];
        let mistake = match generator.random_range(0..6) {
            0 => Mistake::NullArray,
            1 => Mistake::NullText(one),
            2 => Mistake::Derivative([one, other], reading(generator)),
            3 => Mistake::Status(generator.random_range(0..6)),
            4 => Mistake::InputDerivative(one),
            _ => Mistake::Cancel,
        };
        known("a call without sense", self.instance.mistake(mistake))
    }

    /// Model exchange, where there is one.
    fn integrate(&mut self, generator: &mut ChaCha8Rng) -> Result<(), Violation> {
        let Some(functions) = self.subject.exchange else { return Ok(()) };
        let exchange = Exchange { instance: &self.instance, functions };
        let count = generator.random_range(0..4);
        let values: Vec<f64> = (0..count).map(|_| reading(generator)).collect();
        let status = match generator.random_range(0..7) {
            0 => exchange.enter_event_mode(),
            1 => exchange.new_discrete_states().err().unwrap_or(OK),
            2 => exchange.enter_continuous_time_mode(),
            3 => exchange.completed_integrator_step().err().unwrap_or(OK),
            4 => exchange.set_time(self.time + one(generator, &STEPS)),
            5 => exchange.set_states(&values),
            _ => exchange.derivatives(count).err().unwrap_or(OK),
        };
        known("a call of model exchange", status)
    }
}

fn number(variable: &Variable) -> u32 {
    match variable.kind {
        Kind::Real { .. } => 0,
        Kind::Boolean { .. } => 2,
        Kind::String { .. } => 3,
        _ => 1,
    }
}

fn one<T: Copy>(generator: &mut ChaCha8Rng, all: &[T]) -> T {
    all[generator.random_range(0..all.len())]
}

fn reading(generator: &mut ChaCha8Rng) -> f64 {
    if generator.random_bool(0.7) { generator.random_range(-2.0..2.0) } else { one(generator, &READINGS) }
}

fn known(call: &str, status: Status) -> Result<(), Violation> {
    if [OK, WARNING, ERROR].contains(&status) { Ok(()) } else { Err(format!("{call} answers {status}")) }
}
