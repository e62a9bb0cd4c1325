//! The plant in motion: directly, as a scenario, or as an FMU.

use super::generator::Generator;
use super::outside::Agent;
use super::plant::{Law, Rig, Track};
use super::through_fmu;
use switchid::law::{Hold, Samples, State};
use switchid::simulate::{Hidden, Scenario, Stage, record};

/// Steps per sample while strengths are sought, and in the end.
pub const PARTS: [usize; 2] = [4, 16];

impl Rig {
    /// The motion from rest, a sample cut into `parts` steps; none where it has no bounds.
    pub fn run(&self, law: &Law, parts: usize, agent: Option<(Agent, f64)>) -> Option<Track> {
        let track = match self.scenario {
            true => self.run_scenario(law, parts)?,
            false => self.run_direct(law, parts, agent)?,
        };
        track.q.iter().all(|q| q.is_finite()).then_some(track)
    }

    fn run_scenario(&self, law: &Law, parts: usize) -> Option<Track> {
        let mut excitation = self.drive.of_scenario(self.omega, self.sample_time, self.count);
        excitation.rms = self.amplitude;
        excitation.intensity *= self.amplitude * self.amplitude;
        if self.fmu && parts == PARTS[1] {
            return through_fmu::run(self, law, &excitation).ok();
        }
        let (terms, coefficients) = (law.terms[..law.known].to_vec(), law.coefficients[..law.known].to_vec());
        let stage = Stage { start: 0.0, coefficients, amplitude: 0.0, omega: 0.0 };
        let duration = self.sample_time * (self.count as f64 - 0.5);
        let mut scenario = Scenario::new("hidden effect", terms, vec![stage], duration).with_seed(self.fmi_seed());
        scenario.excitation = excitation;
        scenario.inner_step = self.sample_time / parts as f64;
        let mut hidden = Hidden::default();
        let pairs = law.terms.iter().zip(&law.coefficients).skip(law.known);
        pairs.for_each(|(term, coefficient)| hidden.push(*term, *coefficient));
        scenario.hidden = hidden;
        let mut track = Track::default();
        for reading in record(&scenario).ok()? {
            track.push(reading.t, State { q: reading.q, qd: reading.qd }, reading.excitation, 0.0);
        }
        Some(track)
    }

    fn run_direct(&self, law: &Law, parts: usize, mut agent: Option<(Agent, f64)>) -> Option<Track> {
        let mut generator = Generator::new(self.seed);
        let values = self.drive.values(&mut generator, self.omega, self.sample_time, self.count);
        let excitation: Vec<f64> = values.iter().map(|value| value * self.amplitude).collect();
        let t: Vec<f64> = (0..self.count).map(|index| index as f64 * self.sample_time).collect();
        let samples = Samples { t: &t, excitation: &excitation, hold: self.direct_hold };
        let disturbance: Vec<f64> = self.disturbance.iter().map(|value| value * self.amplitude).collect();
        let disturbance = Samples { t: &t[..disturbance.len()], excitation: &disturbance, hold: Hold::Linear };
        let (place, factor) = self.switch.unwrap_or((usize::MAX, 1.0));
        let later = law.stiffened(factor);
        let mut dynamics = law.dynamics()?;
        let mut phase = dynamics.rest(State::default());
        let width = self.sample_time / parts as f64;
        let mut track = Track::default();
        for (k, now) in t.iter().enumerate() {
            if k == place {
                dynamics = later.dynamics()?;
            }
            // what is held stays until the sample's end, also at it
            let is_held = |t: f64| self.direct_hold == Hold::Zero && t > *now;
            let measured = |t: f64| if is_held(t) { excitation[k] } else { samples.at(t) };
            for part in 0..parts {
                let from = now + width * part as f64;
                let (force, strength) = match &mut agent {
                    Some((agent, strength)) => (agent.force(from, width, phase.state, measured(from)), *strength),
                    None => (0.0, 0.0),
                };
                if part == 0 {
                    track.push(*now, phase.state, excitation[k], force);
                }
                phase =
                    dynamics.step(&phase, from, width, &|t: f64| measured(t) + disturbance.at(t) - strength * force);
            }
        }
        Some(track)
    }
}
