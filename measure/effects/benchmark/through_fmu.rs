//! The plant in motion as a simulator sees it: an FMU stepped through its FMI functions.

use super::plant::{Law, Rig, Track};
use super::secret;
use switchid::fmu::plant_of_model;
use switchid::law::{Catalogue, Given, Model, State, Term};
use switchid::simulate::{Excitation, ExcitationKind};
use switchid_fmu_plant::functions;
use switchid_fmu_slave::Interface;
use switchid_fmu_slave::host::{Instance, Request};
use switchid_fmu_slave::linked_functions;

/// Why an FMU gave no motion.
type Failure = Box<dyn std::error::Error + Send + Sync>;

/// `fmi2OK`.
const OK: u32 = 0;

/// The motion from rest of the law's known terms, its others hidden, under that excitation.
///
/// # Errors
/// Whatever the FMU refuses, in its own words.
pub fn run(rig: &Rig, law: &Law, excitation: &Excitation) -> Result<Track, Failure> {
    let pairs = || law.terms.iter().copied().zip(law.coefficients.iter().copied());
    let known = pairs().take(law.known).map(|(term, coefficient)| (term, Given::Known(coefficient)));
    let fmu = plant_of_model("Plant", &Model::of("plant", known))?;
    let resources = tempfile::tempdir()?;
    for (path, content) in fmu.files() {
        if let Some(name) = path.strip_prefix("resources/") {
            std::fs::write(resources.path().join(name), content)?;
        }
    }
    let interface: Interface = serde_json::from_slice(&std::fs::read(resources.path().join("interface.json"))?)?;
    let location = resources.path().display().to_string();
    let request = Request { co_simulation: true, guid: fmu.guid(), location: Some(&location), logging: true };
    let instance = Instance::new(linked_functions!(functions), &request).map_err(|said| format!("{said:?}"))?;
    let plant = Plant { instance, interface };
    plant.drive(excitation, rig.fmi_seed())?;
    for (term, coefficient) in pairs().skip(law.known) {
        plant.hide(term, coefficient)?;
    }
    plant.motion(rig)
}

/// An instance and the names of its variables.
struct Plant {
    instance: Instance,
    interface: Interface,
}

impl Plant {
    fn reference(&self, name: &str) -> Result<u32, Failure> {
        Ok(self.interface.description.position(name).ok_or_else(|| format!("no variable {name}"))? as u32)
    }

    fn accepted(&self, status: u32, what: &str) -> Result<(), Failure> {
        if status == OK { Ok(()) } else { Err(format!("{what}: {:?}", self.instance.messages()).into()) }
    }

    fn set(&self, name: &str, value: f64) -> Result<(), Failure> {
        self.accepted(self.instance.set_reals(&[self.reference(name)?], &[value]), name)
    }

    fn drive(&self, excitation: &Excitation, seed: u64) -> Result<(), Failure> {
        let kind = match excitation.kind {
            ExcitationKind::None => 1,
            ExcitationKind::Sine => 2,
            ExcitationKind::WhiteNoise => 3,
            ExcitationKind::Multisine => 4,
            ExcitationKind::Sweep => 5,
        };
        let integers =
            [("excitation.kind", kind), ("excitation.count", excitation.count as i32), ("seed", seed as i32)];
        for (name, value) in integers {
            self.accepted(self.instance.set_integer(self.reference(name)?, value), name)?;
        }
        let Excitation { intensity, sample_time, from, to, rms, period, .. } = *excitation;
        let reals = [("intensity", intensity), ("sample_time", sample_time), ("from", from), ("to", to)];
        let reals = reals.into_iter().chain([("rms", rms), ("period", period)]);
        reals.into_iter().try_for_each(|(name, value)| self.set(&format!("excitation.{name}"), value))
    }

    fn hide(&self, term: Term, coefficient: f64) -> Result<(), Failure> {
        let entry = Catalogue::find(secret::id(term)).ok_or("an effect that the catalogue does not have")?;
        let name = format!("hidden.{}", entry.id);
        self.set(&name, coefficient)?;
        let values = term.effect().map_or(Vec::new(), |effect| effect.inner_values());
        let mut inner = entry.inner().iter().zip(values);
        inner.try_for_each(|(parameter, value)| self.set(&format!("{name}.{}", parameter.name), value))
    }

    fn motion(&self, rig: &Rig) -> Result<Track, Failure> {
        self.accepted(self.instance.initialize(0.0), "initialization")?;
        let outputs = [self.reference("q")?, self.reference("qd")?, self.reference("F")?];
        let mut track = Track::default();
        for k in 0..rig.count {
            let t = k as f64 * rig.sample_time;
            let [q, qd, excitation] = self.instance.reals(&outputs).map_err(|status| format!("t = {t}: {status}"))?[..]
            else {
                return Err("three outputs were asked for".into());
            };
            track.push(t, State { q, qd }, excitation, 0.0);
            self.accepted(self.instance.step(t, rig.sample_time), "a step")?;
        }
        Ok(track)
    }
}
