//! What every FMU of ours must hold, whatever it computes: run on the identifier and on the plants.

mod storm;
mod subject;

pub use subject::{OK, Subject};

use switchid_fmu_slave::host::{Instance, Request};
use switchid_fmu_slave::{Causality, Kind};

impl Subject {
    /// Why there is no instance once that resource is gone.
    pub fn refusal_without(&self, resource: &str) -> String {
        let path = self.resources.path().join(resource);
        let content = std::fs::read(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        let location = self.resources.path().display().to_string();
        let request =
            Request { co_simulation: true, guid: &self.interface.guid, location: Some(&location), logging: true };
        let messages = Instance::new(self.functions, &request).err().unwrap();
        std::fs::write(&path, content).unwrap();
        messages[0].2.clone()
    }

    /// Every output, bit by bit.
    pub fn outputs(&self, instance: &Instance) -> Vec<u64> {
        let variables = self.interface.description.variables.iter().zip(0..);
        let outputs = variables.filter(|(variable, _)| variable.causality == Causality::Output);
        outputs
            .map(|(variable, reference)| match variable.kind {
                Kind::Real { .. } => instance.reals(&[reference]).unwrap()[0].to_bits(),
                Kind::Boolean { .. } => instance.boolean(reference).unwrap() as u64,
                _ => instance.integer(reference).unwrap() as u64,
            })
            .collect()
    }
}

/// How a subject is set up and stepped.
pub struct Drive<'a> {
    /// Sets parameters of a fresh instance and initialises it.
    pub prepare: &'a dyn Fn(&Instance),
    /// Takes step k.
    pub step: &'a dyn Fn(&Instance, u32),
    /// How many steps a run has; the interesting event should come in the second half.
    pub steps: u32,
}

/// The whole contract.
pub fn check(subject: &Subject, drive: &Drive) {
    let reference = run(subject, drive, &subject.instance());
    assert!(reference.iter().any(|outputs| *outputs != reference[0]), "nothing ever changes: the run shows nothing");
    reset_equals_fresh(subject, drive, &reference);
    restored_equals_going_on(subject, drive, &reference);
    interleaved_equals_alone(subject, drive, &reference);
    storm::storm(subject, drive);
}

fn run(subject: &Subject, drive: &Drive, instance: &Instance) -> Vec<Vec<u64>> {
    (drive.prepare)(instance);
    go_on(subject, drive, instance, 0)
}

fn go_on(subject: &Subject, drive: &Drive, instance: &Instance, from: u32) -> Vec<Vec<u64>> {
    let step = |k| {
        (drive.step)(instance, k);
        subject.outputs(instance)
    };
    (from..drive.steps).map(step).collect()
}

fn reset_equals_fresh(subject: &Subject, drive: &Drive, reference: &[Vec<u64>]) {
    let instance = subject.instance();
    let fresh = subject.outputs(&instance);
    run(subject, drive, &instance);
    assert_eq!(instance.reset(), OK);
    assert_eq!(subject.outputs(&instance), fresh);
    assert!(run(subject, drive, &instance) == reference, "after fmi2Reset the run differs");
}

fn restored_equals_going_on(subject: &Subject, drive: &Drive, reference: &[Vec<u64>]) {
    let half = drive.steps / 2;
    let instance = subject.instance();
    (drive.prepare)(&instance);
    (0..half).for_each(|k| (drive.step)(&instance, k));
    let mut state = instance.save().unwrap();
    let bytes = instance.pack(state).unwrap();
    let rest = &reference[half as usize..];
    assert!(go_on(subject, drive, &instance, half) == rest, "saving disturbs");
    assert_eq!(instance.restore(state), OK);
    assert!(go_on(subject, drive, &instance, half) == rest, "after fmi2SetFMUstate the run differs");
    assert_eq!(instance.free(&mut state), OK);
    moved_equals_going_on(subject, drive, &bytes, rest);
}

fn moved_equals_going_on(subject: &Subject, drive: &Drive, bytes: &[u8], rest: &[Vec<u64>]) {
    let other = subject.instance();
    let mut state = other.unpack(bytes).unwrap();
    assert_eq!(other.restore(state).max(other.free(&mut state)), OK);
    let mut again = other.save().unwrap();
    assert_eq!(other.pack(again).unwrap(), bytes);
    assert_eq!(other.free(&mut again), OK);
    assert!(go_on(subject, drive, &other, drive.steps / 2) == rest, "in another instance the run differs");
}

fn interleaved_equals_alone(subject: &Subject, drive: &Drive, reference: &[Vec<u64>]) {
    let instances = [subject.instance(), subject.instance()];
    instances.iter().for_each(|instance| (drive.prepare)(instance));
    for k in 0..drive.steps {
        for instance in &instances {
            (drive.step)(instance, k);
            assert!(subject.outputs(instance) == reference[k as usize], "instances disturb each other at step {k}");
        }
    }
}
