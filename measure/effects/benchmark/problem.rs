//! One problem: a noisy record, the model's terms, and the truth that only the judge sees.

use super::base::{self, Base};
use super::drive::{Drive, rms, std};
use super::generator::Generator;
use super::outside::Agent;
use super::plant::{Law, Rig, Track};
use super::run::PARTS;
use super::secret::{self, Secret, with_delay};
use super::sensors::{Readings, Sensors};
use std::f64::consts::TAU;
use std::hash::{DefaultHasher, Hash, Hasher};
use switchid::identify::Recording;
use switchid::law::{Catalogue, Hold, State, Term};

/// What is drawn, but for chance.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// What is hidden.
    pub secret: Secret,
    /// RMS of its force ÷ RMS of F.
    pub strength: f64,
    /// Std of the sensors' noise ÷ std of each channel.
    pub noise: f64,
    /// What measures the motion.
    pub sensors: Sensors,
    /// By which part the stiffness rises on the way, for good; 0 where nothing switches.
    pub switch: f64,
    /// Samples of the record, lost ones counted.
    pub samples: usize,
    /// Seed of the whole benchmark.
    pub seed: u64,
    /// Which draw.
    pub draw: u64,
}

/// A problem and its truth.
#[derive(Debug)]
pub struct Problem {
    /// What the sensors show.
    pub recording: Recording,
    /// What the excitation did between samples.
    pub hold: Hold,
    /// The model's terms.
    pub model: Vec<Term>,
    /// The terms that it lacks, inner parameters as they are.
    pub lacking: Vec<Term>,
    /// The record less the force that no term gives, where there is one.
    pub relieved: Option<Recording>,
    /// When the law switches, s.
    pub switch: Option<f64>,
    /// Excitation, channels and scales in words.
    pub words: String,
}

/// Attempts at a bounded motion.
const ATTEMPTS: u64 = 60;

/// Part of the record after which the law switches, give or take a fifth of it.
const SWITCHES_AT: f64 = 0.55;

/// Iterations of coefficient and excitation towards their strengths.
const ITERATIONS: usize = 6;

impl Setting {
    /// A seed of its own for every setting, whatever else is run.
    fn own_seed(&self, attempt: u64) -> u64 {
        let mut hasher = DefaultHasher::new();
        (self.seed, self.draw, attempt, self.secret.name()).hash(&mut hasher);
        (self.strength.to_bits(), self.noise.to_bits(), self.samples).hash(&mut hasher);
        if self.sensors != Sensors::Ideal {
            self.sensors.hash(&mut hasher);
        }
        if self.switch != 0.0 {
            self.switch.to_bits().hash(&mut hasher);
        }
        hasher.finish()
    }
}

/// Draws a problem; none where no attempt has a bounded motion.
pub fn draw(setting: &Setting) -> Option<Problem> {
    (0..ATTEMPTS).find_map(|attempt| attempted(setting, &mut Generator::new(setting.own_seed(attempt))))
}

fn attempted(setting: &Setting, generator: &mut Generator) -> Option<Problem> {
    let mut base = base::draw(generator, &setting.secret, setting.sensors);
    let lead = if generator.chance(0.5) { setting.samples / 10 } else { 0 };
    let mut rig = rig(setting, generator, &base, setting.samples + lead);
    let alone = scaled(setting, &mut rig, &mut base)?;
    let (track, law) = with_secret(setting, generator, &rig, &base, &alone)?;
    measured(setting, generator, &rig, track, lead, &law)
}

/// What drives and samples a plant of that law.
fn rig(setting: &Setting, generator: &mut Generator, base: &Base, count: usize) -> Rig {
    // a scenario's own terms must have the inertia, and nothing disturbs it
    let straight =
        matches!(setting.secret, Secret::Outside(_)) || setting.secret.has("inertia") || setting.switch != 0.0;
    let place = |generator: &mut Generator| (SWITCHES_AT * count as f64 * generator.uniform(0.8..1.2)) as usize;
    let is_ideal = setting.sensors == Sensors::Ideal;
    Rig {
        drive: generator.choose(&Drive::ALL),
        scenario: generator.chance(0.4) && is_ideal && !straight,
        omega: base.omega,
        sample_time: setting.sensors.sample_time(generator, base.omega),
        count,
        amplitude: base.stiffness * base.size,
        fmu: setting.draw % 2 == 1,
        seed: generator.seed(),
        direct_hold: setting.sensors.hold(generator),
        disturbance: setting.sensors.disturbance(generator, base.omega, count),
        switch: (setting.switch != 0.0).then(|| (place(generator), 1.0 + setting.switch)),
    }
}

/// Scales the excitation to the size of the motion that the base law is to have, behind a usual rig's sensors also the
/// law to its T₀.
fn scaled(setting: &Setting, rig: &mut Rig, base: &mut Base) -> Option<Track> {
    let period = TAU / base.omega;
    let mut track = rig.run(&base.law(), PARTS[0], None)?;
    for _ in 0..3 {
        rig.amplitude *= (base.size / std(&track.q)).clamp(0.1, 10.0);
        if setting.sensors != Sensors::Ideal {
            base.stretch((period / track.period()).clamp(0.5, 2.0));
            rig.omega = base.omega;
        }
        track = rig.run(&base.law(), PARTS[0], None)?;
    }
    Some(track)
}

/// The motion with what is hidden, at its strength.
fn with_secret(
    setting: &Setting,
    generator: &mut Generator,
    rig: &Rig,
    base: &Base,
    alone: &Track,
) -> Option<(Track, Law)> {
    let scale = State { q: std(&alone.q), qd: std(&alone.qd) };
    if let Secret::Outside(effect) = setting.secret {
        let agent = Agent::draw(generator, effect, scale, base.omega, rig.sample_time, rig.count);
        let law = base.law();
        return Some((with_agent(setting, rig, &law, alone, agent)?, law));
    }
    let mut known = base.clone();
    let (mut terms, mut signs, mut first) = (Vec::new(), Vec::new(), Vec::new());
    for id in setting.secret.ids() {
        let prototype = Catalogue::find(id)?.term;
        known = known.without(prototype);
        let term = secret::with_inner(generator, prototype, scale, base.omega);
        signs.push(secret::sign(generator, term));
        let present = base.coefficient(term);
        let strength = setting.strength * rms(&alone.excitation) / rms(&alone.force(term, rig.hold()));
        first.push(if present > 0.0 { present } else { signs[signs.len() - 1] * strength });
        terms.push(term);
    }
    let mut law = Law {
        terms: known.terms.iter().chain(&terms).copied().collect(),
        coefficients: known.coefficients.iter().chain(&first).copied().collect(),
        known: known.terms.len(),
    };
    for _ in 0..ITERATIONS {
        let track = rig.run(&law, PARTS[0], None)?;
        strengthen(setting, rig, &mut law, &track);
    }
    let track = rig.run(&law, PARTS[1], None)?;
    bounded(&track, alone).then_some((track, law))
}

/// Moves coefficients, of a delay or a lag the time itself, towards the strength.
fn strengthen(setting: &Setting, rig: &Rig, law: &mut Law, track: &Track) {
    for index in law.known..law.terms.len() {
        let force = law.coefficients[index].abs() * rms(&track.force(law.terms[index], rig.hold()));
        let factor = (setting.strength * rms(&track.excitation) / force).clamp(0.2, 5.0);
        if ["excitation_delay", "actuator_lag"].contains(&secret::id(law.terms[index])) {
            law.coefficients[index] = 1.0;
            law.terms[index] = with_delay(law.terms[index], factor);
        } else {
            law.coefficients[index] *= factor;
        }
    }
}

fn with_agent(setting: &Setting, rig: &Rig, law: &Law, alone: &Track, agent: Agent) -> Option<Track> {
    let mut strength = 0.0;
    for round in 0..=ITERATIONS {
        let parts = PARTS[usize::from(round == ITERATIONS)];
        let track = rig.run(law, parts, Some((agent.clone(), strength)))?;
        if round == ITERATIONS {
            let outside = track.outside.iter().map(|force| strength * force).collect();
            return bounded(&track, alone).then_some(Track { outside, ..track });
        }
        let next = setting.strength * rms(&track.excitation) / rms(&track.outside);
        strength = if strength > 0.0 { next.clamp(0.2 * strength, 5.0 * strength) } else { 0.5 * next };
    }
    None
}

/// Whether the hidden effect left the motion the size that it had.
fn bounded(track: &Track, alone: &Track) -> bool {
    let largest = |values: &[f64]| values.iter().map(|value| value.abs()).fold(0.0, f64::max);
    let ratio = std(&track.q) / std(&alone.q);
    (0.1..5.0).contains(&ratio) && largest(&track.q) < 10.0 * largest(&alone.q)
}

fn measured(
    setting: &Setting,
    generator: &mut Generator,
    rig: &Rig,
    track: Track,
    lead: usize,
    law: &Law,
) -> Option<Problem> {
    let period = track.period();
    let readings = setting.sensors.read(generator, setting.noise, track, lead);
    let Readings { t, q, qd, excitation, relieved } = &readings;
    let record = |excitation: &Vec<f64>| {
        Recording::new("draw", t.clone(), Some(q.clone()), qd.clone(), Some(excitation.clone()))
    };
    let complete = matches!(setting.secret, Secret::Complete(_));
    let split = if complete { law.terms.len() } else { law.known };
    Some(Problem {
        recording: record(excitation).ok()?,
        hold: rig.hold(),
        model: law.terms[..split].to_vec(),
        lacking: law.terms[split..].to_vec(),
        switch: rig.switch.map(|(at, _)| at as f64 * rig.sample_time),
        relieved: matches!(setting.secret, Secret::Outside(_)).then(|| record(relieved)).and_then(Result::ok),
        words: words(rig, law, qd.is_some(), period),
    })
}

fn words(rig: &Rig, law: &Law, velocity: bool, period: f64) -> String {
    let pairs = law.terms.iter().zip(&law.coefficients);
    let law: Vec<String> = pairs
        .map(|(term, coefficient)| {
            let inner = term.effect().map_or(Vec::new(), |effect| effect.inner_values());
            format!(
                "{coefficient:.3e} {}{}",
                term.name(),
                if inner.is_empty() { String::new() } else { format!("{inner:.3?}") }
            )
        })
        .collect();
    let channels = if velocity { "q, qd" } else { "q" };
    let path = match (rig.scenario, rig.fmu) {
        (true, true) => "FMU",
        (true, false) => "scenario",
        (false, _) => "direct",
    };
    let Rig { drive, omega, .. } = rig;
    format!("{drive:?} {path}, {}, {channels}, omega {omega:.2}, T0 {period:.3} s: {}", rig.hold(), law.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_usual_rigs_motion_has_its_period_and_size() {
        for (sensors, period) in [(Sensors::Slow, 2.0), (Sensors::Fast, 0.25)] {
            for draw in 0..6 {
                let secret = Secret::Complete(None);
                let setting =
                    Setting { secret, strength: 0.1, noise: 0.0, sensors, samples: 5000, switch: 0.0, seed: 1, draw };
                let mut generator = Generator::new(setting.own_seed(0));
                let mut base = base::draw(&mut generator, &setting.secret, sensors);
                let mut rig = rig(&setting, &mut generator, &base, setting.samples);
                let Some(track) = scaled(&setting, &mut rig, &mut base) else { panic!("no motion: {setting:?}") };
                assert_eq!(rig.sample_time, 5e-3);
                let [period, size] = [track.period() / period, std(&track.q) / base.size];
                assert!((0.8..1.25).contains(&period) && (0.7..1.4).contains(&size), "{setting:?}: {period}, {size}");
            }
        }
    }
}
