//! Random calls, allowed or not, with random arguments: nothing may crash, and after a reset the instance is as new.

use super::{Drive, OK, Subject, run};
use switchid_fmu_slave::Kind;
use switchid_fmu_slave::host::{Instance, Saved};

/// How many sequences run where the environment does not say otherwise.
const SEQUENCES: u64 = 300;

/// Calls in a sequence.
const CALLS: usize = 40;

/// Runs the sequences, as many as `SWITCHID_SEQUENCES` says, and then the drive on the same instance.
pub fn storm(subject: &Subject, drive: &Drive) {
    let count = std::env::var("SWITCHID_SEQUENCES").ok().and_then(|text| text.parse().ok()).unwrap_or(SEQUENCES);
    let reference = run(subject, drive, &subject.instance());
    let mut instance = subject.instance();
    let mut held = Held::default();
    for sequence in 0..count {
        if sequence % 100 == 99 {
            // the states of the old one stay in the host's list
            instance = subject.instance();
        }
        let mut random = Random(sequence + 1);
        (0..CALLS).for_each(|_| call(subject, &instance, drive, &mut random, &mut held));
        if random.below(4) == 0 {
            assert_eq!(instance.reset(), OK);
        }
    }
    assert_eq!(instance.reset(), OK);
    assert!(run(subject, drive, &instance) == reference, "after {count} random sequences and a reset the run differs");
}

/// What a careless host still has.
#[derive(Default)]
struct Held {
    states: Vec<Saved>,
    bytes: Vec<u8>,
}

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }

    fn real(&mut self) -> f64 {
        let odd = [0.0, 1.0, -1.0, 0.5, 1e-3, 7.0, 1e30, -1e300, f64::NAN, f64::INFINITY, f64::MIN_POSITIVE];
        match self.below(3) {
            0 => odd[self.below(odd.len())],
            _ => self.below(2000) as f64 * 1e-3 - 1.0,
        }
    }
}

fn call(subject: &Subject, instance: &Instance, drive: &Drive, random: &mut Random, held: &mut Held) {
    let status = match random.below(20) {
        0 => instance.setup(random.real()),
        1 => instance.setup_until(random.real(), random.real()),
        2 => instance.enter(),
        3 => instance.exit(),
        4 => instance.terminate(),
        5 => instance.reset(),
        6..10 => set(subject, instance, random),
        10 => instance.reals(&[random.below(2000) as u32]).err().unwrap_or(OK),
        11 => instance.integer(random.below(2000) as u32).err().unwrap_or(OK),
        12 => instance.text(random.below(2000) as u32).err().unwrap_or(OK),
        13 => keep(instance, random, held),
        14 => instance.restore(handle(random, held)),
        15 => free(instance, random, held),
        16 => unpack(instance, random, held),
        17 => begin(instance, drive),
        _ => instance.step(random.real(), random.real().abs().min(1.0)),
    };
    assert!([0, 3].contains(&status), "status {status}");
}

/// A setting of the right type as a rule; those that fix the memory stay.
fn set(subject: &Subject, instance: &Instance, random: &mut Random) -> u32 {
    let variables = &subject.interface.description.variables;
    let place = random.below(variables.len());
    if ["max_window", "sample_time", "excitation.sample_time"].contains(&variables[place].name.as_str()) {
        return OK;
    }
    match (&variables[place].kind, random.below(10)) {
        (_, 0) => instance.set_boolean(random.below(2000) as u32, random.below(3) as i32),
        (Kind::Real { .. }, _) => instance.set_reals(&[place as u32], &[random.real()]),
        (Kind::String { .. }, _) => {
            let texts = ["qdd qd q", "", "q_3,qdd", "% s %n", "größe"];
            instance.set_text(place as u32, texts[random.below(texts.len())])
        }
        (Kind::Boolean { .. }, _) => instance.set_boolean(place as u32, random.below(2) as i32),
        _ => instance.set_integer(place as u32, random.below(9) as i32 - 1),
    }
}

fn begin(instance: &Instance, drive: &Drive) -> u32 {
    let status = instance.reset();
    (drive.prepare)(instance);
    (0..3).for_each(|k| (drive.step)(instance, k));
    status
}

fn handle(random: &mut Random, held: &Held) -> Saved {
    match random.below(4) {
        0 => Saved::at(random.next() as usize),
        _ if held.states.is_empty() => Saved::NULL,
        _ => held.states[random.below(held.states.len())],
    }
}

fn keep(instance: &Instance, random: &mut Random, held: &mut Held) -> u32 {
    let Ok(state) = instance.save() else { return 3 };
    if random.below(8) == 0 {
        held.bytes = instance.pack(state).unwrap();
    }
    if held.states.len() < 4 {
        held.states.push(state);
        return OK;
    }
    // the oldest handle stays in the host's list though its state is freed
    let mut oldest = held.states[random.below(4)];
    let freed = instance.free(&mut oldest);
    instance.free(&mut { state });
    freed
}

fn free(instance: &Instance, random: &mut Random, held: &mut Held) -> u32 {
    let mut state = handle(random, held);
    instance.free(&mut state)
}

fn unpack(instance: &Instance, random: &mut Random, held: &Held) -> u32 {
    let mut bytes = held.bytes.clone();
    if !bytes.is_empty() && random.below(2) == 0 {
        let place = random.below(bytes.len());
        bytes[place] ^= 1 << random.below(8);
        bytes.truncate(bytes.len() - random.below(2) * random.below(bytes.len()));
        return instance.unpack(&bytes).map_or(3, |_| panic!("changed bytes were accepted"));
    }
    match instance.unpack(&bytes) {
        Ok(mut state) => instance.restore(state).max(instance.free(&mut state)),
        Err(status) => status,
    }
}
